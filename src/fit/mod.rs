//! The fit: picture in, drawing out.
//!
//! [`fit`] adds strokes in stages. Each stage seeds new strokes where the residual is largest, fits
//! them alone for a moment on the frozen canvas of those below, and keeps what pays. Then all strokes
//! are polished jointly, those worth least moving to where more is to be gained, and settled against
//! what the file really looks like.

mod anneal;
mod config;
mod control;
mod descent;
mod drawing;
mod objective;
mod observer;
mod plan;
mod polish;
mod recipe;
mod settle;
mod simd;
mod stage;

use std::time::{Duration, Instant};

use fearless_simd::Level;

pub use anneal::final_softness;
pub use config::{Background, Budget, Config, Execution, Preset};
pub use objective::Objective;
pub use observer::{Observer, Progress};
pub use recipe::{Rates, Recipe};
pub use simd::Simd;

use crate::error::Result;
use crate::image::Image;
use crate::metrics::psnr_db;
use crate::scene::Scene;
use anneal::Anneal;
use control::Control;
use drawing::Drawing;
use settle::Page;

/// A finished drawing and how it came to be.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The drawing, rounded to what its SVG says.
    pub scene: Scene,
    /// The picture that was drawn, its alpha laid on the ground.
    pub target: Image,
    /// Our own render of `scene` with the edge of a finished drawing.
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
/// Where the picture has alpha it is laid on the background colour of the configuration, or on white.
///
/// # Errors
/// [`ErrorKind::Config`](crate::ErrorKind::Config) when an option is outside its domain.
pub fn fit(
    target: &Image,
    config: &Config,
    execution: &Execution,
    observer: &mut (dyn Observer + Send),
) -> Result<Fit> {
    config.check()?;
    let level = execution.simd.require()?;
    let target = target.flattened(config.background.ground());
    execution
        .pool()?
        .install(|| draw(target, config, level, observer))
}

fn draw(
    target: Image,
    config: &Config,
    level: Level,
    observer: &mut (dyn Observer + Send),
) -> Result<Fit> {
    let recipe = config.recipe.unwrap_or(Recipe::of(config.preset));
    let mut drawing = Drawing::new(&target, config, level);
    let plan = plan::stages(&drawing, config, &recipe);
    let mut control = Control::new(
        observer,
        config,
        plan::work(&plan, config, &recipe),
        plan.len(),
    );
    let anneal = Anneal {
        coverage: config.coverage,
        from: 1.0,
    };

    let mut stages = Vec::new();
    for planned in plan {
        let start = Instant::now();
        control.enter(planned.index, drawing.strokes.len());
        stage::add(&mut drawing, &recipe, anneal, planned, &mut control);
        stages.push(StageRecord {
            index: planned.index + 1,
            strokes: 0,
            iterations: recipe.stage_iterations,
            wall: start.elapsed(),
            psnr_db: psnr_db(drawing.mse()),
        });
        if control.stopped().is_some() {
            break;
        }
    }
    if config.polish && control.stopped().is_none() {
        control.enter(stages.len(), drawing.strokes.len());
        polish::run(&mut drawing, &recipe, anneal, &mut control);
    }
    let page = Page::of(config);
    let written = settle::run(&mut drawing, &target, page, &recipe, anneal)?;

    for (record, stage) in stages.iter_mut().zip(&written.scene.stages) {
        record.strokes = stage.strokes.len();
    }
    let soft = drawing.soft(&written.scene);
    let stop = control.stopped().unwrap_or(Stop::Strokes);
    Ok(Fit {
        scene: written.scene,
        target,
        soft,
        stages,
        stop,
        dropped: written.dropped,
    })
}
