//! Paths as the integers that a file holds.
//!
//! A file says every on-point, implied ones included. So between two neighbouring off-points of a [`WrittenPath`] lies
//! a multiple of its grid, and none of the numbers in the file is rounded. The path is in canonical form: of all lists
//! of points with its pieces it is one that no rule makes shorter, so that reading gives the points that were written.

use super::grid::{Grid, UNITS_PER_PX};
use super::path::{self, Path, PathPoint, Piece, Place};
use crate::math::{self, Point};

/// A point in units of 1/[`UNITS_PER_PX`] px.
pub(crate) type WrittenPoint = PathPoint<[i64; 2]>;

impl Place for [i64; 2] {
    /// Exact where the sum is even, as it is between the off-points of a written path.
    fn middle(a: Self, b: Self) -> Self {
        [0, 1].map(|axis| (a[axis] + b[axis]) / 2)
    }
}

/// The path of a written mark, in canonical form.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct WrittenPath {
    points: Vec<WrittenPoint>,
    closed: bool,
}

impl WrittenPath {
    /// The path through these points and around these off-points, which has their pieces. Each on-point that lies
    /// exactly halfway between two off-points becomes an implied one.
    pub(crate) fn new(points: Vec<WrittenPoint>, closed: bool) -> Self {
        let mut path = Self { points, closed };
        loop {
            let before = path.points.clone();
            path.straighten();
            path.shorten();
            if path.points == before {
                return path;
            }
        }
    }

    /// Makes lines of curves whose control point lies at one of their ends.
    fn straighten(&mut self) {
        let is_line = |piece: &Piece<[i64; 2]>| match *piece {
            Piece::Line(_) => true,
            Piece::Curve([a, knee, b]) => knee == a || knee == b,
        };
        let is_straight =
            |piece: &Piece<[i64; 2]>| matches!(piece, Piece::Curve(_)) && is_line(piece);
        let Some(start) = self.pieces().next().map(|piece| piece.start()) else {
            return;
        };
        if !self.pieces().any(|piece| is_straight(&piece)) {
            return;
        }
        let mut points = vec![PathPoint::on(start)];
        for piece in self.pieces() {
            if let Piece::Curve([_, knee, _]) = piece
                && !is_line(&piece)
            {
                points.push(PathPoint::off(knee));
            }
            points.push(PathPoint::on(piece.end()));
        }
        self.points = points;
    }

    /// The path with its points on the `grid`. An off-point may be one step of the grid away from where it was, so that
    /// implied on-points are on the grid, too.
    pub(super) fn rounded(path: &Path, grid: &Grid) -> Self {
        let mut points = path.points().to_vec();
        let first_on = points.iter().position(|p| p.is_on);
        points.rotate_left(first_on.unwrap_or(0));
        let step = if points.iter().all(|p| p.is_on) {
            1
        } else {
            step(spacing(path), grid)
        };
        let coarse = grid.coarser(step);
        let mut rounded: Vec<WrittenPoint> = Vec::with_capacity(points.len());
        for point in points {
            let place = [point.at.x, point.at.y].map(f64::from);
            let at = match rounded.last() {
                Some(last) if !last.is_on && !point.is_on => [0, 1].map(|axis| {
                    let halfway = f64::midpoint(last.at[axis] as f64 / PX, place[axis]);
                    2 * coarse.units(halfway) - last.at[axis]
                }),
                _ => place.map(|px| coarse.units(px)),
            };
            rounded.push(PathPoint {
                at,
                is_on: point.is_on,
            });
        }
        let rounded = Self::new(rounded, path.is_closed()).with_corners_for_cusps(&coarse);
        if step > 1 && rounded.points.iter().all(|p| p.is_on) {
            // No curve is left, so that a reader would not use the coarser grid.
            return Self::rounded(&rounded.path(), grid);
        }
        rounded
    }

    /// The line from one place to another, of units.
    #[cfg(test)]
    pub(crate) fn line(a: [i64; 2], b: [i64; 2]) -> Self {
        Self::new([a, b].map(PathPoint::on).into(), false)
    }

