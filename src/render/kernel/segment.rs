//! A segment: its distances from the pixels of a block, and from the centres of a tile's blocks.

use std::ops::Range;

use fearless_simd::{f32x16, prelude::*};

use super::super::edge::Reach;
use super::super::grid::{BLOCK, BLOCKS, BlockSet, LANES, Lanes, TILE, TILE_BLOCKS};
use super::lanes::load;

/// Guard in `1/|b−a|²` and in `|q| = sqrt(q·q + ε)`, px². Larger would blunt the distance near the
/// centre line (by 1e-3 px at this value); smaller would let `1/|q|` overflow the gradient there.
pub(super) const EPSILON: f32 = 1e-6;

/// Distance from a block's centre to its outermost pixel centres, px, rounded up.
pub(super) const BLOCK_RADIUS: f32 = 2.121_5;

/// Rows of 16 block centres that a tile has.
pub(super) const ROWS: usize = BLOCKS / LANES;

/// x and y of the pixel centres of a block, px.
pub(super) const PIXELS: [Lanes; 2] = lattice(BLOCK, 1.0);
/// x and y of the centres of a tile's first 16 blocks, px.
const CENTERS: [Lanes; 2] = lattice(TILE_BLOCKS, BLOCK as f32);

/// The centres of 16 cells of side `side`, `columns` in a row.
const fn lattice(columns: usize, side: f32) -> [Lanes; 2] {
    let mut centers = [Lanes::splat(0.0); 2];
    let mut i = 0;
    while i < LANES {
        centers[0].0[i] = ((i % columns) as f32 + 0.5) * side;
        centers[1].0[i] = ((i / columns) as f32 + 0.5) * side;
        i += 1;
    }
    centers
}

/// A segment from `a` to `b`, relative to its tile.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct Segment {
    a: [f32; 2],
    /// `b − a`.
    axis: [f32; 2],
    /// `|b−a|²`.
    pub(super) length2: f32,
    /// `1/(|b−a|² + ε)`.
    inverse_length2: f32,
}

/// Nearest points of a segment, seen from some pixels or centres.
#[derive(Clone, Copy)]
pub(in crate::render) struct Nearest<S: Simd> {
    /// `(p−a)·(b−a)`.
    pub(super) dot: f32x16<S>,
    /// Where on the segment the nearest point is, 0 at `a` and 1 at `b`.
    pub(super) h: f32x16<S>,
    /// From there to the pixel, `p − a − h(b−a)`.
    pub(super) q: [f32x16<S>; 2],
}

impl<S: Simd> Nearest<S> {
    /// The squared distance.
    #[inline(always)]
    pub(in crate::render) fn distance2(&self) -> f32x16<S> {
        self.q[0] * self.q[0] + self.q[1] * self.q[1]
    }
}

impl Segment {
    pub(in crate::render) fn new([a, b]: [[f32; 2]; 2], origin: [f32; 2]) -> Self {
        let axis = [b[0] - a[0], b[1] - a[1]];
        let length2 = axis[0] * axis[0] + axis[1] * axis[1];
        Self {
            // Relative to the tile, so that one table of pixel centres serves all tiles.
            a: [a[0] - origin[0], a[1] - origin[1]],
            axis,
            length2,
            inverse_length2: 1.0 / (length2 + EPSILON),
        }
    }

    /// The nearest points to those at `pa = p − a`.
    #[inline(always)]
    fn nearest<S: Simd>(&self, pa: [f32x16<S>; 2]) -> Nearest<S> {
        // h = (p−a)·(b−a) / |b−a|². For a dot both are 0, and ε in the denominator makes h = 0.
        let dot = pa[0] * self.axis[0] + pa[1] * self.axis[1];
        // Clamped to the ends: beyond them the nearest point is the end itself.
        let h = (dot * self.inverse_length2).max(0.0).min(1.0);
        let q = [pa[0] - h * self.axis[0], pa[1] - h * self.axis[1]];
        Nearest { dot, h, q }
    }

