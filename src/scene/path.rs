//! Paths: the centre lines of strokes and the outlines of areas.
//!
//! A path is a list of points of four [kinds](PointKind). What lies between two **on**-points says how they are joined:
//!
//! | points between | joined by |
//! | --- | --- |
//! | none | a line |
//! | one or more `Quad` | a quadratic spline, as in TrueType's outlines: each is the control point of a quadratic Bézier curve, and these curves meet halfway between neighbours, in *implied* on-points, without a corner |
//! | two `Cubic` | a cubic Bézier curve, whose control points they are |
//! | one `Arc` | a circular arc through it |
//!
//! A closed path goes on from its last point to its first, and may have none but `Quad` points; an open one starts and ends
//! on the path. A path of one point is a dot.
//!
//! The points are what a fit moves. [`Path::pieces`] are the lines, curves and arcs; [`Path::segments`] and [`Path::bezier`]
//! are the same path as `kurbo` has it, with cubic curves for arcs.
//!
//! ```
//! use kurbo::{Line, PathSeg, QuadBez};
//! use strokefit::math::Point;
//! use strokefit::scene::{Path, PathPoint};
//!
//! let [a, b, c, d] = [(0.0, 0.0), (4.0, 0.0), (8.0, 4.0), (8.0, 8.0)].map(Point::from);
//! let path = Path::new(vec![PathPoint::on(a), PathPoint::off(b), PathPoint::off(c), PathPoint::on(d)], false)?;
//! let implied = Point::new(6.0, 2.0);
//! let curves = [QuadBez::new(a, b, implied), QuadBez::new(implied, c, d)];
//! assert_eq!(path.segments().collect::<Vec<_>>(), curves.map(PathSeg::Quad));
//! # Ok::<(), strokefit::Error>(())
//! ```

use kurbo::{BezPath, Line, ParamCurve, PathEl, PathSeg, Rect};

use super::piece::{PathPiece, PathPoint, Pieces, PointKind};
use super::shape::{Shape, ShapeKind};
use crate::error::{Error, ErrorKind, Result};
use crate::math::{Point, Vec2};

/// Most points of a path.
pub const MAX_POINTS: usize = 65_535;

/// One point or more, open or closed.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    points: Vec<PathPoint>,
    closed: bool,
    /// The shape that the points were made of.
    shape: Option<Shape>,
}

impl Path {
    /// The path of these points.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when there is no point or there are more than [`MAX_POINTS`], or as [`PointKind::check`].
    pub fn new(points: Vec<PathPoint>, closed: bool) -> Result<Self> {
        let refused = |message: String| Err(Error::new(ErrorKind::Config, message));
        match points.len() {
            0 => refused("a path has no point: give at least one".into()),
            n if n > MAX_POINTS => refused(format!(
                "a path has {n} points: split it, so that each part has at most {MAX_POINTS}"
            )),
            _ => {
                let kinds: Vec<PointKind> = points.iter().map(|p| p.kind).collect();
                PointKind::check(&kinds, closed)?;
                Ok(Self::of_points(points, closed))
            }
        }
    }

    /// The path of points that keep the rules of [`new`](Self::new).
    pub(crate) fn of_points(points: Vec<PathPoint>, closed: bool) -> Self {
        Self {
            points,
            closed,
            shape: None,
        }
    }

    /// A dot.
    pub fn dot(p: Point) -> Self {
        Self::of_points(vec![PathPoint::on(p)], false)
    }

    /// The line segment from `a` to `b`.
    pub fn line(a: Point, b: Point) -> Self {
        Self::of_points(vec![PathPoint::on(a), PathPoint::on(b)], false)
    }

    /// The points, in drawing order; never empty.
    pub fn points(&self) -> &[PathPoint] {
        &self.points
    }

    /// The points, without the path.
    pub(super) fn into_points(self) -> Vec<PathPoint> {
        self.points
    }

    /// True if the last point is joined to the first.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The circle, ellipse or rectangle that the path is.
    pub fn shape(&self) -> Option<Shape> {
        self.shape
    }

    /// The path as the circle, ellipse or round rectangle that its points are those of, as arrays of coordinates have no more of
    /// it.
    #[must_use]
    pub(crate) fn recognised(self) -> Self {
        let points = self.points.iter().map(|p| (p.at, p.kind));
        let points = self.closed.then(|| points.collect::<Vec<_>>());
        let shape = points.and_then(|points| ShapeKind::shape_of(&points));
        shape.map_or(self, Shape::path)
    }

