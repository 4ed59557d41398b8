//! Small problems and their descent: a loss of a few numbers, an optimiser, some hundred steps.
//!
//! The article compares [`Adam`] with AdamW and RMSprop, by `PyTorch`'s formulas:
//!
//! ```text
//! AdamW      x ← x − rate·λ·x, then a step of Adam
//!
//! RMSprop    v ← αv + (1−α)g²
//!            b ← μb + g / (√v + ε)
//!            x ← x − rate·b
//! ```
//!
//! AdamW's decay pulls every value towards 0: for positions a corner of the picture, for radii an invisible stroke. RMSprop's
//! average starts from 0 without a correction, so its first step is `1/√(1−α)` times as long as later ones.
//!
//! Sources: Loshchilov & Hutter, "Decoupled weight decay regularization", ICLR 2019, algorithm 2, with the decay multiplied by the
//! learning rate, as in `torch.optim.AdamW`. Tieleman & Hinton, "Lecture 6.5: RMSProp", COURSERA: Neural Networks for Machine
//! Learning, 2012, with ε outside the root and the momentum buffer as in `torch.optim.RMSprop`.

use std::fmt;

use strokefit::math::Real;
use strokefit::optim::{Adam, AdamParams};

/// Something to make small.
pub trait Problem<T: Real> {
    /// The loss at `params`; its derivatives are written over `gradient`.
    fn evaluate(&self, params: &[T], gradient: &mut [T]) -> f64;

    /// Puts `params` back into their domain; called before each evaluation.
    fn clamp(&self, _params: &mut [T]) {}

    /// The learning rate of each of the `len` numbers, as a factor.
    fn scales(&self, len: usize) -> Vec<T> {
        vec![T::one(); len]
    }
}

/// An optimiser and its learning rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Adam.
    Adam(f64),
    /// AdamW with a decay of 0.01.
    AdamW(f64),
    /// RMSprop.
    RmsProp(f64),
}

/// The article's parameters of Adam and AdamW in the small experiments.
const ADAM: AdamParams = AdamParams {
    betas: [0.95, 0.999],
    eps: 1e-8,
};

/// λ, the fraction by which AdamW shrinks a value per step at a learning rate of 1.
const DECAY: f64 = 0.01;

/// RMSprop's α, decay of the mean squared gradient; μ, the share of the step before that is repeated; and ε.
const ALPHA: f64 = 0.99;
const MOMENTUM: f64 = 0.5;
const EPS: f64 = 1e-8;

/// `adam`, `adamw` or `rmsprop`.
impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Adam(_) => "adam",
            Self::AdamW(_) => "adamw",
            Self::RmsProp(_) => "rmsprop",
        })
    }
}

/// An optimiser under way.
struct Optimizer<T> {
    method: Method,
    scales: Vec<T>,
    adam: Adam<T>,
    /// RMSprop's mean squared gradients, and its last steps.
    square: Vec<T>,
    buffer: Vec<T>,
}

impl<T: Real> Optimizer<T> {
    fn new(method: Method, scales: Vec<T>) -> Self {
        let len = scales.len();
        Self {
            method,
            scales,
            adam: Adam::new(len, ADAM),
            square: vec![T::zero(); len],
            buffer: vec![T::zero(); len],
        }
    }

    fn step(&mut self, params: &mut [T], gradient: &[T]) {
        match self.method {
            Method::Adam(rate) => self.step_of_adam(params, gradient, T::of(rate)),
            Method::AdamW(rate) => {
                let rate = T::of(rate);
                for (value, &scale) in params.iter_mut().zip(&self.scales) {
                    *value *= T::one() - rate * scale * T::of(DECAY);
                }
                self.step_of_adam(params, gradient, rate);
            }
            Method::RmsProp(rate) => self.step_of_rmsprop(params, gradient, T::of(rate)),
        }
    }

    fn step_of_adam(&mut self, params: &mut [T], gradient: &[T], rate: T) {
        self.adam.step_scaled(params, gradient, rate, &self.scales);
    }

    fn step_of_rmsprop(&mut self, params: &mut [T], gradient: &[T], rate: T) {
        let (keep, take) = (T::of(ALPHA), T::of(1.0 - ALPHA));
        let values = params.iter_mut().zip(gradient).zip(&self.scales);
        let state = self.square.iter_mut().zip(&mut self.buffer);
        for (((value, &g), &scale), (square, buffer)) in values.zip(state) {
            *square = keep * *square + take * g * g;
            *buffer = T::of(MOMENTUM) * *buffer + g / (square.sqrt() + T::of(EPS));
            *value -= rate * scale * *buffer;
        }
    }
}

/// Course of a descent.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory<T> {
    /// The loss before each step and, last, after all of them.
    pub losses: Vec<f64>,
    /// The numbers at each of the losses.
    pub params: Vec<Vec<T>>,
}

impl<T> Trajectory<T> {
    /// The loss after `step` steps, or after the last one.
    pub fn loss_at(&self, step: usize) -> f64 {
        let last = self.losses.len().saturating_sub(1);
        self.losses.get(step.min(last)).copied().unwrap_or(f64::NAN)
    }

    /// The least of the losses.
    pub fn least(&self) -> f64 {
        self.losses.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The numbers after all steps.
    pub fn last(&self) -> &[T] {
        self.params.last().map_or(&[], Vec::as_slice)
    }
}

/// Goes down `problem` from `start`, as the article does: clamp, evaluate, step.
pub fn descend<T: Real>(
    problem: &impl Problem<T>,
    start: &[T],
    method: Method,
    steps: usize,
) -> Trajectory<T> {
    let mut params = start.to_vec();
    let mut gradient = vec![T::zero(); start.len()];
    let mut optimizer = Optimizer::new(method, problem.scales(start.len()));
    let mut descent = Trajectory {
        losses: Vec::with_capacity(steps + 1),
        params: Vec::with_capacity(steps + 1),
    };
    for step in 0..=steps {
        problem.clamp(&mut params);
        let loss = problem.evaluate(&params, &mut gradient);
        descent.losses.push(loss);
        descent.params.push(params.clone());
        if step < steps {
            optimizer.step(&mut params, &gradient);
        }
    }
    descent
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x², for x ≥ 1.
    struct Square;

    impl Problem<f64> for Square {
        fn evaluate(&self, params: &[f64], gradient: &mut [f64]) -> f64 {
            gradient[0] = 2.0 * params[0];
            params[0] * params[0]
        }

        fn clamp(&self, params: &mut [f64]) {
            params[0] = params[0].max(1.0);
        }
    }

    #[test]
    fn a_descent_goes_down_and_stays_in_its_domain() {
        for method in [Method::Adam(0.1), Method::AdamW(0.1), Method::RmsProp(0.1)] {
            let descent = descend(&Square, &[5.0], method, 100);
            assert_eq!((descent.losses.len(), descent.params.len()), (101, 101));
            assert_eq!(descent.loss_at(0), 25.0);
            let (last, least) = (descent.last(), descent.least());
            assert_eq!((last, least), (&[1.0][..], 1.0), "{method}");
        }
    }

    #[test]
    fn decay_follows_the_scale_of_the_rate() {
        let mut x = [2.0, 2.0];
        Optimizer::new(Method::AdamW(0.1), vec![1.0, 3.0]).step(&mut x, &[0.0, 0.0]);
        let shrunk = [1.0, 3.0].map(|scale| 2.0 * (1.0 - 0.1 * scale * DECAY));
        assert_eq!(x, shrunk);
    }
}
