//! Paints: the gradient of an area as the renderer and the optimiser see it.

use serde::{Deserialize, Serialize};

use crate::math;
use crate::scene::{Axis, Rgb, Shade, ShadeStop};

/// The gradient of an area, in a picture of any resolution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Paint {
    /// The gradient, px of the full picture.
    pub shade: Shade,
    /// Px of the area's numbers for each px of the full picture.
    pub scale: f32,
}

impl Paint {
    /// Colour and opacity at a place in px of the area's numbers.
    pub fn at(&self, at: [f32; 2]) -> (Rgb, f32) {
        let at = math::point(at).to_vec2() / f64::from(self.scale);
        self.shade.at(at.to_point())
    }
}

/// A paint, ready to be evaluated at the pixels of a block.
#[derive(Debug, Clone)]
pub(super) struct Ink {
    pub(super) axis: InkAxis,
    /// Colour and opacity before the first ramp.
    pub(super) first: [f32; 4],
    pub(super) ramps: Vec<Ramp>,
}

/// The offset of a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) enum InkAxis {
    /// The offset at the origin, and its change per px in x and in y.
    Linear { start: f32, slope: [f32; 2] },
    /// The centre, px, and the offset at 1 px from it.
    Radial { center: [f32; 2], slope: f32 },
}

/// The change between two stops.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ramp {
    /// Offset of the first one, and 1 over the distance to the second.
    pub(super) from: f32,
    pub(super) per_offset: f32,
    /// Change of colour and opacity.
    pub(super) change: [f32; 4],
}

impl Ink {
    /// The bits of all numbers.
    pub(super) fn bits(&self) -> impl Iterator<Item = u64> {
        let axis = match self.axis {
            InkAxis::Linear { start, slope } => [1.0, start, slope[0], slope[1]],
            InkAxis::Radial { center, slope } => [2.0, center[0], center[1], slope],
        };
        let ramps = self.ramps.iter().flat_map(|ramp| {
            let [a, b, c, d] = ramp.change;
            [ramp.from, ramp.per_offset, a, b, c, d]
        });
        let numbers = axis.into_iter().chain(self.first).chain(ramps);
        numbers.map(|v| u64::from(v.to_bits()))
    }

    /// Shortest ramp: two stops at one offset are a step.
    const SHORTEST: f32 = 1e-5;

    pub(super) fn of(Paint { shade, scale }: &Paint) -> Self {
        let scale = f64::from(*scale);
        let axis = match shade.axis() {
            Axis::Linear { from, to } => {
                // offset(p) = (p/scale − from)·(to − from)/|to − from|².
                let along = to - from;
                let per_px = along / along.hypot2();
                InkAxis::Linear {
                    start: -per_px.dot(from.to_vec2()) as f32,
                    slope: math::xy((per_px / scale).to_point()),
                }
            }
            Axis::Radial { center, radius } => InkAxis::Radial {
                center: math::xy((center.to_vec2() * scale).to_point()),
                // offset(p) = |p − center·scale| / (radius·scale).
                slope: (1.0 / (radius * scale)) as f32,
            },
        };
        let value = |stop: &ShadeStop| {
            let [red, green, blue] = stop.color;
            [red, green, blue, stop.opacity]
        };
        let stops = shade.stops();
        let ramp = |pair: &[ShadeStop]| {
            let [before, after] = [value(&pair[0]), value(&pair[1])];
            Ramp {
                // A step (two stops at one offset) becomes a very short ramp, so that nothing divides by 0.
                from: pair[0].offset,
                per_offset: 1.0 / (pair[1].offset - pair[0].offset).max(Self::SHORTEST),
                change: std::array::from_fn(|k| after[k] - before[k]),
            }
        };
        Self {
            axis,
            first: stops.first().map_or([0.0; 4], value),
            ramps: stops.windows(2).map(ramp).collect(),
        }
    }
}
