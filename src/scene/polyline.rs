//! Polylines: the straight sides and clear corners of a path that wavers, as the middle of a traced line does.

use kurbo::{Line, ParamCurveNearest, Vec2};

use super::path::Path;
use super::piece::PathPoint;
use crate::math::Point;

/// Cosine of the slightest turn that is a clear corner.
pub(super) const CLEAR: f64 = 0.94;

/// The polyline with clear corners that a path is within a `tolerance`, px; `None` if it has none. The middle of a traced line
/// is farther off where others join it, at corners and at its ends, by about its `radius`: there its long sides tell.
pub(crate) fn polyline(path: &Path, tolerance: f64, radius: f64) -> Option<Path> {
    let is_closed = path.is_closed();
    // 1. The sides that are long enough to tell where the line is.
    let corners = simplified(path, tolerance)?;
    let closing = is_closed.then(|| corners[0]);
    let ends: Vec<Point> = corners.iter().copied().chain(closing).collect();
    let blurred = 2.0 * tolerance + 3.0 * radius;
    let sides = ends.windows(2).map(|ends| [ends[0], ends[1]]);
    let mut sides: Vec<Side> = sides
        .filter(|[a, b]| (*b - *a).hypot() >= blurred)
        .collect();
    // 2. Sides on one line are one side.
    let off = 2.0 * tolerance + 0.3 * radius;
    sides = sides.into_iter().fold(Vec::new(), |mut joined, side| {
        match joined.last_mut() {
            Some(last) if is_one_line(*last, side, off) => last[1] = side[1],
            _ => joined.push(side),
        }
        joined
    });
    if let (true, [first, .., last]) = (is_closed, &mut sides[..])
        && is_one_line(*last, *first, off)
    {
        first[0] = last[0];
        sides.pop();
    }
    // 3. Sides end where the path does, and else where they meet.
    if let (false, [first, ..]) = (is_closed, &mut sides[..]) {
        first[0] = on_line(path.ends().0, *first);
    }
    if let (false, [.., last]) = (is_closed, &mut sides[..]) {
        last[1] = on_line(path.ends().1, *last);
    }
    let polyline = through(&sides, is_closed)?;
    // 4. Bends have no clear corners, and short sides that were left out may have led elsewhere.
    let places = path.flattened(0.05);
    let corners: Vec<Point> = polyline.points().iter().map(|p| p.at).collect();
    let is_like = are_near(&places, &corners, is_closed, 2.0 * tolerance + radius);
    let turns = turns(polyline.points(), is_closed)?;
    let inner = match is_closed {
        true => 0..turns.len(),
        false => 1..turns.len() - 1,
    };
    let is_clear = turns[inner].iter().all(|turn| turn.cosine < CLEAR);
    (is_clear && is_like).then_some(polyline)
}

/// The polyline along these sides, whose corners are where two of them meet; `None` if some do not, or there is none.
pub(crate) fn through(sides: &[Side], is_closed: bool) -> Option<Path> {
    let corner = |i: usize| meeting(sides[i], sides[(i + 1) % sides.len()]);
    let corners: Option<Vec<Point>> = match is_closed {
        true => (0..sides.len()).map(corner).collect(),
        false => {
            let [[start, _], [_, end]] = [sides.first()?, sides.last()?];
            let inner: Option<Vec<Point>> = (0..sides.len() - 1).map(corner).collect();
            Some([vec![*start], inner?, vec![*end]].concat())
        }
    };
    let points = corners?.into_iter().map(PathPoint::on).collect::<Vec<_>>();
    (points.len() > 1).then(|| Path::of_points(points, is_closed))
}

/// The ends of a side.
type Side = [Point; 2];

/// True if two sides, one after the other, lie at most `off` px beside the line through both.
fn is_one_line([a, b]: Side, [c, d]: Side, off: f64) -> bool {
    let (u, v, way) = (b - a, d - c, d - a);
    // The line through both sides runs from the start of the first to the end of the second.
    let beside = |p: Point| (p - a).cross(way).abs() / way.hypot().max(f64::MIN_POSITIVE);
    let is_slight = u.dot(v) >= CLEAR * u.hypot() * v.hypot();
    is_slight && beside(b) <= off && beside(c) <= off
}

/// The place on the line through a side that is nearest to `p`.
fn on_line(p: Point, [a, b]: Side) -> Point {
    let way = b - a;
    a + way * ((p - a).dot(way) / way.hypot2())
}