    /// The rectangle whose corners the path has, in either sense: a file has one element for both.
    pub(super) fn rectangle(&self) -> Option<Shape> {
        let [a, b, c, d] = self.points() else {
            return None;
        };
        let is_level = |p: &PathPoint, q: &PathPoint| p.at.y == q.at.y;
        let is_upright = |p: &PathPoint, q: &PathPoint| p.at.x == q.at.x;
        let is_along = is_level(a, b) && is_upright(b, c) && is_level(c, d) && is_upright(d, a)
            || is_upright(a, b) && is_level(b, c) && is_upright(c, d) && is_level(d, a);
        let is_rect = self.closed && self.points().iter().all(PathPoint::is_on) && is_along;
        let bounds = self.bounds();
        let corners = [bounds.origin(), Point::new(bounds.x1, bounds.y1)];
        (is_rect && bounds.area() > 0.0).then(|| Shape::rect(corners, 0.0))
    }

    /// First and last point; the same for a dot. Those of a closed path mean nothing in particular.
    pub fn ends(&self) -> (Point, Point) {
        let [first, last] = [self.points.first(), self.points.last()]
            .map(|end| end.map_or(Point::ORIGIN, |p| p.at));
        (first, last)
    }

    /// This path with `f` applied to every point. A shape whose points move is none any more.
    #[must_use]
    pub fn map(mut self, f: impl Fn(Point) -> Point) -> Self {
        for point in &mut self.points {
            let at = f(point.at);
            self.shape = self.shape.filter(|_| at == point.at);
            point.at = at;
        }
        self
    }

    /// This path, moved. A shape stays one.
    #[must_use]
    pub(crate) fn moved(self, by: Vec2) -> Self {
        let shape = self.shape.map(|shape| shape.moved(by));
        let moved = self.map(|p| p + by);
        Self { shape, ..moved }
    }

    /// The path drawn the other way.
    #[must_use]
    pub(crate) fn reversed(&self) -> Self {
        let mut points: Vec<PathPoint> = self.points.iter().rev().copied().collect();
        // A closed path keeps its start, so that only the direction changes.
        if self.closed && self.points.first().is_some_and(PathPoint::is_on) {
            points.rotate_right(1);
        }
        Self::of_points(points, self.closed)
    }

    /// The lines, curves and arcs of the path, in drawing order; none for a dot.
    pub fn pieces(&self) -> impl Iterator<Item = PathPiece> {
        Pieces::new(&self.points, self.closed)
    }

    /// The lines and curves of the path, in drawing order; none for a dot. An arc is as many cubic curves as keep within 10⁻⁵ of
    /// its radius.
    pub fn segments(&self) -> impl Iterator<Item = PathSeg> {
        self.pieces().flat_map(PathPiece::segments)
    }

    /// True if it has cubic curves or arcs.
    pub(crate) fn is_mixed(&self) -> bool {
        !self.points.iter().all(|p| p.kind.is_quadratic())
    }

    /// The path with quadratic curves at most `tolerance` px away from its cubic curves and arcs.
    #[must_use]
    pub(crate) fn quadratic(&self, tolerance: f64) -> Self {
        match self.is_mixed() {
            true => self.with_quads(tolerance, |_| true),
            false => self.clone(),
        }
    }

    /// The path with quadratic curves at most `tolerance` px away from the pieces for which `is_one` says so; lines stay.
    pub(super) fn with_quads(&self, tolerance: f64, is_one: impl Fn(&PathPiece) -> bool) -> Self {
        let mut points = self.rewritten(|piece| match is_one(piece) {
            true => piece.between_quads(tolerance),
            false => piece.between().collect(),
        });
        // The last piece of a closed path ends at the first point.
        if self.closed {
            points.pop();
        }
        Self::of_points(points, self.closed)
    }

    /// All on-points, implied ones included, with what `between` gives for each piece. Those of a closed path end where they start.
    pub(super) fn rewritten(
        &self,
        between: impl Fn(&PathPiece) -> Vec<PathPoint>,
    ) -> Vec<PathPoint> {
        let start = self.pieces().next().map(|first| first.start());
        let rest = self.pieces().flat_map(|piece| {
            let end = PathPoint::on(piece.end());
            between(&piece).into_iter().chain([end])
        });
        start.map(PathPoint::on).into_iter().chain(rest).collect()
    }