    /// The path with a corner on the `grid` where a curve bends more sharply than all programs can draw it.
    fn with_corners_for_cusps(self, grid: &Grid) -> Self {
        if !self.pieces().any(|piece| cusp(piece).is_some()) {
            return self;
        }
        let start = self
            .pieces()
            .next()
            .map(|piece| PathPoint::on(piece.start()));
        let mut points: Vec<WrittenPoint> = start.into_iter().collect();
        for piece in self.pieces() {
            match (piece, cusp(piece)) {
                (Piece::Curve(_), Some(corner)) => {
                    points.push(PathPoint::on(corner.map(|px| grid.units(px))));
                }
                (Piece::Curve([_, knee, _]), None) => points.push(PathPoint::off(knee)),
                (Piece::Line(_), _) => {}
            }
            points.push(PathPoint::on(piece.end()));
        }
        // Curves that were smooth together stay so; each round leaves fewer of them.
        Self::new(points, self.closed).with_corners_for_cusps(grid)
    }

    /// The points, in drawing order. A closed path starts on the path, unless all its points are off it.
    pub(crate) fn points(&self) -> &[WrittenPoint] {
        &self.points
    }

    /// True if the last point is joined to the first.
    pub(crate) fn is_closed(&self) -> bool {
        self.closed
    }

    /// The lines and curves of the path, in drawing order; none for a dot.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = Piece<[i64; 2]>> {
        path::pieces(&self.points, self.closed)
    }

    /// The segments of a polyline at most `tolerance` px away from the path, with corners in whole units. None of them
    /// has no length, so that a dot has none.
    pub(crate) fn segments(&self, tolerance: f64) -> Vec<[[i64; 2]; 2]> {
        let mut segments = Vec::new();
        for piece in self.pieces() {
            match piece {
                Piece::Line(ends) => segments.push(ends),
                Piece::Curve(points) => push_chords(&mut segments, points, tolerance),
            }
        }
        segments.retain(|[a, b]| a != b);
        segments
    }

    /// True if the path is closed and its points are not all in one line.
    pub(super) fn encloses(&self) -> bool {
        let [Some(a), Some(b)] = [self.points.first(), self.points.get(1)] else {
            return false;
        };
        let along = [b.at[0] - a.at[0], b.at[1] - a.at[1]];
        let side = |p: &WrittenPoint| {
            let away = [p.at[0] - a.at[0], p.at[1] - a.at[1]].map(i128::from);
            i128::from(along[0]) * away[1] - i128::from(along[1]) * away[0]
        };
        self.closed && self.points.iter().any(|p| side(p) != 0)
    }

    /// True if pieces meet, so that the shape of joins matters.
    pub(crate) fn has_joins(&self) -> bool {
        self.closed || self.pieces().nth(1).is_some()
    }

    /// The path drawn the other way.
    pub(crate) fn reversed(&self) -> Self {
        let mut reversed = self.clone();
        reversed.points.reverse();
        if self.closed && self.points.first().is_some_and(|p| p.is_on) {
            reversed.points.rotate_right(1);
        }
        // Which of equal paths is the canonical one may depend on the direction.
        Self::new(reversed.points, reversed.closed)
    }

    /// The path in px.
    pub(super) fn path(&self) -> Path {
        // One division and one rounding give the `f32` nearest to the written decimal.
        let px = |units: i64| (units as f64 / PX) as f32;
        let point = |p: &WrittenPoint| PathPoint {
            at: Point::new(px(p.at[0]), px(p.at[1])),
            is_on: p.is_on,
        };
        Path::of_valid(self.points.iter().map(point).collect(), self.closed)
    }

    /// Applies the rules of the canonical form once. None of them changes the shape of a piece.
    fn shorten(&mut self) {
        self.retain(|[before, point, after]| !is_implied(before, point, after));
        let coincide = |p: &WrittenPoint, q: &WrittenPoint| p.is_on && q.is_on && p.at == q.at;
        self.points.dedup_by(|next, kept| coincide(next, kept));
        while self.closed
            && self.points.len() > 1
            && self.ends().is_some_and(|[a, b]| coincide(&a, &b))
        {
            self.points.pop();
        }
        self.retain(|[before, point, after]| !is_straight(before, point, after));
        if let Some([first, _]) = self
            .ends()
            .filter(|[first, _]| self.points.iter().all(|p| p.at == first.at))
        {
            self.points = vec![PathPoint::on(first.at)];
        }
        self.closed &= self.points.len() > 1;
        if self.closed {
            let first_on = self.points.iter().position(|p| p.is_on);
            self.points.rotate_left(first_on.unwrap_or(0));
        }
    }

    fn ends(&self) -> Option<[WrittenPoint; 2]> {
        Some([*self.points.first()?, *self.points.last()?])
    }

    /// Keeps the points that have no neighbour on one side, and those for which `keeps` says so. It is given the point
    /// between its neighbours.
    fn retain(&mut self, keeps: impl Fn([&WrittenPoint; 3]) -> bool) {
        let points = std::mem::take(&mut self.points);
        let count = points.len();
        let is_end = |i: usize| !self.closed && (i == 0 || i + 1 == count);
        let around = |i: usize| [i + count - 1, i, i + 1].map(|k| &points[k % count]);
        self.points = (0..count)
            .filter(|&i| is_end(i) || keeps(around(i)))
            .map(|i| points[i])
            .collect();
    }
}

