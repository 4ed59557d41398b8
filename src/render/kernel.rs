//! The two passes over one tile.
//!
//! Pass 1 goes front to back: it accumulates the colour seen, `C ← C + T·m·c`, and the
//! transmittance `T ← T·(1 − m)`, and keeps `T`, `m`, `o·σ'` and `1/|q|` of every block it visits.
//! A block that stays opaque even when any one stroke is taken away leaves the set of live blocks, and
//! nothing behind it is evaluated: neither a gradient nor a stroke's contribution depends on it.
//!
//! Pass 2 goes back to front over the same blocks with the colour behind, `B`:
//!
//! ```text
//! ∂L/∂m = T·g·(c − B)      ∂L/∂c = Σ T·m·g      ∂L/∂d = ∂L/∂m · o · σ'(d)
//! ∂d/∂r = 1                ∂d/∂a = u·(1 − h)    ∂d/∂b = u·h          u = q/|q|
//! contribution = Σ 2e·δ + δ²     δ = −T·m·(c − B)     B ← B + m·(c − B)
//! ```
//!
//! No step divides by `1 − m`, so opaque strokes are as exact as others. `h` is held fixed in the
//! derivatives: at the nearest point the distance does not change with `h` (envelope theorem), up
//! to the guard [`EPSILON`].
//!
//! A stroke of several segments is the union of their capsules, with one coverage: at each pixel the nearest segment gives
//! `d` and its derivatives, the first one if several are equally near.
//!
//! An area has the same segments without a radius, and each pixel a side of them: `d = ±|q|`, and `∂d/∂a`, `∂d/∂b` with the
//! sign of the side ([`winding`]). Blocks inside that no segment is near are its hard core.
//!
//! An area with a gradient has another colour and opacity at each pixel, which both passes work out anew ([`ink`]); no loss is
//! derived by them.
//!
//! Degenerate cases: a zero-length capsule is a disc; on the centre line `u` tends to 0 with the guard instead of being undefined.

// Lanes are never passed through closures of `array::map`: those are compiled on their own, without the
// instruction set of their caller.

mod front;
mod ink;
mod lanes;
mod segment;
mod stack;
mod sums;
mod touching;
mod union;
mod winding;

use std::ops::Range;

use fearless_simd::{Level, dispatch, f32x16, prelude::*};

pub(super) use lanes::{load, members, store, total};
pub(super) use segment::{Segment, length};
pub(super) use sums::{Extras, Mattes, Nothing, OfStroke, Stiffnesses, Sums, Worths};
pub(super) use touching::{Listed, list_segments};

use super::CanvasLoss;
use super::edge::{Edge, Reach, SoftEdge};
use super::grid::{BLOCKS, BlockSet, Lanes, TileRgb, TileWeights, uniform_tile};
use super::polylines::Polylines;
use super::strokes::STYLE;
use front::{Shape, Transmittance};
use ink::InkTile;
use stack::Stack;
use sums::{EdgeBlock, Grounds, Looks, Matte, OfSegment, Shifts};
use union::{Kept, Segments, Union, shared};
use winding::Windings;

/// Least opacity that is drawn, so that the derivative by an opacity of 0 is not 0/0.
const FAINTEST: f32 = 1e-20;

/// A matte that no stroke hides.
const CLEAR: Matte = Matte {
    through: Lanes::splat(1.0),
    gradient: Lanes::splat(0.0),
};

/// One stroke's blocks, as pass 1 visited them.
#[derive(Debug, Clone, Copy)]
struct Visit {
    /// Index in the tile's list of strokes.
    slot: u32,
    /// Blocks on the soft edge, visited first: those in which several segments can be nearest, and then those of each
    /// segment alone.
    edge: BlockSet,
    /// The blocks of `edge` in which several segments can be nearest.
    shared: BlockSet,
    /// Blocks in the hard core, where coverage is 1 and no distance is needed.
    core: BlockSet,
}

