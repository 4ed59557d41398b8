//! Pass 1 in one block: the coverage of a stroke there, and the transmittance of the strokes so far.

use fearless_simd::{f32x16, mask32x16, prelude::*};

use super::super::edge::SoftEdge;
use super::super::grid::{BlockRgb, Lanes};
use super::lanes::{load, store};
use super::segment::length;
use super::sums::EdgeBlock;

/// Transmittance below which nothing behind shows: a sixty-fourth of an 8-bit level. Four times as
/// much costs gradients of tailed edges their third digit.
const OPAQUE: f32 = 1.0 / 16384.0;

/// Share of the light that the strokes drawn so far let through.
#[derive(Debug, Clone, Copy)]
pub(super) struct Transmittance {
    /// Transmittance of all of them.
    pub(super) through: Lanes,
    /// Largest transmittance that leaving out any one stroke gives.
    less_one: Lanes,
}

impl Transmittance {
    /// Fully transparent where `weights` is 1, on the picture; opaque where it is 0, on the padding.
    pub(super) fn clear(weights: &Lanes) -> Self {
        Self {
            through: *weights,
            less_one: *weights,
        }
    }

    /// Adds one stroke behind the others, and its visible light to `color`. Returns true if nothing behind it can matter
    /// any more.
    #[inline(always)]
    pub(super) fn add<S: Simd>(
        &mut self,
        simd: S,
        alpha: f32x16<S>,
        rgb: &[f32x16<S>; 3],
        color: &mut BlockRgb,
    ) -> bool {
        // C ← C + T·m·c, T ← T − T·m.
        let t = load(simd, &self.through);
        let weight = t * alpha;
        for (color, &c) in color.iter_mut().zip(rgb) {
            store(load(simd, color) + weight * c, color);
        }
        let less_one = load(simd, &self.less_one);
        // The largest transmittance with any one stroke left out: `t` if it is the new one; otherwise that of before,
        // dimmed by the new one. While this shows anything, a contribution still depends on the strokes behind.
        let less_one = (less_one - less_one * alpha).max(t);
        store(t - weight, &mut self.through);
        store(less_one, &mut self.less_one);
        less_one.simd_lt(OPAQUE).all_true()
    }
}

/// One stroke in pass 1.
pub(super) struct Shape<E> {
    pub(super) edge: E,
    /// px; without a meaning for an area.
    pub(super) radius: f32,
    /// Distance from an area's outline, px, beyond which its coverage is 1 inside, as it is 0 outside.
    pub(super) outside: f32,
}

impl<E: SoftEdge> Shape<E> {
    /// `m` in a block on the soft edge, from the squared distances of its pixels, and for an area those of them that are
    /// `inside`, one bit each; writes what is kept of it to `kept`.
    #[inline(always)]
    pub(super) fn cover<S: Simd>(
        &self,
        simd: S,
        opacity: f32x16<S>,
        distance2: f32x16<S>,
        inside: Option<u64>,
        kept: &mut EdgeBlock,
    ) -> f32x16<S> {
        let length = length(distance2);
        // d = r − |q| for a stroke. For an area d = ±|q|, + where the rings wind around the pixel.
        let side = inside.map(|inside| {
            let inside = mask32x16::from_bitmask(simd, inside);
            inside.select(f32x16::splat(simd, 1.0), f32x16::splat(simd, -1.0))
        });
        let d = match side {
            None => self.radius - length,
            Some(side) => side * length,
        };
        let (mut value, mut derivative) = self.edge.eval(d);
        if let Some(side) = side {
            // Core blocks have coverage 1, so edge blocks have to have it from the same depth on, or a tail's edge would depend on
            // the grid.
            let is_deep = d.simd_gt(self.outside);
            value = is_deep.select(f32x16::splat(simd, 1.0), value);
            derivative = is_deep.select(f32x16::splat(simd, 0.0), derivative);
            // Pass 2 has the derivatives of −|q| by the segment, which is the distance outside alone.
            derivative = -side * derivative;
        }
        let alpha = opacity * value;
        store(alpha, &mut kept.alpha);
        store(opacity * derivative, &mut kept.slope);
        // Pass 2 would have to take the root again.
        store(1.0 / length, &mut kept.inverse);
        alpha
    }
}
