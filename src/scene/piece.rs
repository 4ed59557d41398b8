//! The points of paths, and the lines, curves and arcs between them.

use kurbo::{CubicBez, Line, ParamCurve, PathSeg, QuadBez};
use serde::{Deserialize, Serialize};

use super::arc::Arc;
use crate::error::{Error, ErrorKind, Result};
use crate::math::Point;

/// What a point is to its path. In files of states it is a number, in the order of these.
#[derive(
    Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(into = "u8", try_from = "u8")]
#[repr(u8)]
pub enum PointKind {
    /// The path goes through it.
    #[default]
    On = 0,
    /// The control point of a quadratic Bézier curve. Between two in a row lies an implied on-point, halfway.
    Quad = 1,
    /// One of the two control points of a cubic Bézier curve.
    Cubic = 2,
    /// The path goes through it along a circular arc from the on-point before it to that behind it.
    Arc = 3,
}

impl PointKind {
    /// All kinds, by their numbers.
    pub const ALL: [Self; 4] = [Self::On, Self::Quad, Self::Cubic, Self::Arc];

    /// The kind of a point of lines and quadratic curves: on the path, or the control point of a curve.
    pub fn on_if(is_on: bool) -> Self {
        if is_on { Self::On } else { Self::Quad }
    }

    /// True for the points of lines and quadratic curves.
    pub fn is_quadratic(self) -> bool {
        matches!(self, Self::On | Self::Quad)
    }

    /// Refuses points of these kinds, in drawing order, if they make no path.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when an open path starts or ends off the path, or when between two on-points are others than
    /// points of quadratic curves, two of a cubic one, or one of an arc.
    pub fn check(kinds: &[Self], closed: bool) -> Result<()> {
        let ends_on = [kinds.first(), kinds.last()] == [Some(&Self::On); 2];
        if (!closed || kinds.len() == 1) && !ends_on {
            let message =
                "an open path has to start and end with points on it: close it, or add an end";
            return Err(Error::new(ErrorKind::Config, message));
        }
        match kinds.iter().all(|kind| kind.is_quadratic()) {
            true => Ok(()),
            false => Self::check_pieces(kinds),
        }
    }

    /// Refuses kinds among which are those of cubic curves or arcs, if something else than one piece is between two on-points.
    fn check_pieces(kinds: &[Self]) -> Result<()> {
        let refused = |message: String| Err(Error::new(ErrorKind::Config, message));
        let Some(first) = kinds.iter().position(|kind| *kind == Self::On) else {
            let message = "a path of cubic curves or arcs needs a point on it where each of them ends: add one";
            return refused(message.into());
        };
        // A closed path goes on from its last point to its first, and so may what lies between two on-points.
        let (before, from) = kinds.split_at(first);
        let around = [from, before].concat();
        let is_piece = |run: &[Self]| match run {
            [Self::Arc] | [Self::Cubic, Self::Cubic] => true,
            _ => run.iter().all(|kind| *kind == Self::Quad),
        };
        let mut runs = around.split(|kind| *kind == Self::On);
        match runs.find(|run| !is_piece(run)) {
            Some(run) => refused(format!(
                "between two points on a path are {run:?}: give any number of Quad, two Cubic or one Arc"
            )),
            None => Ok(()),
        }
    }
}

impl From<PointKind> for u8 {
    fn from(kind: PointKind) -> Self {
        kind as Self
    }
}

impl TryFrom<u8> for PointKind {
    type Error = Error;

    fn try_from(number: u8) -> Result<Self> {
        let kind = Self::ALL.get(usize::from(number)).copied();
        kind.ok_or_else(|| {
            let message = format!(
                "{number} is no kind of point: give 0 on the path, 1 for quadratic and 2 for cubic curves, 3 for arcs"
            );
            Error::new(ErrorKind::Config, message)
        })
    }
}

/// A point of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Its coordinates, px.
    pub at: Point,
    /// What it is to the path.
    pub kind: PointKind,
}

impl PathPoint {
    /// A point that the path goes through.
    pub fn on(at: Point) -> Self {
        let kind = PointKind::On;
        Self { at, kind }
    }

    /// The control point of a quadratic curve.
    pub fn off(at: Point) -> Self {
        let kind = PointKind::Quad;
        Self { at, kind }
    }

    /// One of the two control points of a cubic curve.
    pub fn cubic(at: Point) -> Self {
        let kind = PointKind::Cubic;
        Self { at, kind }
    }

