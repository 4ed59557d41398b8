//! The two passes over one tile.
//!
//! Pass 1 goes front to back: it accumulates the colour seen, `C ← C + T·m·c`, and the
//! transmittance `T ← T·(1 − m)`, and keeps `T`, `m`, `o·σ'` and `1/|q|` of every block it visits.
//! A block that stays opaque even when any one stroke is taken away leaves the set of live blocks, and
//! nothing behind it is evaluated: neither a gradient nor a stroke's worth depends on it.
//!
//! Pass 2 goes back to front over the same blocks with the colour behind, `B`:
//!
//! ```text
//! ∂L/∂m = T·g·(c − B)      ∂L/∂c = Σ T·m·g      ∂L/∂d = ∂L/∂m · o · σ'(d)
//! ∂d/∂r = 1                ∂d/∂a = u·(1 − h)    ∂d/∂b = u·h          u = q/|q|
//! worth  = Σ 2e·δ + δ²     δ = −T·m·(c − B)     B ← B + m·(c − B)
//! ```
//!
//! No step divides by `1 − m`, so opaque strokes are as exact as others. `h` is held fixed in the
//! derivatives: at the nearest point the distance does not change with `h` (envelope theorem), up
//! to the guard [`EPSILON`].
//!
//! A stroke of several segments is the union of their capsules, with one coverage: at each pixel, `d` and its derivatives
//! are those of the nearest segment, the first of them where several are.
//!
//! Degenerate cases: a zero-length capsule is a disc; on the centre line `u` tends to 0 with the guard instead of being undefined.

// Lanes are never passed through closures of `array::map`: those are compiled on their own, without the
// instruction set of their caller.

use fearless_simd::{Level, dispatch, f32x8, f32x16, prelude::*};

use std::ops::Range;

use super::edge::{Edge, Reach, SoftEdge};
use super::flat::Flat;
use super::grid::{
    BLOCK, BLOCKS, BlockRgb, BlockSet, LANES, Lanes, TILE_BLOCKS, TileRgb, TileWeights, flat_tile,
};
use super::strokes::LOOK;
use super::{CanvasLoss, Listed};

/// Guard in `1/|b−a|²` and in `|q| = sqrt(q·q + ε)`, px². Larger would blunt the distance near the
/// centre line (by 1e-3 px at this value); smaller would let `1/|q|` overflow the gradient there.
const EPSILON: f32 = 1e-6;

/// Transmittance below which nothing behind shows: a sixty-fourth of an 8-bit level. Four times as
/// much costs gradients of tailed edges their third digit.
const OPAQUE: f32 = 1.0 / 16384.0;

/// Least opacity that is drawn, so that the derivative by an opacity of 0 is not 0/0.
const FAINTEST: f32 = 1e-20;

/// Distance from a block's centre to its outermost pixel centres, px, rounded up.
const BLOCK_RADIUS: f32 = 2.121_5;

/// x and y of the pixel centres of a block, px.
const PIXELS: [Lanes; 2] = lattice(BLOCK, 1.0);
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

/// `∂L` of the look of one stroke over one tile, then its worth.
pub(super) type LookSums = [f32; LOOK + 1];
/// Index of the leave-one-out change of the squared error.
pub(super) const WORTH: usize = LOOK;
/// `∂L` of the two ends of one segment over one tile, then the stiffness of each.
pub(super) type EndSums = [f32; 6];

/// What pass 1 keeps of a block on the soft edge.
#[derive(Debug, Clone, Copy)]
struct EdgeBlock {
    /// `m = o·σ(d)`.
    alpha: Lanes,
    /// `o·σ'(d)`.
    slope: Lanes,
    /// `1/|q|`.
    inverse: Lanes,
}

/// One stroke's blocks, as pass 1 visited them.
#[derive(Debug, Clone, Copy)]
struct Visit {
    /// Index in the tile's list of strokes.
    slot: u32,
    /// Blocks on the soft edge, visited first.
    edge: BlockSet,
    /// Blocks in the hard core, where coverage is 1 and no distance is needed.
    core: BlockSet,
}

