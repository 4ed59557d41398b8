//! Sums of pass 2 over a tile: the derivatives of strokes' looks, and of the ends of segments.

use fearless_simd::{f32x16, prelude::*};

use super::super::grid::{BLOCKS, BlockRgb, Lanes, TileRgb};
use super::super::polylines::Polylines;
use super::super::strokes::STYLE;
use super::lanes::{load, store, total};
use super::touching::Listed;

/// Results of pass 2 in one tile, for the strokes and segments that it visits, in drawing order.
#[derive(Debug, Default)]
pub(in crate::render) struct Sums {
    pub(in crate::render) strokes: Vec<OfStroke>,
    pub(in crate::render) segments: Vec<OfSegment>,
    /// The stiffness at both ends of each segment, if it is asked for.
    pub(in crate::render) stiffness: Vec<[f32; 2]>,
}

/// The sums of one stroke over one tile.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct OfStroke {
    pub(in crate::render) id: u32,
    /// The index of its first segment in [`Sums::segments`].
    pub(in crate::render) first: u32,
    /// `∂L` of its style.
    pub(in crate::render) style: [f32; STYLE],
    /// The leave-one-out change of the squared error, if it is asked for.
    pub(in crate::render) contribution: f32,
}

/// The sums of one segment over one tile.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct OfSegment {
    /// Its first vertex.
    pub(in crate::render) id: u32,
    /// `∂L` of its two ends.
    pub(in crate::render) ends: [[f32; 2]; 2],
}

impl Sums {
    /// Lists the strokes of a tile that each cover it as a whole, in one colour, without sums so far. Returns false if there are
    /// others.
    pub(in crate::render) fn list_layers(
        &mut self,
        listed: &[Listed],
        polylines: &Polylines,
    ) -> bool {
        for &Listed { stroke, fills, .. } in listed {
            // A gradient has several colours in the tile, so the tile isn't uniform.
            if !fills || polylines.ink(stroke as usize).is_some() {
                self.strokes.clear();
                return false;
            }
            self.strokes.push(OfStroke {
                id: stroke,
                // No segment comes near the tile, so the list of segment sums is empty.
                first: 0,
                style: [0.0; STYLE],
                contribution: 0.0,
            });
        }
        true
    }

    pub(in crate::render) fn clear(&mut self) {
        self.strokes.clear();
        self.segments.clear();
        self.stiffness.clear();
    }
}

/// A block on the soft edge, as pass 1 keeps it for pass 2.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeBlock {
    /// `m = o·σ(d)`.
    pub(super) alpha: Lanes,
    /// `o·σ'(d)`.
    pub(super) slope: Lanes,
    /// `1/|q|`.
    pub(super) inverse: Lanes,
}

impl EdgeBlock {
    /// Nothing kept yet.
    pub(super) const EMPTY: Self = Self {
        alpha: Lanes::splat(0.0),
        slope: Lanes::splat(0.0),
        inverse: Lanes::splat(0.0),
    };
}

/// Results that are asked for besides derivatives.
pub(in crate::render) trait Extras: Sync {
    /// Every stroke's contribution.
    const CONTRIBUTIONS: bool;
    /// Every vertex's stiffness.
    const STIFFNESS: bool;
    /// The derivatives of two losses at once, each of the canvas on its own backdrop.
    const MATTES: bool;
}

/// Derivatives alone.
pub(in crate::render) struct Nothing;
/// Worths, too.
pub(in crate::render) struct Worths;
/// Stiffnesses, too.
pub(in crate::render) struct Stiffnesses;
/// Derivatives of two losses at once.
pub(in crate::render) struct Mattes;

impl Extras for Nothing {
    const CONTRIBUTIONS: bool = false;
    const STIFFNESS: bool = false;
    const MATTES: bool = false;
}

impl Extras for Worths {
    const CONTRIBUTIONS: bool = true;
    const STIFFNESS: bool = false;
    const MATTES: bool = false;
}

impl Extras for Stiffnesses {
    const CONTRIBUTIONS: bool = false;
    const STIFFNESS: bool = true;
    const MATTES: bool = false;
}

