//! The fit: picture in, drawing out.
//!
//! A [`Fitter`] adds strokes in stages, on a blank ground or on a [`Base`]. Each stage seeds new strokes where
//! the residual is largest, fits them alone for a moment on the frozen canvas of those below, and keeps what
//! pays. Then all strokes are polished jointly, those worth least moving to where more is to be gained; where
//! the file may have few colours or pens only, they are brought to those; and they are settled against what
//! the file really looks like. At last strokes are added or removed, and fitted again, until the file is as
//! faithful and as short as the budgets ask for.

mod anneal;
mod background;
mod base;
mod checkpoint;
mod config;
mod control;
mod descent;
mod drawing;
mod fitter;
mod forecast;
mod ground;
mod memory;
mod objective;
mod observer;
mod palette;
mod panel;
mod pens;
mod plan;
mod polish;
mod price;
mod recipe;
mod rounds;
mod settle;
mod simd;
mod stage;
mod work;

use std::time::Duration;

use serde::{Deserialize, Serialize};

pub use anneal::final_softness;
pub use background::Background;
pub use base::Base;
pub use checkpoint::Checkpoint;
pub use config::{Budget, Config, DEFAULT_QUALITY, Execution, Preset};
pub use fitter::Fitter;
pub use memory::predicted_rss_bytes;
pub use objective::Objective;
pub use observer::{Observer, Progress};
pub use palette::Colors;
pub use recipe::{Rates, Recipe};
pub use simd::Simd;

use crate::error::Result;
use crate::image::Image;
use crate::scene::{Dropped, Scene};
use crate::svg::WriteOptions;
use work::{Task, Work};

/// A finished drawing and how it came to be.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The drawing, rounded to what its SVG says. On a base that stays as it is, the new strokes alone.
    pub scene: Scene,
    /// What the drawing goes on from, if anything.
    pub base: Option<Base>,
    /// The picture that was drawn: with its alpha, or laid on the colour of the ground.
    pub target: Image,
    /// Our own render of `scene` with the edge of a finished drawing; with alpha if the drawing has no
    /// ground and the picture has alpha.
    pub soft: Image,
    /// One record per stage of `scene`, those that were kept of a base included.
    pub stages: Vec<StageRecord>,
    /// Why no more was done.
    pub stop: Stop,
    /// Strokes that were dropped because they became non-finite or could not be seen.
    pub dropped: Dropped,
}

impl Fit {
    /// The drawing as SVG text, with the base that it was fitted on.
    pub fn svg(&self, options: &WriteOptions) -> String {
        Base::write(self.base.as_ref(), &self.scene, options)
    }
}

/// How one stage went.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StageRecord {
    /// From 1.
    pub index: usize,
    /// Strokes of this stage in the final drawing.
    pub strokes: usize,
    /// Iterations of the optimiser.
    pub iterations: usize,
    /// Wall time of the stage.
    pub wall: Duration,
    /// Fidelity of the soft render to the target after the stage, dB, at the resolution that the stage
    /// was fitted at: large strokes are fitted to a reduced picture.
    pub psnr_db: f64,
    /// Fidelity of the finished drawing's layers up to this one, dB.
    pub layer_psnr_db: f64,
}

/// Why a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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

/// Draws `target` with strokes: [`Fitter`] in one call.
///
/// # Errors
/// As [`Fitter::fit`].
pub fn fit(
    target: &Image,
    config: &Config,
    execution: &Execution,
    observer: &mut (dyn Observer + Send),
) -> Result<Fit> {
    Fitter::new(config.clone())
        .execution(*execution)
        .observer(observer)
        .fit(target)
}

/// The algorithm: stages, polish, settling, and what budgets ask for beyond, each task saying what follows it.
/// Between any two tasks all there is to know is in `work`, so that it can be kept, and the fit gone on with in
/// another process.
fn draw(mut work: Work<'_>) -> Result<Fit> {
    while let Some(task) = work.next() {
        match task {
            Task::TryBase => work.try_base()?,
            Task::Grow => work.grow()?,
            Task::Stage(stage) => work.stage(stage),
            Task::Record(stage) => work.record(&stage),
            Task::Polish(steps) => work.polish(steps),
            Task::Polishing(polish) => work.polishing(polish)?,
            Task::Settle => work.settle()?,
            Task::MeetFidelity => work.meet_fidelity(),
            Task::MeetBytes => work.meet_bytes(),
        }
        work.keep();
    }
    work.finish()
}