/// What pass 1 sees through the strokes so far.
#[derive(Debug, Clone, Copy)]
struct Veil {
    /// Transmittance.
    through: Lanes,
    /// Largest transmittance that leaving out any one stroke gives.
    less_one: Lanes,
}

impl Veil {
    /// Fully transparent where `weights` is 1, on the picture; opaque where it is 0, on the padding.
    fn clear(weights: &Lanes) -> Self {
        Self {
            through: *weights,
            less_one: *weights,
        }
    }
}

/// Scratch of one worker, reused from tile to tile.
#[derive(Debug)]
pub(super) struct Scratch {
    color: TileRgb,
    veils: [Veil; BLOCKS],
    error: TileRgb,
    gradient: TileRgb,
    visits: Vec<Visit>,
    kept_transmittance: Vec<Lanes>,
    kept_edges: Vec<EdgeBlock>,
    /// For each block on the soft edge of a stroke of several segments, which of them is the nearest to each pixel.
    kept_nearest: Vec<Lanes>,
    /// For each listed segment of a stroke that has several, the blocks that have it as the nearest somewhere.
    near: Vec<BlockSet>,
    /// Squared distances of the blocks' centres from each segment of a stroke.
    centers: Vec<[Lanes; BLOCKS / LANES]>,
}

impl Scratch {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self {
            color: flat_tile([0.0; 3]),
            veils: [Veil::clear(&Lanes::splat(1.0)); BLOCKS],
            error: flat_tile([0.0; 3]),
            gradient: flat_tile([0.0; 3]),
            visits: Vec::new(),
            kept_transmittance: Vec::new(),
            kept_edges: Vec::new(),
            kept_nearest: Vec::new(),
            near: Vec::new(),
            centers: Vec::new(),
        })
    }

    /// What pass 1 has drawn.
    pub(super) fn canvas(&self) -> &TileRgb {
        &self.color
    }
}

/// One tile's share of the work.
pub(super) struct TileJob<'a> {
    /// All strokes of the call.
    pub(super) flat: &'a Flat,
    /// The strokes that may touch this tile, back to front.
    pub(super) listed: &'a [Listed],
    /// Their segments that may, each by its first vertex.
    pub(super) segments: &'a [u32],
    /// The tile's number.
    pub(super) tile: usize,
    /// The tile's top left corner, px.
    pub(super) origin: [f32; 2],
    /// What is behind all strokes.
    pub(super) backdrop: &'a TileRgb,
    /// 1 on the picture, 0 on the padding, through which nothing is seen.
    pub(super) weights: &'a TileWeights,
    pub(super) edge: Edge,
    pub(super) reach: Reach,
}

impl TileJob<'_> {
    /// Where the segments of a listed stroke are in the list.
    fn segments_of(&self, slot: usize) -> Range<usize> {
        let end = self.listed.get(slot + 1);
        let end = end.map_or(self.segments.len(), |next| next.first as usize);
        self.listed[slot].first as usize..end
    }

    /// Radius, red, green, blue and opacity of a listed stroke.
    fn look(&self, slot: usize) -> &[f32; LOOK] {
        &self.flat.looks[self.listed[slot].stroke as usize]
    }

    /// A listed segment, swept by a disc of `radius`.
    #[inline(always)]
    fn capsule<S: Simd>(&self, simd: S, segment: usize, radius: f32) -> Capsule<S> {
        let at = self.segments[segment] as usize;
        let (a, b) = (self.flat.vertices[at], self.flat.vertices[at + 1]);
        Capsule::new(simd, [a, b], radius, self.origin)
    }
}

