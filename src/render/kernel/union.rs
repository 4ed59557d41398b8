//! Strokes of several segments: which segments can be nearest to the pixels of a block, and which one is.
//!
//! Two things are known from a block's centre alone, since its pixels are within [`BLOCK_RADIUS`] of it.
//!
//! - A segment that is farther from the centre than another one by twice the radius is nearest to no pixel.
//! - Where all pixels lie before the start of a segment, its nearest point is its start, which the segment before it
//!   has, too. So that one is at least as near. The same holds beyond the end and for the segment after it, unless that
//!   one in turn is left out in favour of this one.
//!
//! So at a joint most blocks look at one segment only. The chain of segments that stand in for each other goes either
//! backwards or forwards, and ends at one that is looked at.

use fearless_simd::{f32x16, prelude::*};

use super::super::edge::Reach;
use super::super::grid::{BLOCKS, BlockSet, LANES, Lanes};
use super::capsule::{BLOCK_RADIUS, Capsule, ROWS, limits};
use super::lanes::{load, members, store};
use super::sums::{EdgeBlock, EndSums, Extras, Shifts};

/// The segments of one stroke that may touch a tile.
#[derive(Clone, Copy)]
pub(super) struct Segments<'a> {
    /// All vertices of the call.
    pub(super) vertices: &'a [[f32; 2]],
    /// The segments, each by its first vertex, in drawing order.
    pub(super) listed: &'a [u32],
    /// The tile's top left corner, px.
    pub(super) origin: [f32; 2],
}

impl Segments<'_> {
    /// Segment `k` of the list, swept by a disc.
    #[inline(always)]
    pub(super) fn capsule<S: Simd>(&self, simd: S, k: usize, radius: f32) -> Capsule<S> {
        let at = self.listed[k] as usize;
        let ends = [self.vertices[at], self.vertices[at + 1]];
        Capsule::new(simd, ends, radius, self.origin)
    }

    /// Whether segment `k` of the list starts where the one before it ends.
    fn follows(&self, k: usize) -> bool {
        k > 0 && k < self.listed.len() && self.listed[k] == self.listed[k - 1] + 1
    }
}

/// Squared distances before any segment is looked at, px².
const FAR: Lanes = Lanes::splat(f32::INFINITY);

/// How a segment lies to the blocks of a tile.
#[derive(Debug, Clone, Copy)]
struct Sight {
    /// The squared distances of the blocks' centres.
    centers: [Lanes; ROWS],
    /// Blocks all of whose pixels lie before the start.
    before: BlockSet,
    /// Blocks all of whose pixels lie beyond the end.
    after: BlockSet,
}

/// Scratch for one stroke at a time.
#[derive(Debug)]
pub(super) struct Union {
    sights: Vec<Sight>,
    /// By block: the squared distances of its pixels from the stroke.
    distances2: [Lanes; BLOCKS],
    /// By block: the index of the segment that is nearest to each pixel.
    nearest: [Lanes; BLOCKS],
}

impl Union {
    pub(super) fn new() -> Self {
        Self {
            sights: Vec::new(),
            distances2: [Lanes::splat(0.0); BLOCKS],
            nearest: [Lanes::splat(0.0); BLOCKS],
        }
    }

    /// The blocks that the stroke touches, and those wholly in its hard core. Writes to `near` for each segment the blocks
    /// in which it can be nearest.
    #[inline(always)]
    pub(super) fn blocks<S: Simd>(
        &mut self,
        simd: S,
        segments: Segments<'_>,
        radius: f32,
        reach: Reach,
        near: &mut [BlockSet],
    ) -> (BlockSet, BlockSet) {
        let least = self.look(simd, segments);
        let [outer, inner] = limits(radius, reach);
        let mut core = 0;
        let mut limits2 = least;
        for (row, least) in least.iter().enumerate() {
            core |= least.simd_lt(inner * inner).to_bitmask() << (row * LANES);
            let limit = (least.sqrt() + 2.0 * BLOCK_RADIUS).min(outer);
            limits2[row] = limit * limit;
        }
        let mut touched = 0;
        for (k, (sight, near)) in self.sights.iter().zip(&mut *near).enumerate() {
            *near = 0;
            for (row, centers) in sight.centers.iter().enumerate() {
                let is_near = load(simd, centers).simd_lt(limits2[row]);
                *near |= is_near.to_bitmask() << (row * LANES);
            }
            if segments.follows(k) {
                *near &= !sight.before;
            }
            if segments.follows(k + 1) {
                *near &= !sight.after | self.sights[k + 1].before;
            }
            touched |= *near;
        }
        (touched, core & touched)
    }