    /// The nearest points to the pixels of a block.
    #[inline(always)]
    pub(in crate::render) fn at_pixels<S: Simd>(&self, simd: S, block: usize) -> Nearest<S> {
        let x = (block % TILE_BLOCKS * BLOCK) as f32 - self.a[0];
        let y = (block / TILE_BLOCKS * BLOCK) as f32 - self.a[1];
        self.nearest([load(simd, &PIXELS[0]) + x, load(simd, &PIXELS[1]) + y])
    }

    /// The nearest points to the centres of 16 blocks, a quarter of the tile.
    #[inline(always)]
    pub(super) fn at_centers<S: Simd>(&self, simd: S, row: usize) -> Nearest<S> {
        let y = (row * LANES / TILE_BLOCKS * BLOCK) as f32 - self.a[1];
        self.nearest([
            load(simd, &CENTERS[0]) - self.a[0],
            load(simd, &CENTERS[1]) + y,
        ])
    }

    /// The blocks that a disc of this radius, widened by its soft edge, can touch as it sweeps the segment, and those wholly
    /// in its hard core, from the distances of the blocks' centres.
    #[inline(always)]
    pub(in crate::render) fn blocks<S: Simd>(
        &self,
        simd: S,
        radius: f32,
        reach: Reach,
    ) -> (BlockSet, BlockSet) {
        // A disc smaller than a block has inner = 0. No squared distance is below 0, so it has no core.
        let [outer, inner] = limits(radius, reach);
        let (mut touched, mut core) = (0, 0);
        for row in 0..ROWS {
            // Compare squares: a block needs no root.
            let distance2 = self.at_centers(simd, row).distance2();
            touched |= distance2.simd_lt(outer * outer).to_bitmask() << (row * LANES);
            core |= distance2.simd_lt(inner * inner).to_bitmask() << (row * LANES);
        }
        (touched, core)
    }
}

/// Distances between a segment and a block's centre, px: below the first a stroke may touch the block, below the second it
/// covers all of it.
#[inline(always)]
pub(super) fn limits(radius: f32, reach: Reach) -> [f32; 2] {
    [
        (radius + reach.outside + BLOCK_RADIUS).max(0.0),
        (radius - reach.inside - BLOCK_RADIUS).max(0.0),
    ]
}

/// Rows of 16 block centres that may have some within `outer` of a stroke. The stroke is between `top` and `bottom`, px
/// from the top of the tile.
#[inline(always)]
pub(super) fn rows_within(outer: f32, [top, bottom]: [f32; 2]) -> Range<usize> {
    let side = (TILE / ROWS) as f32;
    // Centres lie half a block inside their row's outermost edges.
    let margin = outer - 0.5 * BLOCK as f32;
    // Conversions saturate, and NaN becomes 0.
    let first = ((top - margin) / side) as usize;
    let last = ((bottom + margin) / side) as usize;
    first..last.min(ROWS - 1) + 1
}

/// `|q|` from `q·q`, with the guard.
#[inline(always)]
pub(in crate::render) fn length<S: Simd>(distance2: f32x16<S>) -> f32x16<S> {
    (distance2 + EPSILON).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_those_in_reach() {
        assert_eq!(rows_within(1.0, [9.0, 10.0]), 1..2);
        assert_eq!(rows_within(4.0, [9.0, 10.0]), 0..2);
        assert_eq!(rows_within(4.0, [-90.0, -80.0]).len(), 1);
        assert_eq!(rows_within(4.0, [90.0, 99.0]).len(), 0);
    }

    #[test]
    fn a_stroke_of_any_height_reaches_all_rows() {
        for far in [1e3, 1e30, f32::INFINITY] {
            assert_eq!(rows_within(2.0, [-far, far]), 0..ROWS);
        }
    }
}
