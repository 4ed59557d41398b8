//! Paths: the centre lines of strokes.
//!
//! A path is a list of points, each **on** the path or **off** it, as in TrueType's outlines. Two on-points in a row
//! are joined by a line. A run of off-points between two on-points is a quadratic spline: each off-point is the control
//! point of a quadratic Bézier curve, and these curves meet halfway between neighbouring off-points, in *implied*
//! on-points, without a corner. A closed path goes on from its last point to its first; an open one starts and ends on
//! the path. A path of one point is a dot.
//!
//! ```
//! use strokefit::math::Point;
//! use strokefit::scene::{Path, PathPoint, Piece};
//!
//! let [a, b, c, d] = [[0.0, 0.0], [4.0, 0.0], [8.0, 4.0], [8.0, 8.0]].map(Point::from);
//! let path = Path::new(vec![PathPoint::on(a), PathPoint::off(b), PathPoint::off(c), PathPoint::on(d)], false)?;
//! let implied = Point::new(6.0, 2.0);
//! assert_eq!(path.pieces().collect::<Vec<_>>(), [Piece::Curve([a, b, implied]), Piece::Curve([implied, c, d])]);
//! # Ok::<(), strokefit::Error>(())
//! ```

use crate::error::{Error, ErrorKind, Result};
use crate::math::Point;

/// Most points of a path.
pub const MAX_POINTS: usize = 65_535;

/// A point of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct PathPoint<P = Point> {
    /// The place, px.
    pub at: P,
    /// True if the path goes through it; otherwise it is the control point of a curve.
    pub is_on: bool,
}

impl<P> PathPoint<P> {
    /// A point that the path goes through.
    pub fn on(at: P) -> Self {
        Self { at, is_on: true }
    }

    /// A control point.
    pub fn off(at: P) -> Self {
        Self { at, is_on: false }
    }
}

/// A kind of place that has middles.
pub(super) trait Place: Copy {
    /// The place halfway between two.
    fn middle(a: Self, b: Self) -> Self;
}

impl Place for Point {
    fn middle(a: Self, b: Self) -> Self {
        Self::from((a.coords() + b.coords()) * 0.5)
    }
}

/// The centre line of a stroke: one point or more, open or closed.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    points: Vec<PathPoint>,
    closed: bool,
}

/// A part of a path between two on-points, implied ones included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Piece<P = Point> {
    /// From one point to another.
    Line([P; 2]),
    /// A quadratic Bézier curve: start, control point, end.
    Curve([P; 3]),
}

/// Most steps of a flattened curve. They are enough for 0.05 px along curves of 10,000 px.
const MAX_STEPS: f64 = 256.0;

/// Equal steps of its parameter that a curve takes, so that its chords are at most `tolerance` away from it, where
/// `bend` is |a − 2c + b| (Wang's formula).
pub(super) fn steps(bend: f64, tolerance: f64) -> u16 {
    let steps = (bend / (4.0 * tolerance)).sqrt().ceil();
    steps.clamp(1.0, MAX_STEPS) as u16
}

impl<P: Copy> Piece<P> {
    /// Where the piece starts.
    pub fn start(self) -> P {
        match self {
            Self::Line([start, _]) | Self::Curve([start, ..]) => start,
        }
    }

    /// Where the piece ends.
    pub fn end(self) -> P {
        match self {
            Self::Line([_, end]) | Self::Curve([.., end]) => end,
        }
    }
}

impl Piece {
    /// Appends what follows the start of the piece, as corners of a polyline within `tolerance` px of it.
    fn flatten(self, tolerance: f32, out: &mut Vec<Point>) {
        let [a, c, b] = match self {
            Self::Line([_, end]) => return out.push(end),
            Self::Curve(points) => points.map(|p| p.coords()),
        };
        let bend = (a - c * 2.0 + b).norm();
        let steps = steps(bend.into(), tolerance.into());
        let inner = (1..steps).map(|i| f32::from(i) / f32::from(steps));
        out.extend(inner.map(|t| {
            let u = 1.0 - t;
            Point::from(a * (u * u) + c * (2.0 * u * t) + b * (t * t))
        }));
        out.push(Point::from(b));
    }
}

impl Path {
    /// The path of these points.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when there is no point or there are more than [`MAX_POINTS`], or when an open path starts
    /// or ends off the path.
    pub fn new(points: Vec<PathPoint>, closed: bool) -> Result<Self> {
        let refused = |message: String| Err(Error::new(ErrorKind::Config, message));
        let ends_on = |end: Option<&PathPoint>| end.is_some_and(|p| p.is_on);
        match points.len() {
            0 => refused("a path has no point: give at least one".into()),
            n if n > MAX_POINTS => refused(format!(
                "a path has {n} points: split it, so that each part has at most {MAX_POINTS}"
            )),
            n if (!closed || n == 1) && !(ends_on(points.first()) && ends_on(points.last())) => {
                refused(
                    "an open path has to start and end with points on it: close it, or add an end"
                        .into(),
                )
            }
            _ => Ok(Self { points, closed }),
        }
    }

    /// The path of points that are known to be a path.
    pub(crate) fn of_points(points: Vec<PathPoint>, closed: bool) -> Self {
        Self { points, closed }
    }

    /// A dot.
    pub fn dot(p: Point) -> Self {
        Self {
            points: vec![PathPoint::on(p)],
            closed: false,
        }
    }

    /// The line segment from `a` to `b`.
    pub fn line(a: Point, b: Point) -> Self {
        Self {
            points: vec![PathPoint::on(a), PathPoint::on(b)],
            closed: false,
        }
    }

    /// The path of points that keep the rules of [`new`](Self::new).
    pub(super) fn of_valid(points: Vec<PathPoint>, closed: bool) -> Self {
        Self { points, closed }
    }