/// Sums of one tile over its pixels.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct TileSums {
    /// The loss.
    pub(super) loss: f64,
    /// `∂L/∂backdrop`, summed.
    pub(super) backdrop: [f32; 3],
    /// Blocks visited by pass 1.
    pub(super) blocks: u64,
}

/// A segment swept by a disc, splatted for the lanes, relative to its tile.
#[derive(Clone, Copy)]
pub(super) struct Capsule<S: Simd> {
    a: [f32; 2],
    axis: [f32x16<S>; 2],
    /// `1/(|b−a|² + ε)`.
    inverse_length2: f32x16<S>,
    radius: f32x16<S>,
}

impl<S: Simd> Capsule<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, [a, b]: [[f32; 2]; 2], radius: f32, origin: [f32; 2]) -> Self {
        let axis = [b[0] - a[0], b[1] - a[1]];
        let length2 = axis[0] * axis[0] + axis[1] * axis[1];
        Self {
            a: [a[0] - origin[0], a[1] - origin[1]],
            axis: [f32x16::splat(simd, axis[0]), f32x16::splat(simd, axis[1])],
            inverse_length2: f32x16::splat(simd, 1.0 / (length2 + EPSILON)),
            radius: f32x16::splat(simd, radius),
        }
    }

    /// `h` and `q = p − a − h(b−a)` at `p − a`.
    #[inline(always)]
    fn nearest(&self, pa: [f32x16<S>; 2]) -> (f32x16<S>, [f32x16<S>; 2]) {
        let dot = pa[0] * self.axis[0] + pa[1] * self.axis[1];
        let h = (dot * self.inverse_length2).max(0.0).min(1.0);
        (h, [pa[0] - h * self.axis[0], pa[1] - h * self.axis[1]])
    }

    /// `p − a` at the pixels of a block.
    #[inline(always)]
    fn offsets(&self, simd: S, block: usize) -> [f32x16<S>; 2] {
        let x = (block % TILE_BLOCKS * BLOCK) as f32 - self.a[0];
        let y = (block / TILE_BLOCKS * BLOCK) as f32 - self.a[1];
        [load(simd, &PIXELS[0]) + x, load(simd, &PIXELS[1]) + y]
    }

    /// The signed distance at the pixels of a block.
    #[inline(always)]
    pub(super) fn distance(&self, simd: S, block: usize) -> f32x16<S> {
        let (_, q) = self.nearest(self.offsets(simd, block));
        self.radius - (q[0] * q[0] + q[1] * q[1] + EPSILON).sqrt()
    }

    /// The blocks that the stroke widened by its soft edge can touch, and those wholly in its hard
    /// core, from the distances of the blocks' centres.
    #[inline(always)]
    pub(super) fn blocks(&self, simd: S, radius: f32, reach: Reach) -> (BlockSet, BlockSet) {
        let outer = (radius + reach.outside + BLOCK_RADIUS).max(0.0);
        let inner = (radius - reach.inside - BLOCK_RADIUS).max(0.0);
        let (mut touched, mut core) = (0, 0);
        for row in 0..BLOCKS / LANES {
            let distance2 = self.from_centers(simd, row);
            touched |= distance2.simd_lt(outer * outer).to_bitmask() << (row * LANES);
            core |= distance2.simd_lt(inner * inner).to_bitmask() << (row * LANES);
        }
        (touched, core)
    }

    /// The squared distances of the centres of 16 blocks, a quarter of the tile.
    #[inline(always)]
    fn from_centers(&self, simd: S, row: usize) -> f32x16<S> {
        let y = (row * LANES / TILE_BLOCKS * BLOCK) as f32 - self.a[1];
        let (_, q) = self.nearest([
            load(simd, &CENTERS[0]) - self.a[0],
            load(simd, &CENTERS[1]) + y,
        ]);
        q[0] * q[0] + q[1] * q[1]
    }
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, lanes: &Lanes) -> f32x16<S> {
    f32x16::load_array_ref(simd, &lanes.0)
}

