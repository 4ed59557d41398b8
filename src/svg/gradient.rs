//! Writes the gradient of a shade.

use super::dialect::{self, Unit};
use super::layer::Written;
use crate::scene::{Axis, Shade, ShadeStop, quantum, units};

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
