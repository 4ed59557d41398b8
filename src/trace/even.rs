//! Evenness: does a stroke have the outline of a shape?
//!
//! Rays from the stroke's middle meet the outline of the shape. They are as long as the radius all along a stroke with
//! round ends and joins; they are not where the width varies, at square ends and at mitred corners.

use std::f32::consts::SQRT_2;

use crate::math::{self, Point, direction, distance, median};
use crate::scene::{Band, Path, Stroke, polyline, through};

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
/// Below the first radius, px, a picture does not tell round ends from square ones, and below the second one a line has round
/// ends unless it is nearer to square ones. Guesses.
const THINNEST: f32 = 2.2;
const THIN: f32 = 3.9;
/// Share of the places along a stroke that may be odd: thinning and crossings distort some. A guess.
const MOST_ODD: f32 = 0.15;

/// A pen that draws a line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pen {
    /// Half its width, px.
    pub(super) radius: f32,
    /// True if the line may have round ends and joins.
    pub(super) is_round: bool,
    /// The line with square ends and mitred corners, if it may have those.
    pub(super) band: Option<Band>,
}

impl Pen {
    pub(super) fn round(radius: f32) -> Self {
        Self {
            radius,
            is_round: true,
            band: None,
        }
    }
}

/// Farthest that the middle of a traced line is from its place, px. A guess.
pub(super) const WAVERING: f64 = 0.6;

/// Shortest side of a line with square ends, in radii: bends have shorter ones. A guess.
const SIDE: f32 = 3.0;

/// Places before an end, in radii, beside which something else has to be seen if that goes on beside the end. Guesses.
const BACK: [f32; 3] = [0.0, 0.4, 0.8];

/// Forms whose rays differ by less, px, look alike. A guess.
const ALIKE: f32 = 0.4;

/// The form of an end or a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    Round,
    /// Rather round than square.
    Rounder,
    Square,
}

impl Form {
    /// True if a ray to the outline is about as long as it is where the form is round, or square.
    fn is_at(self, ray: f32, [round, square]: [f32; 2], tolerance: f32) -> bool {
        // The middle of a blurred edge cuts a right angle off by about half a px.
        let blur = (square / round - 1.0) / (SQRT_2 - 1.0);
        let square = square - 0.5 * blur.min(1.0);
        // Slight turns look alike.
        let is_told = square - round >= ALIKE;
        let nearer = match is_told {
            true => tolerance.min(0.5 * (square - round)),
            false => tolerance,
        };
        match self {
            Self::Round => (ray - round).abs() <= tolerance,
            Self::Rounder => (ray - round).abs() <= nearer,
            Self::Square => (ray - square).abs() <= nearer,
        }
    }
}