#[inline(always)]
pub(super) fn store<S: Simd>(value: f32x16<S>, lanes: &mut Lanes) {
    value.store_slice(&mut lanes.0);
}

#[inline(always)]
fn splat_rgb<S: Simd>(simd: S, &[_, red, green, blue, _]: &[f32; LOOK]) -> [f32x16<S>; 3] {
    [
        f32x16::splat(simd, red),
        f32x16::splat(simd, green),
        f32x16::splat(simd, blue),
    ]
}

/// The members of a set, in rising order.
#[inline(always)]
pub(super) fn members(mut set: BlockSet) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (set != 0).then(|| {
            let block = set.trailing_zeros() as usize;
            set &= set - 1;
            block
        })
    })
}

/// The blocks that a stroke of several segments touches, and those wholly in its hard core. Writes for each segment the
/// blocks in which it is the nearest to some pixel.
///
/// A pixel is within [`BLOCK_RADIUS`] of its block's centre. So a segment that is farther from the centre than another
/// one by twice that is the nearest nowhere in the block.
#[inline(always)]
fn union_blocks<S: Simd>(
    simd: S,
    job: &TileJob<'_>,
    segments: Range<usize>,
    radius: f32,
    centers: &mut Vec<[Lanes; BLOCKS / LANES]>,
    near: &mut [BlockSet],
) -> (BlockSet, BlockSet) {
    let reach = job.reach;
    let outer = (radius + reach.outside + BLOCK_RADIUS).max(0.0);
    let inner = (radius - reach.inside - BLOCK_RADIUS).max(0.0);
    centers.clear();
    centers.resize(segments.len(), [Lanes::splat(0.0); BLOCKS / LANES]);
    for (segment, centers) in segments.clone().zip(centers.iter_mut()) {
        let capsule = job.capsule(simd, segment, radius);
        for (row, centers) in centers.iter_mut().enumerate() {
            store(capsule.from_centers(simd, row), centers);
        }
    }
    let (mut touched, mut core) = (0, 0);
    for segment in segments.clone() {
        near[segment] = 0;
    }
    for row in 0..BLOCKS / LANES {
        let mut least = f32x16::splat(simd, f32::INFINITY);
        for centers in centers.iter() {
            least = least.min(load(simd, &centers[row]));
        }
        touched |= least.simd_lt(outer * outer).to_bitmask() << (row * LANES);
        core |= least.simd_lt(inner * inner).to_bitmask() << (row * LANES);
        let limit = (least.sqrt() + 2.0 * BLOCK_RADIUS).min(outer);
        let limit2 = limit * limit;
        for (segment, centers) in segments.clone().zip(centers.iter()) {
            let is_near = load(simd, &centers[row]).simd_le(limit2);
            near[segment] |= is_near.to_bitmask() << (row * LANES);
        }
    }
    (touched, core)
}

/// Of the segments that are near `block`, the squared distance of the nearest one to each pixel, and which one that is.
#[inline(always)]
fn union_distance<S: Simd>(
    simd: S,
    job: &TileJob<'_>,
    segments: Range<usize>,
    near: &[BlockSet],
    block: usize,
) -> (f32x16<S>, f32x16<S>) {
    let mut least = f32x16::splat(simd, f32::INFINITY);
    let mut nearest = f32x16::splat(simd, -1.0);
    for segment in segments.clone() {
        if near[segment] >> block & 1 == 0 {
            continue;
        }
        let capsule = job.capsule(simd, segment, 0.0);
        let (_, q) = capsule.nearest(capsule.offsets(simd, block));
        let distance2 = q[0] * q[0] + q[1] * q[1];
        let index = f32x16::splat(simd, (segment - segments.start) as f32);
        let is_nearer = distance2.simd_lt(least);
        nearest = is_nearer.select(index, nearest);
        least = least.min(distance2);
    }
    (least, nearest)
}

