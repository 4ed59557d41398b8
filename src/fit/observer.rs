//! Progress and cancellation, one path.

use std::ops::ControlFlow;

/// What has just happened in a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Fraction of the planned work that is done, 0..1, never decreasing.
    pub done: f64,
    /// Index of the stage under way, from 1; one past the last during polish.
    pub stage: usize,
    /// How many stages are planned.
    pub stages: usize,
    /// Strokes in the drawing.
    pub strokes: usize,
    /// Fidelity of the soft render to the target, dB.
    pub psnr_db: f64,
}

/// Told of progress; may stop the fit. Stopping is no error: what is finished is a valid scene.
pub trait Observer {
    /// Called after every iteration, always on the same thread; it should return soon.
    fn observe(&mut self, progress: &Progress) -> ControlFlow<()>;
}

/// An observer that never stops the fit.
impl Observer for () {
    fn observe(&mut self, _: &Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(&Progress) -> ControlFlow<()>> Observer for F {
    fn observe(&mut self, progress: &Progress) -> ControlFlow<()> {
        self(progress)
    }
}
