//! Lines whose width varies: the attributes that say which line an outline is that of, and Inkscape's live effect.
//!
//! Inkscape's PowerStroke draws the outline anew from the line and the widths when either is edited; its interpolator `Linear` runs
//! the radius as ours does. Other programs draw the outline as it stands.

use super::dialect::{LINE, Unit, WIDTHS};
use super::layer::Written;
use super::path::{self, Kind};
use crate::math::Point;
use crate::scene::{Path, PathPiece, PathPoint, units};

/// The beginning of the ids of effects, which the numbers of the layer and of the line in it follow.
const EFFECT: &str = "powerstroke";

/// Appends the attributes of a mark that is the outline of a line, in this unit.
pub(super) fn push(out: &mut String, mark: &Written, unit: Unit) {
    let Some((line, radii)) = mark.line() else {
        return;
    };
    let d = path::data([line], Kind::Line, unit);
    *out += &format!(" {LINE}=\"{d}\" {WIDTHS}=\"");
    for (i, radius) in radii.iter().enumerate() {
        if i > 0 {
            out.push(' ');
        }
        unit.push(out, units(2.0 * radius));
    }
    out.push('"');
    if let Some(id) = effect(mark) {
        let d = path::data([&without_arcs(line)], Kind::Line, unit);
        *out += &format!(" inkscape:path-effect=\"#{id}\" inkscape:original-d=\"{d}\"");
    }
}

/// Appends the effect of a mark that has one.
pub(super) fn push_effect(out: &mut String, mark: &Written, end: &str) {
    let (Some((line, radii)), Some(id)) = (mark.line(), effect(mark)) else {
        return;
    };
    let offset = |(index, radius): (usize, &f64)| {
        let mut text = format!("{index},");
        Unit::PX.push(&mut text, units(*radius));
        text
    };
    let offsets: Vec<String> = vertices(line).into_iter().zip(radii).map(offset).collect();
    *out += &format!(
        "<defs><inkscape:path-effect effect=\"powerstroke\" id=\"{id}\" is_visible=\"true\" lpeversion=\"1\" \
         offset_points=\"{}\" not_jump=\"true\" sort_points=\"true\" interpolator_type=\"Linear\" \
         interpolator_beta=\"0.2\" start_linecap_type=\"round\" end_linecap_type=\"round\" \
         linejoin_type=\"round\" miter_limit=\"4\" scale_width=\"1\" message=\"\"/></defs>{end}",
        offsets.join(" | ")
    );
}

/// The id of the effect, if the mark has a place in a file with effects.
fn effect(mark: &Written) -> Option<String> {
    let [layer, number] = mark.place;
    let has_effect = number > 0 && mark.line().is_some();
    has_effect.then(|| format!("{EFFECT}-{layer}-{number}"))
}

/// For each vertex of a path, the number of curves before it.
fn vertices(path: &Path) -> Vec<usize> {
    let points = path.points();
    let first = points.iter().position(PathPoint::is_on).unwrap_or(0);
    let mut pieces = path.pieces();
    let mut found = Vec::new();
    let mut curves = 0;
    for i in 0..points.len() {
        let [point, next] = [i, i + 1].map(|k| &points[(first + k) % points.len()]);
        if point.is_on() {
            found.push(curves);
        }
        // A line begins at a vertex; each control point of a quadratic curve has one of its own; other pieces end in a vertex.
        let is_line = point.is_on() && next.is_on();
        let is_end = !point.is_on() && (point.is_quad() || next.is_on());
        if is_line || is_end {
            curves += pieces.next().map_or(0, |piece| piece.segments().count());
        }
    }
    found
}

/// The path with cubic curves for arcs, to a thousandth of a px: into how many curves Inkscape cuts an arc is its own affair.
fn without_arcs(path: &Path) -> Path {
    if !path.is_mixed() {
        return path.clone();
    }
    let short = |p: Point| {
        Point::new(
            (1000.0 * p.x).round() / 1000.0,
            (1000.0 * p.y).round() / 1000.0,
        )
    };
    let inner = path.pieces().flat_map(|piece| match piece {
        PathPiece::Arc(_) => {
            let cubics = piece.segments().map(|segment| segment.to_cubic());
            let points = cubics.flat_map(|c| {
                [
                    PathPoint::cubic(c.p1),
                    PathPoint::cubic(c.p2),
                    PathPoint::on(c.p3),
                ]
            });
            points
                .map(|p| PathPoint {
                    at: short(p.at),
                    ..p
                })
                .collect::<Vec<_>>()
        }
        piece => piece
            .between()
            .chain([PathPoint::on(piece.end())])
            .collect(),
    });
    let start = path.points().iter().find(|p| p.is_on()).copied();
    let mut points: Vec<PathPoint> = start.into_iter().chain(inner).collect();
    if path.is_closed() {
        points.pop();
    }
    Path::of_points(points, path.is_closed())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_are_counted_by_the_curves_before_them() {
        let at = |x: f64| (x, 2.0 * x * x).into();
        let points = [
            PathPoint::on(at(0.0)),
            PathPoint::on(at(1.0)),
            PathPoint::off(at(2.0)),
            PathPoint::off(at(3.0)),
            PathPoint::on(at(4.0)),
            PathPoint::cubic(at(5.0)),
            PathPoint::cubic(at(6.0)),
            PathPoint::on(at(7.0)),
            PathPoint::arc(at(8.0)),
            PathPoint::on(at(9.0)),
        ];
        let path = Path::new(points.to_vec(), false).unwrap();
        // The arc is cut into as many curves as its line has without arcs.
        let plain = without_arcs(&path);
        assert_eq!(vertices(&path)[..4], [0, 1, 3, 4]);
        assert_eq!(vertices(&path)[4], plain.pieces().count());
    }
}
