//! Writes the gradient of a shade.

use super::dialect::{self, Unit};
use crate::scene::{Shade, Written, WrittenAxis, WrittenShade, WrittenStop};

/// Appends the gradient of a mark that has one, and then `end`.
pub(super) fn push_of(out: &mut String, mark: &Written, end: &str) {
    if let Some(named) = &mark.shade {
        push(out, &named.shade, &id(named));
        *out += end;
    }
}

/// The paint of a mark that has a gradient, as attributes name it.
pub(super) fn paint(mark: &Written) -> Option<String> {
    let named = mark.shade.as_ref()?;
    Some(format!("url(#{})", id(named)))
}

/// The name of the gradient of an area: unique, as layers have different numbers.
fn id(shade: &WrittenShade) -> String {
    let [layer, number] = shade.place;
    format!("{}-{layer}-{number}", dialect::SHADE_ID)
}

/// Appends the gradient of `shade` by the name of `id`, with numbers in px.
pub(super) fn push(out: &mut String, shade: &Shade, id: &str) {
    let (kind, names, numbers): (_, &[&str], &[i64]) = match &shade.axis {
        WrittenAxis::Linear(numbers) => (dialect::LINEAR, &dialect::LINEAR_AXIS, numbers),
        WrittenAxis::Radial(numbers) => (dialect::RADIAL, &dialect::RADIAL_AXIS, numbers),
    };
    *out += &format!("<{kind} id=\"{id}\" gradientUnits=\"userSpaceOnUse\"");
    for (name, &units) in names.iter().zip(numbers) {
        *out += &format!(" {name}=\"");
        Unit::PX.push(out, units);
        out.push('"');
    }
    out.push('>');
    shade.stops.iter().for_each(|stop| push_stop(out, stop));
    *out += &format!("</{kind}>");
}

fn push_stop(out: &mut String, stop: &WrittenStop) {
    *out += "<stop offset=\"";
    Unit::PX.push(out, i64::from(stop.offset) * dialect::THOUSANDTH);
    *out += &format!("\" stop-color=\"{}\"", dialect::hex(stop.color));
    if stop.opacity < u8::MAX {
        *out += &format!(" stop-opacity=\"{}\"", dialect::opacity(stop.opacity));
    }
    *out += "/>";
}
