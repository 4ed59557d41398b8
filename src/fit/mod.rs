//! The fit: stages of new strokes, then a joint polish.

mod config;
pub mod objective;
mod observer;

use std::time::Duration;

pub use config::{Background, Budget, Config, Execution, Preset};
pub use observer::{Observer, Progress};

use crate::error::Result;
use crate::image::Image;
use crate::scene::Scene;

/// A finished drawing and how it came to be.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The drawing, rounded to what its SVG says.
    pub scene: Scene,
    /// Our own render of `scene` at the final softness.
    pub soft: Image,
    /// One record per stage.
    pub stages: Vec<StageRecord>,
    /// Why no more was done.
    pub stop: Stop,
    /// Strokes that were dropped because they became non-finite or could not be seen.
    pub dropped: usize,
}

/// How one stage went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageRecord {
    /// From 1.
    pub index: usize,
    /// Strokes of this stage in the final drawing.
    pub strokes: usize,
    /// Iterations of the optimiser.
    pub iterations: usize,
    /// Wall time of the stage.
    pub wall: Duration,
    /// Fidelity of the soft render to the target after the stage, dB.
    pub psnr_db: f64,
}

/// Why a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The stroke budget is used.
    Strokes,
    /// The fidelity asked for is reached.
    Psnr,
    /// The byte budget is used.
    Bytes,
    /// The time is up.
    Time,
    /// No further stroke pays.
    Converged,
    /// The observer asked to stop.
    Observer,
}

/// Draws `target` with strokes.
///
/// # Errors
/// [`ErrorKind::Config`](crate::ErrorKind::Config) when an option is outside its domain.
pub fn fit(
    _target: &Image,
    _config: &Config,
    _execution: &Execution,
    _observer: &mut dyn Observer,
) -> Result<Fit> {
    Err(crate::Error::new(crate::ErrorKind::Config, "not yet built"))
}
