//! The soft coverage functions in SIMD lanes: `σ(d)` and `σ'(d)` together.
//!
//! The scalar definitions, with their formulas, are in [`crate::coverage`]; here is the same in
//! `f32`, built from add, multiply, divide and select alone, so that every SIMD level gives the
//! same bits (no fused multiply-add, no approximate reciprocal).

use fearless_simd::{f32x16, i32x16, prelude::*};

use crate::coverage::Coverage;

/// A soft edge as the kernels need it.
pub(super) trait SoftEdge: Copy + Send + Sync {
    /// `σ(d)` and `∂σ/∂d`, `d` in px, positive inside.
    fn eval<S: Simd>(self, d: f32x16<S>) -> (f32x16<S>, f32x16<S>);
}

/// Extent of the soft edge on both sides of the outline.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// Coverage is dropped at signed distances below `−outside`, px.
    pub(super) outside: f32,
    /// Coverage is 1 at signed distances above this, px; infinite for functions with tails.
    pub(super) inside: f32,
}

/// Smoothstep on [−s/2, s/2].
#[derive(Debug, Clone, Copy)]
pub(super) struct Smoothstep {
    half: f32,
    slope: f32,
}

impl Smoothstep {
    pub(super) fn new(softness: f32) -> Self {
        Self {
            half: softness / 2.0,
            slope: 1.0 / (softness + 1e-4),
        }
    }
}

impl SoftEdge for Smoothstep {
    #[inline(always)]
    fn eval<S: Simd>(self, d: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
        let t = ((d + self.half) * self.slope).max(0.0).min(1.0);
        // σ = 3t² − 2t³, σ' = 6t(1 − t)/(s + 1e-4). Where t is clamped to 0 or 1, σ' is 0 by itself.
        let t2 = t * t;
        let value = t2 * (3.0 - (t + t));
        let derivative = (t - t2) * (6.0 * self.slope);
        (value, derivative)
    }
}

/// Sigmoid, tanh or atan, cut where coverage falls below the bound of [`Coverage::support`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Tailed {
    kind: Tail,
    /// Multiplies `d`.
    slope: f32,
    outside: f32,
}

#[derive(Debug, Clone, Copy)]
enum Tail {
    /// Also tanh: `tanh(x)/2 + ½ = 1/(1 + exp(−2x))`.
    Logistic,
    Atan,
    Raw,
}

impl Tailed {
    fn new(kind: Tail, slope: f32, outside: f32) -> Self {
        Self {
            kind,
            slope,
            outside,
        }
    }
}

impl SoftEdge for Tailed {
    // Not inlined: in pass 1 at the level without vectors, LLVM took half its time for the crate over it.
    #[inline(never)]
    fn eval<S: Simd>(self, d: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
        d.token().vectorize(
            #[inline(always)]
            || self.eval_inlined(d),
        )
    }
}

impl Tailed {
    #[inline(always)]
    fn eval_inlined<S: Simd>(self, d: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
        let x = d * self.slope;
        let (value, derivative) = match self.kind {
            Tail::Logistic => logistic(x),
            Tail::Atan => arctangent(x),
            Tail::Raw => raw(x),
        };
        let zero = f32x16::splat(d.token(), 0.0);
        // Tails are cut where the blocks that a stroke touches end, or its edge would depend on the grid.
        let kept = d.simd_ge(-self.outside);
        (
            kept.select(value, zero),
            kept.select(derivative * self.slope, zero),
        )
    }
}

/// A coverage function at a softness, ready for the kernels.
#[derive(Debug, Clone, Copy)]
pub(super) enum Edge {
    Smoothstep(Smoothstep),
    Tailed(Tailed),
}