/// Pass 1, for one kind of edge.
#[inline(always)]
fn front_to_back<S: Simd, E: SoftEdge>(simd: S, edge: E, job: &TileJob<'_>, scratch: &mut Scratch) {
    let Scratch {
        color,
        veils,
        visits,
        kept_transmittance,
        kept_edges,
        kept_nearest,
        near,
        centers,
        ..
    } = scratch;
    *color = flat_tile([0.0; 3]);
    for (veil, weights) in veils.iter_mut().zip(job.weights) {
        *veil = Veil::clear(weights);
    }
    visits.clear();
    kept_transmittance.clear();
    kept_edges.clear();
    kept_nearest.clear();
    near.resize(job.segments.len(), 0);
    let mut live = BlockSet::MAX;
    // The list is back to front, so the walk starts at its end.
    for slot in (0..job.listed.len()).rev() {
        let look = job.look(slot);
        let segments = job.segments_of(slot);
        let is_capsule = segments.len() == 1;
        let radius = look[0];
        let capsule = job.capsule(simd, segments.start, radius);
        let (touched, core) = if is_capsule {
            capsule.blocks(simd, radius, job.reach)
        } else {
            union_blocks(simd, job, segments.clone(), radius, centers, near)
        };
        let visit = Visit {
            slot: slot as u32,
            edge: touched & !core & live,
            core: touched & core & live,
        };
        if visit.edge | visit.core == 0 {
            continue;
        }
        visits.push(visit);
        let rgb = splat_rgb(simd, look);
        let opacity = f32x16::splat(simd, look[LOOK - 1].max(FAINTEST));
        for block in members(visit.edge) {
            let distance2 = if is_capsule {
                let (_, q) = capsule.nearest(capsule.offsets(simd, block));
                q[0] * q[0] + q[1] * q[1]
            } else {
                let (least, nearest) = union_distance(simd, job, segments.clone(), near, block);
                let mut kept = Lanes::splat(0.0);
                store(nearest, &mut kept);
                kept_nearest.push(kept);
                least
            };
            let length = (distance2 + EPSILON).sqrt();
            let (value, derivative) = edge.eval(capsule.radius - length);
            let alpha = opacity * value;
            let mut kept = EdgeBlock {
                alpha: Lanes::splat(0.0),
                slope: Lanes::splat(0.0),
                inverse: Lanes::splat(0.0),
            };
            store(alpha, &mut kept.alpha);
            store(opacity * derivative, &mut kept.slope);
            store(1.0 / length, &mut kept.inverse);
            kept_edges.push(kept);
            kept_transmittance.push(veils[block].through);
            if see_through(simd, alpha, &rgb, &mut color[block], &mut veils[block]) {
                live &= !(1 << block);
            }
        }
        // σ is 1 and σ' is 0 here: no distance to evaluate, and nothing but `T` to keep for pass 2.
        for block in members(visit.core) {
            kept_transmittance.push(veils[block].through);
            if see_through(simd, opacity, &rgb, &mut color[block], &mut veils[block]) {
                live &= !(1 << block);
            }
        }
        if live == 0 {
            break;
        }
    }
    // The backdrop is the last thing seen, through whatever all strokes let through.
    for ((color, veil), backdrop) in color.iter_mut().zip(veils.iter()).zip(job.backdrop) {
        let t = load(simd, &veil.through);
        for (color, backdrop) in color.iter_mut().zip(backdrop) {
            store(load(simd, color) + t * load(simd, backdrop), color);
        }
    }
}

