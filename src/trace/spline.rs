//! Splines: a run of places as the few points of a path.
//!
//! A line is cut at its corners. Between two corners lies a quadratic spline through as few control points as keep it
//! within a tolerance; none makes a straight line.

use std::ops::RangeInclusive;

use super::lines::Line;
use crate::math::{self, Normal, direction, nearest_on_segment};
use crate::scene::{Path, PathPoint};

/// The cosine of a corner's turn within [`CORNER_REACH`] radii is less than this. A guess.
const CORNER: f32 = 0.62;
/// Reach to either side of a place over which its turn is measured, in radii. A guess.
const CORNER_REACH: f32 = 0.9;
/// Farthest that a spline may be from its line, px and in units of the radius. A guess.
const TOLERANCE: [f32; 2] = [0.35, 0.03];
/// Distance between the places of a resampled line, px.
const STEP: f32 = 1.0;
type Place = [f32; 2];

/// The path of a line whose stroke has this radius, px.
pub(super) fn path(line: &Line, radius: f32) -> Path {
    let places: Vec<Place> = line.spots.iter().map(|spot| spot.at).collect();
    let mut places = resampled(&places, line.closed);
    if places.len() < 3 {
        return open_path(places, Vec::new());
    }
    // Pixels make stairs, the larger ones the wider the line is.
    smooth(&mut places, line.closed, (0.25 * radius) as usize + 1);
    let [px, radii] = TOLERANCE;
    let tolerance = px + radii * radius;
    let corners = corners(&places, line.closed, radius);
    if line.closed {
        return closed_path(places, &corners, tolerance);
    }
    let mut cuts = corners;
    cuts.insert(0, 0);
    cuts.push(places.len() - 1);
    let points = runs(&places, &cuts, tolerance);
    open_path(vec![places[0]], points)
}

fn open_path(start: Vec<Place>, rest: Vec<PathPoint>) -> Path {
    let mut points: Vec<PathPoint> = start.into_iter().map(on).collect();
    points.extend(rest);
    Path::of_points(points, false)
}

fn closed_path(mut places: Vec<Place>, corners: &[usize], tolerance: f32) -> Path {
    let Some(&first) = corners.first() else {
        let points = ring(&places, tolerance);
        return Path::of_points(points, true);
    };
    places.rotate_left(first);
    places.push(places[0]);
    let mut cuts: Vec<usize> = corners.iter().map(|corner| corner - first).collect();
    cuts.push(places.len() - 1);
    let mut points = runs(&places, &cuts, tolerance);
    // The last point is the first corner again.
    points.rotate_right(1);
    Path::of_points(points, true)
}

fn on(place: Place) -> PathPoint {
    PathPoint::on(math::point(place))
}

fn off(place: Place) -> PathPoint {
    PathPoint::off(math::point(place))
}

fn distance(a: Place, b: Place) -> f32 {
    math::hypot(f64::from(a[0] - b[0]), f64::from(a[1] - b[1])) as f32
}

/// Places evenly along a polyline, with its ends.
fn resampled(places: &[Place], closed: bool) -> Vec<Place> {
    let mut all = places.to_vec();
    if closed {
        all.extend(places.first());
    }
    let length: f32 = all.windows(2).map(|w| distance(w[0], w[1])).sum();
    let count = (length / STEP).round() as usize;
    let Some(&last) = all.last().filter(|_| count > 0) else {
        return all.into_iter().take(1).collect();
    };
    // The step that divides the length evenly. `left` is what remains of it at the start of a segment.
    let step = length / count as f32;
    let mut out = vec![all[0]];
    let mut left = step;
    for pair in all.windows(2) {
        let (mut a, b) = (pair[0], pair[1]);
        let mut rest = distance(a, b);
        while rest >= left && out.len() < count {
            let share = left / rest;
            a = [0, 1].map(|k| a[k] + share * (b[k] - a[k]));
            out.push(a);
            rest -= left;
            left = step;
        }
        left -= rest;
    }
    if !closed {
        out.push(last);
    }
    out
}

