//! Paints: the gradient of an area as the renderer and the optimiser see it.

use fearless_simd::{f32x16, prelude::*};
use serde::{Deserialize, Serialize};

use super::grid::{BLOCK, Lanes, TILE_BLOCKS};
use super::kernel::{PIXELS, load};
use crate::math::Point;
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
    pub fn at(&self, [x, y]: [f32; 2]) -> (Rgb, f32) {
        self.shade.at(Point::new(x / self.scale, y / self.scale))
    }
}

/// A paint, ready to be evaluated at the pixels of a block.
#[derive(Debug, Clone)]
pub(super) struct Ink {
    axis: InkAxis,
    /// Colour and opacity before the first ramp.
    first: [f32; 4],
    ramps: Vec<Ramp>,
}

/// The offset of a pixel.
#[derive(Debug, Clone, Copy)]
enum InkAxis {
    /// The offset at the origin, and its change per px in x and in y.
    Linear { start: f32, slope: [f32; 2] },
    /// The centre, px, and the offset at 1 px from it.
    Radial { center: [f32; 2], slope: f32 },
}

/// The change between two stops.
#[derive(Debug, Clone, Copy)]
struct Ramp {
    /// Offset of the first one, and 1 over the distance to the second.
    from: f32,
    per_offset: f32,
    /// Change of colour and opacity.
    change: [f32; 4],
}

impl Ink {
    /// Shortest ramp: two stops at one offset are a step.
    const SHORTEST: f32 = 1e-5;

    pub(super) fn of(Paint { shade, scale }: &Paint) -> Self {
        let axis = match shade.axis() {
            Axis::Linear { from, to } => {
                let along = to - from;
                let per_px = along / along.norm_squared();
                InkAxis::Linear {
                    start: -(per_px.x * from.x + per_px.y * from.y),
                    slope: [per_px.x / scale, per_px.y / scale],
                }
            }
            Axis::Radial { center, radius } => InkAxis::Radial {
                center: [center.x * scale, center.y * scale],
                slope: 1.0 / (radius * scale),
            },
        };
        let value = |stop: &ShadeStop| {
            let [red, green, blue] = stop.color;
            [red, green, blue, stop.opacity]
        };
        let stops: Vec<ShadeStop> = shade.stops().collect();
        let ramp = |pair: &[ShadeStop]| {
            let [before, after] = [value(&pair[0]), value(&pair[1])];
            Ramp {
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

    /// Red, green, blue and opacity at the pixels of a block of the tile at `origin`.
    #[inline(always)]
    pub(super) fn at<S: Simd>(&self, simd: S, block: usize, origin: [f32; 2]) -> [f32x16<S>; 4] {
        let left = origin[0] + (block % TILE_BLOCKS * BLOCK) as f32;
        let top = origin[1] + (block / TILE_BLOCKS * BLOCK) as f32;
        let [x, y]: &[Lanes; 2] = &PIXELS;
        let (x, y) = (load(simd, x) + left, load(simd, y) + top);
        let offset = match self.axis {
            InkAxis::Linear { start, slope } => x * slope[0] + y * slope[1] + start,
            InkAxis::Radial { center, slope } => {
                let (x, y) = (x - center[0], y - center[1]);
                (x * x + y * y).sqrt() * slope
            }
        };
        let mut value = [
            f32x16::splat(simd, self.first[0]),
            f32x16::splat(simd, self.first[1]),
            f32x16::splat(simd, self.first[2]),
            f32x16::splat(simd, self.first[3]),
        ];
        for ramp in &self.ramps {
            let part = ((offset - ramp.from) * ramp.per_offset).max(0.0).min(1.0);
            for (value, change) in value.iter_mut().zip(ramp.change) {
                *value += part * change;
            }
        }
        value
    }
}
