//! What pass 2 sums up over a tile: the derivatives of one stroke's look, and of the ends of one segment.

use fearless_simd::{f32x16, prelude::*};

use super::super::grid::{BLOCKS, BlockRgb, Lanes, TileRgb};
use super::super::strokes::LOOK;
use super::lanes::{load, store, total};

/// `∂L` of the look of one stroke over one tile, then its worth.
pub(in crate::render) type LookSums = [f32; LOOK + 1];
/// Index of the leave-one-out change of the squared error.
pub(in crate::render) const WORTH: usize = LOOK;
/// `∂L` of the two ends of one segment over one tile, then the stiffness of each.
pub(in crate::render) type EndSums = [f32; 6];

/// What pass 1 keeps of a block on the soft edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeBlock {
    /// `m = o·σ(d)`.
    pub(super) alpha: Lanes,
    /// `o·σ'(d)`.
    pub(super) slope: Lanes,
    /// `1/|q|`.
    pub(super) inverse: Lanes,
}

/// What is asked for besides derivatives.
pub(in crate::render) trait Extras: Sync {
    /// Every stroke's worth.
    const WORTH: bool;
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
    const WORTH: bool = false;
    const STIFFNESS: bool = false;
    const MATTES: bool = false;
}

impl Extras for Worths {
    const WORTH: bool = true;
    const STIFFNESS: bool = false;
    const MATTES: bool = false;
}

impl Extras for Stiffnesses {
    const WORTH: bool = false;
    const STIFFNESS: bool = true;
    const MATTES: bool = false;
}

impl Extras for Mattes {
    const WORTH: bool = false;
    const STIFFNESS: bool = false;
    const MATTES: bool = true;
}

/// What tells the canvas on a second backdrop from that on the first, in one block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Matte {
    /// Transmittance of the strokes behind.
    pub(super) through: Lanes,
    /// The derivative of the second loss by the transmittance of all strokes: `Σ ∂L/∂canvas` times the difference between
    /// the backdrops.
    pub(super) gradient: Lanes,
}

/// What a stroke is laid on in a tile.
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

/// What a stroke is laid on in one block.
pub(super) struct Ground<'a> {
    behind: &'a mut BlockRgb,
    gradient: &'a BlockRgb,
    error: &'a BlockRgb,
    matte: &'a mut Matte,
}

/// Sums of one stroke in lanes.
pub(super) struct Sums<S: Simd> {
    color: [f32x16<S>; 3],
    opacity: f32x16<S>,
    radius: f32x16<S>,
    worth: f32x16<S>,
}

impl<S: Simd> Sums<S> {
    #[inline(always)]
    pub(super) fn new(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        Self {
            color: [zero; 3],
            opacity: zero,
            radius: zero,
            worth: zero,
        }
    }

    /// Lays the stroke on what is behind it in one block; returns `∂L/∂m`, and `|c − B|²` if stiffness is asked for.
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
        let seen = t * alpha;
        let (mut along, mut change, mut contrast2) = (zero, zero, zero);
        for channel in 0..3 {
            let back = load(simd, &behind[channel]);
            let contrast = rgb[channel] - back;
            let g = load(simd, &gradient[channel]);
            along += g * contrast;
            self.color[channel] += seen * g;
            store(back + alpha * contrast, &mut behind[channel]);
            if X::WORTH {
                // This `delta` is −δ of the head, hence the minus before 2e.
                let delta = seen * contrast;
                let e = load(simd, &error[channel]);
                change += delta * (delta - (e + e));
            }
            if X::STIFFNESS {
                contrast2 += contrast * contrast;
            }
        }
        if X::WORTH {
            self.worth += change;
        }
        if X::MATTES {
            // The second colour behind is the first one and `through` times the difference between the backdrops.
            let through = load(simd, &matte.through);
            along -= load(simd, &matte.gradient) * through;
            store(through - alpha * through, &mut matte.through);
        }
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
        let slope = load(simd, &kept.slope);
        let d_distance = d_alpha * slope;
        self.radius += d_distance;
        // Pass 1 kept 1/|q|, which costs a root; `q` is computed again.
        let pull = d_distance * load(simd, &kept.inverse);
        let seen = t * slope;
        (pull, 2.0 * (seen * seen) * contrast2)
    }

    #[inline(always)]
    pub(super) fn finish(&self, opacity: f32) -> LookSums {
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

    #[inline(always)]
    pub(super) fn finish<X: Extras>(&self) -> EndSums {
        let (bx, by) = (total(self.of_b[0]), total(self.of_b[1]));
        let [ax, ay] = [total(self.whole[0]) - bx, total(self.whole[1]) - by];
        let (mut of_a, mut of_b) = (0.0, 0.0);
        if X::STIFFNESS {
            of_b = total(self.stiffness[1]);
            of_a = total(self.stiffness[0]) - of_b;
        }
        [ax, ay, bx, by, of_a, of_b]
    }
}