/// Scratch of one worker, reused from tile to tile.
#[derive(Debug)]
pub(super) struct Scratch {
    color: TileRgb,
    transmittances: [Transmittance; BLOCKS],
    error: TileRgb,
    gradient: TileRgb,
    /// `∂L/∂canvas` of the second of two losses.
    second: TileRgb,
    mattes: [Matte; BLOCKS],
    visits: Vec<Visit>,
    /// The transmittance before each block that pass 1 visits.
    kept_transmittance: Stack<Lanes>,
    /// The other kept values of the blocks on a soft edge.
    kept_edges: Stack<EdgeBlock>,
    /// Index of the segment nearest to each pixel, in blocks where several segments compete.
    kept_nearest: Stack<Lanes>,
    /// For each listed segment, the blocks in which it can be nearest.
    near: Vec<BlockSet>,
    union: Union,
    windings: Windings,
    /// The gradient of the stroke that is visited.
    inks: InkTile,
}

impl Scratch {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self {
            color: uniform_tile([0.0; 3]),
            transmittances: [Transmittance::clear(&Lanes::splat(1.0)); BLOCKS],
            error: uniform_tile([0.0; 3]),
            gradient: uniform_tile([0.0; 3]),
            second: uniform_tile([0.0; 3]),
            mattes: [CLEAR; BLOCKS],
            visits: Vec::new(),
            kept_transmittance: Stack::new(Lanes::splat(0.0)),
            kept_edges: Stack::new(EdgeBlock::EMPTY),
            kept_nearest: Stack::new(Lanes::splat(0.0)),
            near: Vec::new(),
            union: Union::new(),
            windings: Windings::new(),
            inks: [[Lanes::splat(0.0); 4]; BLOCKS],
        })
    }

    /// The loss of the canvas that pass 1 has drawn in tile `tile`.
    pub(super) fn judge<L: CanvasLoss>(&mut self, tile: usize, loss: &L) -> f64 {
        loss.tile(tile, &self.color, None, &mut self.gradient)
    }

    /// The canvas that pass 1 has drawn.
    pub(super) fn canvas(&self) -> &TileRgb {
        &self.color
    }
}

/// One tile's share of the work.
pub(super) struct TileJob<'a> {
    /// All strokes of the call.
    pub(super) polylines: &'a Polylines,
    /// The strokes that may touch this tile, back to front.
    pub(super) listed: &'a [Listed],
    /// The segments of these strokes that may touch the tile, each by its first vertex.
    pub(super) segments: &'a [u32],
    /// The tile's number.
    pub(super) tile: usize,
    /// The tile's top left corner, px.
    pub(super) origin: [f32; 2],
    /// The tile of the backdrop.
    pub(super) backdrop: &'a TileRgb,
    /// 1 on the picture, 0 on the padding, through which nothing is seen.
    pub(super) weights: &'a TileWeights,
    pub(super) edge: Edge,
    pub(super) reach: Reach,
}

impl<'a> TileJob<'a> {
    /// The job on another tile of backdrop.
    pub(super) fn on(&self, backdrop: &'a TileRgb) -> Self {
        Self { backdrop, ..*self }
    }

    /// Where the segments of a listed stroke are in the list.
    #[inline(always)]
    fn range(&self, slot: usize) -> Range<usize> {
        let end = self.listed.get(slot + 1);
        let end = end.map_or(self.segments.len(), |next| next.first as usize);
        self.listed[slot].first as usize..end
    }

    /// Radius, red, green, blue and opacity of a listed stroke.
    fn style(&self, slot: usize) -> &[f32; STYLE] {
        &self.polylines.styles[self.listed[slot].stroke as usize]
    }

    /// True if a listed stroke is an area.
    #[inline(always)]
    fn is_area(&self, slot: usize) -> bool {
        self.polylines.areas[self.listed[slot].stroke as usize]
    }

    /// The colour and the opacity of a listed stroke in these blocks. A gradient is evaluated into `inks`.
    #[inline(always)]
    fn brush<'b, S: Simd>(
        &self,
        simd: S,
        slot: usize,
        blocks: BlockSet,
        inks: &'b mut InkTile,
    ) -> Brush<'b, S> {
        let style = self.style(slot);
        let ink = self.polylines.ink(self.listed[slot].stroke as usize);
        if let Some(ink) = ink {
            ink::fill(simd.level(), ink, blocks, self.origin, inks);
        }
        Brush {
            rgb: splat_rgb(simd, style),
            opacity: f32x16::splat(simd, style[STYLE - 1].max(FAINTEST)),
            inks: ink.is_some().then_some(&*inks),
        }
    }

    /// The segments of a listed stroke.
    #[inline(always)]
    fn segments(&self, slot: usize, range: Range<usize>) -> Segments<'_> {
        let [low, high] = self.polylines.boxes[self.listed[slot].stroke as usize];
        Segments {
            y: [low[1], high[1]],
            vertices: &self.polylines.vertices,
            listed: &self.segments[range],
            origin: self.origin,
        }
    }
}

