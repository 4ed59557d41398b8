//! Annealing: the soft edge narrows during a descent.

use crate::coverage::{Coverage, CoverageSchedule};
use crate::math;
use crate::render::Softness;

/// Slope of the final edge at the outline, 1/px. A box of 1 px, which antialiasing rasterisers approximate, has a slope between 1
/// (upright edges) and √2 (diagonal ones). 1.2 instead of 1.5: +0.15 dB at 1,000 strokes, +0.3 at 5,000, agreement with resvg +1.2.
/// Half, twice: −2.26, −1.10.
const FINAL_SLOPE: f64 = 1.2;
/// Share of a descent after which the edge has its final softness. 0.85: −0.07 dB; 0.55 instead of 0.7, with points: +0.02 dB.
const ANNEALED: f32 = 0.55;

/// The edge of a finished drawing: the softness at which `coverage` has the slope of a rasterised edge.
pub fn final_softness(coverage: Coverage) -> Softness {
    // Coverage depends on d/s alone, so that the slope at 0 is inversely proportional to the softness s.
    let width = (coverage.derivative(0.0, 1.0) / FINAL_SLOPE) as f32;
    Softness { coverage, width }
}

/// The schedule from a soft edge to the final one.
#[derive(Debug, Clone, Copy)]
pub(in crate::fit) struct Annealing {
    pub(in crate::fit) coverage: CoverageSchedule,
}

impl Annealing {
    /// The softness when a share `done` of a descent is over. It begins at `from` times the final one, at least at 1,
    /// and shrinks geometrically.
    pub(in crate::fit) fn at(&self, from: f32, done: f32) -> Softness {
        if done >= ANNEALED {
            return self.last();
        }
        let last = final_softness(self.coverage.early);
        Softness {
            width: last.width * math::powf(from.max(1.0), 1.0 - done / ANNEALED),
            ..last
        }
    }

    /// The final edge.
    pub(in crate::fit) fn last(&self) -> Softness {
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
        let annealing = Annealing {
            coverage: CoverageSchedule::default(),
        };
        let width = |k: i32| annealing.at(4.0, k as f32 / 10.0).width;
        let widths: Vec<f32> = (0..=10).map(width).collect();
        assert!((widths[0] / widths[10] - 4.0).abs() < 1e-5);
        assert!(widths.windows(2).all(|w| w[1] <= w[0]));
    }
}
