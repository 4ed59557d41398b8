//! The soft edge narrows during a fit.

use crate::coverage::{Coverage, CoverageSchedule};
use crate::render::Softness;

/// Slope of the final edge at the outline, 1/px. An antialiasing rasteriser's box of 1 px has a slope
/// between 1 (upright edges) and √2 (diagonal ones); of 1.0 to 1.5, this agreed best with resvg: by
/// 1.2 dB more than 1.5, at no cost in fidelity.
const FINAL_SLOPE: f64 = 1.2;

/// Share of a fit after which the edge has its final softness.
const ANNEALED: f32 = 0.7;

/// The edge of a finished drawing: the softness at which `coverage` has the final slope.
pub fn final_softness(coverage: Coverage) -> Softness {
    // All coverage functions are functions of d/s, so that the slope at 0 is inverse to the softness.
    let width = (coverage.derivative(0.0, 1.0) / FINAL_SLOPE) as f32;
    Softness { coverage, width }
}

/// A passage from a soft edge to the final one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Anneal {
    pub(super) coverage: CoverageSchedule,
    /// How many times softer than the final edge the first one is, at least 1.
    pub(super) from: f32,
}

impl Anneal {
    /// The softness when a share `done` of the fit is over; it shrinks geometrically.
    pub(super) fn at(&self, done: f32) -> Softness {
        if done >= ANNEALED {
            return self.last();
        }
        let last = final_softness(self.coverage.early);
        Softness {
            width: last.width * self.from.max(1.0).powf(1.0 - done / ANNEALED),
            ..last
        }
    }

    /// The edge of the finished drawing.
    pub(super) fn last(&self) -> Softness {
        final_softness(self.coverage.late)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_edge_ends_as_steep_as_a_rasterised_one() {
        let functions = [
            Coverage::Smoothstep,
            Coverage::Sigmoid,
            Coverage::Tanh,
            Coverage::Atan { k: 4.0 },
        ];
        for coverage in functions {
            let softness = final_softness(coverage);
            let slope = coverage.derivative(0.0, f64::from(softness.width));
            assert!((slope - FINAL_SLOPE).abs() < 1e-3, "{coverage}: {slope}");
        }
    }

    #[test]
    fn softness_shrinks_to_the_last() {
        let anneal = Anneal {
            coverage: CoverageSchedule::default(),
            from: 4.0,
        };
        let widths: Vec<f32> = (0..=10).map(|k| anneal.at(k as f32 / 10.0).width).collect();
        assert!((widths[0] / widths[10] - 4.0).abs() < 1e-5);
        assert!(widths.windows(2).all(|w| w[1] <= w[0]));
    }
}