/// True if an on-point lies where one between these off-points is implied.
fn is_implied(before: &WrittenPoint, point: &WrittenPoint, after: &WrittenPoint) -> bool {
    let is_halfway = |axis: usize| before.at[axis] + after.at[axis] == 2 * point.at[axis];
    point.is_on && !before.is_on && !after.is_on && is_halfway(0) && is_halfway(1)
}

/// True if an off-point makes a line, because it lies at one of the two on-points beside it.
fn is_straight(before: &WrittenPoint, point: &WrittenPoint, after: &WrittenPoint) -> bool {
    let are_on = before.is_on && after.is_on;
    !point.is_on && are_on && [before.at, after.at].contains(&point.at)
}

/// Appends the chords of a curve.
fn push_chords(out: &mut Vec<[[i64; 2]; 2]>, [a, c, b]: [[i64; 2]; 3], tolerance: f64) {
    let bend = [0, 1].map(|k| (a[k] - 2 * c[k] + b[k]) as f64 / PX);
    let count = path::steps(math::hypot(bend[0], bend[1]), tolerance);
    let at = |i: u16| {
        let t = f64::from(i) / f64::from(count);
        let u = 1.0 - t;
        let along =
            |k: usize| a[k] as f64 * u * u + 2.0 * c[k] as f64 * u * t + b[k] as f64 * t * t;
        [0, 1].map(|k| along(k).round() as i64)
    };
    out.extend((0..count).map(|i| [at(i), at(i + 1)]));
}

const PX: f64 = UNITS_PER_PX as f64;

/// The smallest radius of curvature of a curve, px. Cairo draws a sharper bend without its round outside: of a stroke
/// 4 px wide with bends of 0.01 px, librsvg's render is 35 dB from that of a polyline, with 0.04 px 44 dB.
const SHARPEST: f64 = 0.02;

/// Largest distance of the chord from a curve that it replaces because of a bend at an end, px.
const BESIDE: f64 = 0.1;

/// Where a curve bends most, px, if it does so more sharply than [`SHARPEST`]. At an end, where less of the stroke's width
/// is at stake, it counts if the chord is at most [`BESIDE`] from the curve.
fn cusp(piece: Piece<[i64; 2]>) -> Option<[f64; 2]> {
    let Piece::Curve(points) = piece else {
        return None;
    };
    let [a, c, b] = points.map(|p| p.map(|units| units as f64 / PX));
    let there = [c[0] - a[0], c[1] - a[1]];
    let bend = [a[0] - 2.0 * c[0] + b[0], a[1] - 2.0 * c[1] + b[1]];
    let bend2 = bend[0] * bend[0] + bend[1] * bend[1];
    let area = (there[0] * bend[1] - there[1] * bend[0]).abs();
    // A parabola a + 2t(c − a) + t²(a − 2c + b) bends most where its speed is across its acceleration.
    let apex = -(there[0] * bend[0] + there[1] * bend[1]) / bend2;
    let t = apex.clamp(0.0, 1.0);
    let is_within = t > 0.0 && t < 1.0;
    let half_speed = if is_within {
        // Zero, as it should be, where the curve turns back into itself.
        area / bend2.sqrt()
    } else {
        math::hypot(there[0] + t * bend[0], there[1] + t * bend[1])
    };
    let is_sharp = 2.0 * math::powi(half_speed, 3) <= SHARPEST * area;
    let is_beside_chord = area <= 2.0 * BESIDE * math::hypot(b[0] - a[0], b[1] - a[1]);
    let at = |axis: usize| a[axis] + t * (2.0 * there[axis] + t * bend[axis]);
    (is_sharp && (is_within || is_beside_chord)).then(|| [at(0), at(1)])
}

/// The grid's step, in its multiples, on which `f32` with this `spacing` tells neighbours apart. Otherwise what is read
/// could have another rounding.
pub(super) fn step(spacing: f32, grid: &Grid) -> i64 {
    ((f64::from(spacing) * grid.per_px()).ceil() as u64).next_power_of_two() as i64
}