/// Averages neighbours with weights of 1, 2, 1, `times` times. Ends stay.
fn smooth(places: &mut [Place], closed: bool, times: usize) {
    let count = places.len();
    for _ in 0..times {
        let before = places.to_vec();
        for (i, place) in places.iter_mut().enumerate() {
            if !closed && (i == 0 || i + 1 == count) {
                continue;
            }
            let (a, b) = (before[(i + count - 1) % count], before[(i + 1) % count]);
            *place = [0, 1].map(|k| 0.25 * (a[k] + b[k]) + 0.5 * before[i][k]);
        }
    }
}

/// The indices of the corners, in order.
fn corners(places: &[Place], closed: bool, radius: f32) -> Vec<usize> {
    let count = places.len();
    let reach = ((CORNER_REACH * radius / STEP) as usize).clamp(3, 24);
    if count < 2 * reach + 1 {
        return Vec::new();
    }
    // The cosine of the turn at each place.
    let cosine = |i: usize| {
        if !closed && (i < reach || i + reach >= count) {
            return 1.0;
        }
        let [a, b] = [(i + count - reach) % count, (i + reach) % count].map(|k| places[k]);
        let p = places[i];
        let (u, v) = ([p[0] - a[0], p[1] - a[1]], [b[0] - p[0], b[1] - p[1]]);
        let lengths = (u[0] * u[0] + u[1] * u[1]) * (v[0] * v[0] + v[1] * v[1]);
        (u[0] * v[0] + u[1] * v[1]) / lengths.sqrt().max(f32::MIN_POSITIVE)
    };
    let cosines: Vec<f32> = (0..count).map(cosine).collect();
    // Of neighbouring places that turn, the sharpest one is the corner.
    let is_sharpest = |&i: &usize| {
        cosines[i] < CORNER
            && (1..=reach).all(|d| {
                let before = (closed || i >= d).then(|| cosines[(i + count - d) % count]);
                let after = (closed || i + d < count).then(|| cosines[(i + d) % count]);
                before.is_none_or(|c| c > cosines[i]) && after.is_none_or(|c| c >= cosines[i])
            })
    };
    (0..count).filter(is_sharpest).collect()
}

/// The points after the first place: control points and corners of the runs between neighbouring `cuts`.
fn runs(places: &[Place], cuts: &[usize], tolerance: f32) -> Vec<PathPoint> {
    let mut points = Vec::new();
    for pair in cuts.windows(2) {
        let run = &places[pair[0]..=pair[1]];
        points.extend(controls(run, tolerance).into_iter().map(off));
        points.push(on(run[run.len() - 1]));
    }
    points
}

/// The fewest control points of a spline from the first to the last place that is nowhere farther than `tolerance`
/// from the places between.
fn controls(run: &[Place], tolerance: f32) -> Vec<Place> {
    if farthest(strays(run, &[run[0], run[run.len() - 1]])) <= tolerance {
        return Vec::new();
    }
    let spline = |shares: &[f32], count: usize| {
        let found = open_spline(run, shares, count);
        let away = strays(run, &flattened(run, shares, &found, false));
        (away, found)
    };
    nearest(1..=60, run, false, tolerance, spline)
}

/// The control points of a smooth ring.
fn ring(places: &[Place], tolerance: f32) -> Vec<PathPoint> {
    let spline = |shares: &[f32], count: usize| {
        let found = closed_spline(places, shares, count);
        let mut line = flattened(places, shares, &found, true);
        line.extend(line.first().copied());
        (strays(places, &line), found)
    };
    let controls = nearest(4..=80, places, true, tolerance, spline);
    controls.into_iter().map(off).collect()
}

/// The control points of a spline within `tolerance` of the places, or else of the nearest one. They lie evenly along the
/// places, unless `counts` of them are wild, as in a spiral of many turns: then they lie where it bends.
fn nearest(
    counts: RangeInclusive<usize>,
    places: &[Place],
    closed: bool,
    tolerance: f32,
    spline: impl Fn(&[f32], usize) -> (Vec<f32>, Vec<Place>),
) -> Vec<Place> {
    let (first, most) = (*counts.start(), (places.len() / 3).max(*counts.start()));
    let shares = even(places.len(), closed);
    let found = fewest(first, most.min(*counts.end()), tolerance, |count| {
        let (away, points) = spline(&shares, count);
        (farthest(away), points)
    });
    // What misses a little is mended by the fit. Where a score's staff turns into a stem, that is better than a line which does not.
    if found.0 <= WILD * tolerance || most <= *counts.end() {
        return found.1;
    }
    let shares = by_bends(places, closed);
    // Of so many places some are out of line. At half the tolerance a spiral takes 20 s and loses 6 dB.
    let bent = fewest(*counts.end() / 2, most, tolerance, |count| {
        let (away, points) = spline(&shares, count);
        (usual(away), points)
    });
    match bent.0 <= tolerance {
        true => bent.1,
        false => found.1,
    }
}

