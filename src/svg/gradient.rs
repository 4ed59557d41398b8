//! Writes what areas refer to: gradients, and filters that blur.

use super::dialect::{self, Unit};
use super::layer::Written;
use crate::scene::{Area, Axis, Shade, ShadeStop, quantum, units};

/// Appends the filter of a shadow, the `number`-th of its file, in px.
pub(super) fn push_blur(out: &mut String, shadow: &Area, number: usize) {
    *out += &format!("<filter id=\"{}-{number}\"", dialect::BLUR_ID);
    for (name, value) in dialect::FILTER {
        *out += &format!(" {name}=\"{value}\"");
    }
    for (name, px) in dialect::FILTER_PLACE.iter().zip(place(shadow)) {
        *out += &format!(" {name}=\"{px}\"");
    }
    let (gaussian, deviation) = dialect::GAUSSIAN;
    *out += &format!("><{gaussian} {deviation}=\"");
    let hundredths = (f64::from(shadow.blur) * 100.0).round() as i64;
    Unit::PX.push(out, hundredths * dialect::HUNDREDTH);
    *out += "\"/></filter>";
}

/// The x, y, width and height of the filter of a shadow, px: without them programs cut off the blur far from the shape.
pub(super) fn place(shadow: &Area) -> [i64; 4] {
    let extent = shadow.extent();
    [extent.x0, extent.y0, extent.width(), extent.height()].map(|px| px as i64)
}

/// Appends the gradient of a mark that has one, and then `end`.
pub(super) fn push_of(out: &mut String, mark: &Written, end: &str) {
    if let Some(shade) = mark.mark.shade() {
        push(out, shade, &id(mark));
        *out += end;
    }
}

/// The paint of a mark that has a gradient, as attributes name it.
pub(super) fn paint(mark: &Written) -> Option<String> {
    mark.mark.shade()?;
    Some(format!("url(#{})", id(mark)))
}

/// The name of the gradient of an area: unique, as layers have different numbers.
fn id(mark: &Written) -> String {
    let [layer, number] = mark.place;
    format!("{}-{layer}-{number}", dialect::SHADE_ID)
}

/// Appends the gradient of `shade` by the name of `id`, with numbers in px.
pub(super) fn push(out: &mut String, shade: &Shade, id: &str) {
    let (kind, names): (_, &[&str]) = match shade.axis() {
        Axis::Linear { .. } => (dialect::LINEAR, &dialect::LINEAR_AXIS),
        Axis::Radial { .. } => (dialect::RADIAL, &dialect::RADIAL_AXIS),
    };
    *out += &format!("<{kind} id=\"{id}\" gradientUnits=\"userSpaceOnUse\"");
    for (name, px) in names.iter().zip(shade.axis().numbers()) {
        *out += &format!(" {name}=\"");
        Unit::PX.push(out, units(px));
        out.push('"');
    }
    out.push('>');
    shade.stops().iter().for_each(|stop| push_stop(out, stop));
    *out += &format!("</{kind}>");
}

fn push_stop(out: &mut String, stop: &ShadeStop) {
    *out += "<stop offset=\"";
    Unit::PX.push(out, i64::from(stop.thousandths()) * dialect::THOUSANDTH);
    *out += &format!(
        "\" stop-color=\"{}\"",
        dialect::hex(stop.color.map(quantum))
    );
    let opacity = quantum(stop.opacity);
    if opacity < u8::MAX {
        *out += &format!(" stop-opacity=\"{}\"", dialect::opacity(opacity));
    }
    *out += "/>";
}