/// The distance of neighbouring `f32` at the path's largest coordinate.
pub(super) fn spacing(path: &Path) -> f32 {
    let far = path.points().iter().flat_map(|p| [p.at.x, p.at.y]);
    let far = far.fold(0.0_f32, |far, px| far.max(px.abs()));
    far.next_up() - far
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points by their places, each on the path if it says so.
    fn points(list: &[(f32, f32, bool)]) -> Vec<PathPoint> {
        let point = |&(x, y, is_on): &(f32, f32, bool)| PathPoint {
            at: Point::new(x, y),
            is_on,
        };
        list.iter().map(point).collect()
    }

    /// The path rounded to a decimal, in tenths of a px.
    fn rounded(list: &[(f32, f32, bool)], closed: bool) -> (Vec<(i64, i64, bool)>, bool) {
        let path = Path::new(points(list), closed).unwrap();
        let written = WrittenPath::rounded(&path, &Grid::new(1));
        let tenths = |units: i64| units / (UNITS_PER_PX / 10);
        let points = written.points().iter();
        let points = points
            .map(|p| (tenths(p.at[0]), tenths(p.at[1]), p.is_on))
            .collect();
        (points, written.is_closed())
    }

    const ON: bool = true;
    const OFF: bool = false;

    #[test]
    fn every_implied_point_is_on_the_grid_and_no_point_is_a_step_away() {
        let list = [
            (0.0, 0.0, ON),
            (1.06, 0.04, OFF),
            (2.11, 1.36, OFF),
            (3.98, 1.03, OFF),
            (5.07, 2.0, OFF),
            (6.0, 0.0, ON),
        ];
        for closed in [false, true] {
            let path = Path::new(points(&list), closed).unwrap();
            let written = WrittenPath::rounded(&path, &Grid::new(1));
            for (before, after) in path.points().iter().zip(written.path().points()) {
                let away = (before.at - after.at).abs().max();
                assert!(
                    away <= if before.is_on { 0.0501 } else { 0.1001 },
                    "{after:?}"
                );
            }
            for piece in written.pieces() {
                assert_eq!(piece.end().map(|units| units % (UNITS_PER_PX / 10)), [0; 2]);
            }
        }
    }

    #[test]
    fn points_that_coincide_are_one() {
        let line = [
            (1.0, 2.0, ON),
            (1.01, 2.0, ON),
            (4.0, 2.0, ON),
            (4.02, 2.01, ON),
        ];
        assert_eq!(rounded(&line, false).0, [(10, 20, ON), (40, 20, ON)]);
        let ring = [
            (1.0, 2.0, ON),
            (4.0, 2.0, ON),
            (3.0, 6.0, ON),
            (1.01, 2.02, ON),
        ];
        assert_eq!(rounded(&ring, true).0.len(), 3);
        for kind in [ON, OFF] {
            let speck = [
                (1.0, 2.0, ON),
                (1.01, 2.01, kind),
                (1.02, 2.02, kind),
                (1.0, 2.0, ON),
            ];
            for closed in [false, true] {
                assert_eq!(rounded(&speck, closed), (vec![(10, 20, ON)], false));
            }
        }
    }

    #[test]
    fn a_control_point_at_an_end_makes_a_line() {
        let start = [(1.0, 2.0, ON), (1.01, 2.0, OFF), (4.0, 2.0, ON)];
        let end = [(1.0, 2.0, ON), (4.01, 2.0, OFF), (4.0, 2.0, ON)];
        for list in [start, end] {
            assert_eq!(rounded(&list, false).0, [(10, 20, ON), (40, 20, ON)]);
        }
        // Here it makes the first half of the path straight, and the second one starts there in its direction.
        let spline = [
            (1.0, 2.0, ON),
            (1.0, 2.0, OFF),
            (4.0, 2.0, OFF),
            (4.0, 6.0, ON),
        ];
        assert_eq!(rounded(&spline, false).0.len(), 4);
    }

    #[test]
    fn a_path_that_became_straight_in_part_has_no_implied_points() {
        let ring = [
            (4.0, 6.0, ON),
            (2.0, 8.0, OFF),
            (0.0, 6.0, ON),
            (0.0, 6.0, OFF),
            (6.0, 4.0, OFF),
        ];
        let expected = [(0, 60, ON), (30, 50, ON), (60, 40, OFF), (20, 80, OFF)];
        assert_eq!(rounded(&ring, true).0, expected);
    }

    #[test]
    fn points_halfway_between_control_points_are_implied() {
        let wave = [
            (0.0, 0.0, ON),
            (1.0, 1.0, OFF),
            (2.01, 1.0, ON),
            (3.0, 1.0, OFF),
            (4.0, 0.0, ON),
        ];
        let expected = [(0, 0, ON), (10, 10, OFF), (30, 10, OFF), (40, 0, ON)];
        assert_eq!(rounded(&wave, false).0, expected);
        let ring = [
            (0.0, 1.0, ON),
            (0.0, 0.0, OFF),
            (4.0, 0.0, OFF),
            (0.0, 2.0, OFF),
        ];
        let expected = [(0, 0, OFF), (40, 0, OFF), (0, 20, OFF)];
        assert_eq!(rounded(&ring, true), (expected.to_vec(), true));
    }

    #[test]
    fn a_curve_that_turns_back_sharply_is_two_lines() {
        let needle = [(0.0, 0.0, ON), (30.0, 10.0, OFF), (0.0, 0.1, ON)];
        let expected = [(0, 0, ON), (150, 50, ON), (0, 1, ON)];
        assert_eq!(rounded(&needle, false).0, expected);
        let bend = [(0.0, 0.0, ON), (30.0, 10.0, OFF), (0.0, 9.0, ON)];
        assert_eq!(rounded(&bend, false).0[1], (300, 100, OFF));
        // The curves before and after it stay smooth together.
        let spline = [
            (0.0, 0.0, ON),
            (2.0, 9.0, OFF),
            (9.0, 2.0, OFF),
            (9.0, 20.0, OFF),
            (9.0, -20.0, OFF),
            (20.0, 0.0, ON),
        ];
        let kinds: Vec<_> = rounded(&spline, false).0.iter().map(|p| p.2).collect();
        assert_eq!(kinds, [ON, OFF, OFF, ON, ON, ON, OFF, ON]);
    }

    #[test]
    fn a_curve_that_bends_sharply_at_its_end_is_a_line_if_that_is_close() {
        let late = [(0.0, 0.0, ON), (30.0, 10.0, OFF), (30.2, 9.9, ON)];
        assert_eq!(rounded(&late, false).0, [(0, 0, ON), (302, 99, ON)]);
        let early = [(30.2, 9.9, ON), (30.0, 10.0, OFF), (0.0, 0.0, ON)];
        assert_eq!(rounded(&early, false).0, [(302, 99, ON), (0, 0, ON)]);
        // Further from its end, the control point makes a blunter bend.
        let blunt = [(0.0, 0.0, ON), (30.0, 10.0, OFF), (30.9, 9.6, ON)];
        assert_eq!(rounded(&blunt, false).0[1], (300, 100, OFF));
        // The chord is 0.15 px from this one.
        let far = [(0.0, 0.0, ON), (90.0, 0.0, OFF), (90.1, 0.3, ON)];
        assert_eq!(rounded(&far, false).0[1], (900, 0, OFF));
    }

    #[test]
    fn a_closed_path_starts_on_the_path() {
        let drop = [
            (4.0, 0.0, OFF),
            (4.0, 4.0, OFF),
            (0.0, 0.0, ON),
            (1.0, -3.0, ON),
        ];
        let expected = [(0, 0, ON), (10, -30, ON), (40, 0, OFF), (40, 40, OFF)];
        assert_eq!(rounded(&drop, true), (expected.to_vec(), true));
    }

    #[test]
    fn the_other_way_has_the_same_pieces() {
        let list = [
            (0.0, 0.0, ON),
            (4.0, 0.0, OFF),
            (4.0, 4.0, OFF),
            (0.0, 4.0, ON),
        ];
        let off = list.map(|(x, y, _)| (x, y, OFF));
        for (list, closed) in [(list, false), (list, true), (off, true)] {
            let path = Path::new(points(&list), closed).unwrap();
            let written = WrittenPath::rounded(&path, &Grid::new(1));
            let turned = |piece: Piece<[i64; 2]>| match piece {
                Piece::Line([a, b]) => vec![b, a],
                Piece::Curve([a, c, b]) => vec![b, c, a],
            };
            let kept = |piece: Piece<[i64; 2]>| match piece {
                Piece::Line(ends) => ends.to_vec(),
                Piece::Curve(points) => points.to_vec(),
            };
            let mut pieces: Vec<_> = written.pieces().map(turned).collect();
            let mut reversed: Vec<_> = written.reversed().pieces().map(kept).collect();
            pieces.sort();
            reversed.sort();
            assert_eq!(pieces, reversed);
            assert_eq!(written.reversed().reversed().pieces().count(), pieces.len());
        }
    }
}
