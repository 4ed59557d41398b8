//! Progress and cancellation, one path.

use std::ops::ControlFlow;

use super::drawing::Drawing;
use crate::scene::Scene;

/// What has just happened in a fit.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct Progress<'a> {
    /// Fraction of the planned work that is done, 0..1, never decreasing.
    pub done: f64,
    /// Index of the stage under way, from 1; one past the last during polish.
    pub stage: usize,
    /// How many stages are planned; 0 where the picture decides as it goes.
    pub stages: usize,
    /// Whether strokes of several stages are fitted jointly, or those of this stage once more.
    pub polishing: bool,
    /// Strokes in the drawing.
    pub strokes: usize,
    /// Fidelity of the soft render to the target, dB.
    pub psnr_db: f64,
    pub(super) drawing: &'a Drawing,
}

impl Progress<'_> {
    /// The drawing so far: unrounded, in px of the picture, on its background. Made anew at every call.
    pub fn scene(&self) -> Scene {
        self.drawing.scene(true)
    }
}

/// Told of progress; may stop the fit. Stopping is no error: what is finished is a valid scene.
pub trait Observer {
    /// Called after every iteration, always on the same thread; it should return soon.
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()>;
}

/// An observer that never stops the fit.
impl Observer for () {
    fn observe(&mut self, _: &Progress<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(&Progress<'_>) -> ControlFlow<()>> Observer for F {
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        self(progress)
    }
}