/// Adds one stroke, seen through those in front of it. Returns whether nothing behind it can matter any more.
#[inline(always)]
fn see_through<S: Simd>(
    simd: S,
    alpha: f32x16<S>,
    rgb: &[f32x16<S>; 3],
    color: &mut BlockRgb,
    veil: &mut Veil,
) -> bool {
    let t = load(simd, &veil.through);
    let weight = t * alpha;
    for (color, &c) in color.iter_mut().zip(rgb) {
        store(load(simd, color) + weight * c, color);
    }
    let less_one = load(simd, &veil.less_one);
    // The largest transmittance with any one stroke left out: `t` if it is the new one; otherwise that of before,
    // dimmed by the new one. While this shows anything, worth still depends on what lies behind.
    let less_one = (less_one - less_one * alpha).max(t);
    store(t - weight, &mut veil.through);
    store(less_one, &mut veil.less_one);
    less_one.simd_lt(OPAQUE).all_true()
}

/// Sums of one stroke in lanes.
struct Sums<S: Simd> {
    color: [f32x16<S>; 3],
    opacity: f32x16<S>,
    radius: f32x16<S>,
    worth: f32x16<S>,
}

impl<S: Simd> Sums<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        Self {
            color: [zero; 3],
            opacity: zero,
            radius: zero,
            worth: zero,
        }
    }

    #[inline(always)]
    fn finish(&self, opacity: f32) -> LookSums {
        [
            total(self.radius),
            total(self.color[0]),
            total(self.color[1]),
            total(self.color[2]),
            total(self.opacity) / opacity,
            total(self.worth),
        ]
    }
}

/// Sums of one segment in lanes.
struct Shifts<S: Simd> {
    /// `Σ ∂L/∂d · u`.
    whole: [f32x16<S>; 2],
    /// `Σ ∂L/∂d · u · h`.
    of_b: [f32x16<S>; 2],
    /// `Σ k` and `Σ k · h`, where k is twice the squared derivative of the canvas by the distance.
    stiffness: [f32x16<S>; 2],
}

impl<S: Simd> Shifts<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        Self {
            whole: [zero; 2],
            of_b: [zero; 2],
            stiffness: [zero; 2],
        }
    }

    /// Adds a block in which `∂L/∂d · u` is `pull · q`.
    #[inline(always)]
    fn add(&mut self, pull: f32x16<S>, q: [f32x16<S>; 2], h: f32x16<S>) {
        for (axis, &q) in q.iter().enumerate() {
            let shift = pull * q;
            self.whole[axis] += shift;
            self.of_b[axis] += shift * h;
        }
    }

    #[inline(always)]
    fn stiffen(&mut self, k: f32x16<S>, h: f32x16<S>) {
        self.stiffness[0] += k;
        self.stiffness[1] += k * h;
    }

    #[inline(always)]
    fn finish<const WITH_WORTH: bool>(&self) -> EndSums {
        let (bx, by) = (total(self.of_b[0]), total(self.of_b[1]));
        let [ax, ay] = [total(self.whole[0]) - bx, total(self.whole[1]) - by];
        let (mut of_a, mut of_b) = (0.0, 0.0);
        if WITH_WORTH {
            of_b = total(self.stiffness[1]);
            of_a = total(self.stiffness[0]) - of_b;
        }
        [ax, ay, bx, by, of_a, of_b]
    }
}

/// The sum of all lanes, in one order at every SIMD level.
#[inline(always)]
pub(super) fn total<S: Simd>(v: f32x16<S>) -> f32 {
    let (low, high) = v.split();
    let eight: f32x8<S> = low + high;
    let (low, high) = eight.split();
    let four = low + high;
    (four[0] + four[2]) + (four[1] + four[3])
}