/// A spline that is farther off than so many tolerances is wild: between control points far from each other, it follows nothing. A
/// guess.
const WILD: f32 = 16.0;

/// Shares of a spline at which its places lie, 0 to 1, if all are as far from each other.
fn even(count: usize, closed: bool) -> Vec<f32> {
    let last = if closed { count } else { count - 1 };
    (0..count).map(|i| i as f32 / last as f32).collect()
}

/// Shares of a spline at which its places lie if it has more control points where it bends. A piece of a given tolerance is
/// as long as the radius of curvature to the power of ¾.
fn by_bends(places: &[Place], closed: bool) -> Vec<f32> {
    let count = places.len();
    let turn = |i: usize| {
        let beside = match closed {
            true => [(i + count - BEND) % count, (i + BEND) % count],
            false => [i.saturating_sub(BEND), (i + BEND).min(count - 1)],
        };
        let [a, b] = beside.map(|k| places[k]);
        let (u, v) = (direction(a, places[i]), direction(places[i], b));
        // About the angle between both.
        math::powf(distance(u, v), 0.75)
    };
    let turns: Vec<f32> = (0..count).map(turn).collect();
    let mean = turns.iter().sum::<f32>() / count as f32;
    // The cumulated density; bends of stairs are noise, so that a part of it is even.
    let mut sum = 0.0;
    let mut shares: Vec<f32> = Vec::with_capacity(count);
    for turn in &turns {
        shares.push(sum);
        sum += EVEN * mean + (1.0 - EVEN) * turn;
    }
    let all = if closed { sum } else { shares[count - 1] };
    let all = all.max(f32::MIN_POSITIVE);
    shares.iter().map(|share| share / all).collect()
}

/// Places to either side over which a bend is measured. A guess.
const BEND: usize = 8;

/// Share of the control points that lie evenly along a line, and not where it bends. A guess.
const EVEN: f32 = 0.3;

/// The first of the splines of `first` to `most` control points that is within `tolerance`, or else the nearest one: how
/// far it is away, and its control points. `spline` tells both for one of so many.
fn fewest(
    first: usize,
    most: usize,
    tolerance: f32,
    spline: impl Fn(usize) -> (f32, Vec<Place>),
) -> (f32, Vec<Place>) {
    let mut best = (f32::INFINITY, Vec::new());
    let mut count = first;
    loop {
        let found = spline(count);
        if found.0 < best.0 {
            best = found;
        }
        if best.0 <= tolerance || count >= most {
            return best;
        }
        // Long lines are tried with a sixth more at a time: a few points too many are removed after the polish.
        count += 1 + count / 6;
    }
}

/// The weights of the control points, and of the two ends, at share `t` of an open spline of `count` control points.
fn open_weights(count: usize, t: f32) -> Vec<(usize, f32)> {
    // Point 0 is the start, 1 to `count` are the control points, and `count + 1` is the end.
    let u = t * count as f32;
    let piece = (u as usize).min(count - 1);
    let s = u - piece as f32;
    let [a, c, b] = [(1.0 - s) * (1.0 - s), 2.0 * s * (1.0 - s), s * s];
    let k = piece + 1;
    let mut weights = vec![(k, c)];
    match piece {
        0 => weights.push((0, a)),
        _ => weights.extend([(k - 1, 0.5 * a), (k, 0.5 * a)]),
    }
    match piece + 1 == count {
        true => weights.push((count + 1, b)),
        false => weights.extend([(k, 0.5 * b), (k + 1, 0.5 * b)]),
    }
    weights
}

