//! Adam: a step is the learning rate times the mean gradient divided by its root mean square.
//!
//! ```text
//! m ← β₁m + (1−β₁)g          v ← β₂v + (1−β₂)g²
//! x ← x − rate · m/(1−β₁ᵗ) / (√(v/(1−β₂ᵗ)) + ε)
//! ```
//!
//! `1−βᵗ` corrects the bias of averages that start from 0. It equals the same average of the constant 1,
//! and is stored as such for every value, so that one slice can hold values of different age `t`.
//!
//! Domain: finite gradients, `0 ≤ β < 1`, `ε > 0`. A value whose gradient is always 0 does not move.
//!
//! Source: Kingma & Ba, "Adam: a method for stochastic optimization", ICLR 2015, algorithm 1, with
//! ε outside the root and the correction, as in `torch.optim.Adam`.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::math::Real;

/// Parameters of Adam besides the learning rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AdamParams {
    /// Decay of the mean gradient and of the mean squared gradient, each in 0..1.
    pub betas: [f64; 2],
    /// Added to the root mean square.
    pub eps: f64,
}

impl Default for AdamParams {
    fn default() -> Self {
        Self {
            betas: [0.9, 0.999],
            eps: 1e-8,
        }
    }
}

/// The Adam optimiser.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Adam<T> {
    params: AdamParams,
    /// The moving averages of the gradient, of its square, and of 1 with each decay.
    mean: Vec<T>,
    square: Vec<T>,
    mean_of_one: Vec<T>,
    square_of_one: Vec<T>,
}

impl<T: Real> Adam<T> {
    /// An optimiser of `len` values.
    pub fn new(len: usize, params: AdamParams) -> Self {
        let zeros = || vec![T::zero(); len];
        Self {
            params,
            mean: zeros(),
            square: zeros(),
            mean_of_one: zeros(),
            square_of_one: zeros(),
        }
    }

    /// Rearranges the state like the values, in groups of `group`: group `i` was `sources[i]`, or is new
    /// and has no past.
    pub fn rearrange(&mut self, group: usize, sources: &[Option<usize>]) {
        for state in [
            &mut self.mean,
            &mut self.square,
            &mut self.mean_of_one,
            &mut self.square_of_one,
        ] {
            // Zeros are the state of a new value: all its averages start from 0.
            let mut moved = vec![T::zero(); group * sources.len()];
            for (to, source) in moved.chunks_exact_mut(group).zip(sources) {
                if let Some(from) = source.and_then(|i| state.get(i * group..(i + 1) * group)) {
                    to.copy_from_slice(from);
                }
            }
            *state = moved;
        }
    }

    /// One step at the learning rate `rate · scales[i]` for value `i`, with `squares[i]` in place of its squared
    /// gradient. Values that move together, such as the coordinates of a point, share a square: a step then has the
    /// direction of their gradient.
    pub fn step_with_squares(
        &mut self,
        params: &mut [T],
        gradients: &[T],
        rate: T,
        scales: &[T],
        squares: &[T],
    ) {
        let n = scales.len().min(squares.len()).min(params.len());
        let (scales, squares) = (&scales[..n], &squares[..n]);
        self.update(
            &mut params[..n],
            gradients,
            |i| rate * scales[i],
            |i, take, _| take * squares[i],
        );
    }

    /// Moves `params` down `gradients` with one learning `rate` for all. Values beyond the shortest slice do not change.
    pub fn step(&mut self, params: &mut [T], gradients: &[T], rate: T) {
        self.update(params, gradients, |_| rate, square);
    }

    /// Moves `params` with the learning rate `rate · scales[i]` for value `i`, since positions, radii, colours and
    /// opacities need different rates. `scales` are filled once; `rate` follows a [`Schedule`](super::Schedule).
    pub fn step_scaled(&mut self, params: &mut [T], gradients: &[T], rate: T, scales: &[T]) {
        let n = scales.len().min(params.len());
        let scales = &scales[..n];
        self.update(&mut params[..n], gradients, |i| rate * scales[i], square);
    }

    /// Resets the state of the values in `range`, as if they had never made a step. Indices beyond the end are ignored.
    pub fn reset(&mut self, range: Range<usize>) {
        let end = range.end.min(self.mean.len());
        let range = range.start.min(end)..end;
        for state in [
            &mut self.mean,
            &mut self.square,
            &mut self.mean_of_one,
            &mut self.square_of_one,
        ] {
            state[range.clone()].fill(T::zero());
        }
    }

    /// One step; value `i` at the learning rate `rate(i)`. Of the gradient `g`, the moving average of its square takes
    /// `share(i, 1−β₂, g)`.
    #[inline]
    fn update(
        &mut self,
        params: &mut [T],
        gradients: &[T],
        rate: impl Fn(usize) -> T,
        share: impl Fn(usize, T, T) -> T,
    ) {
        let [keep1, keep2] = self.params.betas.map(T::of);
        let [take1, take2] = self.params.betas.map(|beta| T::of(1.0 - beta));
        let eps = T::of(self.params.eps);
        // Slices of known equal length let the compiler vectorise the loop.
        let n = self.mean.len().min(params.len()).min(gradients.len());
        let (params, gradients) = (&mut params[..n], &gradients[..n]);
        let (mean, square) = (&mut self.mean[..n], &mut self.square[..n]);
        let mean_of_one = &mut self.mean_of_one[..n];
        let square_of_one = &mut self.square_of_one[..n];
        for i in 0..n {
            let g = gradients[i];
            mean[i] += take1 * (g - mean[i]);
            square[i] = keep2 * square[i] + share(i, take2, g);
            mean_of_one[i] = keep1 * mean_of_one[i] + take1;
            square_of_one[i] = keep2 * square_of_one[i] + take2;
            // m/(1−β₁ᵗ) / (√(v/(1−β₂ᵗ)) + ε), with one division for both quotients of m. At g = 0 from the start this is 0/ε.
            let scale = mean_of_one[i] * ((square[i] / square_of_one[i]).sqrt() + eps);
            params[i] -= rate(i) * mean[i] / scale;
        }
    }
}