impl Extras for Mattes {
    const CONTRIBUTIONS: bool = false;
    const STIFFNESS: bool = false;
    const MATTES: bool = true;
}

/// Difference between the canvases on a second backdrop and on the first, in one block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Matte {
    /// Transmittance of the strokes behind.
    pub(super) through: Lanes,
    /// The derivative of the second loss by the transmittance of all strokes: `Σ ∂L/∂canvas` times the difference between
    /// the backdrops.
    pub(super) gradient: Lanes,
}

/// The tile that a stroke is laid on.
pub(super) struct Grounds<'a> {
    /// The colours behind the stroke.
    pub(super) behind: &'a mut TileRgb,
    /// `∂L/∂canvas`.
    pub(super) gradient: &'a TileRgb,
    /// `canvas − target`.
    pub(super) error: &'a TileRgb,
    pub(super) mattes: &'a mut [Matte; BLOCKS],
}

impl Grounds<'_> {
    #[inline(always)]
    pub(super) fn at(&mut self, block: usize) -> Ground<'_> {
        Ground {
            behind: &mut self.behind[block],
            gradient: &self.gradient[block],
            error: &self.error[block],
            matte: &mut self.mattes[block],
        }
    }
}

/// The block that a stroke is laid on.
pub(super) struct Ground<'a> {
    behind: &'a mut BlockRgb,
    gradient: &'a BlockRgb,
    error: &'a BlockRgb,
    matte: &'a mut Matte,
}

/// Sums of one stroke in lanes.
pub(super) struct Looks<S: Simd> {
    color: [f32x16<S>; 3],
    opacity: f32x16<S>,
    radius: f32x16<S>,
    contribution: f32x16<S>,
}

impl<S: Simd> Looks<S> {
    #[inline(always)]
    pub(super) fn new(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        Self {
            color: [zero; 3],
            opacity: zero,
            radius: zero,
            contribution: zero,
        }
    }

    /// Lays the stroke on the colours behind it in one block; returns `∂L/∂m`, and `|c − B|²` if stiffness is asked for.
    #[inline(always)]
    pub(super) fn blend<X: Extras>(
        &mut self,
        simd: S,
        alpha: f32x16<S>,
        t: f32x16<S>,
        rgb: &[f32x16<S>; 3],
        ground: Ground<'_>,
    ) -> (f32x16<S>, f32x16<S>) {
        let Ground {
            behind,
            gradient,
            error,
            matte,
        } = ground;
        let zero = f32x16::splat(simd, 0.0);
        // T·m: the share of the pixel's light that comes from this stroke.
        let seen = t * alpha;
        // `along` becomes g·(c − B), `change` the stroke's part in contribution, `contrast2` |c − B|².
        let (mut along, mut change, mut contrast2) = (zero, zero, zero);
        for channel in 0..3 {
            let back = load(simd, &behind[channel]);
            let contrast = rgb[channel] - back;
            let g = load(simd, &gradient[channel]);
            along += g * contrast;
            self.color[channel] += seen * g;
            // The next stroke has this one behind it.
            store(back + alpha * contrast, &mut behind[channel]);
            if X::CONTRIBUTIONS {
                // This `delta` is −δ of the head, hence the minus before 2e.
                let delta = seen * contrast;
                let e = load(simd, &error[channel]);
                change += delta * (delta - (e + e));
            }
            if X::STIFFNESS {
                contrast2 += contrast * contrast;
            }
        }
        if X::CONTRIBUTIONS {
            self.contribution += change;
        }
        if X::MATTES {
            // The second colour behind is the first one and `through` times the difference between the backdrops.
            let through = load(simd, &matte.through);
            along -= load(simd, &matte.gradient) * through;
            store(through - alpha * through, &mut matte.through);
        }
        // ∂L/∂m. The sum for the opacity has a factor m, which the caller divides out.
        let d_alpha = t * along;
        self.opacity += d_alpha * alpha;
        (d_alpha, contrast2)
    }

