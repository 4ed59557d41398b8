//! The part of the residual that a traced stroke explains, in closed form.

use std::ops::Range;

use super::areas::{Areas, Label, Pixel, Pixels, distance2, mix};
use crate::math::{self, nearest_on_segment};
use crate::scene::Path;

/// The squared residual under a stroke, and how much of it the stroke removes; summed over the channels of one matte.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Gain {
    pub(super) under: f32,
    pub(super) removed: f32,
}

impl Gain {
    /// The gain of a stroke of `color` along `path`. Pixels of other colours may be covered by other strokes, and do not
    /// count.
    pub(super) fn of(
        path: &Path,
        radius: f32,
        own: u8,
        color: &Pixel,
        areas: &Areas,
        pixels: &Pixels<'_>,
    ) -> Self {
        let mut gain = Self::default();
        for (i, coverage) in coverage(path, radius, pixels) {
            let (target, canvas) = (pixels.target.at(i), pixels.canvas.at(i));
            if !matches!(areas.labels[i], Label::Color(k) if k != own) {
                let before = distance2(&target, &canvas);
                let drawn = mix(&canvas, color, coverage);
                let weight = pixels.weights.map_or(1.0, |weights| weights[i]);
                gain.under += weight * before;
                gain.removed += weight * (before - distance2(&target, &drawn));
            }
        }
        gain
    }
}

/// The pixels that a stroke touches, and those 1 px around it, with their coverage.
pub(super) fn coverage(path: &Path, radius: f32, pixels: &Pixels<'_>) -> Vec<(usize, f32)> {
    let mut line: Vec<[f32; 2]> = path.flattened(0.1).into_iter().map(math::xy).collect();
    if let [dot] = line[..] {
        line.push(dot);
    }
    let reach = radius + FRINGE;
    // A stroke is the union of its segments' capsules, so that the deepest one counts.
    let [columns, rows] = spans(&line, reach, pixels);
    let mut depths = vec![f32::NEG_INFINITY; columns.len() * rows.len()];
    for ends in line.windows(2) {
        let [across, down] = spans(ends, reach, pixels);
        for y in down {
            let row = (y - rows.start) * columns.len();
            for x in across.clone() {
                let center = [x as f32 + 0.5, y as f32 + 0.5];
                let (_, dist2) = nearest_on_segment(center, [ends[0], ends[1]]);
                let deepest = &mut depths[row + x - columns.start];
                *deepest = deepest.max(radius - dist2.sqrt());
            }
        }
    }
    let places = rows.flat_map(|y| columns.clone().map(move |x| y * pixels.width + x));
    let touched = places.zip(depths).filter(|(_, depth)| *depth > -FRINGE);
    touched
        .map(|(i, depth)| (i, (depth + 0.5).clamp(0.0, 1.0)))
        .collect()
}

/// Farthest from a stroke that pixels are looked at, px.
const FRINGE: f32 = 1.5;

/// The columns and rows of the pixels within `reach` px of the box around some places.
fn spans(places: &[[f32; 2]], reach: f32, pixels: &Pixels<'_>) -> [Range<usize>; 2] {
    let span = |axis: usize, size: usize| {
        let along = || places.iter().map(|place| place[axis]);
        let low = along().fold(f32::INFINITY, f32::min);
        let high = along().fold(f32::NEG_INFINITY, f32::max);
        let last = ((high + reach).ceil().max(0.0) as usize).min(size);
        let first = (low - reach).floor().max(0.0) as usize;
        first.min(last)..last
    };
    [span(0, pixels.width), span(1, pixels.height)]
}
