//! The optimisers that the article compares with [`Adam`]: AdamW and RMSprop, with `PyTorch`'s update formulas.
//!
//! ```text
//! AdamW      x ← x − rate·λ·x, then a step of Adam
//!
//! RMSprop    v ← αv + (1−α)g²
//!            b ← μb + g / (√v + ε)
//!            x ← x − rate·b
//! ```
//!
//! AdamW's decay pulls every value towards 0. For positions, 0 is a corner of the picture; for radii, it is an invisible stroke.
//! RMSprop's average starts from 0 without a correction, so the first step is `1/√(1−α)` times as long as later steps with the same
//! gradient.
//!
//! Domain: finite gradients, `0 ≤ α, μ < 1`, `ε > 0`. A value whose gradient is always 0 does not move.
//!
//! Sources: Loshchilov & Hutter, "Decoupled weight decay regularization", ICLR 2019, algorithm 2, with the decay multiplied by the
//! learning rate, as in `torch.optim.AdamW`. Tieleman & Hinton, "Lecture 6.5: RMSProp", COURSERA: Neural Networks for Machine
//! Learning, 2012, with ε outside the root and the momentum buffer as in `torch.optim.RMSprop`.

use strokefit::math::Real;
use strokefit::optim::{Adam, AdamParams};

/// The interface of all optimisers.
pub trait Optimizer<T: Real> {
    /// Moves `params` with the learning rate `rate · scales[i]` for value `i`.
    fn step_scaled(&mut self, params: &mut [T], gradients: &[T], rate: T, scales: &[T]);
}

impl<T: Real> Optimizer<T> for Adam<T> {
    fn step_scaled(&mut self, params: &mut [T], gradients: &[T], rate: T, scales: &[T]) {
        Self::step_scaled(self, params, gradients, rate, scales);
    }
}

/// Parameters of AdamW besides the learning rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdamWParams {
    /// Those of the step of Adam.
    pub adam: AdamParams,
    /// λ, the fraction by which a value shrinks per step at a learning rate of 1.
    pub decay: f64,
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
    fn step_scaled(&mut self, params: &mut [T], gradients: &[T], rate: T, scales: &[T]) {
        let decay = T::of(self.decay);
        for (value, &scale) in params.iter_mut().zip(scales) {
            *value *= T::one() - rate * scale * decay;
        }
        self.adam.step_scaled(params, gradients, rate, scales);
    }
}

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
}

impl<T: Real> Optimizer<T> for RmsProp<T> {
    fn step_scaled(&mut self, params: &mut [T], gradients: &[T], rate: T, scales: &[T]) {
        let (keep, take) = (T::of(self.params.alpha), T::of(1.0 - self.params.alpha));
        let (momentum, eps) = (T::of(self.params.momentum), T::of(self.params.eps));
        let values = params.iter_mut().zip(gradients).zip(scales);
        let state = self.square.iter_mut().zip(&mut self.buffer);
        for (((value, &g), &scale), (square, buffer)) in values.zip(state) {
            *square = keep * *square + take * g * g;
            *buffer = momentum * *buffer + g / (square.sqrt() + eps);
            *value -= rate * scale * *buffer;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_decay(decay: f64) -> AdamWParams {
        AdamWParams {
            adam: AdamParams::default(),
            decay,
        }
    }

    #[test]
    fn decay_follows_the_scale_of_the_rate() {
        let mut x = [2.0, 2.0];
        let mut adamw = AdamW::new(2, of_decay(0.01));
        adamw.step_scaled(&mut x, &[0.0, 0.0], 0.1, &[1.0, 3.0]);
        assert_eq!(
            x,
            [2.0 * (1.0 - 0.1 * 0.01), 2.0 * (1.0 - 0.1 * 3.0 * 0.01)]
        );
    }

    #[test]
    fn without_decay_it_is_adam() {
        let (mut x, mut y) = ([2.0_f32, -1.0], [2.0_f32, -1.0]);
        let mut adam = Adam::new(2, AdamParams::default());
        let mut adamw = AdamW::new(2, of_decay(0.0));
        for i in 0..10 {
            let gradients = [i as f32 - 4.0, 0.3];
            adam.step_scaled(&mut x, &gradients, 0.1, &[1.0; 2]);
            adamw.step_scaled(&mut y, &gradients, 0.1, &[1.0; 2]);
        }
        assert_eq!(x, y);
    }

    #[test]
    fn two_steps_of_rmsprop_by_hand() {
        let mut x = [1.0_f64, 1.0];
        let params = RmsPropParams {
            alpha: 0.9,
            momentum: 0.5,
            eps: 1e-3,
        };
        let mut rmsprop = RmsProp::new(2, params);
        rmsprop.step_scaled(&mut x, &[2.0, 2.0], 0.1, &[1.0, 2.0]);
        let first = 2.0 / (0.4_f64.sqrt() + 1e-3);
        assert!((x[0] - (1.0 - 0.1 * first)).abs() < 1e-15);
        assert!((x[1] - (1.0 - 0.2 * first)).abs() < 1e-15);
        rmsprop.step_scaled(&mut x, &[-1.0, 0.0], 0.1, &[1.0, 2.0]);
        let second = 0.5 * first - 1.0 / (0.46_f64.sqrt() + 1e-3);
        assert!((x[0] - (1.0 - 0.1 * first - 0.1 * second)).abs() < 1e-15);
    }
}