/// The share of a squared gradient that its moving average takes.
#[inline]
fn square<T: Real>(_: usize, take: T, g: T) -> T {
    take * g * g
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;

    /// The formulas at the head of the file, for one value, with powers instead of averages of 1.
    fn by_the_book(x: f64, gradients: &[f64], rate: f64, params: AdamParams) -> f64 {
        let [b1, b2] = params.betas;
        let (mut x, mut m, mut v) = (x, 0.0, 0.0);
        for (t, g) in (1..).zip(gradients) {
            m = b1 * m + (1.0 - b1) * g;
            v = b2 * v + (1.0 - b2) * g * g;
            let scale = f64::sqrt(v) / (1.0 - math::powi(b2, t)).sqrt() + params.eps;
            x -= rate / (1.0 - math::powi(b1, t)) * m / scale;
        }
        x
    }

    const GRADIENTS: [f64; 5] = [0.5, -1.5, 3.0, 0.0, 2e-9];

    #[test]
    fn a_step_follows_the_formula() {
        let params = AdamParams {
            betas: [0.95, 0.99],
            eps: 1e-4,
        };
        let mut x = [1.0, -2.0];
        let mut adam = Adam::new(2, params);
        for g in GRADIENTS {
            adam.step(&mut x, &[g, -g], 0.1);
        }
        let expected = by_the_book(1.0, &GRADIENTS, 0.1, params);
        assert!((x[0] - expected).abs() < 1e-14, "{} {expected}", x[0]);
        assert!((x[1] + 1.0 + expected).abs() < 1e-14, "{} {expected}", x[1]);
    }

    #[test]
    fn rates_scale_per_value() {
        let mut x = [1.0, 1.0, 1.0];
        let mut adam = Adam::new(3, AdamParams::default());
        for g in GRADIENTS {
            adam.step_scaled(&mut x, &[g; 3], 0.1, &[1.0, 0.5, 0.0]);
        }
        for (x, rate) in x.into_iter().zip([0.1, 0.05, 0.0]) {
            let expected = by_the_book(1.0, &GRADIENTS, rate, AdamParams::default());
            assert!((x - expected).abs() < 1e-14, "rate {rate}: {x} {expected}");
        }
    }

    #[test]
    fn a_reset_value_starts_afresh_and_the_others_go_on() {
        let mut x = [1.0, 1.0];
        let mut adam = Adam::new(2, AdamParams::default());
        for g in [7.0, -3.0] {
            adam.step(&mut x, &[g; 2], 0.1);
        }
        let before = x[1];
        adam.reset(1..9);
        for g in GRADIENTS {
            adam.step(&mut x, &[g; 2], 0.1);
        }
        let all: Vec<f64> = [7.0, -3.0].into_iter().chain(GRADIENTS).collect();
        let expected = [
            by_the_book(1.0, &all, 0.1, AdamParams::default()),
            by_the_book(before, &GRADIENTS, 0.1, AdamParams::default()),
        ];
        assert!((x[0] - expected[0]).abs() < 1e-14);
        assert!((x[1] - expected[1]).abs() < 1e-14);
    }

    #[test]
    fn single_precision_follows_double() {
        let (mut single, mut double) = ([1.0_f32], [1.0_f64]);
        let mut adam32 = Adam::new(1, AdamParams::default());
        let mut adam64 = Adam::new(1, AdamParams::default());
        for i in 0..200 {
            let g = math::sin(f64::from(i) * 0.1);
            adam32.step(&mut single, &[g as f32], 0.01);
            adam64.step(&mut double, &[g], 0.01);
        }
        let gap = (f64::from(single[0]) - double[0]).abs();
        assert!(gap < 1e-5, "{gap}");
    }

    #[test]
    fn no_gradient_no_motion() {
        let mut x = [0.7_f32];
        let mut adam = Adam::new(1, AdamParams::default());
        adam.step(&mut x, &[0.0], 0.1);
        assert_eq!(x, [0.7]);
    }

    #[test]
    fn values_that_share_a_square_move_along_their_gradient() {
        let mut x = [0.0_f64; 2];
        let mut adam = Adam::new(2, AdamParams::default());
        for _ in 0..5 {
            adam.step_with_squares(&mut x, &[3.0, 4.0], 0.1, &[1.0; 2], &[25.0; 2]);
        }
        assert!(
            (x[0] * 4.0 - x[1] * 3.0).abs() < 1e-12 && x[0] < 0.0,
            "{x:?}"
        );
        assert!((x[0] + 5.0 * 0.1 * 0.6).abs() < 1e-6, "{x:?}");
    }
}
