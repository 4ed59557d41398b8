//! Paths that `linesweeper` found.

use kurbo::{BezPath, CubicBez, PathEl, Point};

use crate::scene::{Path, PathPoint};

/// Largest distance of quadratic curves from a cubic one that they stand for, px.
const TOLERANCE: f64 = 1e-3;

/// A closed path of lines and curves; `None` if it has no inside.
pub(super) fn ring(path: &BezPath) -> Option<Path> {
    let mut points: Vec<PathPoint> = Vec::new();
    let mut last = Point::ZERO;
    for element in path.elements() {
        match *element {
            PathEl::MoveTo(p) | PathEl::LineTo(p) => points.push(PathPoint::on(p)),
            PathEl::QuadTo(knee, p) => points.extend([PathPoint::off(knee), PathPoint::on(p)]),
            PathEl::CurveTo(c, d, p) => {
                // Scenes have quadratic curves alone.
                for (_, _, quad) in CubicBez::new(last, c, d, p).to_quads(TOLERANCE) {
                    points.extend([PathPoint::off(quad.p1), PathPoint::on(quad.p2)]);
                }
            }
            PathEl::ClosePath => {}
        }
        last = element.end_point().unwrap_or(last);
    }
    // The last point is the first one again.
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    Path::new(points, true).ok()
}
