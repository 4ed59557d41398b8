//! The outline of a mark, which is one element: of a dot a circle, of a straight stroke two lines and two arcs, of any other
//! stroke the rings around it.

use super::dialect::{self, Unit};
use super::gradient;
use super::path::{self, Kind};
use super::shape;
use crate::math;
use crate::outline;
use crate::scene::{Mark, Piece, UNITS_PER_PX, Written, WrittenPath};

/// Decimals of outlines: where both sides of a stroke are rounded, a tenth of a px shows in its width.
const LEAST_PRECISION: u8 = 2;

/// Appends the outline of a mark as an element of its own: that of an area is its rings.
pub(super) fn push(out: &mut String, mark: &Written) {
    gradient::push_of(out, mark, "\n");
    let shape = mark.shape.filter(|_| mark.is_area());
    match (mark.paths.as_slice(), straight(mark)) {
        _ if shape.is_some() => {
            shape
                .into_iter()
                .for_each(|shape| shape::push(out, shape, "", Unit::PX));
        }
        (rings, _) if mark.is_area() => push_rings(out, rings),
        _ if mark.is_band => push_rings(out, &rings(mark)),
        ([dot], _) if dot.points().len() == 1 => push_circle(out, dot.points()[0].at, mark.width),
        (_, Some([a, b])) => push_capsule(out, a, b, mark.width),
        _ => push_rings(out, &rings(mark)),
    }
    let paint = gradient::paint(mark).unwrap_or_else(|| dialect::hex(mark.color));
    *out += &format!(" fill=\"{paint}\"");
    if mark.opacity < u8::MAX {
        *out += &format!(" fill-opacity=\"{}\"", dialect::opacity(mark.opacity));
    }
    out.push_str("/>\n");
}

/// The ends of a stroke that is one line.
fn straight(mark: &Written) -> Option<[[i64; 2]; 2]> {
    let [path] = mark.paths.as_slice() else {
        return None;
    };
    let mut pieces = path.pieces();
    match (pieces.next(), pieces.next()) {
        (Some(Piece::Line(ends)), None) => Some(ends),
        _ => None,
    }
}

/// The rings around a stroke.
fn rings(stroke: &Written) -> Vec<WrittenPath> {
    let around = match stroke.mark() {
        Mark::Stroke(stroke) => outline::area(&stroke).into(),
        Mark::Area(band) => band.filled().into(),
    };
    Written::round_or_filled(&around, LEAST_PRECISION)
        .map_or_else(|_| Vec::new(), |area| area.paths)
}

fn push_rings(out: &mut String, rings: &[WrittenPath]) {
    *out += &format!("<path d=\"{}\"", path::data(rings, Kind::Ring, Unit::PX));
}

fn push_circle(out: &mut String, [x, y]: [i64; 2], width: i64) {
    let numbers = [x, y, width / 2].map(number);
    let [x, y, r] = numbers;
    *out += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"");
}

/// One side, an arc around the second end, the other side, an arc around the first. The two sides are the same
/// step, forth and back, and so are the chords of the arcs; so rounding cannot open the outline.
fn push_capsule(out: &mut String, a: [i64; 2], b: [i64; 2], width: i64) {
    let side = [b[0] - a[0], b[1] - a[1]];
    let length = math::hypot(side[0] as f64, side[1] as f64);
    let across = |along: i64| rounded(along as f64 / length * width as f64);
    let chord = [across(-side[1]), across(side[0])];
    // By specification, a radius too short for its chord is stretched to a half circle; a longer one would
    // make a flatter arc.
    let r = number(floor(width / 2));
    let start = [a[0] - floor(chord[0] / 2), a[1] - floor(chord[1] / 2)];
    let arc = |step| format!("a{r} {r} 0 0 1{}", pair(step, true));
    let back = |step: [i64; 2]| step.map(|units| -units);
    *out += &format!(
        "<path d=\"M{}l{}{}l{}{}z\"",
        pair(start, false),
        pair(side, false),
        arc(chord),
        pair(back(side), false),
        arc(back(chord)),
    );
}

/// A ten-thousandth of a px, because rounding of its ends shows more in an arc than in a stroke.
const STEP: i64 = UNITS_PER_PX / 10_000;

fn rounded(units: f64) -> i64 {
    (units / STEP as f64).round() as i64 * STEP
}

fn floor(units: i64) -> i64 {
    units.div_euclid(STEP) * STEP
}

fn number(units: i64) -> String {
    let mut out = String::new();
    Unit::PX.push(&mut out, units);
    out
}

/// Two numbers; `spaced` when another precedes them.
fn pair([x, y]: [i64; 2], spaced: bool) -> String {
    let space = |units: i64, needed: bool| if needed && units >= 0 { " " } else { "" };
    format!(
        "{}{}{}{}",
        space(x, spaced),
        number(x),
        space(y, true),
        number(y)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{PathPoint, WrittenPath};

    fn written(points: &[[i64; 2]], opacity: u8) -> String {
        let point = |p: &[i64; 2]| PathPoint::on(p.map(|px| px * UNITS_PER_PX));
        let stroke = Written {
            paths: vec![WrittenPath::new(points.iter().map(point).collect(), false)],
            shape: None,
            width: 3 * UNITS_PER_PX,
            is_band: false,
            color: [255, 102, 0],
            opacity,
            shade: None,
        };
        let mut out = String::new();
        push(&mut out, &stroke);
        out
    }

    #[test]
    fn a_capsule_has_two_lines_and_two_arcs() {
        let d = "M10 18.5l30 0a1.5 1.5 0 0 1 0 3l-30 0a1.5 1.5 0 0 1 0-3z";
        let expected = format!("<path d=\"{d}\" fill=\"#ff6600\"/>\n");
        assert_eq!(written(&[[10, 20], [40, 20]], 255), expected);
    }

    #[test]
    fn a_dot_is_a_circle() {
        let expected =
            "<circle cx=\"10\" cy=\"20\" r=\"1.5\" fill=\"#ff6600\" fill-opacity=\"0.502\"/>\n";
        assert_eq!(written(&[[10, 20]], 128), expected);
    }
}
