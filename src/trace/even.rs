//! Evenness: does a stroke have the outline of a shape?
//!
//! Rays from the stroke's middle meet the outline of the shape. They are as long as the radius all along a stroke with
//! round ends and joins; they are not where the width varies, at square ends and at mitred corners.

use crate::math::{direction, distance, median};
use crate::scene::Stroke;

type Place = [f32; 2];

/// A shape under a stroke.
pub(super) struct Shape<I, R> {
    /// The share of the shape at a place, 0 to 1.
    pub(super) inside: I,
    /// The region that is seen at a place.
    pub(super) region: R,
}

/// Farthest that a ray's length may be from the radius: px, and in units of the radius. Guesses.
const ODD: [f32; 2] = [0.3, 0.12];
/// Below this radius, px, a picture hardly tells round ends from square ones. A guess.
const THIN: f32 = 3.9;
/// Share of the places along a stroke that may be odd: thinning and crossings distort some. A guess.
const MOST_ODD: f32 = 0.15;

impl<I: Fn(Place) -> f32, R: Fn(Place) -> Option<u32>> Shape<I, R> {
    /// Half the width of the shape, px, if the stroke draws it.
    pub(super) fn even_radius(&self, stroke: &Stroke) -> Option<f32> {
        let line = stroke.path.flattened(0.1);
        let line: Vec<Place> = line.iter().map(|p| [p.x, p.y]).collect();
        let places = smoothed(along(&line, 1.0), 0.5 * stroke.radius);
        let reach = 1.7 * stroke.radius + 2.0;
        if places.len() < 3 || (places.len() as f32) < 0.7 * stroke.radius {
            let middle = places[places.len() / 2].0;
            return self.disc_radius(middle, reach);
        }
        let widths = places
            .iter()
            .filter_map(|&(at, way)| self.radius(at, way, reach));
        let widths: Vec<f32> = widths.collect();
        let Some(radius) = median(widths.iter().copied()) else {
            return Some(stroke.radius);
        };
        let odd = widths
            .iter()
            .filter(|width| is_odd(**width, radius))
            .count();
        let most = if radius < THIN {
            2.0 * MOST_ODD
        } else {
            MOST_ODD
        };
        if odd as f32 > most * widths.len() as f32 {
            return None;
        }
        if radius < THIN {
            return Some(radius);
        }
        let ends = match stroke.path.is_closed() {
            true => Vec::new(),
            false => {
                let (first, last) = (places[0], places[places.len() - 1]);
                vec![(first.0, first.1.map(|v| -v)), last]
            }
        };
        let is_round = ends
            .into_iter()
            .all(|(at, way)| self.is_round_end(at, way, radius))
            && self.has_round_joins(&line, stroke.path.is_closed(), radius);
        is_round.then_some(radius)
    }

    /// The distance in a direction at which the shape ends.
    fn ray(&self, from: Place, way: Place, reach: f32) -> Option<f32> {
        const STEP: f32 = 0.5;
        let at = |t: f32| (self.inside)([0, 1].map(|k| from[k] + t * way[k]));
        let mut before = at(0.0);
        if before < 0.5 {
            return None;
        }
        let mut t = 0.0;
        while t < reach {
            let after = at(t + STEP);
            if after < 0.5 {
                return Some(t + STEP * (before - 0.5) / (before - after));
            }
            before = after;
            t += STEP;
        }
        None
    }

    /// Half the width of the shape across a place.
    fn radius(&self, at: Place, way: Place, reach: f32) -> Option<f32> {
        let [a, b] = [[-way[1], way[0]], [way[1], -way[0]]].map(|n| self.ray(at, n, reach));
        Some(0.5 * (a? + b?))
    }

    /// The radius of a disc around a place.
    fn disc_radius(&self, middle: Place, reach: f32) -> Option<f32> {
        const DIAGONAL: f32 = std::f32::consts::FRAC_1_SQRT_2;
        let across = |way: Place| {
            let [a, b] = [way, way.map(|v| -v)].map(|way| self.ray(middle, way, reach));
            Some(0.5 * (a? + b?))
        };
        let ways = [[1.0, 0.0], [0.0, 1.0], [DIAGONAL; 2], [DIAGONAL, -DIAGONAL]];
        let radii: Option<Vec<f32>> = ways.into_iter().map(across).collect();
        let radii = radii?;
        let middle = 0.25 * radii.iter().sum::<f32>();
        let is_round = radii.iter().all(|&radius| !is_odd(radius, middle));
        is_round.then_some(middle)
    }

