//! Strokes of several segments: the segments that can be nearest to the pixels of a block, and the one that is.
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
use super::lanes::{load, members, store};
use super::segment::{BLOCK_RADIUS, Segment, limits, rows_within};
use super::sums::{EdgeBlock, Extras, Shifts};

/// The segments of one stroke that may touch a tile.
#[derive(Clone, Copy)]
pub(super) struct Segments<'a> {
    /// All vertices of the call.
    pub(super) vertices: &'a [[f32; 2]],
    /// The segments, each by its first vertex, in drawing order.
    pub(super) listed: &'a [u32],
    /// The tile's top left corner, px.
    pub(super) origin: [f32; 2],
    /// The smallest and the largest y of the stroke's vertices, px.
    pub(super) y: [f32; 2],
}

impl Segments<'_> {
    /// Segment `k` of the list.
    #[inline(always)]
    pub(super) fn get(&self, k: usize) -> Segment {
        let at = self.listed[k] as usize;
        Segment::new([self.vertices[at], self.vertices[at + 1]], self.origin)
    }

    /// True if segment `k` of the list starts where the one before it ends.
    fn follows(&self, k: usize) -> bool {
        k > 0 && k < self.listed.len() && self.listed[k] == self.listed[k - 1] + 1
    }
}

/// Squared distances before any segment is looked at, px².
const FAR: Lanes = Lanes::splat(f32::INFINITY);

/// A limit that nothing is below or above.
const NEVER: f32 = f32::NAN;

