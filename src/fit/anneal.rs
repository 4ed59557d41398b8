//! The soft edge narrows during a fit.

use crate::coverage::CoverageSchedule;
use crate::render::Softness;

/// Softness of a finished drawing, px: what an antialiasing rasteriser draws.
pub(super) const FINAL_SOFTNESS: f32 = 1.0;

/// Share of a fit after which the edge has its final softness.
const ANNEALED: f32 = 0.7;

/// A passage from a soft edge to the final one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Anneal {
    pub(super) coverage: CoverageSchedule,
    /// Softness at the start, px.
    pub(super) from: f32,
}

impl Anneal {
    /// The softness at iteration `step` of `steps`; it shrinks geometrically.
    pub(super) fn at(&self, step: usize, steps: usize) -> Softness {
        let done = step as f32 / (steps as f32 * ANNEALED);
        if done >= 1.0 {
            return self.last();
        }
        let width = self.from.max(FINAL_SOFTNESS).powf(1.0 - done);
        Softness {
            coverage: self.coverage.early,
            width,
        }
    }

    /// The edge of the finished drawing.
    pub(super) fn last(&self) -> Softness {
        Softness {
            coverage: self.coverage.late,
            width: FINAL_SOFTNESS,
        }
    }
}