    /// A point halfway along an arc.
    pub fn arc(at: Point) -> Self {
        let kind = PointKind::Arc;
        Self { at, kind }
    }

    /// True if it is where lines, curves or arcs end.
    pub fn is_on(&self) -> bool {
        self.kind == PointKind::On
    }

    /// True if it is the control point of a quadratic curve.
    pub(crate) fn is_quad(&self) -> bool {
        self.kind == PointKind::Quad
    }
}

/// A part of a path between two on-points, implied ones included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathPiece {
    /// A line.
    Line(Line),
    /// A quadratic Bézier curve.
    Quad(QuadBez),
    /// A cubic Bézier curve.
    Cubic(CubicBez),
    /// A circular arc.
    Arc(Arc),
}

impl PathPiece {
    /// Its start, px.
    pub fn start(&self) -> Point {
        match self {
            Self::Line(line) => line.p0,
            Self::Quad(curve) => curve.p0,
            Self::Cubic(curve) => curve.p0,
            Self::Arc(arc) => arc.from,
        }
    }

    /// Its end, px.
    pub fn end(&self) -> Point {
        match self {
            Self::Line(line) => line.p1,
            Self::Quad(curve) => curve.p2,
            Self::Cubic(curve) => curve.p3,
            Self::Arc(arc) => arc.to,
        }
    }

    /// The points between its ends.
    pub(crate) fn between(&self) -> impl Iterator<Item = PathPoint> + use<> {
        let points = match self {
            Self::Line(_) => [None, None],
            Self::Quad(curve) => [Some(PathPoint::off(curve.p1)), None],
            Self::Cubic(curve) => [curve.p1, curve.p2].map(|p| Some(PathPoint::cubic(p))),
            Self::Arc(arc) => [Some(PathPoint::arc(arc.through)), None],
        };
        points.into_iter().flatten()
    }

    /// The piece as `kurbo` has it: of an arc cubic curves, each of 45° at most and 10⁻⁵ of the radius off.
    pub(crate) fn segments(self) -> impl Iterator<Item = PathSeg> {
        let (segment, arc) = match self {
            Self::Line(line) => (Some(PathSeg::Line(line)), None),
            Self::Quad(curve) => (Some(PathSeg::Quad(curve)), None),
            Self::Cubic(curve) => (Some(PathSeg::Cubic(curve)), None),
            Self::Arc(arc) => (None, Some(arc)),
        };
        segment
            .into_iter()
            .chain(arc.into_iter().flat_map(Arc::beziers))
    }

    /// Quadratic curves at most `tolerance` px away from the piece, unless it is far larger than a page; none for a line.
    pub(crate) fn quads(self, tolerance: f64) -> Vec<QuadBez> {
        let quads = self.segments().map(|segment| match segment {
            PathSeg::Line(_) => Vec::new(),
            PathSeg::Quad(curve) => vec![curve],
            PathSeg::Cubic(curve) => quads(curve, tolerance),
        });
        quads.flatten().collect()
    }

    /// The points between its ends when it becomes quadratic curves at most `tolerance` px away.
    pub(super) fn between_quads(self, tolerance: f64) -> Vec<PathPoint> {
        let quads = self.quads(tolerance).into_iter();
        let points = quads.flat_map(|q| [PathPoint::on(q.p0), PathPoint::off(q.p1)]);
        // The first of them starts where the piece does.
        points.skip(1).collect()
    }
}

/// Most quadratic curves in the place of a cubic one: with as many, any within a page of 4,000 px is nearer than 0.01 px.
const MOST_QUADS: u16 = 64;

/// Quadratic curves in the place of a cubic one, each for an equal step of its parameter. Those of `kurbo` are the same, but their
/// number is taken from a power of the platform, and without bound.
fn quads(curve: CubicBez, tolerance: f64) -> Vec<QuadBez> {
    // The control points of quadratic curves that leave one end, and the other, as the cubic one does. Their distance is half of
    // the third difference.
    let knees = |part: &CubicBez| {
        let knee = |p: Point, end: Point| 0.5 * (3.0 * p.to_vec2() - end.to_vec2());
        [knee(part.p1, part.p0), knee(part.p2, part.p3)]
    };
    let [first, second] = knees(&curve);
    // With the control point halfway, the distance is √3/36 of the third difference, of which an nth of the curve has an n³th.
    let third = 2.0 * (second - first);
    let is_enough = |count: &u16| {
        let count = f64::from(*count);
        let most = tolerance * count * count * count;
        third.hypot2() <= 432.0 * most * most
    };
    let count = (1..MOST_QUADS).find(is_enough).unwrap_or(MOST_QUADS);
    let part = |k: u16| {
        let [from, to] = [k, k + 1].map(|k| f64::from(k) / f64::from(count));
        let part = curve.subsegment(from..to);
        let [first, second] = knees(&part);
        QuadBez::new(part.p0, (0.5 * (first + second)).to_point(), part.p3)
    };
    (0..count).map(part).collect()
}