/// Pass 2, over the blocks that pass 1 visited. `scratch.gradient` and `scratch.error` are given;
/// `scratch.color` becomes the colour behind.
#[inline(always)]
fn back_to_front<S: Simd, const WITH_WORTH: bool>(
    simd: S,
    job: &TileJob<'_>,
    scratch: &mut Scratch,
    looks: &mut [LookSums],
    ends: &mut [EndSums],
) -> [f32; 3] {
    let Scratch {
        color: behind,
        veils,
        error,
        gradient,
        visits,
        kept_transmittance,
        kept_edges,
        kept_nearest,
        near,
        ..
    } = scratch;
    // Behind the rearmost stroke is the backdrop.
    behind.clone_from(job.backdrop);
    let mut backdrop = [f32x16::splat(simd, 0.0); 3];
    for (veil, g) in veils.iter().zip(gradient.iter()) {
        for (sum, g) in backdrop.iter_mut().zip(g) {
            *sum += load(simd, &veil.through) * load(simd, g);
        }
    }
    // What pass 1 kept is read from its end: pass 2 visits the same strokes in reverse, and in each of them the
    // same blocks in the same order.
    let (mut at, mut at_edge) = (kept_transmittance.len(), kept_edges.len());
    let mut at_nearest = kept_nearest.len();
    for visit in visits.iter().rev() {
        let slot = visit.slot as usize;
        let look = job.look(slot);
        let segments = job.segments_of(slot);
        let is_capsule = segments.len() == 1;
        let capsule = job.capsule(simd, segments.start, look[0]);
        let rgb = splat_rgb(simd, look);
        let mut stroke = Sums::new(simd);
        let mut shifts = Shifts::new(simd);
        at -= (visit.edge.count_ones() + visit.core.count_ones()) as usize;
        at_edge -= visit.edge.count_ones() as usize;
        let mut seen_through = kept_transmittance[at..].iter();
        for ((block, kept), t) in members(visit.edge)
            .zip(&mut kept_edges[at_edge..])
            .zip(&mut seen_through)
        {
            let alpha = load(simd, &kept.alpha);
            let t = load(simd, t);
            let (d_alpha, contrast2) = stroke.blend::<WITH_WORTH>(
                simd,
                alpha,
                t,
                &rgb,
                &mut behind[block],
                &gradient[block],
                &error[block],
            );
            let slope = load(simd, &kept.slope);
            let d_distance = d_alpha * slope;
            // `∂L/∂d · u` is `pull · q`: pass 1 kept 1/|q|, which costs a root; `q` is computed again.
            let pull = d_distance * load(simd, &kept.inverse);
            stroke.radius += d_distance;
            let seen = t * slope;
            let stiffness = 2.0 * (seen * seen) * contrast2;
            if is_capsule {
                let (h, q) = capsule.nearest(capsule.offsets(simd, block));
                shifts.add(pull, q, h);
                if WITH_WORTH {
                    shifts.stiffen(stiffness, h);
                }
            } else {
                // What the segments need, in the place of what is not needed any more.
                store(pull, &mut kept.slope);
                if WITH_WORTH {
                    store(stiffness, &mut kept.inverse);
                }
            }
        }
        let opacity = f32x16::splat(simd, look[LOOK - 1].max(FAINTEST));
        for (block, t) in members(visit.core).zip(seen_through) {
            stroke.blend::<WITH_WORTH>(
                simd,
                opacity,
                load(simd, t),
                &rgb,
                &mut behind[block],
                &gradient[block],
                &error[block],
            );
        }
        looks[slot] = stroke.finish(look[LOOK - 1].max(FAINTEST));
        if is_capsule {
            ends[segments.start] = shifts.finish::<WITH_WORTH>();
            continue;
        }
        at_nearest -= visit.edge.count_ones() as usize;
        let kept = Kept {
            edge: visit.edge,
            blocks: &kept_edges[at_edge..],
            nearest: &kept_nearest[at_nearest..],
        };
        for segment in segments.clone() {
            let capsule = job.capsule(simd, segment, 0.0);
            let index = (segment - segments.start) as f32;
            ends[segment] = kept.ends::<_, WITH_WORTH>(simd, &capsule, index, near[segment]);
        }
    }
    [total(backdrop[0]), total(backdrop[1]), total(backdrop[2])]
}

/// What was kept of a stroke of several segments.
struct Kept<'a> {
    /// Its blocks on the soft edge.
    edge: BlockSet,
    /// For each of these, `pull` in `slope`, and the stiffness in `inverse`.
    blocks: &'a [EdgeBlock],
    nearest: &'a [Lanes],
}

