//! The outline of a mark, which is one element: of a dot a circle, of a straight stroke two lines and two arcs, of any other
//! stroke the rings around it.

use super::dialect::{self, Unit};
use super::gradient;
use super::layer::Written;
use super::path::{self, Kind};
use super::shape;
use crate::math::{Point, Vec2};
use crate::outline;
use crate::scene::{Area, Mark, Path, UNITS_PER_PX, quantized_anywhere, units};

/// Decimals of outlines: where both sides of a stroke are rounded, a tenth of a px shows in its width.
const LEAST_PRECISION: u8 = 2;

/// Appends the outline of a mark as an element of its own. An area's outline is its rings.
pub(super) fn push(out: &mut String, mark: &Written) {
    gradient::push_of(out, mark, "\n");
    match &mark.mark {
        Mark::Area(area) => push_area(out, area),
        Mark::Stroke(stroke) => match (stroke.path.points(), straight(&stroke.path)) {
            // Square ends first: a straight band isn't a capsule.
            _ if mark.mark.is_butt() || mark.line().is_some() => push_rings(out, &rings(mark)),
            ([dot], _) => push_circle(out, dot.at, mark.width()),
            (_, Some([a, b])) => push_capsule(out, a, b, mark.width()),
            _ => push_rings(out, &rings(mark)),
        },
    }
    let paint = gradient::paint(mark).unwrap_or_else(|| dialect::hex(mark.color()));
    *out += &format!(" fill=\"{paint}\"");
    if mark.opacity() < u8::MAX {
        *out += &format!(" fill-opacity=\"{}\"", dialect::opacity(mark.opacity()));
    }
    out.push_str("/>\n");
}

fn push_area(out: &mut String, area: &Area) {
    match &area.rings[..] {
        [ring] if let Some(shape) = ring.shape() => shape::push(out, shape, "", Unit::PX),
        rings => push_rings(out, rings),
    }
}

/// The ends of a path that is one line.
fn straight(path: &Path) -> Option<[Point; 2]> {
    match path.points() {
        [a, b] if !path.is_closed() => Some([a.at, b.at]),
        _ => None,
    }
}

/// The rings around a stroke.
fn rings(mark: &Written) -> Vec<Path> {
    let around = outline::of_mark(&mark.mark);
    match quantized_anywhere(&around.into(), LEAST_PRECISION) {
        Some(Mark::Area(area)) => area.rings,
        _ => Vec::new(),
    }
}

fn push_rings(out: &mut String, rings: &[Path]) {
    *out += &format!("<path d=\"{}\"", path::data(rings, Kind::Ring, Unit::PX));
}

fn push_circle(out: &mut String, center: Point, width: i64) {
    let numbers = [units(center.x), units(center.y), width / 2].map(number);
    let [x, y, r] = numbers;
    *out += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"");
}

/// One side, an arc around the second end, the other side, an arc around the first. The two sides are the same
/// step, forth and back, and so are the chords of the arcs; so rounding cannot open the outline.
fn push_capsule(out: &mut String, a: Point, b: Point, width: i64) {
    let [a, b] = [a, b].map(|p| [units(p.x), units(p.y)]);
    let side = [b[0] - a[0], b[1] - a[1]];
    let length = Vec2::new(side[0] as f64, side[1] as f64).hypot();
    // The chord of an end is the direction turned by 90°, as long as the stroke is wide.
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
    use crate::scene::{Cap, PathPoint, Stroke};

    fn written(points: &[[f64; 2]], opacity: f32) -> String {
        let point = |&[x, y]: &[f64; 2]| PathPoint::on(Point::new(x, y));
        let stroke = Stroke {
            path: Path::canonical(points.iter().map(point).collect(), false),
            radius: 1.5,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [1.0, 0.4, 0.0],
            opacity,
        };
        let mut out = String::new();
        push(&mut out, &Mark::from(stroke).into());
        out
    }

    #[test]
    fn a_capsule_has_two_lines_and_two_arcs() {
        let d = "M10 18.5l30 0a1.5 1.5 0 0 1 0 3l-30 0a1.5 1.5 0 0 1 0-3z";
        let expected = format!("<path d=\"{d}\" fill=\"#ff6600\"/>\n");
        assert_eq!(written(&[[10.0, 20.0], [40.0, 20.0]], 1.0), expected);
    }

    #[test]
    fn a_dot_is_a_circle() {
        let expected =
            "<circle cx=\"10\" cy=\"20\" r=\"1.5\" fill=\"#ff6600\" fill-opacity=\"0.502\"/>\n";
        assert_eq!(written(&[[10.0, 20.0]], 128.0 / 255.0), expected);
    }
}