/// The weights of a closed spline, whose pieces go from middle to middle of neighbouring control points.
fn closed_weights(count: usize, t: f32) -> Vec<(usize, f32)> {
    let u = t * count as f32;
    let k = (u as usize).min(count - 1);
    let s = u - k as f32;
    let [a, c, b] = [(1.0 - s) * (1.0 - s), 2.0 * s * (1.0 - s), s * s];
    let (before, after) = ((k + count - 1) % count, (k + 1) % count);
    vec![
        (before, 0.5 * a),
        (k, 0.5 * a + c + 0.5 * b),
        (after, 0.5 * b),
    ]
}

/// The control points of an open spline that is nearest to the places of `run`, in least squares.
fn open_spline(run: &[Place], shares: &[f32], count: usize) -> Vec<Place> {
    let last = run.len() - 1;
    let samples = run.iter().zip(shares).map(|(&place, &share)| {
        let weights = open_weights(count, share);
        let mut rest = place;
        let mut free = Vec::new();
        for (k, w) in weights {
            match k {
                0 => rest = [0, 1].map(|axis| rest[axis] - w * run[0][axis]),
                k if k == count + 1 => rest = [0, 1].map(|axis| rest[axis] - w * run[last][axis]),
                k => free.push((k - 1, w)),
            }
        }
        (free, rest)
    });
    solve(samples, count)
}

fn closed_spline(places: &[Place], shares: &[f32], count: usize) -> Vec<Place> {
    let weights = shares.iter().map(|&share| closed_weights(count, share));
    solve(weights.zip(places.iter().copied()), count)
}

/// The points whose weighted sums are nearest to the places.
fn solve(samples: impl Iterator<Item = (Vec<(usize, f32)>, Place)>, count: usize) -> Vec<Place> {
    let mut equations = Normal::of(count);
    // A little ridge keeps them solvable where no place depends on a point.
    for k in 0..count {
        equations.add(&[(k, 1.0)], [0.0; 2], 1e-6);
    }
    for (weights, place) in samples {
        let terms: Vec<_> = weights.iter().map(|&(k, w)| (k, w.into())).collect();
        equations.add(&terms, place.map(f64::from), 1.0);
    }
    let solution = equations.solve().unwrap_or_default();
    solution.iter().map(|xy| xy.map(|v| v as f32)).collect()
}

/// Places along a spline through `controls`, between the ends of `run` or around: two for each place of the run.
fn flattened(run: &[Place], shares: &[f32], controls: &[Place], closed: bool) -> Vec<Place> {
    if controls.is_empty() {
        return vec![run[0], run[run.len() - 1]];
    }
    let count = controls.len();
    let place = |t: f32| {
        let weights = match closed {
            true => closed_weights(count, t),
            false => open_weights(count, t),
        };
        let mut place = [0.0; 2];
        for (k, w) in weights {
            let point = match (closed, k) {
                (true, k) => controls[k],
                (false, 0) => run[0],
                (false, k) => controls.get(k - 1).copied().unwrap_or(run[run.len() - 1]),
            };
            place = [0, 1].map(|axis| place[axis] + w * point[axis]);
        }
        place
    };
    let end = closed.then_some(1.0);
    let shares: Vec<f32> = shares.iter().copied().chain(end).collect();
    let halves = shares.windows(2).flat_map(|w| [w[0], 0.5 * (w[0] + w[1])]);
    halves.chain(shares.last().copied()).map(place).collect()
}

/// The squared distance of each place from the part of a polyline beside it. Both have the same parametrisation.
fn strays(places: &[Place], line: &[Place]) -> Vec<f32> {
    let (segments, last) = (line.len() - 1, (places.len() - 1).max(1));
    let away2 = |(i, p): (usize, &Place)| {
        let middle = i * segments / last;
        let near = middle.saturating_sub(WINDOW)..(middle + WINDOW).min(segments);
        let to = |k: usize| nearest_on_segment(*p, [line[k], line[k + 1]]).1;
        near.map(to).fold(f32::INFINITY, f32::min)
    };
    places.iter().enumerate().map(away2).collect()
}