    /// The path as `kurbo` has it. A closed one ends where it starts.
    pub fn bezier(&self) -> BezPath {
        let start = self.segments().next().map(|first| first.start());
        let start = start.unwrap_or(self.ends().0);
        let rest = self.segments().map(|segment| segment.as_path_el());
        std::iter::once(PathEl::MoveTo(start)).chain(rest).collect()
    }

    /// The corners of a polyline that is at most `tolerance` px away from the path. That of a closed path ends where
    /// it starts; a dot is one point.
    pub fn flattened(&self, tolerance: f64) -> Vec<Point> {
        let mut corners = Vec::new();
        kurbo::flatten(self.bezier(), tolerance, |element| {
            corners.extend(element.end_point());
        });
        corners
    }

    /// The path as lines that are at most `tolerance` px away from it. A dot is a line without length.
    pub(crate) fn lines(&self, tolerance: f64) -> Vec<Line> {
        let corners = self.flattened(tolerance);
        match corners[..] {
            [dot] => vec![Line::new(dot, dot)],
            _ => corners
                .windows(2)
                .map(|ends| Line::new(ends[0], ends[1]))
                .collect(),
        }
    }

    /// True if segments meet, so that the shape of joins matters.
    pub(crate) fn has_joins(&self) -> bool {
        self.closed || self.pieces().nth(1).is_some()
    }

    /// The box around its [hull](Self::hull).
    pub(crate) fn bounds(&self) -> Rect {
        bounds(self.hull())
    }

    /// Points whose convex hull has the path in it: its own, and for arcs the control points of curves that go farther out.
    pub(crate) fn hull(&self) -> impl Iterator<Item = Point> {
        let is_arc = |piece: &PathPiece| matches!(piece, PathPiece::Arc(_));
        let arcs = self.is_mixed().then(|| self.pieces().filter(is_arc));
        let curves = arcs.into_iter().flatten().flat_map(PathPiece::segments);
        let controls = curves.flat_map(|segment| {
            let curve = segment.to_cubic();
            [curve.p1, curve.p2]
        });
        self.points.iter().map(|p| p.at).chain(controls)
    }
}

/// The box around points, an empty one at the origin if there is none.
pub(crate) fn bounds(points: impl IntoIterator<Item = Point>) -> Rect {
    let mut points = points.into_iter();
    let first = points.next().unwrap_or(Point::ORIGIN);
    points.fold(Rect::from_points(first, first), |bounds, p| {
        bounds.union_pt(p)
    })
}

impl Shape {
    /// The closed path of the shape's element; its curves bulge by 0.02 px at most.
    pub fn path(self) -> Path {
        let points = self.points().map(|(at, kind)| PathPoint { at, kind });
        Path {
            points: points.collect(),
            closed: true,
            shape: Some(self),
        }
    }
}

