//! Losses of a canvas: mean absolute and mean squared error, with ∂L/∂canvas.
//!
//! Per value, with `e = canvas − target`:
//!
//! ```text
//! L1 = |e|     ∂L1/∂e = sign(e), with sign(0) = 0
//! L2 = e²      ∂L2/∂e = 2e
//! ```
//!
//! The loss of a picture is the **mean over all values**, rows·columns·3, as in `PyTorch`'s `l1_loss` and
//! `mse_loss`. The gradient is the derivative of this mean.

use crate::math::Real;

/// A measure of the difference between a canvas and its target.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Loss {
    /// Absolute error. It does not favour spread-out errors, so it keeps edges sharp.
    L1,
    /// Squared error, on which PSNR and all closed-form gains are based.
    #[default]
    L2,
}

impl Loss {
    /// The loss of the error `e = canvas − target` of one value.
    #[inline]
    pub fn value<T: Real>(self, e: T) -> T {
        match self {
            Self::L1 => e.abs(),
            Self::L2 => e * e,
        }
    }

    /// The derivative of [`value`](Self::value) by `e`; 0 at 0.
    #[inline]
    pub fn derivative<T: Real>(self, e: T) -> T {
        match self {
            Self::L1 if e > T::zero() => T::one(),
            Self::L1 if e < T::zero() => -T::one(),
            Self::L1 => T::zero(),
            Self::L2 => e + e,
        }
    }

    /// The mean loss over all values, summed in `f64`; 0 without values.
    ///
    /// `canvas` and `target` have equal length and the same order.
    pub fn mean<T: Real>(self, canvas: &[T], target: &[T]) -> f64 {
        debug_assert_eq!(canvas.len(), target.len());
        let values = canvas.iter().zip(target);
        let sum: f64 = values.map(|(&c, &t)| self.value(c - t).to_f64()).sum();
        sum / canvas.len().max(1) as f64
    }

    /// The derivative of [`mean`](Self::mean) by each value of the canvas, in its order.
    pub fn gradient<T: Real>(self, canvas: &[T], target: &[T]) -> Vec<T> {
        debug_assert_eq!(canvas.len(), target.len());
        let weight = T::of(1.0 / canvas.len().max(1) as f64);
        let values = canvas.iter().zip(target);
        values
            .map(|(&c, &t)| self.derivative(c - t) * weight)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CANVAS: [f64; 6] = [0.1, 0.9, 0.5, 0.0, 1.0, 0.3];
    const TARGET: [f64; 6] = [0.4, 0.1, 0.5, 1.0, 0.0, 0.2];

    #[test]
    fn losses_are_means() {
        assert!((Loss::L1.mean(&CANVAS, &TARGET) - 3.2 / 6.0).abs() < 1e-15);
        assert!((Loss::L2.mean(&CANVAS, &TARGET) - 2.74 / 6.0).abs() < 1e-15);
        assert_eq!(Loss::L2.mean::<f32>(&[], &[]), 0.0);
    }

    #[test]
    fn derivatives_are_central_differences() {
        let step = 1e-6;
        for loss in [Loss::L1, Loss::L2] {
            let gradient = loss.gradient(&CANVAS, &TARGET);
            for (k, &analytic) in gradient.iter().enumerate() {
                let (mut low, mut high) = (CANVAS, CANVAS);
                low[k] -= step;
                high[k] += step;
                let rise = loss.mean(&high, &TARGET) - loss.mean(&low, &TARGET);
                assert!(
                    (rise / (2.0 * step) - analytic).abs() < 1e-9,
                    "{loss:?} value {k}"
                );
            }
        }
    }

    #[test]
    fn no_error_no_slope() {
        assert_eq!(Loss::L1.derivative(0.0), 0.0);
        assert_eq!(Loss::L1.derivative(-0.0), 0.0);
        assert_eq!(Loss::L2.derivative(0.0), 0.0);
    }
}