    /// True if the shape is round where a stroke ends, or goes on there beneath or along something else.
    fn is_round_end(&self, at: Place, way: Place, radius: f32) -> bool {
        let Some(tip) = self.ray(at, way, 2.2 * radius + 2.0) else {
            return true;
        };
        let center = [0, 1].map(|k| at[k] + (tip - radius) * way[k]);
        let normal = [-way[1], way[0]];
        let seen = |way: Place, away: f32| {
            (self.region)([0, 1].map(|k| center[k] + (away + 1.5) * way[k]))
        };
        let beyond = seen(way, radius);
        let sides = [normal, normal.map(|v| -v)].map(|n| seen(n, radius));
        if sides.iter().all(|side| *side != beyond) {
            return true;
        }
        let slanted = |side: f32| {
            let slanted =
                [0, 1].map(|k| (way[k] + side * normal[k]) * std::f32::consts::FRAC_1_SQRT_2);
            self.ray(center, slanted, 2.2 * radius + 2.0)
        };
        let rays = [slanted(1.0), slanted(-1.0)];
        rays.into_iter()
            .flatten()
            .all(|ray| (ray - radius).abs() <= ODD[0] + 0.15 * radius)
    }

    /// True if the outline is round at the corners of a stroke's middle.
    fn has_round_joins(&self, line: &[Place], is_closed: bool, radius: f32) -> bool {
        let count = line.len();
        let corners = if is_closed {
            0..count
        } else {
            1..count.saturating_sub(1)
        };
        corners.into_iter().all(|i| {
            let [a, b, c] = [
                line[(i + count - 1) % count],
                line[i],
                line[(i + 1) % count],
            ];
            let (u, v) = (direction(a, b), direction(b, c));
            let turn = u[0] * v[0] + u[1] * v[1];
            if turn > 0.75 || distance(a, b) < radius || distance(b, c) < radius {
                return true;
            }
            let out = direction(v, u);
            let ray = self.ray(b, out, 2.5 * radius + 2.0);
            ray.is_none_or(|ray| (ray - radius).abs() <= ODD[0] + 0.2 * radius)
        })
    }
}

fn is_odd(width: f32, radius: f32) -> bool {
    (width - radius).abs() > ODD[0] + ODD[1] * radius
}

/// Places along a polyline about `step` px apart, with the direction there.
fn along(line: &[Place], step: f32) -> Vec<(Place, Place)> {
    let mut places = Vec::new();
    for pair in line.windows(2) {
        let length = distance(pair[0], pair[1]);
        let way = direction(pair[0], pair[1]);
        let count = (length / step).ceil().max(1.0) as usize;
        let place = |k: usize| {
            let share = k as f32 / count as f32;
            (
                [0, 1].map(|axis| pair[0][axis] + share * (pair[1][axis] - pair[0][axis])),
                way,
            )
        };
        places.extend((0..count).map(place));
    }
    match (places.last().copied(), line.last()) {
        (Some((_, way)), Some(&end)) => places.push((end, way)),
        (_, Some(&end)) => places.push((end, [1.0, 0.0])),
        _ => {}
    }
    places
}

/// Places with directions over `reach` px to either side, as traced lines waver.
fn smoothed(places: Vec<(Place, Place)>, reach: f32) -> Vec<(Place, Place)> {
    let reach = reach.ceil().max(1.0) as usize;
    let at = |i: usize| {
        let last = places.len() - 1;
        let (a, b) = (
            places[i.saturating_sub(reach)].0,
            places[(i + reach).min(last)].0,
        );
        let (at, way) = places[i];
        let is_turned_back = distance(a, b) < 0.5;
        (at, if is_turned_back { way } else { direction(a, b) })
    };
    (0..places.len()).map(at).collect()
}