impl<I: Fn(Place) -> f32, R: Fn(Place) -> Option<u32>> Shape<I, R> {
    /// The pen that draws the shape along the middle of the stroke, if there is one.
    pub(super) fn pen(&self, stroke: &Stroke) -> Option<Pen> {
        let own = stroke.radius as f32;
        let line = places_of(&stroke.path);
        let places = smoothed(along(&line, 1.0), 0.5 * own);
        let reach = 1.7 * own + 2.0;
        if places.len() < 3 || (places.len() as f32) < 0.7 * own {
            let middle = places[places.len() / 2].0;
            return self.disc_radius(middle, reach).map(Pen::round);
        }
        let widths = places
            .iter()
            .filter_map(|&(at, way)| self.radius(at, way, reach));
        let widths: Vec<f32> = widths.collect();
        let Some(radius) = median(widths.iter().copied()) else {
            return Some(Pen::round(own));
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
        let is_closed = stroke.path.is_closed();
        let band = self.band(stroke, radius);
        // Of a band that others hide the ends of, both may be true.
        let is_round = match &band {
            Some((_, is_round)) => *is_round,
            None => radius < THIN || self.has(&line, &places, is_closed, radius, Form::Round),
        };
        let band = band.map(|(band, _)| band);
        (is_round || band.is_some()).then_some(Pen {
            radius,
            is_round,
            band,
        })
    }

    /// The line of this radius with square ends and mitred corners along the middle of a stroke, if the shape may have those;
    /// and true if they may as well be round.
    fn band(&self, stroke: &Stroke, radius: f32) -> Option<(Band, bool)> {
        if radius < THINNEST {
            return None;
        }
        let path = self.centered(&polyline(&stroke.path, WAVERING, radius.into())?, radius)?;
        let (line, is_closed) = (places_of(&path), path.is_closed());
        let mut sides = line.windows(2);
        let is_long = sides.all(|ends| distance(ends[0], ends[1]) >= SIDE * radius);
        let places = along(&line, 1.0);
        if !is_long || !self.has(&line, &places, is_closed, radius, Form::Square) {
            return None;
        }
        let beyond = |(at, way)| self.ray(at, way, 2.2 * radius + 2.0).unwrap_or(0.0);
        let beyond = ends_of(&places).map(beyond);
        let band = Band::along(
            &path,
            2.0 * f64::from(radius),
            beyond.map(f64::from),
            [WAVERING, 0.0],
        )?;
        let is_round = self.has(&line, &places, is_closed, radius, Form::Rounder);
        Some((band, is_round))
    }

    /// A polyline with each of its sides in the middle of the shape.
    fn centered(&self, polyline: &Path, radius: f32) -> Option<Path> {
        let (line, is_closed) = (places_of(polyline), polyline.is_closed());
        let middle = |ends: &[Place]| {
            let (way, length) = (direction(ends[0], ends[1]), distance(ends[0], ends[1]));
            let normal = [-way[1], way[0]];
            let reach = 1.7 * radius + 2.0;
            // Corners and ends are another shape's.
            let inner = (0..length as usize).map(|px| px as f32 + 0.5);
            let inner = inner.filter(|px| (radius..=length - radius).contains(px));
            let offset = |px: f32| {
                let at = [0, 1].map(|k| ends[0][k] + px * way[k]);
                let [a, b] = [normal, normal.map(|v| -v)].map(|n| self.ray(at, n, reach));
                Some((px, 0.5 * (a? - b?)))
            };
            let offsets: Vec<(f32, f32)> = inner.filter_map(offset).collect();
            let (first, last) = offsets.split_at(offsets.len() / 2);
            let median = |part: &[(f32, f32)]| {
                let [px, offset] = [
                    median(part.iter().map(|o| o.0)),
                    median(part.iter().map(|o| o.1)),
                ];
                Some([px?, offset?])
            };
            let [[a, a_off], [b, b_off]] = [median(first)?, median(last)?];
            let at = |px: f32| {
                let off = a_off + (b_off - a_off) * (px - a) / (b - a);
                math::point([0, 1].map(|k| ends[0][k] + px * way[k] + off * normal[k]))
            };
            Some([at(0.0), at(length)])
        };
        let sides: Option<Vec<[Point; 2]>> = line.windows(2).map(middle).collect();
        through(&sides?, is_closed)
    }

    /// True if the ends and corners of a line have this form, or are hidden.
    fn has(
        &self,
        line: &[Place],
        places: &[(Place, Place)],
        is_closed: bool,
        radius: f32,
        form: Form,
    ) -> bool {
        let is_end = |(at, way)| self.is_end(at, way, radius, form);
        (is_closed || ends_of(places).into_iter().all(is_end))
            && self.has_joins(line, is_closed, radius, form)
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

    /// True if the shape ends with a stroke and has this form there, or goes on beneath or along something else.
    fn is_end(&self, at: Place, way: Place, radius: f32, form: Form) -> bool {
        let Some(tip) = self.ray(at, way, 2.2 * radius + 2.0) else {
            return true;
        };
        let center = [0, 1].map(|k| at[k] + (tip - radius) * way[k]);
        let normal = [-way[1], way[0]];
        let seen = |way: Place, from: Place| {
            (self.region)([0, 1].map(|k| from[k] + (radius + 1.5) * way[k]))
        };
        let beyond = seen(way, center);
        // A line that ends at one side, of some place, hides nothing.
        let is_other = |back: &f32| {
            let from = [0, 1].map(|k| center[k] - back * radius * way[k]);
            [normal, normal.map(|v| -v)]
                .iter()
                .all(|&n| seen(n, from) != beyond)
        };
        if BACK.iter().all(is_other) {
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
            .all(|ray| form.is_at(ray, [radius, SQRT_2 * radius], ODD[0] + 0.15 * radius))
    }

    /// True if the outline has this form at the corners of a stroke's middle.
    fn has_joins(&self, line: &[Place], is_closed: bool, radius: f32, form: Form) -> bool {
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
            let mitred = radius / (0.5 * (1.0 + turn)).sqrt();
            ray.is_none_or(|ray| form.is_at(ray, [radius, mitred], ODD[0] + 0.2 * radius))
        })
    }
}

fn places_of(path: &Path) -> Vec<Place> {
    path.flattened(0.1).into_iter().map(math::xy).collect()
}

/// The first and the last of places along a line, each with the direction in which the line ends.
fn ends_of(places: &[(Place, Place)]) -> [(Place, Place); 2] {
    let (first, last) = (places[0], places[places.len() - 1]);
    [(first.0, first.1.map(|v| -v)), last]
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
