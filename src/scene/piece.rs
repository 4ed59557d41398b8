//! The points of paths, and the lines, curves and arcs between them.

use kurbo::{CubicBez, Line, PathSeg, QuadBez};
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

    /// Refuses points of these kinds, in drawing order, if they make no path.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when an open path starts or ends off the path, or when between two on-points are others than
    /// points of quadratic curves, two of a cubic one, or one of an arc.
    pub fn check(kinds: &[Self], closed: bool) -> Result<()> {
        let refused = |message: String| Err(Error::new(ErrorKind::Config, message));
        let ends_on = [kinds.first(), kinds.last()] == [Some(&Self::On); 2];
        if (!closed || kinds.len() == 1) && !ends_on {
            let message =
                "an open path has to start and end with points on it: close it, or add an end";
            return refused(message.into());
        }
        if !kinds
            .iter()
            .any(|kind| matches!(kind, Self::Cubic | Self::Arc))
        {
            return Ok(());
        }
        let Some(first) = kinds.iter().position(|kind| *kind == Self::On) else {
            let message = "a path of cubic curves or arcs needs a point on it where each of them ends: add one";
            return refused(message.into());
        };
        // A closed path goes on from its last point to its first, and so may what lies between two on-points.
        let (before, from) = kinds.split_at(first);
        let around = [from, before].concat();
        let runs = around.split(|kind| *kind == Self::On);
        for run in runs {
            let is_one = match run {
                [Self::Arc] | [Self::Cubic, Self::Cubic] => true,
                _ => run.iter().all(|kind| *kind == Self::Quad),
            };
            if !is_one {
                return refused(format!(
                    "between two points on a path are {run:?}: give any number of Quad, two Cubic or one Arc"
                ));
            }
        }
        Ok(())
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
