//! Annealing: the soft edge narrows during a descent.

use crate::coverage::{Coverage, CoverageSchedule};
use crate::fit::recipe::{EdgeShape, Preset, Recipe};
use crate::math;
use crate::render::Softness;

/// The edge of a finished drawing: the softness at which `coverage` has the slope of a rasterised edge.
pub fn final_softness(coverage: Coverage) -> Softness {
    with_slope(coverage, Recipe::of(Preset::default()).edge.final_slope)
}

/// The softness at which `coverage` has the slope `slope` at the outline, 1/px.
fn with_slope(coverage: Coverage, slope: f64) -> Softness {
    // Coverage depends on d/s alone, so that the slope at 0 is inversely proportional to the softness s.
    let width = (coverage.derivative(0.0, 1.0) / slope) as f32;
    Softness { coverage, width }
}

/// The schedule from a soft edge to the final one.
#[derive(Debug, Clone, Copy)]
pub(in crate::fit) struct Annealing {
    pub(in crate::fit) coverage: CoverageSchedule,
    pub(in crate::fit) edge: EdgeShape,
}

impl Annealing {
    /// The softness when a share `done` of a descent is over. It begins at `from` times the final one, at least at 1,
    /// and shrinks geometrically.
    pub(in crate::fit) fn at(&self, from: f32, done: f32) -> Softness {
        let annealed = self.edge.annealed;
        if done >= annealed {
            return self.last();
        }
        let last = with_slope(self.coverage.early, self.edge.final_slope);
        Softness {
            width: last.width * math::powf(from.max(1.0), 1.0 - done / annealed),
            ..last
        }
    }

    /// The final edge.
    pub(in crate::fit) fn last(&self) -> Softness {
        with_slope(self.coverage.late, self.edge.final_slope)
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
        let expected = Recipe::of(Preset::default()).edge.final_slope;
        for coverage in functions {
            let softness = final_softness(coverage);
            let slope = coverage.derivative(0.0, f64::from(softness.width));
            assert!((slope - expected).abs() < 1e-3, "{coverage}: {slope}");
        }
    }

    #[test]
    fn softness_shrinks_to_the_last() {
        let annealing = Annealing {
            coverage: CoverageSchedule::default(),
            edge: Recipe::of(Preset::default()).edge,
        };
        let width = |k: i32| annealing.at(4.0, k as f32 / 10.0).width;
        let widths: Vec<f32> = (0..=10).map(width).collect();
        assert!((widths[0] / widths[10] - 4.0).abs() < 1e-5);
        assert!(widths.windows(2).all(|w| w[1] <= w[0]));
    }
}