/// The colour and the opacity of a stroke.
struct Brush<'a, S: Simd> {
    rgb: [f32x16<S>; 3],
    opacity: f32x16<S>,
    /// A gradient: its colours replace `rgb`, and its opacities multiply `opacity`.
    inks: Option<&'a InkTile>,
}

impl<S: Simd> Brush<'_, S> {
    /// Colour and opacity at the pixels of a block.
    #[inline(always)]
    fn at(&self, simd: S, block: usize) -> ([f32x16<S>; 3], f32x16<S>) {
        match self.inks {
            None => (self.rgb, self.opacity),
            Some(inks) => {
                let [red, green, blue, opacity] = &inks[block];
                let rgb = [load(simd, red), load(simd, green), load(simd, blue)];
                (rgb, self.opacity * load(simd, opacity))
            }
        }
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

#[inline(always)]
fn splat_rgb<S: Simd>(simd: S, &[_, red, green, blue, _]: &[f32; STYLE]) -> [f32x16<S>; 3] {
    [
        f32x16::splat(simd, red),
        f32x16::splat(simd, green),
        f32x16::splat(simd, blue),
    ]
}

/// Pass 1, for one kind of edge.
#[inline(always)]
fn front_to_back<S: Simd, E: SoftEdge>(simd: S, edge: E, job: &TileJob<'_>, scratch: &mut Scratch) {
    let Scratch {
        color,
        transmittances,
        visits,
        kept_transmittance,
        kept_edges,
        kept_nearest,
        near,
        union,
        windings,
        inks,
        ..
    } = scratch;
    // Start with nothing drawn and all blocks in view.
    color.as_flattened_mut().fill(Lanes::splat(0.0));
    for (transmittance, weights) in transmittances.iter_mut().zip(job.weights) {
        *transmittance = Transmittance::clear(weights);
    }
    visits.clear();
    kept_transmittance.clear();
    kept_edges.clear();
    kept_nearest.clear();
    // Each stroke writes its own range of `near` before anything reads it, so old content may stay.
    near.resize(job.segments.len(), 0);
    let mut live = BlockSet::MAX;
    // The list is back to front, so the walk starts at its end.
    for slot in (0..job.listed.len()).rev() {
        // Sort the tile's blocks by what the stroke does there: nothing, a soft edge, or full coverage. Blocks that are opaque
        // by now drop out.
        let style = job.style(slot);
        let range = job.range(slot);
        let segments = job.segments(slot, range.clone());
        let near = &mut near[range];
        let radius = style[0];
        let is_area = job.is_area(slot);
        // A single capsule has nothing to compare: its only segment is the nearest everywhere.
        let (mut touched, mut core) = if near.len() == 1 && !is_area {
            let (touched, core) = segments.get(0).blocks(simd, radius, job.reach);
            near[0] = touched;
            (touched, core)
        } else {
            union.blocks(simd, segments, radius, job.reach, near)
        };
        // The edge of an area is the edge of a stroke without radius, which has no core.
        if is_area {
            // A block whose pixels lie on both sides has a segment through it, so it is touched. The remaining blocks are wholly
            // inside, hence core, or wholly outside. An area that fills the tile has no block on the edge, so nothing reads its
            // windings.
            let listed = job.listed[slot];
            let inside = if listed.fills {
                BlockSet::MAX
            } else {
                let crossings = job.polylines.crossings.of(listed.stroke, job.origin[1]);
                windings.fill(crossings, job.origin)
            };
            core = inside & !touched;
            touched |= inside;
        }
        let edge_blocks = touched & !core & live;
        let visit = Visit {
            slot: slot as u32,
            edge: edge_blocks,
            // Segments compete on the edge alone: coverage in the core is 1 whichever is nearest.
            shared: shared(near) & edge_blocks,
            core: touched & core & live,
        };
        // Hidden or out of reach: the stroke has no sums in this tile, and its derivatives here are 0.
        if visit.edge | visit.core == 0 {
            continue;
        }
        // Make room for what pass 2 needs. The two cursors walk over it in the order in which the blocks are visited: shared
        // ones, those of each segment alone, the core.
        visits.push(visit);
        let brush = job.brush(simd, slot, visit.edge | visit.core, inks);
        let shape = Shape {
            edge,
            radius,
            outside: job.reach.outside,
        };
        let mut through = kept_transmittance.push(visit.edge | visit.core).iter_mut();
        let mut edges = kept_edges.push(visit.edge).iter_mut();
        // Near joints, several segments compete for each pixel: the nearest one decides.
        if visit.shared != 0 {
            union.measure(simd, near, visit.shared);
            let nearest = kept_nearest.push(visit.shared).iter_mut();
            let kept = nearest.zip(&mut edges).zip(&mut through);
            for (block, ((nearest, kept), through)) in members(visit.shared).zip(kept) {
                // Pass 2 sorts the pixels by segment; with the index kept, it compares no distances again.
                *nearest = union.nearest(block);
                let inside = windings.inside(is_area, block);
                let (rgb, opacity) = brush.at(simd, block);
                let alpha = shape.cover(simd, opacity, union.distance2(simd, block), inside, kept);
                *through = transmittances[block].through;
                if transmittances[block].add(simd, alpha, &rgb, &mut color[block]) {
                    live &= !(1 << block);
                }
            }
        }
        // Elsewhere on the edge one segment is the nearest throughout the block, so that nothing has to be compared.
        for (k, near) in near.iter().enumerate() {
            let alone = near & visit.edge & !visit.shared;
            if alone == 0 {
                continue;
            }
            let segment = segments.get(k);
            let kept = (&mut edges).zip(&mut through);
            for (block, (kept, through)) in members(alone).zip(kept) {
                let distance2 = segment.at_pixels(simd, block).distance2();
                let inside = windings.inside(is_area, block);
                let (rgb, opacity) = brush.at(simd, block);
                let alpha = shape.cover(simd, opacity, distance2, inside, kept);
                *through = transmittances[block].through;
                if transmittances[block].add(simd, alpha, &rgb, &mut color[block]) {
                    live &= !(1 << block);
                }
            }
        }
        // σ is 1 and σ' is 0 here: no distance to evaluate, and nothing but `T` to keep for pass 2.
        for (block, through) in members(visit.core).zip(through) {
            let (rgb, opacity) = brush.at(simd, block);
            *through = transmittances[block].through;
            if transmittances[block].add(simd, opacity, &rgb, &mut color[block]) {
                live &= !(1 << block);
            }
        }
        // Every block is opaque: no stroke farther back can show or matter in this tile.
        if live == 0 {
            break;
        }
    }
    // The backdrop is the last thing seen, through whatever all strokes let through.
    for ((color, transmittance), backdrop) in color
        .iter_mut()
        .zip(transmittances.iter())
        .zip(job.backdrop)
    {
        let t = load(simd, &transmittance.through);
        for (color, backdrop) in color.iter_mut().zip(backdrop) {
            store(load(simd, color) + t * load(simd, backdrop), color);
        }
    }
}

/// Pass 2, over the blocks that pass 1 visited. `scratch.gradient` is given, and `scratch.error` if contribution is asked for;
/// `scratch.color` becomes the colour behind.
#[inline(always)]
fn back_to_front<S: Simd, X: Extras>(
    simd: S,
    job: &TileJob<'_>,
    scratch: &mut Scratch,
    sums: &mut Sums,
) -> [f32; 3] {
    let Scratch {
        color: behind,
        transmittances,
        error,
        gradient,
        visits,
        kept_transmittance,
        kept_edges,
        kept_nearest,
        near,
        mattes,
        inks,
        ..
    } = scratch;
    // Behind the rearmost stroke is the backdrop.
    behind.clone_from(job.backdrop);
    // ∂L/∂backdrop = Σ T·g, with the transmittance of all strokes.
    let mut backdrop = [f32x16::splat(simd, 0.0); 3];
    for (transmittance, g) in transmittances.iter().zip(gradient.iter()) {
        for (sum, g) in backdrop.iter_mut().zip(g) {
            *sum += load(simd, &transmittance.through) * load(simd, g);
        }
    }
    let mut grounds = Grounds {
        behind,
        gradient,
        error,
        mattes,
    };
    // Pass 2 visits the same strokes in reverse, and in each of them the same blocks in the same order.
    for visit in visits.iter().rev() {
        let slot = visit.slot as usize;
        let style = job.style(slot);
        let range = job.range(slot);
        let segments = job.segments(slot, range.clone());
        let near = &near[range];
        let brush = job.brush(simd, slot, visit.edge | visit.core, inks);
        let mut stroke = Looks::new(simd);
        let first = sums.segments.len() as u32;
        // Take back what pass 1 kept: the cursors walk in its order.
        let mut through = kept_transmittance.pop(visit.edge | visit.core).iter();
        let edges = kept_edges.pop(visit.edge);
        let (of_shared, alone) = edges.split_at_mut(visit.shared.count_ones() as usize);
        // Near joints, blend the stroke once, since it has one coverage. Which segment a pixel pulls at is sorted out below.
        for (block, (kept, t)) in members(visit.shared).zip(of_shared.iter_mut().zip(&mut through))
        {
            let (rgb, _) = brush.at(simd, block);
            let (pull, stiffness) = stroke.blend_edge::<X>(simd, kept, t, &rgb, grounds.at(block));
            // The segments need these values; they overwrite values that are used up.
            store(pull, &mut kept.slope);
            if X::STIFFNESS {
                store(stiffness, &mut kept.inverse);
            }
        }
        let of_shared = Kept {
            shared: visit.shared,
            blocks: of_shared,
            nearest: kept_nearest.pop(visit.shared),
        };
        // Give each segment the pull of its own blocks, and of those pixels near joints that it is nearest to.
        let mut alone = alone.iter();
        for (k, near) in near.iter().enumerate() {
            // No visible block of the edge has this segment as a candidate: moving it changes no pixel.
            if near & visit.edge == 0 {
                continue;
            }
            let segment = segments.get(k);
            let mut shifts = Shifts::new(simd);
            let kept = (&mut alone).zip(&mut through);
            for (block, (kept, t)) in members(near & visit.edge & !visit.shared).zip(kept) {
                let (rgb, _) = brush.at(simd, block);
                let (pull, stiffness) =
                    stroke.blend_edge::<X>(simd, kept, t, &rgb, grounds.at(block));
                let nearest = segment.at_pixels(simd, block);
                shifts.pull(pull, nearest.q, nearest.h);
                if X::STIFFNESS {
                    shifts.stiffen(stiffness, nearest.h);
                }
            }
            of_shared.pull::<_, X>(simd, &segment, k, *near, &mut shifts);
            // Segments that were skipped have no row, so a row names its segment by `id`.
            sums.segments.push(OfSegment {
                id: segments.listed[k],
                ends: shifts.ends(),
            });
            if X::STIFFNESS {
                sums.stiffness.push(shifts.stiffness());
            }
        }
        // In the core, coverage does not change with the shape: only colour, opacity and contribution have a part in it.
        for (block, t) in members(visit.core).zip(through) {
            let (rgb, opacity) = brush.at(simd, block);
            stroke.blend::<X>(simd, opacity, load(simd, t), &rgb, grounds.at(block));
        }
        // The sum over `m = o·σ` becomes the derivative by the opacity when divided by it, hence the least opacity.
        sums.strokes.push(OfStroke {
            id: job.listed[slot].stroke,
            first,
            style: stroke.style(
                style[STYLE - 1].max(FAINTEST),
                job.is_area(slot),
                brush.inks.is_some(),
            ),
            contribution: if X::CONTRIBUTIONS {
                stroke.contribution()
            } else {
                0.0
            },
        });
    }
    [total(backdrop[0]), total(backdrop[1]), total(backdrop[2])]
}

/// Pass 1. Leaves the canvas in [`Scratch::canvas`].
pub(super) fn draw(level: Level, job: &TileJob<'_>, scratch: &mut Scratch) {
    match job.edge {
        Edge::Smoothstep(edge) => draw_with(level, edge, job, scratch),
        Edge::Tailed(edge) => draw_with(level, edge, job, scratch),
    }
}

// Not inlined, as LLVM's time grows with the square of a function's length.
#[inline(never)]
fn draw_with<E: SoftEdge>(level: Level, edge: E, job: &TileJob<'_>, scratch: &mut Scratch) {
    dispatch!(level, simd => front_to_back(simd, edge, job, scratch));
}

/// After pass 1: the tile's loss, and the derivatives of it in `sums`, which are empty before.
pub(super) fn differentiate<L: CanvasLoss, X: Extras>(
    level: Level,
    job: &TileJob<'_>,
    loss: &L,
    scratch: &mut Scratch,
    sums: &mut Sums,
) -> TileSums {
    let Scratch {
        color,
        error,
        gradient,
        ..
    } = scratch;
    let value = dispatch!(level, _simd => {
        // Only contributions need the error itself.
        loss.tile(job.tile, color, X::CONTRIBUTIONS.then_some(error), gradient)
    });
    differentiate_canvas::<X>(level, job, value, scratch, sums)
}

/// [`differentiate`] for the sum of two losses: the second is of the canvas on the backdrop `other`.
pub(super) fn differentiate_on_mattes<L: CanvasLoss>(
    level: Level,
    job: &TileJob<'_>,
    other: &TileRgb,
    losses: [&L; 2],
    scratch: &mut Scratch,
    sums: &mut Sums,
) -> TileSums {
    let loss = dispatch!(level, simd => {
        let Scratch { color, gradient, .. } = scratch;
        // The first loss reads the canvas before it becomes the canvas on the second backdrop.
        let first = losses[0].tile(job.tile, color, None, gradient);
        // Both canvases have the same strokes, so that one pass 1 serves both.
        change_backdrop(simd, job.backdrop, other, scratch);
        let Scratch { color, second, .. } = scratch;
        let loss = first + losses[1].tile(job.tile, color, None, second);
        add_second_loss(simd, job.backdrop, other, scratch);
        loss
    });
    differentiate_canvas::<Mattes>(level, job, loss, scratch, sums)
}

// Apart from the losses, so that it is compiled once for all of them.
#[inline(never)]
fn differentiate_canvas<X: Extras>(
    level: Level,
    job: &TileJob<'_>,
    loss: f64,
    scratch: &mut Scratch,
    sums: &mut Sums,
) -> TileSums {
    // Pass 1 kept one transmittance per block it visited. Pass 2 pops them, so count first.
    let blocks = scratch.kept_transmittance.len() as u64;
    let backdrop = dispatch!(level, simd => back_to_front::<_, X>(simd, job, scratch, sums));
    TileSums {
        loss,
        backdrop,
        blocks,
    }
}

/// Turns the canvas on the backdrop `from` into the canvas on `to`.
#[inline(always)]
fn change_backdrop<S: Simd>(simd: S, from: &TileRgb, to: &TileRgb, scratch: &mut Scratch) {
    for (block, transmittance) in scratch.transmittances.iter().enumerate() {
        // C₂ = C₁ + T·(B₂ − B₁): the strokes' own light is the same on both backdrops.
        let through = load(simd, &transmittance.through);
        for (channel, color) in scratch.color[block].iter_mut().enumerate() {
            let change = load(simd, &to[block][channel]) - load(simd, &from[block][channel]);
            store(load(simd, color) + through * change, color);
        }
    }
}

/// Prepares pass 2 for both losses. In front of it, the colours of a stroke are the same on both backdrops, so that the
/// derivatives by the canvases add up, and [`Matte`] has the difference behind it.
#[inline(always)]
fn add_second_loss<S: Simd>(simd: S, first: &TileRgb, other: &TileRgb, scratch: &mut Scratch) {
    let Scratch {
        gradient,
        second,
        mattes,
        ..
    } = scratch;
    for (block, matte) in mattes.iter_mut().enumerate() {
        let mut by_through = f32x16::splat(simd, 0.0);
        for channel in 0..3 {
            let change = load(simd, &other[block][channel]) - load(simd, &first[block][channel]);
            let g = load(simd, &second[block][channel]);
            // On the second backdrop the canvas is the first one plus `T·(B₂ − B₁)`.
            by_through += g * change;
            let sum = &mut gradient[block][channel];
            store(load(simd, sum) + g, sum);
        }
        // At the rearmost stroke the two colours behind differ by the whole difference of the backdrops: `through` is 1.
        *matte = CLEAR;
        store(by_through, &mut matte.gradient);
    }
}
