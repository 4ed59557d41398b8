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
//! Degenerate cases: a zero-length capsule is a disc; a stroke with a non-finite number touches no
//! block; on the centre line `u` tends to 0 with the guard instead of being undefined.

// Lanes are never passed through closures of `array::map`: those are compiled on their own, without the
// instruction set of their caller.

use fearless_simd::{Level, dispatch, f32x8, f32x16, prelude::*};

use super::CanvasLoss;
use super::edge::{Edge, Reach, SoftEdge};
use super::grid::{
    BLOCK, BLOCKS, BlockRgb, BlockSet, LANES, Lanes, TILE_BLOCKS, TileRgb, TileWeights, flat_tile,
};
use super::strokes::{AX, AY, BX, BY, OPACITY, PARAMS, Params, RADIUS, RED};

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

/// `∂L` of one stroke over one tile: its [`PARAMS`] in order, then its worth.
pub(super) type StrokeSums = [f32; PARAMS + 1];
/// Index of the leave-one-out change of the squared error.
pub(super) const WORTH: usize = PARAMS;

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
    /// Position in the tile's list of strokes.
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
    pub(super) strokes: &'a [Params],
    /// The strokes that may touch this tile, back to front.
    pub(super) ids: &'a [u32],
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

/// A stroke, splatted for the lanes, relative to its tile.
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
    pub(super) fn new(simd: S, p: &Params, origin: [f32; 2]) -> Self {
        let axis = [p[BX] - p[AX], p[BY] - p[AY]];
        let length2 = axis[0] * axis[0] + axis[1] * axis[1];
        Self {
            a: [p[AX] - origin[0], p[AY] - origin[1]],
            axis: [f32x16::splat(simd, axis[0]), f32x16::splat(simd, axis[1])],
            inverse_length2: f32x16::splat(simd, 1.0 / (length2 + EPSILON)),
            radius: f32x16::splat(simd, p[RADIUS]),
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
            let y = (row * LANES / TILE_BLOCKS * BLOCK) as f32 - self.a[1];
            let (_, q) = self.nearest([
                load(simd, &CENTERS[0]) - self.a[0],
                load(simd, &CENTERS[1]) + y,
            ]);
            let distance2 = q[0] * q[0] + q[1] * q[1];
            touched |= distance2.simd_lt(outer * outer).to_bitmask() << (row * LANES);
            core |= distance2.simd_lt(inner * inner).to_bitmask() << (row * LANES);
        }
        (touched, core)
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
fn splat_rgb<S: Simd>(simd: S, p: &Params) -> [f32x16<S>; 3] {
    [
        f32x16::splat(simd, p[RED]),
        f32x16::splat(simd, p[RED + 1]),
        f32x16::splat(simd, p[RED + 2]),
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

/// Pass 1, for one kind of edge.
#[inline(always)]
fn front_to_back<S: Simd, E: SoftEdge>(simd: S, edge: E, job: &TileJob<'_>, scratch: &mut Scratch) {
    let Scratch {
        color,
        veils,
        visits,
        kept_transmittance,
        kept_edges,
        ..
    } = scratch;
    *color = flat_tile([0.0; 3]);
    for (veil, weights) in veils.iter_mut().zip(job.weights) {
        *veil = Veil::clear(weights);
    }
    visits.clear();
    kept_transmittance.clear();
    kept_edges.clear();
    let mut live = BlockSet::MAX;
    // `ids` is back to front, so the walk starts at its end.
    for (slot, &id) in job.ids.iter().enumerate().rev() {
        let p = &job.strokes[id as usize];
        let capsule = Capsule::new(simd, p, job.origin);
        let (touched, core) = capsule.blocks(simd, p[RADIUS], job.reach);
        let visit = Visit {
            slot: slot as u32,
            edge: touched & !core & live,
            core: touched & core & live,
        };
        if visit.edge | visit.core == 0 {
            continue;
        }
        visits.push(visit);
        let rgb = splat_rgb(simd, p);
        let opacity = f32x16::splat(simd, p[OPACITY].max(FAINTEST));
        for block in members(visit.edge) {
            let (_, q) = capsule.nearest(capsule.offsets(simd, block));
            let length = (q[0] * q[0] + q[1] * q[1] + EPSILON).sqrt();
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
    /// `Σ ∂L/∂d · u`.
    shift: [f32x16<S>; 2],
    /// `Σ ∂L/∂d · u · h`.
    shift_b: [f32x16<S>; 2],
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
            shift: [zero; 2],
            shift_b: [zero; 2],
            worth: zero,
        }
    }

    #[inline(always)]
    fn finish(&self, opacity: f32) -> StrokeSums {
        let (bx, by) = (total(self.shift_b[0]), total(self.shift_b[1]));
        [
            total(self.shift[0]) - bx,
            total(self.shift[1]) - by,
            bx,
            by,
            total(self.radius),
            total(self.color[0]),
            total(self.color[1]),
            total(self.color[2]),
            total(self.opacity) / opacity,
            total(self.worth),
        ]
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
    sums: &mut [StrokeSums],
) -> [f32; 3] {
    let Scratch {
        color: behind,
        veils,
        error,
        gradient,
        visits,
        kept_transmittance,
        kept_edges,
    } = scratch;
    // Behind the rearmost stroke is the backdrop.
    behind.clone_from(job.backdrop);
    sums.fill([0.0; PARAMS + 1]);
    let mut backdrop = [f32x16::splat(simd, 0.0); 3];
    for (veil, g) in veils.iter().zip(gradient.iter()) {
        for (sum, g) in backdrop.iter_mut().zip(g) {
            *sum += load(simd, &veil.through) * load(simd, g);
        }
    }
    // What pass 1 kept is read from its end: pass 2 visits the same strokes in reverse, and in each of them the
    // same blocks in the same order.
    let (mut at, mut at_edge) = (kept_transmittance.len(), kept_edges.len());
    for visit in visits.iter().rev() {
        let p = &job.strokes[job.ids[visit.slot as usize] as usize];
        let capsule = Capsule::new(simd, p, job.origin);
        let rgb = splat_rgb(simd, p);
        let mut stroke = Sums::new(simd);
        at -= (visit.edge.count_ones() + visit.core.count_ones()) as usize;
        at_edge -= visit.edge.count_ones() as usize;
        let mut seen_through = kept_transmittance[at..].iter();
        for ((block, kept), t) in members(visit.edge)
            .zip(&kept_edges[at_edge..])
            .zip(&mut seen_through)
        {
            let alpha = load(simd, &kept.alpha);
            let d_alpha = stroke.blend::<WITH_WORTH>(
                simd,
                alpha,
                load(simd, t),
                &rgb,
                &mut behind[block],
                &gradient[block],
                &error[block],
            );
            let (h, q) = capsule.nearest(capsule.offsets(simd, block));
            let d_distance = d_alpha * load(simd, &kept.slope);
            // `∂L/∂d · u` is `pull · q`: pass 1 kept 1/|q|, which costs a root; `q` is computed again.
            let pull = d_distance * load(simd, &kept.inverse);
            stroke.radius += d_distance;
            for (axis, &q) in q.iter().enumerate() {
                let shift = pull * q;
                stroke.shift[axis] += shift;
                stroke.shift_b[axis] += shift * h;
            }
        }
        let opacity = f32x16::splat(simd, p[OPACITY].max(FAINTEST));
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
        sums[visit.slot as usize] = stroke.finish(p[OPACITY].max(FAINTEST));
    }
    [total(backdrop[0]), total(backdrop[1]), total(backdrop[2])]
}

impl<S: Simd> Sums<S> {
    /// Lays the stroke on what is behind it in one block; returns `∂L/∂m`.
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
    ) -> f32x16<S> {
        let zero = f32x16::splat(simd, 0.0);
        let seen = t * alpha;
        let (mut along, mut change) = (zero, zero);
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
            }
        }
        if WITH_WORTH {
            self.worth += change;
        }
        let d_alpha = t * along;
        self.opacity += d_alpha * alpha;
        d_alpha
    }
}

/// Pass 1. Leaves the canvas in [`Scratch::canvas`].
pub(super) fn draw(level: Level, job: &TileJob<'_>, scratch: &mut Scratch) {
    match job.edge {
        Edge::Smoothstep(edge) => dispatch!(level, simd => front_to_back(simd, edge, job, scratch)),
        Edge::Tailed(edge) => dispatch!(level, simd => front_to_back(simd, edge, job, scratch)),
    }
}

/// After pass 1: the tile's loss and the derivatives of it. `sums` has one row per stroke of the job.
pub(super) fn differentiate<L: CanvasLoss, const WITH_WORTH: bool>(
    level: Level,
    job: &TileJob<'_>,
    loss: &L,
    scratch: &mut Scratch,
    sums: &mut [StrokeSums],
) -> TileSums {
    dispatch!(level, simd => {
        let Scratch { color, error, gradient, .. } = scratch;
        let value = loss.tile(job.tile, color, error, gradient);
        let backdrop = back_to_front::<_, WITH_WORTH>(simd, job, scratch, sums);
        TileSums { loss: value, backdrop, blocks: scratch.kept_transmittance.len() as u64 }
    })
}
