//! Paths of the two kinds: ours, and those that `kurbo` and `linesweeper` work with.

use kurbo::{BezPath, CubicBez, PathEl, Point};

use crate::scene::{Path, PathPoint, Piece};

/// Largest distance of quadratic curves from a cubic one that they stand for, px.
const TOLERANCE: f64 = 1e-3;

/// Appends a closed path.
pub(super) fn push(out: &mut BezPath, ring: &Path) {
    let at = |p: crate::math::Point| Point::new(p.x.into(), p.y.into());
    for (i, piece) in ring.pieces().enumerate() {
        if i == 0 {
            out.move_to(at(piece.start()));
        }
        match piece {
            Piece::Line([_, end]) => out.line_to(at(end)),
            Piece::Curve([_, knee, end]) => out.quad_to(at(knee), at(end)),
        }
    }
    if ring.pieces().next().is_some() {
        out.close_path();
    }
}

/// A closed path of lines and curves; `None` if it has no inside.
pub(super) fn ring(path: &BezPath) -> Option<Path> {
    let mut points: Vec<PathPoint> = Vec::new();
    let on = |p: Point| PathPoint::on([p.x as f32, p.y as f32].into());
    let off = |p: Point| PathPoint::off([p.x as f32, p.y as f32].into());
    let mut last = Point::ZERO;
    for element in path.elements() {
        match *element {
            PathEl::MoveTo(p) | PathEl::LineTo(p) => points.push(on(p)),
            PathEl::QuadTo(knee, p) => points.extend([off(knee), on(p)]),
            PathEl::CurveTo(c, d, p) => {
                for (_, _, quad) in CubicBez::new(last, c, d, p).to_quads(TOLERANCE) {
                    points.extend([off(quad.p1), on(quad.p2)]);
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
