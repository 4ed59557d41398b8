//! Small problems and their descent: a loss of a few numbers, an optimiser, some hundred steps.

use std::fmt;

use super::optimizers::{AdamW, AdamWParams, Optimizer, RmsProp, RmsPropParams};
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

/// An optimiser with its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Method {
    /// Learning rate.
    pub rate: f64,
    /// Which optimiser.
    pub kind: MethodKind,
}

/// Which optimiser.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MethodKind {
    /// [`Adam`].
    Adam(AdamParams),
    /// [`AdamW`].
    AdamW(AdamWParams),
    /// [`RmsProp`].
    RmsProp(RmsPropParams),
}

/// Parameters that the article gives Adam and AdamW in the small experiments.
const ADAM: AdamParams = AdamParams {
    betas: [0.95, 0.999],
    eps: 1e-8,
};

impl Method {
    /// Adam with the betas 0.95 and 0.999.
    pub const fn adam(rate: f64) -> Self {
        Self {
            rate,
            kind: MethodKind::Adam(ADAM),
        }
    }

    /// AdamW with the betas 0.95 and 0.999 and a decay of 0.01.
    pub const fn adamw(rate: f64) -> Self {
        let params = AdamWParams {
            adam: ADAM,
            decay: 0.01,
        };
        Self {
            rate,
            kind: MethodKind::AdamW(params),
        }
    }

    /// RMSprop with α = 0.99 and a momentum of ½.
    pub const fn rmsprop(rate: f64) -> Self {
        let params = RmsPropParams {
            alpha: 0.99,
            momentum: 0.5,
            eps: 1e-8,
        };
        Self {
            rate,
            kind: MethodKind::RmsProp(params),
        }
    }

    /// The optimiser, for `len` numbers.
    pub fn optimizer<T: Real>(&self, len: usize) -> Box<dyn Optimizer<T>> {
        match self.kind {
            MethodKind::Adam(params) => Box::new(Adam::new(len, params)),
            MethodKind::AdamW(params) => Box::new(AdamW::new(len, params)),
            MethodKind::RmsProp(params) => Box::new(RmsProp::new(len, params)),
        }
    }
}

/// `adam`, `adamw` or `rmsprop`.
impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.kind {
            MethodKind::Adam(_) => "adam",
            MethodKind::AdamW(_) => "adamw",
            MethodKind::RmsProp(_) => "rmsprop",
        })
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

    /// The numbers after `step` steps, or after the last one.
    pub fn params_at(&self, step: usize) -> &[T] {
        let last = self.params.len().saturating_sub(1);
        self.params.get(step.min(last)).map_or(&[], Vec::as_slice)
    }

    /// The numbers after all steps.
    pub fn last(&self) -> &[T] {
        self.params_at(usize::MAX)
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
    let mut optimizer = method.optimizer(start.len());
    let scales = problem.scales(start.len());
    let mut descent = Trajectory {
        losses: Vec::with_capacity(steps + 1),
        params: Vec::with_capacity(steps + 1),
    };
    for step in 0..=steps {
        problem.clamp(&mut params);
        descent
            .losses
            .push(problem.evaluate(&params, &mut gradient));
        descent.params.push(params.clone());
        if step < steps {
            optimizer.step_scaled(&mut params, &gradient, T::of(method.rate), &scales);
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
        for method in [Method::adam(0.1), Method::adamw(0.1), Method::rmsprop(0.1)] {
            let descent = descend(&Square, &[5.0], method, 100);
            assert_eq!((descent.losses.len(), descent.params.len()), (101, 101));
            assert_eq!(descent.loss_at(0), 25.0);
            assert_eq!(
                (descent.last(), descent.least()),
                (&[1.0][..], 1.0),
                "{method}"
            );
        }
    }
}
