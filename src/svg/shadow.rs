//! Writes shadows.

use super::dialect::{self, Unit};
use super::element;
use crate::scene::{Mark, Shadow};

/// Appends the filter and the element of a shadow, the `number`-th of its file, in px.
pub(super) fn push(out: &mut String, shadow: &Shadow, number: usize) {
    let (filter, id) = (dialect::BLUR_ID, dialect::SHADOW_ID);
    *out += &format!("<filter id=\"{filter}-{number}\"");
    for (name, value) in dialect::FILTER {
        *out += &format!(" {name}=\"{value}\"");
    }
    for (name, px) in dialect::FILTER_PLACE.iter().zip(place(shadow)) {
        *out += &format!(" {name}=\"{px}\"");
    }
    let (gaussian, deviation) = dialect::GAUSSIAN;
    *out += &format!("><{gaussian} {deviation}=\"");
    Unit::PX.push(
        out,
        (f64::from(shadow.blur()) * 100.0).round() as i64 * dialect::HUNDREDTH,
    );
    *out += "\"/></filter>";
    let names = format!(" id=\"{id}-{number}\" filter=\"url(#{filter}-{number})\"");
    element::push_alone(out, &Mark::from(shadow.area().clone()).into(), &names);
    out.push('\n');
}

/// The x, y, width and height of the filter of a shadow, px: without them programs cut off the blur far from the shape.
pub(super) fn place(shadow: &Shadow) -> [i64; 4] {
    let [[left, top], [right, bottom]] = shadow.extent();
    [left, top, right - left, bottom - top]
}
