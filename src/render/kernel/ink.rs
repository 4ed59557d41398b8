//! The gradient of an area in one block.

use fearless_simd::{Level, dispatch, f32x16, prelude::*};

use super::super::grid::{BLOCK, BLOCKS, BlockSet, Lanes, TILE_BLOCKS};
use super::super::paint::{Ink, InkAxis};
use super::lanes::{load, members, store};
use super::segment::PIXELS;

/// Red, green, blue and opacity of an ink at the pixels of each block of a tile.
pub(super) type InkTile = [[Lanes; 4]; BLOCKS];

/// Evaluates `ink` at some blocks of the tile at `origin`. A function of its own, since passes of the compiler take far longer
/// for a larger kernel.
#[inline(never)]
pub(super) fn fill(level: Level, ink: &Ink, blocks: BlockSet, origin: [f32; 2], out: &mut InkTile) {
    dispatch!(level, simd => {
        for block in members(blocks) {
            for (value, lanes) in ink_at(simd, ink, block, origin).into_iter().zip(&mut out[block]) {
                store(value, lanes);
            }
        }
    });
}

/// Red, green, blue and opacity of `ink` at the pixels of a block of the tile at `origin`.
#[inline(always)]
fn ink_at<S: Simd>(simd: S, ink: &Ink, block: usize, origin: [f32; 2]) -> [f32x16<S>; 4] {
    let left = origin[0] + (block % TILE_BLOCKS * BLOCK) as f32;
    let top = origin[1] + (block / TILE_BLOCKS * BLOCK) as f32;
    let [x, y]: &[Lanes; 2] = &PIXELS;
    let (x, y) = (load(simd, x) + left, load(simd, y) + top);
    // The offset along the axis: 0 at its start, 1 at its end, beyond these below 0 and above 1.
    let offset = match ink.axis {
        InkAxis::Linear { start, slope } => x * slope[0] + y * slope[1] + start,
        InkAxis::Radial { center, slope } => {
            let (x, y) = (x - center[0], y - center[1]);
            (x * x + y * y).sqrt() * slope
        }
    };
    let mut value = [
        f32x16::splat(simd, ink.first[0]),
        f32x16::splat(simd, ink.first[1]),
        f32x16::splat(simd, ink.first[2]),
        f32x16::splat(simd, ink.first[3]),
    ];
    for ramp in &ink.ramps {
        // Each ramp adds its change between its two stops and keeps it beyond them. The sum is linear between stops, and constant
        // before the first and beyond the last, which is SVG's `pad`.
        let part = ((offset - ramp.from) * ramp.per_offset).max(0.0).min(1.0);
        for (value, change) in value.iter_mut().zip(ramp.change) {
            *value += part * change;
        }
    }
    value
}
