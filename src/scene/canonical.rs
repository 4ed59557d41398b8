//! Paths as a file holds them.
//!
//! A file says every on-point, implied ones included. So between two neighbouring off-points of a rounded path lies
//! a multiple of its grid, and none of the numbers in the file is rounded. The path is in canonical form: of all lists
//! of points with its segments it is one that no rule makes shorter, so that reading gives the points that were written.

use kurbo::{CubicBez, ParamCurve, ParamCurveDeriv, QuadBez};

use super::arc::{Arc, Rounded};
use super::grid::{Grid, px, units};
use super::path::Path;
use super::piece::{PathPiece, PathPoint, PointKind};
use crate::math::Point;

impl Path {
    /// The path in canonical form. Each on-point that lies exactly halfway between two quadratic control points becomes an
    /// implied one, and a curve or an arc that is a line becomes one. All coordinates are multiples of a unit but those of arcs:
    /// the point of an arc is the one that [`Arc::of_numbers`] gives.
    pub(crate) fn canonical(points: Vec<PathPoint>, closed: bool) -> Self {
        let given = Self::of_points(points, closed);
        // Arcs while their three points are all in px; below they are taken along.
        let is_flat = |piece: &PathPiece| matches!(piece, PathPiece::Arc(arc) if arc.is_line());
        let points = given
            .without_between(is_flat)
            .unwrap_or(given)
            .into_points();
        // Whole numbers of units are exact, and so are their sums.
        let scaled = |points: &[PathPoint], f: fn(f64) -> f64| -> Vec<PathPoint> {
            let point = |p: &PathPoint| match p.kind {
                PointKind::Arc => *p,
                kind => PathPoint {
                    at: Point::new(f(p.at.x), f(p.at.y)),
                    kind,
                },
            };
            points.iter().map(point).collect()
        };
        let mut path = Canonical {
            points: scaled(&points, |px| units(px) as f64),
            closed,
        };
        path.settle();
        Self::of_points(scaled(&path.points, |units| px(units as i64)), path.closed)
    }

    /// The path with its points on the `grid`. The control point of a quadratic curve may be one step of the grid away from where
    /// it was, so that implied on-points are on the grid, too; and arcs become what a file has for them, as [`Arc::rounded`] says.
    pub(super) fn rounded(&self, grid: &Grid) -> Self {
        let mut points = self.points().to_vec();
        let first_on = points.iter().position(PathPoint::is_on);
        // Begin with an on-point, which is rounded by itself, so that each run of off-points starts from the grid.
        points.rotate_left(first_on.unwrap_or(0));
        let given = points.clone();
        let mut last: Option<PathPoint> = None;
        for point in &mut points {
            point.at = match last {
                Some(last) if last.is_quad() && point.is_quad() => {
                    // The implied point m goes to the grid, and the off-point to 2m − last. So neighbouring off-points are
                    // an even number of steps apart, and a ring of off-points alone closes on the grid, too.
                    let halfway = grid.point(last.at.midpoint(point.at));
                    (halfway.to_vec2() * 2.0 - last.at.to_vec2()).to_point()
                }
                _ => grid.point(point.at),
            };
            last = Some(*point);
        }
        if self.is_mixed() {
            points = with_arcs(&given, &points, grid);
        }
        Self::canonical(points, self.is_closed()).with_corners_for_cusps(grid)
    }

