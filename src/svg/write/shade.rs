//! Writes a shade: a gradient, and the rectangle that it fills.

use super::super::dialect::{self, SHADE_ID, Unit};
use crate::scene::{Shade, WrittenAxis, WrittenStop};

/// The elements of `shade` on a page of this size, each on a line of its own.
pub(super) fn elements(shade: &Shade, width: u32, height: u32) -> String {
    let (kind, names, numbers): (_, &[&str], &[i64]) = match &shade.axis {
        WrittenAxis::Linear(numbers) => (dialect::LINEAR, &dialect::LINEAR_AXIS, numbers),
        WrittenAxis::Radial(numbers) => (dialect::RADIAL, &dialect::RADIAL_AXIS, numbers),
    };
    let mut out = format!("<{kind} id=\"{SHADE_ID}\" gradientUnits=\"userSpaceOnUse\"");
    for (name, &units) in names.iter().zip(numbers) {
        out += &format!(" {name}=\"");
        Unit::PX.push(&mut out, units);
        out.push('"');
    }
    out.push('>');
    shade
        .stops
        .iter()
        .for_each(|stop| push_stop(&mut out, stop));
    out += &format!("</{kind}>\n");
    out + &format!("<rect width=\"{width}\" height=\"{height}\" fill=\"url(#{SHADE_ID})\"/>\n")
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
