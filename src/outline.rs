//! The outline of a stroke: rings around all that its pen covers, as tiny-skia's stroker draws them.
//!
//! The rings are filled by the nonzero rule. A ring crosses itself where the stroke does, and on the inner side of
//! bends: the rule fills each place once all the same.

use resvg::tiny_skia::{LineCap, LineJoin, Path, PathBuilder, PathSegment, Stroke as Pen};

use crate::math::Point;
use crate::scene::{self, Area, PathPoint, Piece, Stroke};

/// The length of the segment that a dot is written as, px.
const DOT: f32 = 0.01;

/// The stroker's round caps and joins may be a quarter of its unit off. At this scale that is a sixteenth of a px, at 8 % more
/// bytes than at 1; 8 takes 21 % more. Renders at 1 and 3 times the size do not change by it.
const SCALE: f32 = 4.0;

/// The area that looks like the stroke.
pub(crate) fn area(stroke: &Stroke) -> Area {
    Area {
        rings: stroked(stroke).map_or_else(Vec::new, |path| rings(&path)),
        color: stroke.color,
        opacity: stroke.opacity,
        shade: None,
    }
}

/// The outline of a stroke on a page that is [`SCALE`] times as large.
fn stroked(stroke: &Stroke) -> Option<Path> {
    let pen = Pen {
        width: 2.0 * stroke.radius * SCALE,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Pen::default()
    };
    let path = &stroke.path;
    let mut line = PathBuilder::new();
    let to = |p: Point| (p.x * SCALE, p.y * SCALE);
    for (i, piece) in path.pieces().enumerate() {
        if i == 0 {
            let (x, y) = to(piece.start());
            line.move_to(x, y);
        }
        let (x, y) = to(piece.end());
        match piece {
            Piece::Line(_) => line.line_to(x, y),
            Piece::Curve([_, knee, _]) => {
                let (knee_x, knee_y) = to(knee);
                line.quad_to(knee_x, knee_y, x, y);
            }
        }
    }
    if let [dot] = path.points() {
        let (x, y) = to(dot.at);
        line.move_to(x, y);
        line.line_to(x + DOT * SCALE, y);
    }
    if path.is_closed() {
        line.close();
    }
    line.finish()?.stroke(&pen, 1.0)
}

/// The contours of an outline, which has lines and quadratic curves, as rings.
fn rings(outline: &Path) -> Vec<scene::Path> {
    let at = |p: resvg::tiny_skia::Point| Point::new(p.x / SCALE, p.y / SCALE);
    let mut rings: Vec<Vec<PathPoint>> = Vec::new();
    for segment in outline.segments() {
        let points = match segment {
            PathSegment::MoveTo(start) => {
                rings.push(vec![PathPoint::on(at(start))]);
                continue;
            }
            PathSegment::LineTo(end) => [None, Some(end)],
            PathSegment::QuadTo(knee, end) => [Some(knee), Some(end)],
            PathSegment::CubicTo(.., end) => [None, Some(end)],
            PathSegment::Close => continue,
        };
        if let (Some(ring), [knee, end]) = (rings.last_mut(), points) {
            ring.extend(knee.map(|knee| PathPoint::off(at(knee))));
            ring.extend(end.map(|end| PathPoint::on(at(end))));
        }
    }
    let closed = rings.into_iter().map(|ring| scene::Path::new(ring, true));
    closed.filter_map(Result::ok).collect()
}