/// True if closed polygons wind around a place.
pub(crate) fn is_inside(polygons: &[Line], p: Point) -> bool {
    // Each line that crosses the ray to the right of the place counts by its direction.
    let turn = |Line { p0, p1 }: &Line| match (p0.y <= p.y, p1.y <= p.y) {
        (true, false) if (*p1 - *p0).cross(p - *p0) > 0.0 => 1,
        (false, true) if (*p1 - *p0).cross(p - *p0) < 0.0 => -1,
        _ => 0,
    };
    polygons.iter().map(turn).sum::<i32>() != 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(points: &[(f64, f64, bool)], closed: bool) -> Result<Path> {
        let point = |&(x, y, is_on): &(f64, f64, bool)| PathPoint {
            at: Point::new(x, y),
            kind: PointKind::on_if(is_on),
        };
        Path::new(points.iter().map(point).collect(), closed)
    }

    #[test]
    fn a_shape_is_recognised_by_its_coordinates() {
        let center = Point::new(1310.29, 33.61);
        let shapes = [
            Shape::circle(center, 20.52),
            Shape::ellipse(center, [9.5, 30.0]),
            Shape::rect([center, Point::new(1400.5, 80.25)], 6.0),
        ];
        for shape in shapes {
            let single = |p: Point| crate::math::point(crate::math::xy(p));
            let plain = shape.path().map(single);
            assert_eq!(plain.shape(), None);
            let again = plain.clone().recognised().shape().unwrap();
            assert_eq!(again.kind(), shape.kind());
            let places = again.path().points().to_vec();
            let mut pairs = places.iter().zip(plain.points());
            assert!(pairs.all(|(a, b)| (a.at - b.at).hypot() < 1e-3));
            let first = plain.points()[0].at;
            let bent = plain.map(|p| {
                if p == first {
                    p + Vec2::new(0.01, 0.0)
                } else {
                    p
                }
            });
            assert_eq!(bent.recognised().shape(), None);
        }
    }

    #[test]
    fn segments_lie_end_to_end() {
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
                let segments: Vec<_> = path.segments().collect();
                let offs = 5 - kinds.count_ones() as usize;
                let joined = points.iter().zip(points.iter().cycle().skip(1));
                let pairs = joined.take(if closed { 5 } else { 4 });
                let lines = pairs.filter(|(a, b)| a.2 && b.2).count();
                assert_eq!(segments.len(), lines + offs, "{kinds:b} {closed}");
                for pair in segments.windows(2) {
                    assert_eq!(pair[0].end(), pair[1].start(), "{kinds:b}");
                }
                if closed {
                    assert_eq!(segments[0].start(), segments[segments.len() - 1].end());
                }
            }
        }
    }

    #[test]
    fn a_dot_has_no_segment() {
        assert_eq!(Path::dot(Point::new(1.0, 2.0)).segments().count(), 0);
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

    #[test]
    fn other_points_than_those_of_a_piece_are_refused() {
        use PointKind::{Arc, Cubic, On, Quad};
        let path = |kinds: &[PointKind], closed: bool| {
            let at = |k: usize| Point::new((k * k) as f64, 3.0 * k as f64);
            let points = kinds.iter().enumerate();
            let points = points.map(|(k, &kind)| PathPoint { at: at(k), kind });
            Path::new(points.collect(), closed)
        };
        for (kinds, closed) in [
            (&[On, Cubic, On][..], false),
            (&[On, Cubic, Cubic, Cubic, On], false),
            (&[On, Arc, Arc, On], false),
            (&[On, Quad, Arc, On], false),
            (&[On, Cubic, Quad, On], false),
            (&[Cubic, On, On, Quad], true),
            (&[Arc, Arc, Arc], true),
            (&[Cubic, Cubic], true),
            (&[On, On, Cubic], true),
        ] {
            let error = path(kinds, closed).unwrap_err().to_string();
            assert!(
                error.contains("on it") || error.contains("one Arc"),
                "{error}"
            );
        }
        for (kinds, closed, pieces) in [
            (
                &[On, Cubic, Cubic, On, Arc, On, Quad, Quad, On][..],
                false,
                4,
            ),
            (&[On, Arc, On, Arc], true, 2),
            (&[On, Cubic, Cubic], true, 1),
            (&[Cubic, On, On, Arc, On, Cubic], true, 3),
        ] {
            let path = path(kinds, closed).unwrap();
            assert_eq!(path.pieces().count(), pieces, "{kinds:?}");
            let pairs = path.pieces().zip(path.pieces().skip(1));
            pairs.for_each(|(a, b)| assert_eq!(a.end(), b.start()));
            let places = path.flattened(1e-3);
            let bounds = path.bounds().inflate(1e-9, 1e-9);
            assert!(places.iter().all(|p| bounds.contains(*p)), "{path:?}");
            let quadratic = path.quadratic(1e-3);
            assert!(!quadratic.is_mixed());
            let areas = [&path, &quadratic].map(|path| kurbo::Shape::area(&path.bezier()));
            assert!((areas[0] - areas[1]).abs() < 0.2, "{areas:?}");
        }
    }

    #[test]
    fn corners_make_a_rectangle_in_either_sense() {
        let corners = [(1.0, 2.0), (9.0, 2.0), (9.0, 7.5), (1.0, 7.5)].map(Point::from);
        let rect = Shape::rect([corners[0], corners[2]], 0.0);
        for turn in 0..4 {
            let mut points = corners.map(PathPoint::on).to_vec();
            points.rotate_left(turn);
            let of = |points: &[PathPoint], closed: bool| {
                Path::of_points(points.to_vec(), closed).rectangle()
            };
            assert_eq!(of(&points, true), Some(rect));
            points.reverse();
            assert_eq!(of(&points, true), Some(rect));
            assert_eq!(of(&points, false), None);
            points[0].at.x += 0.1;
            assert_eq!(of(&points, true), None);
        }
    }
}