/// The corners of a polyline that a path is within a tolerance of, px.
fn simplified(path: &Path, tolerance: f64) -> Option<Vec<Point>> {
    let is_closed = path.is_closed();
    let places = path.flattened(0.05);
    let end = places.len().checked_sub(1)?;
    let far = |i: &usize| (places[*i] - places[0]).hypot2();
    // Ramer–Douglas–Peucker: the place that is farthest off becomes a corner, until none is too far off.
    // Two places that stay: the ends, or of a closed path its start and the place farthest from it.
    let mut kept = match is_closed {
        true => vec![0, (0..=end).max_by(|a, b| far(a).total_cmp(&far(b)))?, end],
        false => vec![0, end],
    };
    while let Some((at, i)) = farthest_off(&places, &kept, tolerance) {
        kept.insert(at, i);
    }
    let mut corners: Vec<Point> = kept.iter().map(|&i| places[i]).collect();
    if is_closed {
        corners.pop();
    }
    // Where a path turns back a little, or begins within a side, a corner adds nothing to the others.
    let mut i = usize::from(!is_closed);
    while i + usize::from(!is_closed) < corners.len() {
        let mut fewer = corners.clone();
        fewer.remove(i);
        match fewer.len() > 1 && are_near(&places, &fewer, is_closed, tolerance) {
            true => corners = fewer,
            false => i += 1,
        }
    }
    Some(corners)
}

/// Where the lines through two sides meet.
fn meeting([a, b]: Side, [c, d]: Side) -> Option<Point> {
    Line::new(a, b).crossing_point(Line::new(c, d))
}

/// True if each place is within a tolerance of the polyline of these corners.
fn are_near(places: &[Point], corners: &[Point], is_closed: bool, tolerance: f64) -> bool {
    let closing = is_closed.then(|| corners[0]);
    let ends: Vec<Point> = corners.iter().copied().chain(closing).collect();
    let is_near = |place: &Point| {
        let away2 = |ends: &[Point]| distance2(*place, ends[0], ends[1]);
        ends.windows(2)
            .any(|ends| away2(ends) <= tolerance * tolerance)
    };
    places.iter().all(is_near)
}

/// The place that is farthest from the polyline of those that are kept, and where among them it belongs; `None` if all are
/// within the tolerance.
fn farthest_off(places: &[Point], kept: &[usize], tolerance: f64) -> Option<(usize, usize)> {
    let spans = kept.windows(2).enumerate();
    let away = spans.flat_map(|(k, span)| {
        let [a, b] = [span[0], span[1]].map(|i| places[i]);
        let inner = span[0] + 1..span[1];
        inner.map(move |i| (distance2(places[i], a, b), (k + 1, i)))
    });
    let (far2, found) = away.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (far2 > tolerance * tolerance).then_some(found)
}

/// The square of a point's distance from the line segment from `a` to `b`.
fn distance2(p: Point, a: Point, b: Point) -> f64 {
    Line::new(a, b).nearest(p, 0.0).distance_sq
}

/// The turn of a line at one of its points.
pub(super) struct Turn {
    pub(super) cosine: f64,
    /// The tangent of half of it.
    pub(super) tangent: f64,
}

/// Directions of the legs before and after each point of a line; `None` if points coincide.
pub(super) fn directions(points: &[PathPoint], is_closed: bool) -> Option<Vec<[Vec2; 2]>> {
    let count = points.len();
    let leg = |from: usize, to: usize| {
        let way = points[to % count].at - points[from % count].at;
        (way.hypot() > 0.0).then(|| way.normalize())
    };
    let both = |i: usize| {
        let before = (is_closed || i > 0).then(|| leg(i + count - 1, i));
        let after = (is_closed || i + 1 < count).then(|| leg(i, i + 1));
        // At an end the line goes straight on, so its turn is 0.
        let (before, after) = (before.or(after)?, after.or(before)?);
        Some([before?, after?])
    };
    (0..count).map(both).collect()
}

/// The turns of a line at its points, 0 at its ends; `None` if points coincide.
pub(super) fn turns(points: &[PathPoint], is_closed: bool) -> Option<Vec<Turn>> {
    let turn = |[before, after]: [Vec2; 2]| {
        let cosine = before.dot(after);
        Turn {
            cosine,
            // tan(θ/2) = sin θ / (1 + cos θ)
            tangent: before.cross(after).abs() / (1.0 + cosine),
        }
    };
    Some(
        directions(points, is_closed)?
            .into_iter()
            .map(turn)
            .collect(),
    )
}