    /// The path with a corner on the `grid` where a curve bends more sharply than all programs can draw it.
    fn with_corners_for_cusps(self, grid: &Grid) -> Self {
        // The bend becomes an on-point, and a quadratic curve two lines. At an end it's the end itself, and one line is left. Of
        // a cubic curve both parts stay curves.
        let cut = |piece: &PathPiece| match piece {
            PathPiece::Quad(curve) => Some(vec![PathPoint::on(grid.point(cusp(curve)?))]),
            PathPiece::Cubic(curve) => {
                let corner = fold(curve)?;
                let [first, second] = [0.0..corner, corner..1.0].map(|part| curve.subsegment(part));
                let controls = |part: CubicBez| [part.p1, part.p2].map(PathPoint::cubic);
                let corner = PathPoint::on(first.p3);
                let mut points = [&controls(first)[..], &[corner], &controls(second)].concat();
                points.iter_mut().for_each(|p| p.at = grid.point(p.at));
                let is_within = ![curve.p0, curve.p3].contains(&points[2].at);
                is_within.then_some(points)
            }
            _ => None,
        };
        if !self.pieces().any(|piece| cut(&piece).is_some()) {
            return self;
        }
        let points =
            self.rewritten(|piece| cut(piece).unwrap_or_else(|| piece.between().collect()));
        // Curves that were smooth together stay so; each round leaves fewer of them.
        Self::canonical(points, self.is_closed()).with_corners_for_cusps(grid)
    }

    /// The rounded path with quadratic curves in the place of cubic ones that bend more tightly than a pen of this `radius`, px: inside
    /// such bends the outlines of resvg's cubic strokes leave parts out.
    pub(super) fn with_quads_for_bends(self, radius: f64, grid: &Grid) -> Self {
        let is_tight = |piece: &PathPiece| matches!(piece, PathPiece::Cubic(curve) if bends_within(curve, radius, HALVINGS));
        if !self.pieces().any(|piece| is_tight(&piece)) {
            return self;
        }
        let path = self.with_quads(grid.step().max(NEAREST), is_tight);
        // Arcs that were rounded stay as they are, or become cubic curves; each round leaves fewer of both.
        path.rounded(grid).with_quads_for_bends(radius, grid)
    }

    /// The path with lines in the place of the pieces for which `is_line` says so; `None` if there is none.
    fn without_between(&self, is_line: impl Fn(&PathPiece) -> bool) -> Option<Self> {
        // All on-points are written out first: without its control point, a curve would take its implied ends along.
        let lines = || {
            self.rewritten(|piece| match is_line(piece) {
                true => Vec::new(),
                false => piece.between().collect(),
            })
        };
        let has_lines = self.pieces().any(|piece| is_line(&piece));
        has_lines.then(|| Self::of_points(lines(), self.is_closed()))
    }

    /// The rounded path drawn the other way. Which of equal paths is the canonical one may depend on the direction.
    pub(crate) fn turned(&self) -> Self {
        let turned = self.reversed();
        Self::canonical(turned.points().to_vec(), self.is_closed())
    }

    /// True if the path is closed and its points are not all in one line.
    pub(super) fn encloses(&self) -> bool {
        let mut points = self.points().iter();
        let Some(a) = points.next() else { return false };
        // The first control point of a cubic curve may lie on its start.
        let Some(b) = points.find(|p| p.at != a.at) else {
            return false;
        };
        let side = |p: &PathPoint| (b.at - a.at).cross(p.at - a.at);
        // A rounded path that is a line strays from it by rounding of its coordinates alone.
        let least = 1e-9 * (b.at - a.at).hypot();
        // `side` is a distance times the length of the first leg; so is the bound, a distance of 1e-9 px.
        self.is_closed() && self.points().iter().any(|p| side(p).abs() > least)
    }
}

/// The `rounded` points of a path, whose arcs are those of the points as `given`, in the same order, that begins on the path.
fn with_arcs(given: &[PathPoint], rounded: &[PathPoint], grid: &Grid) -> Vec<PathPoint> {
    let count = given.len();
    let around =
        |points: &[PathPoint], i: usize| [i + count - 1, i, i + 1].map(|k| points[k % count].at);
    let point = |i: usize| {
        if rounded[i].kind != PointKind::Arc {
            return vec![rounded[i]];
        }
        let ([from, through, to], [start, _, end]) = (around(given, i), around(rounded, i));
        let points = Arc { from, through, to }
            .rounded([start, end], grid)
            .into_iter();
        let points = points.flat_map(|point| match point {
            Rounded::On(p) => vec![PathPoint::on(p)],
            Rounded::Arc(p) => vec![PathPoint::arc(p)],
            Rounded::Cubic(controls) => controls.map(PathPoint::cubic).to_vec(),
        });
        points.collect()
    };
    (0..count).flat_map(point).collect()
}