    /// Looks at every segment from the blocks' centres; returns the squared distances of the nearest ones.
    #[inline(always)]
    fn look<S: Simd>(&mut self, simd: S, segments: Segments<'_>) -> [f32x16<S>; ROWS] {
        let mut least = [f32x16::splat(simd, f32::INFINITY); ROWS];
        self.sights.clear();
        for k in 0..segments.listed.len() {
            let capsule = segments.capsule(simd, k, 0.0);
            // `(p−a)·(b−a)` differs by at most this between a pixel and the centre of its block.
            let slack = BLOCK_RADIUS * capsule.length2.sqrt();
            let mut sight = Sight {
                centers: [Lanes::splat(0.0); ROWS],
                before: 0,
                after: 0,
            };
            for (row, least) in least.iter_mut().enumerate() {
                let nearest = capsule.at_centers(simd, row);
                let distance2 = nearest.distance2();
                store(distance2, &mut sight.centers[row]);
                *least = distance2.simd_lt(*least).select(distance2, *least);
                let (before, after) = (
                    nearest.dot.simd_le(-slack),
                    nearest.dot.simd_ge(capsule.length2 + slack),
                );
                sight.before |= before.to_bitmask() << (row * LANES);
                sight.after |= after.to_bitmask() << (row * LANES);
            }
            self.sights.push(sight);
        }
        least
    }

    /// Finds the distances of the pixels of the blocks in `edge`, and the segments that are nearest to them.
    #[inline(always)]
    pub(super) fn measure<S: Simd>(
        &mut self,
        simd: S,
        segments: Segments<'_>,
        near: &[BlockSet],
        edge: BlockSet,
    ) {
        for block in members(edge) {
            self.distances2[block] = FAR;
        }
        for (k, near) in near.iter().enumerate() {
            let capsule = segments.capsule(simd, k, 0.0);
            let index = f32x16::splat(simd, k as f32);
            for block in members(near & edge) {
                let distance2 = capsule.at_pixels(simd, block).distance2();
                let least = load(simd, &self.distances2[block]);
                let nearest = load(simd, &self.nearest[block]);
                let is_nearer = distance2.simd_lt(least);
                store(
                    is_nearer.select(distance2, least),
                    &mut self.distances2[block],
                );
                store(is_nearer.select(index, nearest), &mut self.nearest[block]);
            }
        }
    }

    /// The squared distances of the pixels of `block`.
    #[inline(always)]
    pub(super) fn distance2<S: Simd>(&self, simd: S, block: usize) -> f32x16<S> {
        load(simd, &self.distances2[block])
    }

    /// The segments that are nearest to the pixels of `block`.
    #[inline(always)]
    pub(super) fn nearest(&self, block: usize) -> Lanes {
        self.nearest[block]
    }
}

/// What was kept of a stroke of several segments.
pub(super) struct Kept<'a> {
    /// Its blocks on the soft edge.
    pub(super) edge: BlockSet,
    /// For each of these, `pull` in `slope`, and the stiffness in `inverse`.
    pub(super) blocks: &'a [EdgeBlock],
    /// For each of these, the segments that are nearest to its pixels.
    pub(super) nearest: &'a [Lanes],
}

impl Kept<'_> {
    /// The sums of segment `k`, over the pixels that have it as the nearest, in the blocks `near` it.
    #[inline(always)]
    pub(super) fn ends<S: Simd, X: Extras>(
        &self,
        simd: S,
        capsule: &Capsule<S>,
        k: usize,
        near: BlockSet,
    ) -> EndSums {
        let blocks = near & self.edge;
        if blocks == 0 {
            return EndSums::default();
        }
        let zero = f32x16::splat(simd, 0.0);
        let mut shifts = Shifts::new(simd);
        for block in members(blocks) {
            let at = (self.edge & ((1 << block) - 1)).count_ones() as usize;
            let is_nearest = load(simd, &self.nearest[at]).simd_eq(k as f32);
            let nearest = capsule.at_pixels(simd, block);
            let pull = is_nearest.select(load(simd, &self.blocks[at].slope), zero);
            shifts.pull(pull, nearest.q, nearest.h);
            if X::STIFFNESS {
                let stiffness = load(simd, &self.blocks[at].inverse);
                shifts.stiffen(is_nearest.select(stiffness, zero), nearest.h);
            }
        }
        shifts.finish::<X>()
    }
}
