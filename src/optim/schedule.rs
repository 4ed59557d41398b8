//! Schedules of the learning rate over a fit.
//!
//! Source of the cosine: Loshchilov & Hutter, "SGDR: stochastic gradient descent with warm restarts",
//! ICLR 2017, equation 5, without restarts.

use std::f64::consts::PI;

use crate::math;

/// The course of the learning rate, as a factor of its first value.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Schedule {
    /// 1 throughout.
    #[default]
    Constant,
    /// From 1 down half a cosine wave to `end`: slow, fast, slow.
    Cosine {
        /// The factor of the last step, usually in 0..1.
        end: f64,
    },
}

impl Schedule {
    /// The factor of step `step`, counted from 0, of `steps`. After the last step it stays constant.
    pub fn factor(self, step: usize, steps: usize) -> f64 {
        // The last step has the number steps − 1, and reaches the end exactly. A single step starts at 1.
        let last = steps.saturating_sub(1).max(1);
        let done = step.min(last) as f64 / last as f64;
        match self {
            Self::Constant => 1.0,
            Self::Cosine { end } => end + (1.0 - end) * (1.0 + math::cos(PI * done)) / 2.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cosine_goes_from_1_to_its_end() {
        let cosine = Schedule::Cosine { end: 0.1 };
        assert_eq!(cosine.factor(0, 101), 1.0);
        assert!((cosine.factor(50, 101) - 0.55).abs() < 1e-15);
        assert!((cosine.factor(100, 101) - 0.1).abs() < 1e-15);
        assert_eq!(cosine.factor(500, 101), cosine.factor(100, 101));
        let factors: Vec<f64> = (0..101).map(|i| cosine.factor(i, 101)).collect();
        assert!(factors.is_sorted_by(|a, b| a > b));
    }

    #[test]
    fn short_schedules_are_finite() {
        for steps in [0, 1, 2] {
            assert_eq!(Schedule::Cosine { end: 0.0 }.factor(0, steps), 1.0);
            assert_eq!(Schedule::Constant.factor(0, steps), 1.0);
        }
    }
}
