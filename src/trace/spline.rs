//! Splines: a line as the few points of a path.
//!
//! The line is cut at its corners. Between two of them lies the cheapest chain of spans.

use super::chain::{Sample, chain};
use super::lines::Line;
use crate::math::{self, distance};
use crate::scene::{Path, PathPoint};

/// The cosine of a corner's turn within [`CORNER_REACH`] radii is less than this. A guess.
const CORNER: f32 = 0.62;
/// Reach to either side of a place over which its turn is measured, in radii. A guess.
const CORNER_REACH: f32 = 0.9;
/// Farthest that a path may be from its line, px and in units of the radius. 0.15, 0.2, 0.25, 0.35 px: a bicycle has 36.7, 36.9, 35.8,
/// 36.5 dB in 13.7, 13.5, 15.4, 12.7 kB, a score 36.2, 36.1, 36.0, 35.6 dB in 8.7, 8.6, 8.4, 7.9 kB, a signature 33, 42, 40, 41 marks.
const TOLERANCE: [f32; 2] = [0.15, 0.03];
/// Distance between the places of a resampled line, px.
const STEP: f32 = 1.0;
type Place = [f32; 2];

/// The path of a line whose stroke has this radius, px.
pub(super) fn path(line: &Line, radius: f32) -> Path {
    let places: Vec<Place> = line.spots.iter().map(|spot| spot.at).collect();
    let mut places = resampled(&places, line.closed);
    if places.len() < 3 {
        let points = places.into_iter().map(|at| PathPoint::on(math::point(at)));
        return Path::of_points(points.collect(), false);
    }
    // Pixels make stairs, the larger ones the wider the line is.
    smooth(&mut places, line.closed, (0.25 * radius) as usize + 1);
    let [px, radii] = TOLERANCE;
    let tolerance = px + radii * radius;
    let mut corners = corners(&places, line.closed, radius);
    if line.closed {
        // From the first corner around to it, or from any place.
        let first = corners.first().copied().unwrap_or(0);
        places.rotate_left(first);
        places.push(places[0]);
        corners.iter_mut().for_each(|corner| *corner -= first);
    } else {
        corners.insert(0, 0);
    }
    let points = points(&places, corners, tolerance);
    let points = points.into_iter().map(|(at, is_on)| PathPoint {
        at: math::point(at),
        is_on,
    });
    let end = places.last().filter(|_| !line.closed);
    let end = end.map(|&end| PathPoint::on(math::point(end)));
    Path::of_points(points.chain(end).collect(), line.closed)
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

/// The points of a line with these corners, its end left out, each with whether it is on the path.
fn points(places: &[Place], corners: Vec<usize>, tolerance: f32) -> Vec<(Place, bool)> {
    let sample = |&at: &Place| Sample {
        at,
        outward: [0.0; 2],
        tolerance: [tolerance; 2],
        weight: 1.0,
    };
    let samples: Vec<Sample> = places.iter().map(sample).collect();
    // 1. Chains between corners. A ring without corners is one chain.
    let is_ring = corners.is_empty();
    let cuts: Vec<usize> = match is_ring {
        true => vec![0, places.len() - 1],
        false => corners.into_iter().chain([places.len() - 1]).collect(),
    };
    let mut points = Vec::new();
    let mut starts = Vec::new();
    for pair in cuts.windows(2) {
        starts.push(points.len());
        let run = &samples[pair[0]..=pair[1]];
        chain(run, std::iter::empty(), tolerance, &mut points);
    }
    // 2. Where two spans of a chain meet smoothly, the place between their control points says where.
    let count = points.len();
    let is_implied = |&i: &usize| {
        let [(a, before), (at, _), (b, after)] =
            [i + count - 1, i, i + 1].map(|k| points[k % count]);
        let middle = [0, 1].map(|k| 0.5 * (a[k] + b[k]));
        let is_corner = !is_ring && starts.contains(&i);
        !is_corner && !before && !after && distance(at, middle) <= tolerance
    };
    let is_kept = |i: &usize| !points[*i].1 || !is_implied(i);
    (0..count).filter(is_kept).map(|i| points[i]).collect()
}

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
                .map(|w| math::nearest_on_segment(*p, [w[0], w[1]]).1);
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