/// A path on its way to canonical form, in whole units.
struct Canonical {
    points: Vec<PathPoint>,
    closed: bool,
}

impl Canonical {
    /// Applies the rules of the canonical form until none makes the path shorter. None of them changes a segment's shape.
    fn settle(&mut self) {
        loop {
            let before = self.points.clone();
            // Straightening writes out implied points, and shortening takes back those that still are.
            self.straighten();
            self.shorten();
            if self.points == before {
                return;
            }
        }
    }

    /// Makes lines of curves whose control points add nothing to the line between their ends.
    fn straighten(&mut self) {
        let is_line = |piece: &PathPiece| match piece {
            PathPiece::Line(_) => false,
            PathPiece::Quad(curve) => [curve.p0, curve.p2].contains(&curve.p1),
            PathPiece::Cubic(curve) => is_straight_cubic(curve),
            // The arc's own point is in px here.
            PathPiece::Arc(arc) => arc.from == arc.to,
        };
        let path = Path::of_points(std::mem::take(&mut self.points), self.closed);
        self.points = path.without_between(is_line).unwrap_or(path).into_points();
    }

    /// Applies the rules of the canonical form once. None of them changes the shape of a piece.
    fn shorten(&mut self) {
        // 1. On-points that two off-points imply. Their neighbours are off-points, so removing them all at once is safe.
        self.retain(|[before, point, after]| !is_implied(before, point, after));
        // 2. On-points in one place, also where a closed path ends at its start.
        let coincide = |p: &PathPoint, q: &PathPoint| p.is_on() && q.is_on() && p.at == q.at;
        self.points.dedup_by(|next, kept| coincide(next, kept));
        while self.closed
            && self.points.len() > 1
            && self.ends().is_some_and(|[a, b]| coincide(&a, &b))
        {
            self.points.pop();
        }
        // 3. Control points at an end of their quadratic curve. Both neighbours are on-points, so these stay.
        self.retain(|[before, point, after]| !is_straight(before, point, after));
        // 4. A path whose points coincide is a dot, and a dot is open.
        if let Some([first, _]) = self
            .ends()
            .filter(|[first, _]| self.points.iter().all(|p| p.at == first.at))
        {
            self.points = vec![PathPoint::on(first.at)];
        }
        self.closed &= self.points.len() > 1;
        if self.closed {
            // 5. A closed path begins with an on-point if it has one, as the file's `M` does.
            let first_on = self.points.iter().position(PathPoint::is_on);
            self.points.rotate_left(first_on.unwrap_or(0));
        }
    }

    fn ends(&self) -> Option<[PathPoint; 2]> {
        Some([*self.points.first()?, *self.points.last()?])
    }