impl Kept<'_> {
    /// The sums of the segment number `index`, over the pixels that have it as the nearest.
    #[inline(always)]
    fn ends<S: Simd, const WITH_WORTH: bool>(
        &self,
        simd: S,
        capsule: &Capsule<S>,
        index: f32,
        near: BlockSet,
    ) -> EndSums {
        let zero = f32x16::splat(simd, 0.0);
        let mut shifts = Shifts::new(simd);
        for block in members(near & self.edge) {
            let k = (self.edge & ((1 << block) - 1)).count_ones() as usize;
            let is_nearest = load(simd, &self.nearest[k]).simd_eq(index);
            let (h, q) = capsule.nearest(capsule.offsets(simd, block));
            let pull = is_nearest.select(load(simd, &self.blocks[k].slope), zero);
            shifts.add(pull, q, h);
            if WITH_WORTH {
                let stiffness = load(simd, &self.blocks[k].inverse);
                shifts.stiffen(is_nearest.select(stiffness, zero), h);
            }
        }
        shifts.finish::<WITH_WORTH>()
    }
}

impl<S: Simd> Sums<S> {
    /// Lays the stroke on what is behind it in one block; returns `∂L/∂m` and, `WITH_WORTH`, the squared contrast.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn blend<const WITH_WORTH: bool>(
        &mut self,
        simd: S,
        alpha: f32x16<S>,
        t: f32x16<S>,
        rgb: &[f32x16<S>; 3],
        behind: &mut BlockRgb,
        gradient: &BlockRgb,
        error: &BlockRgb,
    ) -> (f32x16<S>, f32x16<S>) {
        let zero = f32x16::splat(simd, 0.0);
        let seen = t * alpha;
        let (mut along, mut change, mut contrast2) = (zero, zero, zero);
        for channel in 0..3 {
            let back = load(simd, &behind[channel]);
            let contrast = rgb[channel] - back;
            let g = load(simd, &gradient[channel]);
            along += g * contrast;
            self.color[channel] += seen * g;
            store(back + alpha * contrast, &mut behind[channel]);
            if WITH_WORTH {
                // This `delta` is −δ of the head, hence the minus before 2e.
                let delta = seen * contrast;
                let e = load(simd, &error[channel]);
                change += delta * (delta - (e + e));
                contrast2 += contrast * contrast;
            }
        }
        if WITH_WORTH {
            self.worth += change;
        }
        let d_alpha = t * along;
        self.opacity += d_alpha * alpha;
        (d_alpha, contrast2)
    }
}

/// Pass 1. Leaves the canvas in [`Scratch::canvas`].
pub(super) fn draw(level: Level, job: &TileJob<'_>, scratch: &mut Scratch) {
    match job.edge {
        Edge::Smoothstep(edge) => dispatch!(level, simd => front_to_back(simd, edge, job, scratch)),
        Edge::Tailed(edge) => dispatch!(level, simd => front_to_back(simd, edge, job, scratch)),
    }
}

/// After pass 1: the tile's loss and the derivatives of it. `looks` has one row per stroke of the job, and `ends` one per
/// segment, all 0.
pub(super) fn differentiate<L: CanvasLoss, const WITH_WORTH: bool>(
    level: Level,
    job: &TileJob<'_>,
    loss: &L,
    scratch: &mut Scratch,
    looks: &mut [LookSums],
    ends: &mut [EndSums],
) -> TileSums {
    dispatch!(level, simd => {
        let Scratch { color, error, gradient, .. } = scratch;
        let value = loss.tile(job.tile, color, error, gradient);
        let backdrop = back_to_front::<_, WITH_WORTH>(simd, job, scratch, looks, ends);
        TileSums { loss: value, backdrop, blocks: scratch.kept_transmittance.len() as u64 }
    })
}