    /// The points, in drawing order; never empty.
    pub fn points(&self) -> &[PathPoint] {
        &self.points
    }

    /// True if the last point is joined to the first.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// First and last point; the same for a dot. Those of a closed path mean nothing in particular.
    pub fn ends(&self) -> (Point, Point) {
        match self.points.as_slice() {
            [first, .., last] => (first.at, last.at),
            [only] => (only.at, only.at),
            [] => (Point::origin(), Point::origin()),
        }
    }

    /// This path with `f` applied to every point.
    #[must_use]
    pub fn map(mut self, f: impl Fn(Point) -> Point) -> Self {
        self.points.iter_mut().for_each(|p| p.at = f(p.at));
        self
    }

    /// The lines and curves of the path, in drawing order; none for a dot.
    pub fn pieces(&self) -> impl Iterator<Item = Piece> {
        pieces(&self.points, self.closed)
    }

    /// The corners of a polyline that is at most `tolerance` px away from the path. That of a closed path ends where
    /// it starts; a dot is one point.
    pub fn flattened(&self, tolerance: f32) -> Vec<Point> {
        let mut out = Vec::new();
        for piece in self.pieces() {
            if out.is_empty() {
                out.push(piece.start());
            }
            piece.flatten(tolerance, &mut out);
        }
        if out.is_empty() {
            out.extend(self.points.first().map(|p| p.at));
        }
        out
    }
}

/// The lines and curves of a path of these points.
pub(super) fn pieces<P: Place>(
    points: &[PathPoint<P>],
    closed: bool,
) -> impl Iterator<Item = Piece<P>> {
    Pieces::new(points, closed)
}

/// The pieces of a path that are still to come.
struct Pieces<'a, P> {
    points: &'a [PathPoint<P>],
    /// The index of the point after the next piece's start; a closed path goes on from 0 beyond its last point.
    next: usize,
    /// The index at which the path has come to its end.
    end: usize,
    /// Where the next piece starts; nowhere if the path has no point.
    at: Option<P>,
}

impl<'a, P: Place> Pieces<'a, P> {
    fn new(points: &'a [PathPoint<P>], closed: bool) -> Self {
        let count = points.len();
        let first_on = points.iter().position(|p| p.is_on);
        let (next, at) = match (first_on, points) {
            (Some(first), _) => (first + 1, Some(points[first].at)),
            // All points of a closed path may be off: it starts halfway between the last one and the first.
            (None, [first, .., last]) => (0, Some(P::middle(last.at, first.at))),
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

    fn point(&self, i: usize) -> PathPoint<P> {
        self.points[i % self.points.len()]
    }
}

impl<P: Place> Iterator for Pieces<'_, P> {
    type Item = Piece<P>;

    fn next(&mut self) -> Option<Piece<P>> {
        if self.next >= self.end {
            return None;
        }
        let (from, knot) = (self.at?, self.point(self.next));
        self.next += 1;
        if knot.is_on {
            self.at = Some(knot.at);
            return Some(Piece::Line([from, knot.at]));
        }
        let after = self.point(self.next);
        let to = if after.is_on {
            self.next += 1;
            after.at
        } else {
            P::middle(knot.at, after.at)
        };
        self.at = Some(to);
        Some(Piece::Curve([from, knot.at, to]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(points: &[(f32, f32, bool)], closed: bool) -> Result<Path> {
        let point = |&(x, y, is_on): &(f32, f32, bool)| PathPoint {
            at: Point::new(x, y),
            is_on,
        };
        Path::new(points.iter().map(point).collect(), closed)
    }

    fn ends(piece: Piece) -> [Point; 2] {
        [piece.start(), piece.end()]
    }

    #[test]
    fn pieces_lie_end_to_end() {
        let shapes = [(0.0, 0.0), (4.0, 1.0), (6.0, 5.0), (3.0, 7.0), (1.0, 6.0)];
        for kinds in 0_u32..32 {
            for closed in [false, true] {
                let points = shapes.iter().enumerate();
                let points: Vec<_> = points
                    .map(|(i, &(x, y))| (x, y, kinds >> i & 1 == 1))
                    .collect();
                let Ok(path) = path(&points, closed) else {
                    assert!(!closed && kinds & 0b10001 != 0b10001);
                    continue;
                };
                let pieces: Vec<_> = path.pieces().collect();
                let offs = 5 - kinds.count_ones() as usize;
                let joined = points.iter().zip(points.iter().cycle().skip(1));
                let pairs = joined.take(if closed { 5 } else { 4 });
                let lines = pairs.filter(|(a, b)| a.2 && b.2).count();
                assert_eq!(pieces.len(), lines + offs, "{kinds:b} {closed}");
                for pair in pieces.windows(2) {
                    assert_eq!(ends(pair[0])[1], ends(pair[1])[0], "{kinds:b}");
                }
                if closed {
                    assert_eq!(ends(pieces[0])[0], ends(pieces[pieces.len() - 1])[1]);
                }
            }
        }
    }

    #[test]
    fn a_dot_has_no_piece() {
        assert_eq!(Path::dot(Point::new(1.0, 2.0)).pieces().count(), 0);
    }

    #[test]
    fn what_is_no_path_is_refused() {
        for (points, why) in [
            (vec![], "no point"),
            (vec![(0.0, 0.0, false)], "start and end"),
            (vec![(0.0, 0.0, true), (1.0, 0.0, false)], "start and end"),
            (vec![(0.0, 0.0, true); MAX_POINTS + 1], "at most 65535"),
        ] {
            let error = path(&points, false).unwrap_err();
            assert!(error.to_string().contains(why), "{error}");
        }
    }
}