impl Edge {
    /// The edge of `coverage` at `softness` px, with its reach.
    pub(super) fn new(coverage: Coverage, softness: f32) -> (Self, Reach) {
        // Coverage beyond the support is dropped, so that blocks farther away need no visit.
        let outside = coverage.support(f64::from(softness)) as f32;
        let tailed = |kind, slope: f32| Self::Tailed(Tailed::new(kind, slope / softness, outside));
        let edge = match coverage {
            Coverage::Smoothstep => Self::Smoothstep(Smoothstep::new(softness)),
            Coverage::Sigmoid => tailed(Tail::Logistic, 1.0),
            Coverage::Tanh => tailed(Tail::Logistic, 2.0),
            Coverage::Atan { k } => tailed(Tail::Atan, k),
            Coverage::Raw => tailed(Tail::Raw, 1.0),
        };
        let inside = match coverage {
            // t reaches 1 a little past s/2 because of the guard 1e-4 in its denominator.
            Coverage::Smoothstep => softness / 2.0 + 1e-4,
            _ => f32::INFINITY,
        };
        (edge, Reach { outside, inside })
    }
}

/// `clamp(x, −1, 1)/2 + ½` and its derivative by `x`.
#[inline(always)]
fn raw<S: Simd>(x: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
    let simd = x.token();
    let value = x.max(-1.0).min(1.0) * 0.5 + 0.5;
    // The derivative at ±1 is ½, as in `Coverage::derivative`.
    let derivative = x
        .abs()
        .simd_le(1.0)
        .select(f32x16::splat(simd, 0.5), f32x16::splat(simd, 0.0));
    (value, derivative)
}

/// `1/(1 + exp(−x))` and its derivative by `x`.
#[inline(always)]
fn logistic<S: Simd>(x: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
    let value = 1.0 / (exp(-x) + 1.0);
    (value, value * (1.0 - value))
}

/// `exp(x)`, relative error below 3e-7 (Cephes `expf`: two-part ln 2, polynomial of degree 5).
#[inline(always)]
fn exp<S: Simd>(x: f32x16<S>) -> f32x16<S> {
    // 2ⁿ has to stay a normal number: e^±87 is near the ends of f32.
    let x = x.max(-87.0).min(87.0);
    // exp(x) = 2ⁿ·exp(r), with n the whole number nearest to x / ln 2, so that |r| ≤ ln 2 / 2.
    let n = (x * std::f32::consts::LOG2_E + 0.5).floor();
    // ln 2 in two parts: the first has so few bits that n times it is exact, the second is the rest.
    let r = x - n * 0.693_359_4 - n * -2.121_944_4e-4;
    // exp(r) = 1 + r + r²·p(r).
    let mut p = r * 1.987_569_1e-4 + 1.398_2e-3;
    for coefficient in [8.333_452e-3, 4.166_579_6e-2, 1.666_666_5e-1, 0.5] {
        p = p * r + coefficient;
    }
    let power: i32x16<S> = n.to_int();
    // 2ⁿ by its exponent bits.
    let scale: f32x16<S> = ((power + 127) << 23).bitcast();
    (p * r * r + r + 1.0) * scale
}

/// `atan(x)/π + ½` and its derivative by `x` (Cephes `atanf`: reduction at tan π/8 and tan 3π/8).
#[inline(always)]
fn arctangent<S: Simd>(x: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
    let simd = x.token();
    let splat = |v: f32| f32x16::splat(simd, v);
    let size = x.abs();
    let far = size.simd_gt(2.414_213_6);
    let near = size.simd_le(0.414_213_57);
    // Near 0 the series runs in x, beyond tan 3π/8 in −1/x, and between in (x − 1)/(x + 1).
    let reduced = far.select(-1.0 / size.max(1e-30), (size - 1.0) / (size + 1.0));
    let reduced = near.select(size, reduced);
    // The angle that the reduction has taken away: π/2, π/4 or nothing.
    let base = far.select(
        splat(std::f32::consts::FRAC_PI_2),
        splat(std::f32::consts::FRAC_PI_4),
    );
    let base = near.select(splat(0.0), base);
    // atan(r) = r + r³·p(r²), for |r| ≤ tan π/8. The sign comes back last, since atan is odd.
    let z = reduced * reduced;
    let mut p = z * 8.053_744_5e-2 - 1.387_768_6e-1;
    p = p * z + 1.997_771_1e-1;
    p = p * z - 3.333_295e-1;
    let angle = (base + (p * z * reduced + reduced)).copysign(x);
    let value = angle * std::f32::consts::FRAC_1_PI + 0.5;
    (value, std::f32::consts::FRAC_1_PI / (x * x + 1.0))
}
