//! AdamW: [`Adam`] with weight decay applied to the values directly, not through the averages.
//!
//! ```text
//! x ← x − rate·λ·x, then a step of Adam
//! ```
//!
//! The decay pulls every value towards 0. For positions, 0 is a corner of the picture; for radii and
//! opacities, it is an invisible stroke.
//!
//! Source: Loshchilov & Hutter, "Decoupled weight decay regularization", ICLR 2019, algorithm 2,
//! with the decay multiplied by the learning rate, as in `torch.optim.AdamW`.

use std::ops::Range;

use super::adam::square;
use super::{Adam, AdamParams, Optimizer};
use crate::math::Real;

/// Parameters of AdamW besides the learning rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdamWParams {
    /// Those of the step of Adam.
    pub adam: AdamParams,
    /// λ, the fraction by which a value shrinks per step at a learning rate of 1.
    pub decay: f64,
}

impl Default for AdamWParams {
    fn default() -> Self {
        Self {
            adam: AdamParams::default(),
            decay: 0.01,
        }
    }
}

/// The AdamW optimiser.
#[derive(Debug, Clone)]
pub struct AdamW<T> {
    decay: f64,
    adam: Adam<T>,
}

impl<T: Real> AdamW<T> {
    /// An optimiser of `len` values.
    pub fn new(len: usize, params: AdamWParams) -> Self {
        Self {
            decay: params.decay,
            adam: Adam::new(len, params.adam),
        }
    }
}

impl<T: Real> Optimizer<T> for AdamW<T> {
    fn step(&mut self, params: &mut [T], gradients: &[T], rate: T) {
        let keep = T::one() - rate * T::of(self.decay);
        self.adam
            .update(params, gradients, |_| rate, |_| keep, square);
    }

    fn step_scaled(&mut self, params: &mut [T], gradients: &[T], rate: T, scales: &[T]) {
        let n = scales.len().min(params.len());
        let (scales, decay) = (&scales[..n], T::of(self.decay));
        let rate = |i: usize| rate * scales[i];
        let keep = |i: usize| T::one() - rate(i) * decay;
        self.adam
            .update(&mut params[..n], gradients, rate, keep, square);
    }

    fn reset(&mut self, range: Range<usize>) {
        self.adam.reset(range);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decay_is_decoupled_from_the_step() {
        let (mut plain, mut decayed) = ([2.0], [2.0]);
        let mut adam = Adam::new(1, AdamParams::default());
        let mut adamw = AdamW::new(1, AdamWParams::default());
        adam.step(&mut plain, &[5.0], 0.1);
        adamw.step(&mut decayed, &[5.0], 0.1);
        let lost: f64 = plain[0] - decayed[0];
        assert!((lost - 2.0 * 0.1 * 0.01).abs() < 1e-15, "{lost}");
    }

    #[test]
    fn decay_follows_the_scale_of_the_rate() {
        let mut x = [2.0, 2.0];
        let mut adamw = AdamW::new(2, AdamWParams::default());
        adamw.step_scaled(&mut x, &[0.0, 0.0], 0.1, &[1.0, 3.0]);
        assert_eq!(
            x,
            [2.0 * (1.0 - 0.1 * 0.01), 2.0 * (1.0 - 0.1 * 3.0 * 0.01)]
        );
    }

    #[test]
    fn without_decay_it_is_adam() {
        let (mut x, mut y) = ([2.0_f32, -1.0], [2.0_f32, -1.0]);
        let params = AdamWParams {
            decay: 0.0,
            ..Default::default()
        };
        let mut adam = Adam::new(2, AdamParams::default());
        let mut adamw = AdamW::new(2, params);
        for i in 0..10 {
            let gradients = [i as f32 - 4.0, 0.3];
            adam.step(&mut x, &gradients, 0.1);
            adamw.step(&mut y, &gradients, 0.1);
            adamw.reset(1..2);
            adam.reset(1..2);
        }
        assert_eq!(x, y);
    }
}