    /// Lays the stroke on a block of its soft edge; returns `pull`, which times `q` is `∂L/∂d · u`, and the stiffness if that
    /// is asked for.
    #[inline(always)]
    pub(super) fn blend_edge<X: Extras>(
        &mut self,
        simd: S,
        kept: &EdgeBlock,
        t: &Lanes,
        rgb: &[f32x16<S>; 3],
        ground: Ground<'_>,
    ) -> (f32x16<S>, f32x16<S>) {
        let (alpha, t) = (load(simd, &kept.alpha), load(simd, t));
        let (d_alpha, contrast2) = self.blend::<X>(simd, alpha, t, rgb, ground);
        // ∂L/∂d = ∂L/∂m · o·σ'(d), and ∂d/∂r = 1.
        let slope = load(simd, &kept.slope);
        let d_distance = d_alpha * slope;
        self.radius += d_distance;
        // Pass 1 kept 1/|q|, which costs a root; `q` is computed again.
        let pull = d_distance * load(simd, &kept.inverse);
        // k = 2|∂C/∂d|², the bound of the second derivative that the reference explains.
        let seen = t * slope;
        (pull, 2.0 * (seen * seen) * contrast2)
    }

    /// `∂L` of the style of a stroke of this opacity. An area has no radius to be changed, and one with a gradient no
    /// colour.
    #[inline(always)]
    pub(super) fn style(&self, opacity: f32, is_area: bool, has_ink: bool) -> [f32; STYLE] {
        let [red, green, blue] = self.color;
        let [red, green, blue] = [total(red), total(green), total(blue)];
        [
            if is_area { 0.0 } else { total(self.radius) },
            if has_ink { 0.0 } else { red },
            if has_ink { 0.0 } else { green },
            if has_ink { 0.0 } else { blue },
            total(self.opacity) / opacity,
        ]
    }

    /// The leave-one-out change of the squared error.
    #[inline(always)]
    pub(super) fn contribution(&self) -> f32 {
        total(self.contribution)
    }
}

/// Sums of one segment in lanes.
pub(super) struct Shifts<S: Simd> {
    /// `Σ ∂L/∂d · u`.
    whole: [f32x16<S>; 2],
    /// `Σ ∂L/∂d · u · h`.
    of_b: [f32x16<S>; 2],
    /// `Σ k` and `Σ k · h`, where k is twice the squared derivative of the canvas by the distance.
    stiffness: [f32x16<S>; 2],
}

impl<S: Simd> Shifts<S> {
    #[inline(always)]
    pub(super) fn new(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        Self {
            whole: [zero; 2],
            of_b: [zero; 2],
            stiffness: [zero; 2],
        }
    }

    /// Adds a block in which `∂L/∂d · u` is `pull · q`.
    #[inline(always)]
    pub(super) fn pull(&mut self, pull: f32x16<S>, q: [f32x16<S>; 2], h: f32x16<S>) {
        for (axis, &q) in q.iter().enumerate() {
            // Both ends move the nearest point: b by the share h, a by 1 − h.
            let shift = pull * q;
            self.whole[axis] += shift;
            self.of_b[axis] += shift * h;
        }
    }

    /// Adds a block of stiffness `k`.
    #[inline(always)]
    pub(super) fn stiffen(&mut self, k: f32x16<S>, h: f32x16<S>) {
        self.stiffness[0] += k;
        self.stiffness[1] += k * h;
    }

    /// `∂L` of both ends.
    #[inline(always)]
    pub(super) fn ends(&self) -> [[f32; 2]; 2] {
        let of_b = [total(self.of_b[0]), total(self.of_b[1])];
        let whole = [total(self.whole[0]), total(self.whole[1])];
        // The shares of both ends are 1 − h and h, so that one product is enough.
        let of_a = [whole[0] - of_b[0], whole[1] - of_b[1]];
        [of_a, of_b]
    }

    /// The stiffness at both ends.
    #[inline(always)]
    pub(super) fn stiffness(&self) -> [f32; 2] {
        // As in `ends`: the shares of k are 1 − h and h.
        let of_b = total(self.stiffness[1]);
        [total(self.stiffness[0]) - of_b, of_b]
    }
}