/// The largest of squared distances, px.
fn farthest(away2: Vec<f32>) -> f32 {
    away2.into_iter().fold(0.0, f32::max).sqrt()
}

/// The largest of squared distances but a fiftieth of them, px.
fn usual(mut away2: Vec<f32>) -> f32 {
    let at = away2.len() - 1 - away2.len() / 50;
    away2.select_nth_unstable_by(at, f32::total_cmp).1.sqrt()
}

/// Segments to each side in which the nearest one is searched for.
const WINDOW: usize = 24;

#[cfg(test)]
mod tests {
    use super::super::skeleton::Spot;
    use super::*;

    fn line(places: impl IntoIterator<Item = Place>, closed: bool) -> Line {
        let spots = places.into_iter().map(|at| Spot { at, radius: 3.0 });
        Line {
            spots: spots.collect(),
            closed,
        }
    }

    /// Places on a circle of radius 40 px about (50, 50).
    fn circle() -> Vec<Place> {
        let at = |i: u16| {
            let (sin, cos) = math::sin_cos(f64::from(i) * std::f64::consts::TAU / 240.0);
            [50.0 + 40.0 * cos as f32, 50.0 + 40.0 * sin as f32]
        };
        (0..240).map(at).collect()
    }

    fn path_of(line: &Line) -> Path {
        path(line, 3.0)
    }

    fn kinds(path: &Path) -> Vec<bool> {
        path.points().iter().map(PathPoint::is_on).collect()
    }

    #[test]
    fn a_straight_line_has_two_points() {
        let places = (0..50).map(|i| [i as f32, 10.0 + 0.5 * i as f32 + 0.2 * (i % 2) as f32]);
        assert_eq!(kinds(&path_of(&line(places, false))), [true, true]);
    }

    #[test]
    fn a_ring_is_a_closed_spline_of_few_control_points() {
        let path = path_of(&line(circle(), true));
        assert!(path.is_closed() && path.points().len() <= 12, "{path:?}");
        assert!(path.points().iter().all(|p| !p.is_on()));
        for p in path.flattened(0.05) {
            let away = math::hypot(p.x - 50.0, p.y - 50.0) - 40.0;
            assert!(away.abs() < 0.6, "{away} px off at {p:?}");
        }
    }

    #[test]
    fn an_arc_ends_where_its_line_does() {
        let places = &circle()[20..140];
        let path = path_of(&line(places.iter().copied(), false));
        let (a, b) = path.ends();
        assert_eq!([math::xy(a), math::xy(b)], [places[0], places[119]]);
        assert!(kinds(&path).iter().filter(|is_on| **is_on).count() == 2);
    }

    #[test]
    fn a_spiral_of_many_turns_is_followed_to_its_end() {
        let place = |i: u16| {
            let turn = f64::from(i) * 0.1;
            let (sin, cos) = math::sin_cos(turn);
            let radius = 4.0 + 0.8 * turn;
            [150.0 + (radius * cos) as f32, 150.0 + (radius * sin) as f32]
        };
        let places: Vec<Place> = (0..800).map(place).collect();
        let path = path_of(&line(places.iter().copied(), false));
        assert!(path.points().len() < 400, "{} points", path.points().len());
        let drawn: Vec<Place> = path.flattened(0.05).into_iter().map(math::xy).collect();
        for p in &places[20..] {
            let away2 = drawn
                .windows(2)
                .map(|w| nearest_on_segment(*p, [w[0], w[1]]).1);
            let away = away2.fold(f32::INFINITY, f32::min).sqrt();
            assert!(away < 1.0, "{away} px off at {p:?}");
        }
    }

    #[test]
    fn corners_stay_corners() {
        let along = |a: Place, b: Place| {
            (0..40).map(move |i| [0, 1].map(|k| a[k] + (b[k] - a[k]) * i as f32 / 40.0))
        };
        let corners = [[10.0, 10.0], [60.0, 12.0], [55.0, 60.0], [12.0, 50.0]];
        let sides = (0..4).flat_map(|i| along(corners[i], corners[(i + 1) % 4]));
        let path = path_of(&line(sides, true));
        assert_eq!(kinds(&path), [true; 4], "{path:?}");
        assert!(path.is_closed());
    }
}
