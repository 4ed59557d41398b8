//! Splines: a run of places as the few points of a path.
//!
//! A line is cut at its corners. Between two corners lies a quadratic spline through as few control points as keep it
//! within a tolerance; none makes a straight line.

use super::lines::Line;
use super::recipe::Splines;
use crate::math::{self, Point, nearest_on_segment};
use crate::scene::{Path, PathPoint};

/// Distance between the places of a resampled line, px.
const STEP: f32 = 1.0;
type Place = [f32; 2];

/// The path of a line whose stroke has this radius, px.
pub(super) fn path(line: &Line, radius: f32, splines: Splines) -> Path {
    let places: Vec<Place> = line.spots.iter().map(|spot| spot.at).collect();
    let mut places = resampled(&places, line.closed);
    if places.len() < 3 {
        return open_path(places, Vec::new());
    }
    // Pixels make stairs, the larger ones the wider the line is.
    smooth(&mut places, line.closed, (0.25 * radius) as usize + 1);
    let [px, radii] = splines.tolerance;
    let tolerance = px + radii * radius;
    let corners = corners(&places, line.closed, radius, splines);
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
    PathPoint::on(Point::new(place[0], place[1]))
}

fn off(place: Place) -> PathPoint {
    PathPoint::off(Point::new(place[0], place[1]))
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
fn corners(places: &[Place], closed: bool, radius: f32, splines: Splines) -> Vec<usize> {
    let count = places.len();
    let reach = ((splines.corner_reach * radius / STEP) as usize).clamp(3, 24);
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
        cosines[i] < splines.corner
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
    if strays(run, &[run[0], run[run.len() - 1]]) <= tolerance {
        return Vec::new();
    }
    fewest(1, (run.len() / 3).clamp(1, 60), tolerance, |count| {
        let found = open_spline(run, count);
        let away = strays(run, &flattened(run, &found, false));
        (away, found)
    })
}

/// The control points of a smooth ring.
fn ring(places: &[Place], tolerance: f32) -> Vec<PathPoint> {
    let controls = fewest(4, (places.len() / 3).clamp(4, 80), tolerance, |count| {
        let found = closed_spline(places, count);
        let mut line = flattened(places, &found, true);
        line.extend(line.first().copied());
        (strays(places, &line), found)
    });
    controls.into_iter().map(off).collect()
}

/// The control points of the first of the splines of `first` to `most` control points that is within `tolerance`, or else
/// of the nearest one. `spline` tells how far one of so many is away, and its control points.
fn fewest(
    first: usize,
    most: usize,
    tolerance: f32,
    spline: impl Fn(usize) -> (f32, Vec<Place>),
) -> Vec<Place> {
    let mut best = (f32::INFINITY, Vec::new());
    let mut count = first;
    loop {
        let found = spline(count);
        if found.0 < best.0 {
            best = found;
        }
        if best.0 <= tolerance || count >= most {
            return best.1;
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
fn open_spline(run: &[Place], count: usize) -> Vec<Place> {
    let last = run.len() - 1;
    let samples = run.iter().enumerate().map(|(i, &place)| {
        let weights = open_weights(count, i as f32 / last as f32);
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

fn closed_spline(places: &[Place], count: usize) -> Vec<Place> {
    let all = places.len() as f32;
    let samples = places
        .iter()
        .enumerate()
        .map(|(i, &place)| (closed_weights(count, i as f32 / all), place));
    solve(samples, count)
}

/// The points whose weighted sums are nearest to the places.
fn solve(samples: impl Iterator<Item = (Vec<(usize, f32)>, Place)>, count: usize) -> Vec<Place> {
    // The normal equations; a little ridge keeps them solvable where no place depends on a point.
    let mut columns = vec![vec![0.0; count]; count];
    for (i, column) in columns.iter_mut().enumerate() {
        column[i] = 1e-6;
    }
    let mut right = [vec![0.0; count], vec![0.0; count]];
    for (weights, place) in samples {
        for &(i, v) in &weights {
            for &(k, w) in &weights {
                columns[k][i] += f64::from(v) * f64::from(w);
            }
            for axis in [0, 1] {
                right[axis][i] += f64::from(v) * f64::from(place[axis]);
            }
        }
    }
    let Some([x, y]) = math::solve_symmetric(columns, right) else {
        return Vec::new();
    };
    let pairs = x.iter().zip(&y);
    pairs.map(|(&x, &y)| [x as f32, y as f32]).collect()
}

/// Places along a spline through `controls`, between the ends of `run` or around.
fn flattened(run: &[Place], controls: &[Place], closed: bool) -> Vec<Place> {
    if controls.is_empty() {
        return vec![run[0], run[run.len() - 1]];
    }
    let count = controls.len();
    let samples = 2 * run.len();
    let place = |i: usize| {
        let t = i as f32 / samples as f32;
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
    (0..=samples).map(place).collect()
}

/// The largest distance of a place from the part of a polyline beside it. Both have the same parametrisation.
fn strays(places: &[Place], line: &[Place]) -> f32 {
    let (segments, last) = (line.len() - 1, (places.len() - 1).max(1));
    let away2 = |(i, p): (usize, &Place)| {
        let middle = i * segments / last;
        let near = middle.saturating_sub(WINDOW)..(middle + WINDOW).min(segments);
        let to = |k: usize| nearest_on_segment(*p, [line[k], line[k + 1]]).1;
        near.map(to).fold(f32::INFINITY, f32::min)
    };
    let all = places.iter().enumerate().map(away2);
    all.fold(0.0, f32::max).sqrt()
}

/// Segments to each side in which the nearest one is searched for.
const WINDOW: usize = 24;

#[cfg(test)]
mod tests {
    use super::super::skeleton::Spot;
    use super::*;
    use crate::fit::{Preset, Recipe};

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
        path(line, 3.0, Recipe::of(Preset::Balanced).tracing.splines)
    }

    fn kinds(path: &Path) -> Vec<bool> {
        path.points().iter().map(|p| p.is_on).collect()
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
        assert!(path.points().iter().all(|p| !p.is_on));
        for p in path.flattened(0.05) {
            let away = math::hypot(f64::from(p.x - 50.0), f64::from(p.y - 50.0)) - 40.0;
            assert!(away.abs() < 0.6, "{away} px off at {p:?}");
        }
    }

    #[test]
    fn an_arc_ends_where_its_line_does() {
        let places = &circle()[20..140];
        let path = path_of(&line(places.iter().copied(), false));
        let (a, b) = path.ends();
        assert_eq!([[a.x, a.y], [b.x, b.y]], [places[0], places[119]]);
        assert!(kinds(&path).iter().filter(|is_on| **is_on).count() == 2);
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
