//! The outline of a stroke: rings around all that its pen covers, as tiny-skia's stroker draws them.
//!
//! The rings are filled by the nonzero rule. A ring crosses itself where the stroke does, and on the inner side of
//! bends: the rule fills each place once all the same.

use kurbo::{ParamCurve, PathSeg};
use resvg::tiny_skia::{LineCap, LineJoin, Path, PathBuilder, PathSegment, Stroke as Pen};

use crate::math::{self, Point, Vec2};
use crate::scene::{self, Area, Mark, PathPoint, Stroke};

/// The length of the segment that a dot is written as, px.
const DOT: f64 = 0.01;

/// The stroker's round caps and joins may be a quarter of its unit off. At this scale that is a sixteenth of a px, at 8 % more
/// bytes than at 1; 8 takes 21 % more. Renders at 1 and 3 times the size do not change by it.
const SCALE: f64 = 4.0;

/// The area that looks like a mark.
pub(crate) fn of_mark(mark: &Mark) -> Area {
    match mark.clone().filled() {
        Mark::Area(area) => area,
        Mark::Stroke(stroke) => {
            let rings = stroked(&stroke).map_or_else(Vec::new, |path| rings(&path));
            Area::plain(rings, stroke.color, stroke.opacity)
        }
    }
}

/// The outline of a stroke with round ends on a page that is [`SCALE`] times as large.
fn stroked(stroke: &Stroke) -> Option<Path> {
    let pen = Pen {
        width: (2.0 * stroke.radius * SCALE) as f32,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Pen::default()
    };
    let path = &stroke.path;
    let mut line = PathBuilder::new();
    let to = |p: Point| ((p.x * SCALE) as f32, (p.y * SCALE) as f32);
    for (i, segment) in path.segments().enumerate() {
        if i == 0 {
            let (x, y) = to(segment.start());
            line.move_to(x, y);
        }
        let (x, y) = to(segment.end());
        match segment {
            PathSeg::Quad(curve) => {
                let (knee_x, knee_y) = to(curve.p1);
                line.quad_to(knee_x, knee_y, x, y);
            }
            PathSeg::Cubic(curve) => {
                let ((x1, y1), (x2, y2)) = (to(curve.p1), to(curve.p2));
                line.cubic_to(x1, y1, x2, y2, x, y);
            }
            PathSeg::Line(_) => line.line_to(x, y),
        }
    }
    if let [dot] = path.points() {
        let [start, end] = [0.0, DOT].map(|px| to(dot.at + Vec2::new(px, 0.0)));
        line.move_to(start.0, start.1);
        line.line_to(end.0, end.1);
    }
    if path.is_closed() {
        line.close();
    }
    line.finish()?.stroke(&pen, 1.0)
}

/// The contours of an outline, which has lines and quadratic curves, as rings.
fn rings(outline: &Path) -> Vec<scene::Path> {
    let at = |p: resvg::tiny_skia::Point| (math::point([p.x, p.y]).to_vec2() / SCALE).to_point();
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