/// A segment, and how it lies to the blocks of a row.
#[derive(Debug, Clone, Copy)]
struct Sight {
    segment: Segment,
    /// Where `(p−a)·(b−a)` of a block's centre is at most this, all pixels of the block lie before the start, which the
    /// segment before has, too.
    start: f32,
    /// Where it is at least this, all pixels lie beyond the end, which the next segment has, too.
    end: f32,
    /// The squared distances of the blocks' centres.
    centers: Lanes,
    /// Blocks before the start, a bit each.
    before: u64,
    /// Blocks beyond the end.
    after: u64,
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
        self.take(segments);
        near.fill(0);
        let [outer, inner] = limits(radius, reach);
        let (mut touched, mut core) = (0, 0);
        let y = [0, 1].map(|side| segments.y[side] - segments.origin[1]);
        for row in rows_within(outer, y) {
            // Squared distances of the row's block centres, from each segment and from the nearest one.
            let least = self.measure_row(simd, row);
            // A segment farther than the nearest by two radii of a block wins no pixel of it; nor does one out of the stroke's
            // reach.
            let limit = (least.sqrt() + 2.0 * BLOCK_RADIUS).min(outer);
            let limit2 = limit * limit;
            let mut touched_here = 0;
            let mut before_next = 0;
            // From the last segment to the first: a segment gives way to the next one only where that one does not give way to
            // it.
            for (sight, near) in self.sights.iter().zip(&mut *near).rev() {
                let is_near = load(simd, &sight.centers).simd_lt(limit2).to_bitmask();
                // A block before the start belongs to the segment before. A block beyond the end belongs to the next one, unless
                // it lies before that one's start, too: then neither may pass it on, and this one keeps it.
                let near_here = is_near & !sight.before & (!sight.after | before_next);
                before_next = sight.before;
                *near |= near_here << (row * LANES);
                touched_here |= near_here;
            }
            // A block in the core is covered whichever segment is the nearest.
            let core_here = least.simd_lt(inner * inner).to_bitmask() & touched_here;
            touched |= touched_here << (row * LANES);
            core |= core_here << (row * LANES);
        }
        (touched, core)
    }

    /// Takes the segments to look at.
    #[inline(always)]
    fn take(&mut self, segments: Segments<'_>) {
        self.sights.clear();
        for k in 0..segments.listed.len() {
            let segment = segments.get(k);
            // `(p−a)·(b−a)` differs by at most this between a pixel and the centre of its block.
            let slack = BLOCK_RADIUS * segment.length2.sqrt();
            // Only a neighbour that is listed in this tile can stand in for the segment. A comparison with NaN is false, so an end
            // without a neighbour never gives way.
            let (joins_last, joins_next) = (segments.follows(k), segments.follows(k + 1));
            self.sights.push(Sight {
                segment,
                start: if joins_last { -slack } else { NEVER },
                end: if joins_next {
                    segment.length2 + slack
                } else {
                    NEVER
                },
                centers: FAR,
                before: 0,
                after: 0,
            });
        }
    }

    /// Looks at every segment from the centres of a row of blocks; returns the squared distances of the nearest ones.
    #[inline(always)]
    fn measure_row<S: Simd>(&mut self, simd: S, row: usize) -> f32x16<S> {
        let mut least = f32x16::splat(simd, f32::INFINITY);
        for sight in &mut self.sights {
            let nearest = sight.segment.at_centers(simd, row);
            let distance2 = nearest.distance2();
            store(distance2, &mut sight.centers);
            // The least is the distance of each centre from the whole stroke.
            least = distance2.simd_lt(least).select(distance2, least);
            sight.before = nearest.dot.simd_le(sight.start).to_bitmask();
            sight.after = nearest.dot.simd_ge(sight.end).to_bitmask();
        }
        least
    }

    /// Finds the distances of the pixels of the blocks in `shared`, and the segments that are nearest to them.
    #[inline(always)]
    pub(super) fn measure<S: Simd>(&mut self, simd: S, near: &[BlockSet], shared: BlockSet) {
        let mut seen = 0;
        for (k, (sight, near)) in self.sights.iter().zip(near).enumerate() {
            let index = f32x16::splat(simd, k as f32);
            // Blocks that one segment has alone need no memory: the passes measure them where they use them.
            let blocks = near & shared;
            // The first segment of a block writes, so that nothing has to be cleared; later ones compare.
            for block in members(blocks & !seen) {
                let distance2 = sight.segment.at_pixels(simd, block).distance2();
                store(distance2, &mut self.distances2[block]);
                store(index, &mut self.nearest[block]);
            }
            for block in members(blocks & seen) {
                let distance2 = sight.segment.at_pixels(simd, block).distance2();
                let least = load(simd, &self.distances2[block]);
                let nearest = load(simd, &self.nearest[block]);
                // Strictly nearer: of equally near segments the first stays, as in the reference.
                let is_nearer = distance2.simd_lt(least);
                store(
                    is_nearer.select(distance2, least),
                    &mut self.distances2[block],
                );
                store(is_nearer.select(index, nearest), &mut self.nearest[block]);
            }
            seen |= blocks;
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

/// The blocks in which several segments can be nearest, from those in which each can.
#[inline(always)]
pub(super) fn shared(near: &[BlockSet]) -> BlockSet {
    let (mut once, mut twice) = (0, 0);
    for near in near {
        // A carry-less count up to two, for all 64 blocks at once.
        twice |= once & near;
        once |= near;
    }
    twice
}

/// Blocks in which several segments can be nearest, as they were kept.
pub(super) struct Kept<'a> {
    /// The blocks.
    pub(super) shared: BlockSet,
    /// For each of these, `pull` in `slope`, and the stiffness in `inverse`.
    pub(super) blocks: &'a [EdgeBlock],
    /// For each of these, the segments that are nearest to its pixels.
    pub(super) nearest: &'a [Lanes],
}

impl Kept<'_> {
    /// Adds to the sums of segment `k` the pixels that have it as the nearest, in the blocks `near` it.
    #[inline(always)]
    pub(super) fn pull<S: Simd, X: Extras>(
        &self,
        simd: S,
        segment: &Segment,
        k: usize,
        near: BlockSet,
        shifts: &mut Shifts<S>,
    ) {
        let zero = f32x16::splat(simd, 0.0);
        for block in members(near & self.shared) {
            // Kept blocks are packed: the place of one is the number of members before it.
            let at = (self.shared & ((1 << block) - 1)).count_ones() as usize;
            // Pixels that are nearer to another segment pull at that one.
            let is_nearest = load(simd, &self.nearest[at]).simd_eq(k as f32);
            let nearest = segment.at_pixels(simd, block);
            let pull = is_nearest.select(load(simd, &self.blocks[at].slope), zero);
            shifts.pull(pull, nearest.q, nearest.h);
            if X::STIFFNESS {
                let stiffness = load(simd, &self.blocks[at].inverse);
                shifts.stiffen(is_nearest.select(stiffness, zero), nearest.h);
            }
        }
    }
}