/// The pieces of a path that are still to come.
pub(super) struct Pieces<'a> {
    points: &'a [PathPoint],
    /// The index of the point after the next piece's start; a closed path goes on from 0 beyond its last point.
    next: usize,
    /// The index at which the path has come to its end.
    end: usize,
    /// Where the next piece starts; nowhere if the path has no point.
    at: Option<Point>,
}

impl<'a> Pieces<'a> {
    pub(super) fn new(points: &'a [PathPoint], closed: bool) -> Self {
        let count = points.len();
        let first_on = points.iter().position(PathPoint::is_on);
        let (next, at) = match (first_on, points) {
            (Some(first), _) => (first + 1, Some(points[first].at)),
            // All points of a closed path may be off: it starts halfway between the last one and the first.
            (None, [first, .., last]) => (0, Some(last.at.midpoint(first.at))),
            _ => (0, None),
        };
        let end = match (count, closed) {
            (0 | 1, _) => next,
            (_, true) => next + count,
            (_, false) => count,
        };
        Self {
            points,
            next,
            end,
            at,
        }
    }

    fn point(&self, i: usize) -> PathPoint {
        self.points[i % self.points.len()]
    }

    /// The next point, which is passed.
    fn pass(&mut self) -> PathPoint {
        self.next += 1;
        self.point(self.next - 1)
    }
}

impl Iterator for Pieces<'_> {
    type Item = PathPiece;

    fn next(&mut self) -> Option<PathPiece> {
        if self.next >= self.end {
            return None;
        }
        let (from, PathPoint { at, kind }) = (self.at?, self.pass());
        let piece = match kind {
            PointKind::On => PathPiece::Line(Line::new(from, at)),
            PointKind::Quad => {
                let after = self.point(self.next);
                let to = match after.is_on() {
                    true => self.pass().at,
                    false => at.midpoint(after.at),
                };
                PathPiece::Quad(QuadBez::new(from, at, to))
            }
            PointKind::Cubic => {
                let (second, to) = (self.pass().at, self.pass().at);
                PathPiece::Cubic(CubicBez::new(from, at, second, to))
            }
            PointKind::Arc => PathPiece::Arc(Arc {
                from,
                through: at,
                to: self.pass().at,
            }),
        };
        self.at = Some(piece.end());
        Some(piece)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng;
    use kurbo::ParamCurve;

    fn random(seed: u64) -> CubicBez {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| {
            let [x, y] = [0, 1].map(|axis| 200.0 * f64::from(rng::draw(axis, seed, k, 0)));
            Point::new(x, y)
        });
        CubicBez::new(a, b, c, d)
    }

    #[test]
    fn quadratic_curves_are_near_the_cubic_one_and_meet() {
        for curve in (0..100).map(random) {
            for tolerance in [1e-3, 0.1, 10.0] {
                let quads = PathPiece::Cubic(curve).quads(tolerance);
                let share = 1.0 / quads.len() as f64;
                for (i, quad) in quads.iter().enumerate() {
                    for t in [0.0, 0.2, 0.5, 0.7, 1.0] {
                        let at = curve.eval(share * (i as f64 + t));
                        assert!((quad.eval(t) - at).hypot() < 1.000_001 * tolerance + 1e-9);
                    }
                }
                let ends = quads.windows(2).map(|pair| [pair[0].p2, pair[1].p0]);
                assert!(ends.into_iter().all(|[a, b]| a == b));
                assert_eq!(
                    [quads[0].p0, quads[quads.len() - 1].p2],
                    [curve.p0, curve.p3]
                );
                let expected = curve.to_quads(tolerance).map(|(.., quad)| quad);
                assert_eq!(quads, expected.collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn a_curve_far_larger_than_a_page_is_few_quadratic_ones() {
        for far in [1e30, 1e200, f64::INFINITY, f64::NAN] {
            let curve = CubicBez::new((0.0, 0.0), (far, 0.0), (0.0, far), (1.0, 1.0));
            let count = PathPiece::Cubic(curve).quads(0.02).len();
            assert!(count <= usize::from(MOST_QUADS));
        }
    }
}