    /// Keeps the points that have no neighbour on one side, and those for which `keeps` says so. It is given the point
    /// between its neighbours.
    fn retain(&mut self, keeps: impl Fn([&PathPoint; 3]) -> bool) {
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
fn is_implied(before: &PathPoint, point: &PathPoint, after: &PathPoint) -> bool {
    let is_halfway = before.at.midpoint(after.at) == point.at;
    point.is_on() && before.is_quad() && after.is_quad() && is_halfway
}

/// True if an off-point makes a line, because it lies at one of the two on-points beside it.
fn is_straight(before: &PathPoint, point: &PathPoint, after: &PathPoint) -> bool {
    let are_on = before.is_on() && after.is_on();
    point.is_quad() && are_on && [before.at, after.at].contains(&point.at)
}

/// True if both control points of a curve in whole units lie on the line between its ends, and the curve doesn't turn back on it.
fn is_straight_cubic(curve: &CubicBez) -> bool {
    // Products of units may be beyond 2⁵³, where floats are no longer exact.
    let way = |from: Point, to: Point| [to.x - from.x, to.y - from.y].map(|units| units as i128);
    let chord = way(curve.p0, curve.p3);
    let legs = [
        (curve.p0, curve.p1),
        (curve.p1, curve.p2),
        (curve.p2, curve.p3),
    ];
    legs.into_iter().all(|(from, to)| {
        let [x, y] = way(from, to);
        let is_along = chord[0] * y == chord[1] * x && chord[0] * x + chord[1] * y >= 0;
        // Of a loop, whose chord has no direction, every leg has to have no length.
        is_along && (chord != [0; 2] || [x, y] == [0; 2])
    })
}

/// The smallest radius of curvature of a curve, px. Cairo draws a sharper bend without its round outside: of a stroke
/// 4 px wide with bends of 0.01 px, librsvg's render is 35 dB from its render of a polyline, with 0.04 px 44 dB.
const SHARPEST: f64 = 0.02;

/// Largest distance of the chord from a curve that it replaces because of a bend at an end, px.
const BESIDE: f64 = 0.1;

/// The point where a curve bends most if it does so more sharply than [`SHARPEST`]. At an end, where less of the stroke's
/// width is at stake, it counts if the chord is at most [`BESIDE`] from the curve.
fn cusp(curve: &QuadBez) -> Option<Point> {
    // Half the speed is |there + t·bend|, half the acceleration |bend|, and their cross product doesn't depend on t.
    let there = curve.p1 - curve.p0;
    let bend = (curve.p2 - curve.p1) - there;
    let area = there.cross(bend).abs();
    // A parabola a + 2t(c − a) + t²(a − 2c + b) bends most where its speed is across its acceleration.
    let apex = -there.dot(bend) / bend.hypot2();
    let t = apex.clamp(0.0, 1.0);
    let is_within = t > 0.0 && t < 1.0;
    // At the apex, speed and acceleration are at a right angle: |there × bend| = half speed · |bend|.
    let half_speed = if is_within {
        // Zero, as it should be, where the curve turns back into itself.
        area / bend.hypot()
    } else {
        (there + t * bend).hypot()
    };
    // The radius of curvature is |B′|³ / |B′ × B″| = 8h³ / 4·area = 2h³ / area; multiplied out, as the area may be 0.
    let is_sharp = 2.0 * half_speed * half_speed * half_speed <= SHARPEST * area;
    // `area` is chord · height of the control point, and a curve is half that height from its chord.
    let is_beside_chord = area <= 2.0 * BESIDE * (curve.p2 - curve.p0).hypot();
    (is_sharp && (is_within || is_beside_chord)).then(|| curve.eval(t))
}

/// Smallest distance of quadratic curves from the cubic one that they replace, px.
const NEAREST: f64 = 0.01;

/// Most times that a cubic curve is halved to tell how tightly it bends.
const HALVINGS: u32 = 6;

/// True if a cubic curve may have a radius of curvature below `radius`, px.
fn bends_within(curve: &CubicBez, radius: f64, halvings: u32) -> bool {
    let CubicBez { p0, p1, p2, p3 } = *curve;
    // The velocity is a quadratic Bézier curve of these, and its cross product with the acceleration one of those numbers; both lie
    // within the hull of their controls.
    let [a, b, c] = [p1 - p0, p2 - p1, p3 - p2].map(|leg| 3.0 * leg);
    let turns = [2.0 * a.cross(b), a.cross(c), 2.0 * b.cross(c)];
    let most = turns
        .iter()
        .fold(0.0, |most: f64, turn| most.max(turn.abs()));
    let chord = p3 - p0;
    let along = [a, b, c].map(|v| v.dot(chord)).into_iter();
    let slowest = along.fold(f64::INFINITY, f64::min).max(0.0);
    // The radius of curvature is |v|³ / |v × a|, and |v| is at least its part along the chord.
    let length = chord.hypot();
    if slowest * slowest * slowest >= radius * most * length * length * length {
        return false;
    }
    halvings == 0 || {
        let (first, second) = curve.subdivide();
        [first, second]
            .iter()
            .any(|half| bends_within(half, radius, halvings - 1))
    }
}

/// Steps in which a cubic curve is searched for bends; it has two at most.
const STEPS: usize = 32;

/// The parameter at which a cubic curve turns back more sharply than [`SHARPEST`], away from its ends.
fn fold(curve: &CubicBez) -> Option<f64> {
    let (velocity, acceleration) = (curve.deriv(), curve.deriv().deriv());
    let speed2 = |t: f64| velocity.eval(t).to_vec2().hypot2();
    let at = |step: usize| step as f64 / STEPS as f64;
    let is_sharp = |t: f64| {
        let [v, a] = [velocity.eval(t), acceleration.eval(t)].map(|p| p.to_vec2());
        let speed = v.hypot2().sqrt();
        // The radius of curvature is |v|³ / |v × a|. Where the curve comes back on itself both are 0, but for rounding.
        speed * speed * speed <= SHARPEST * v.cross(a).abs() || v.hypot2() <= 1e-10 * a.hypot2()
    };
    // It is slowest where it turns back.
    let is_slow = |k: &usize| speed2(at(*k)) <= speed2(at(k - 1)).min(speed2(at(k + 1)));
    let slow = (1..STEPS).filter(is_slow).map(|k| {
        let [mut low, mut high] = [at(k - 1), at(k + 1)];
        for _ in 0..60 {
            let [a, b] = [1.0 / 3.0, 2.0 / 3.0].map(|share| low + share * (high - low));
            match speed2(a) < speed2(b) {
                true => high = b,
                false => low = a,
            }
        }
        0.5 * (low + high)
    });
    slow.into_iter().find(|&t| is_sharp(t))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng;
    use crate::scene::UNITS_PER_PX;
    use kurbo::ParamCurveNearest;

    /// Points by their places, each on the path if it says so.
    fn points(list: &[(f64, f64, bool)]) -> Vec<PathPoint> {
        let point = |&(x, y, is_on): &(f64, f64, bool)| PathPoint {
            at: Point::new(x, y),
            kind: PointKind::on_if(is_on),
        };
        list.iter().map(point).collect()
    }

    /// The path rounded to a decimal, in tenths of a px.
    fn rounded(list: &[(f64, f64, bool)], closed: bool) -> (Vec<(i64, i64, bool)>, bool) {
        let path = Path::new(points(list), closed).unwrap();
        let written = path.rounded(&Grid::new(1));
        let tenths = |px: f64| units(px) / (UNITS_PER_PX / 10);
        let points = written.points().iter();
        let points = points
            .map(|p| (tenths(p.at.x), tenths(p.at.y), p.is_on()))
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
            let written = path.rounded(&Grid::new(1));
            for (before, after) in path.points().iter().zip(written.points()) {
                let away = before.at - after.at;
                let away = away.x.abs().max(away.y.abs());
                assert!(
                    away <= if before.is_on() { 0.0501 } else { 0.1001 },
                    "{after:?}"
                );
            }
            for end in written.segments().map(|segment| segment.end()) {
                let off = [end.x, end.y].map(|px| units(px) % (UNITS_PER_PX / 10));
                assert_eq!(off, [0; 2]);
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
    fn a_cubic_curve_that_turns_back_has_a_corner_there() {
        let kinds = |x: [f64; 4], y: [f64; 4]| {
            let at = |k: usize| Point::new(x[k], y[k]);
            let controls = [1, 2].map(|k| PathPoint::cubic(at(k)));
            let points = [
                &[PathPoint::on(at(0))],
                &controls[..],
                &[PathPoint::on(at(3))],
            ];
            let path = Path::new(points.concat(), false).unwrap();
            let points = path.rounded(&Grid::new(1)).points().to_vec();
            points.iter().map(|p| p.kind).collect::<Vec<_>>()
        };
        use PointKind::{Cubic, On};
        assert_eq!(kinds([9.5, 19.0, 19.0, 0.0], [19.0; 4]), [On; 3]);
        assert_eq!(kinds([0.0, -9.0, 19.0, 10.0], [19.0; 4]), [On; 4]);
        let cusp = [On, Cubic, Cubic, On, Cubic, Cubic, On];
        assert_eq!(kinds([0.0, 20.0, 0.0, 20.0], [0.0, 20.0, 20.0, 0.0]), cusp);
        let bend = [On, Cubic, Cubic, On];
        assert_eq!(kinds([0.0, 14.0, 6.0, 20.0], [0.0, 20.0, 20.0, 0.0]), bend);
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

    /// A path of all kinds of pieces, open or closed.
    fn mixed(seed: u64) -> Path {
        let draw = |axis, k| f64::from(rng::draw(axis, seed, k, 0));
        let closed = seed.is_multiple_of(2);
        let pieces = (0..4).flat_map(|i| {
            let at = |k: u64| Point::new(20.0 * draw(0, 4 * i + k), 20.0 * draw(1, 4 * i + k));
            let between = match (draw(2, i) * 5.0) as usize {
                0 => vec![],
                1 => vec![PathPoint::off(at(1)), PathPoint::off(at(2))],
                2 => vec![PathPoint::cubic(at(1)), PathPoint::cubic(at(2))],
                _ => vec![PathPoint::arc(at(1))],
            };
            [vec![PathPoint::on(at(0))], between].concat()
        });
        let last = (!closed).then(|| PathPoint::on(Point::new(3.0, 4.0)));
        Path::new(pieces.chain(last).collect(), closed).unwrap()
    }

    #[test]
    fn rounded_pieces_are_near_and_round_to_themselves() {
        for path in (0..500).map(mixed) {
            let written = path.rounded(&Grid::new(2));
            assert_eq!(written.rounded(&Grid::new(2)), written);
            let lines = path.lines(1e-3);
            for p in written.flattened(1e-3) {
                let nearest = lines.iter().map(|line| line.nearest(p, 0.0).distance_sq);
                let away = nearest.fold(f64::INFINITY, f64::min).sqrt();
                assert!(away < 0.1, "{path:?}: {away}");
            }
        }
    }

    #[test]
    fn cubic_curves_on_their_chord_are_lines() {
        let curve = |x: [f64; 4], y: [f64; 4]| {
            let at = |k: usize| Point::new(x[k], y[k]);
            let controls = [1, 2].map(|k| PathPoint::cubic(at(k)));
            let points = [
                &[PathPoint::on(at(0))],
                &controls[..],
                &[PathPoint::on(at(3))],
            ];
            let path = Path::new(points.concat(), false)
                .unwrap()
                .rounded(&Grid::new(2));
            path.points().len()
        };
        assert_eq!(curve([0.0, 1.0, 2.0, 3.0], [0.0, 2.0, 4.0, 6.0]), 2);
        assert_eq!(curve([0.0, 0.0, 3.0, 3.0], [0.0, 0.0, 6.0, 6.0]), 2);
        assert_eq!(curve([0.0, 1.0, 2.0, 3.0], [0.0, 2.0, 4.01, 6.0]), 4);
        assert_eq!(curve([0.0, 2.0, 1.0, 3.0], [0.0, 4.0, 2.0, 6.0]), 4);
        assert_eq!(curve([5.0; 4], [7.0; 4]), 1);
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
        let plain = [(list, false), (list, true), (off, true)];
        let plain = plain.map(|(list, closed)| Path::new(points(&list), closed).unwrap());
        for path in plain.into_iter().chain((0..200).map(mixed)) {
            let written = path.rounded(&Grid::new(1));
            let around = |piece: &PathPiece, is_turned: bool| {
                let mut points: Vec<_> = piece.between().map(|p| (p.kind, p.at)).collect();
                points.insert(0, (PointKind::On, piece.start()));
                points.push((PointKind::On, piece.end()));
                if is_turned {
                    points.reverse();
                }
                points
                    .into_iter()
                    .map(|(kind, at)| (kind, <(f64, f64)>::from(at)))
                    .collect()
            };
            let pieces = |path: &Path, is_turned: bool| -> Vec<Vec<_>> {
                let pieces = path.pieces().map(|piece| around(&piece, is_turned));
                let mut pieces: Vec<_> = pieces.collect();
                pieces.sort_by(|a: &Vec<_>, b| a.partial_cmp(b).unwrap());
                pieces
            };
            assert_eq!(pieces(&written, true), pieces(&written.turned(), false));
        }
    }
}
