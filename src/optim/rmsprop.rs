//! RMSprop: gradients divided by their root mean square, with momentum.
//!
//! ```text
//! v ← αv + (1−α)g²
//! b ← μb + g / (√v + ε)
//! x ← x − rate·b
//! ```
//!
//! The average starts from 0 without a correction, so the first step is `1/√(1−α)` times as long as
//! later steps with the same gradient.
//!
//! Domain: finite gradients, `0 ≤ α, μ < 1`, `ε > 0`. A value whose gradient is always 0 does not move.
//!
//! Source: Tieleman & Hinton, "Lecture 6.5: RMSProp", COURSERA: Neural Networks for Machine
//! Learning, 2012, with ε outside the root and the momentum buffer as in `torch.optim.RMSprop`.

use std::ops::Range;

use super::{Optimizer, clip};
use crate::math::Real;

/// Parameters of RMSprop besides the learning rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RmsPropParams {
    /// α, decay of the mean squared gradient, in 0..1.
    pub alpha: f64,
    /// μ, the share of the previous step that is repeated, in 0..1.
    pub momentum: f64,
    /// Added to the root mean square.
    pub eps: f64,
}

impl Default for RmsPropParams {
    fn default() -> Self {
        Self {
            alpha: 0.99,
            momentum: 0.0,
            eps: 1e-8,
        }
    }
}

/// The RMSprop optimiser.
#[derive(Debug, Clone)]
pub struct RmsProp<T> {
    params: RmsPropParams,
    square: Vec<T>,
    buffer: Vec<T>,
}

impl<T: Real> RmsProp<T> {
    /// An optimiser of `len` values.
    pub fn new(len: usize, params: RmsPropParams) -> Self {
        Self {
            params,
            square: vec![T::zero(); len],
            buffer: vec![T::zero(); len],
        }
    }

    #[inline]
    fn update(&mut self, params: &mut [T], gradients: &[T], rate: impl Fn(usize) -> T) {
        let (keep, take) = (T::of(self.params.alpha), T::of(1.0 - self.params.alpha));
        let (momentum, eps) = (T::of(self.params.momentum), T::of(self.params.eps));
        // Slices of known equal length let the compiler vectorise the loop.
        let n = self.square.len().min(params.len()).min(gradients.len());
        let (params, gradients) = (&mut params[..n], &gradients[..n]);
        let (square, buffer) = (&mut self.square[..n], &mut self.buffer[..n]);
        for i in 0..n {
            let g = gradients[i];
            square[i] = keep * square[i] + take * g * g;
            buffer[i] = momentum * buffer[i] + g / (square[i].sqrt() + eps);
            params[i] -= rate(i) * buffer[i];
        }
    }
}

impl<T: Real> Optimizer<T> for RmsProp<T> {
    fn step(&mut self, params: &mut [T], gradients: &[T], rate: T) {
        self.update(params, gradients, |_| rate);
    }

    fn step_scaled(&mut self, params: &mut [T], gradients: &[T], rate: T, scales: &[T]) {
        let n = scales.len().min(params.len());
        let scales = &scales[..n];
        self.update(&mut params[..n], gradients, |i| rate * scales[i]);
    }

    fn reset(&mut self, range: Range<usize>) {
        let range = clip(range, self.square.len());
        self.square[range.clone()].fill(T::zero());
        self.buffer[range].fill(T::zero());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARAMS: RmsPropParams = RmsPropParams {
        alpha: 0.9,
        momentum: 0.5,
        eps: 1e-3,
    };

    #[test]
    fn two_steps_by_hand() {
        let mut x = [1.0];
        let mut rmsprop = RmsProp::new(1, PARAMS);
        rmsprop.step(&mut x, &[2.0], 0.1);
        let first = 2.0 / (0.4_f64.sqrt() + 1e-3);
        assert!((x[0] - (1.0 - 0.1 * first)).abs() < 1e-15);
        rmsprop.step(&mut x, &[-1.0], 0.1);
        let second = 0.5 * first - 1.0 / (0.46_f64.sqrt() + 1e-3);
        assert!((x[0] - (1.0 - 0.1 * first - 0.1 * second)).abs() < 1e-15);
    }

    #[test]
    fn rates_scale_per_value_and_values_reset() {
        let mut x = [1.0, 1.0];
        let mut rmsprop = RmsProp::new(2, PARAMS);
        rmsprop.step_scaled(&mut x, &[2.0, 2.0], 0.1, &[1.0, 2.0]);
        let first: f64 = 1.0 - x[0];
        assert!((1.0 - x[1] - 2.0 * first).abs() < 1e-15);
        rmsprop.reset(0..1);
        let before = x[0];
        rmsprop.step(&mut x, &[2.0, 2.0], 0.1);
        assert!((before - x[0] - first).abs() < 1e-15);
    }

    #[test]
    fn no_gradient_no_motion() {
        let mut x = [0.7_f32];
        RmsProp::new(1, PARAMS).step(&mut x, &[0.0], 0.1);
        assert_eq!(x, [0.7]);
    }
}
