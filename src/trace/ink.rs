//! Ink: the middles of lines whose width varies, as a field of shares shows them.
//!
//! The skeleton of the field at twice its resolution, with the radius of each of its points.

use super::contour::Field;
use super::edge::Middle;
use super::lines::{self, Line};
use super::shape;
use super::skeleton::{Graph, Spot};
use crate::math;

/// Pixels of the mask along one of the field. Lines of less than a px break at its own resolution.
const FINENESS: usize = 2;
/// Where shares differ by less than this in the neighbourhood of a pixel, it is inside or outside by itself. A guess.
const FLAT: f32 = 0.15;
/// Fewest pixels of the mask that are a line. A guess.
const LEAST: usize = 6;
/// Standard deviation by which the skeleton is smoothed, points of it: a staircase of half a px.
const SMOOTH: f32 = 3.0;

/// The middles of the lines in a field; `None` if what it shows is no lines.
pub(super) fn middles(field: &Field) -> Option<Vec<Middle>> {
    let (mask, width) = mask(field);
    let keys: Vec<Option<()>> = mask.iter().map(|&inside| inside.then_some(())).collect();
    let shapes = shape::shapes(&keys, width, LEAST);
    let middles: Vec<Middle> = shapes
        .iter()
        .flat_map(|(_, shape)| {
            let mut graph = Graph::of(shape);
            let scaled = |spot: &mut Spot| {
                spot.at = [0, 1].map(|k| field.origin[k] as f32 + spot.at[k] / FINENESS as f32);
                spot.radius /= FINENESS as f32;
            };
            graph.nodes.iter_mut().for_each(scaled);
            let edges = graph.edges.iter_mut();
            edges.flat_map(|edge| &mut edge.spots).for_each(scaled);
            graph.clean();
            graph.cross();
            let crossings: Vec<Spot> = graph.crossings().collect();
            lines::chain(&graph)
                .into_iter()
                .map(|line| middle(&line, &crossings))
                .collect::<Vec<_>>()
        })
        .collect();
    // What lines cover is as long as that is in units of their mean radius.
    let lengths = middles.iter().map(|middle| {
        let steps = middle.places.windows(2);
        steps.map(|ends| (ends[1] - ends[0]).hypot()).sum::<f64>()
    });
    let length: f64 = lengths.sum();
    let covered: f64 = field.values.iter().map(|share| f64::from(*share)).sum();
    let radius = 0.5 * covered / length;
    let is_slender = length >= SLENDER * radius * middles.len() as f64;
    (is_slender && middles.len() <= MOST).then_some(middles)
}

/// Most lines that are described together, as each is tried with each other one: 386 of a crayon took minutes. A guess.
const MOST: usize = 64;
/// Least length of lines in the mean, in units of their mean radius. A guess: a disc has none, a square 0 to 4.
const SLENDER: f64 = 8.0;

/// What is ink, at [`FINENESS`] times the resolution of the field, and its width. A pale line is darker than what is beside it.
fn mask(field: &Field) -> (Vec<bool>, usize) {
    let [width, height] =
        [field.width, field.values.len() / field.width].map(|size| FINENESS * size);
    let at = |i: usize, origin: i32| origin as f32 + (i as f32 + 0.5) / FINENESS as f32;
    let values = (0..width * height).map(|i| {
        field.at([
            at(i % width, field.origin[0]),
            at(i / width, field.origin[1]),
        ])
    });
    let values: Vec<f32> = values.collect();
    let around = |i: usize, reach: usize| {
        let [x, y] = [i % width, i / width];
        let rows = y.saturating_sub(reach)..(y + reach + 1).min(height);
        rows.flat_map(move |y| {
            let columns = x.saturating_sub(reach)..(x + reach + 1).min(width);
            columns.map(move |x| y * width + x)
        })
    };
    let is_ink = |i: usize| {
        let most = around(i, 1).map(|k| values[k]).fold(0.0, f32::max);
        let least = around(i, 2).map(|k| values[k]).fold(1.0, f32::min);
        match most - least > FLAT {
            true => values[i] > 0.5 * (most + least).min(1.0),
            false => values[i] > 0.5,
        }
    };
    ((0..width * height).map(is_ink).collect(), width)
}

/// The middle along a line of a skeleton, smoothed.
fn middle(line: &Line, crossings: &[Spot]) -> Middle {
    let count = line.spots.len() as isize;
    let reach = (3.0 * SMOOTH) as isize;
    let smoothed = |i: isize| {
        // Ends stay where they are, as fewer points are near them to either side alike.
        let reach = match line.closed {
            true => reach,
            false => reach.min(i).min(count - 1 - i),
        };
        let mut sum = [0.0; 4];
        for d in -reach..=reach {
            let spot = line.spots[(i + d).rem_euclid(count) as usize];
            let weight = math::exp(-0.5 * (d * d) as f32 / (SMOOTH * SMOOTH));
            let terms = [spot.at[0], spot.at[1], spot.radius, 1.0];
            (0..4).for_each(|k| sum[k] += weight * terms[k]);
        }
        let at = math::point([0, 1].map(|k| sum[k] / sum[3]));
        (at, f64::from(sum[2] / sum[3]))
    };
    let (mut places, radii): (Vec<_>, Vec<f64>) = (0..count).map(smoothed).unzip();
    if line.closed {
        places.extend(places.first().copied());
    }
    let near = crossings.iter().map(|spot| {
        (
            math::point(spot.at),
            f64::from(spot.radius + BESIDE_CROSSING),
        )
    });
    Middle {
        places,
        is_closed: line.closed,
        radius: radii.iter().fold(0.0, |most, radius| radius.max(most)),
        radii,
        crossings: near.collect(),
    }
}

/// Profiles are wider as far from the disc of a crossing, px. A guess.
const BESIDE_CROSSING: f32 = 1.0;
