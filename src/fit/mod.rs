//! The fit: stages of new strokes, then a joint polish.

mod anneal;
mod config;
mod descent;
mod drawing;
pub mod objective;
mod observer;
mod plan;
mod polish;
mod recipe;
mod stage;

use std::time::Duration;

pub use config::{Background, Budget, Config, Execution, Preset};
pub use observer::{Observer, Progress};

use crate::error::Result;
use crate::image::Image;
use crate::scene::Scene;
use anneal::Anneal;
use drawing::Drawing;
pub use recipe::{Rates, Recipe};

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
    target: &Image,
    config: &Config,
    execution: &Execution,
    observer: &mut dyn Observer,
) -> Result<Fit> {
    let _ = observer;
    let pool = execution.pool()?;
    Ok(pool.install(|| {
        run(
            target,
            config,
            &config.recipe.unwrap_or(Recipe::of(config.preset)),
        )
    }))
}

fn run(target: &Image, config: &Config, recipe: &Recipe) -> Fit {
    let anneal = |from: f32| Anneal {
        coverage: config.coverage,
        from,
    };
    let mut drawing = Drawing::new(
        target,
        mean_color(target),
        config,
        fearless_simd::Level::new(),
    );
    let total = config.budget.strokes.unwrap_or(1000);
    let count = config.stages.unwrap_or(recipe.stages);
    let mut records = Vec::new();
    for planned in plan::stages(total, count, recipe.growth, drawing.pixels(), recipe.scale) {
        let start = std::time::Instant::now();
        stage::add(
            &mut drawing,
            recipe,
            anneal(planned.scale.min(4.0)),
            planned.count,
            planned.scale,
        );
        records.push(StageRecord {
            index: records.len() + 1,
            strokes: planned.count,
            iterations: recipe.stage_iterations,
            wall: start.elapsed(),
            psnr_db: -10.0 * drawing.mse().log10(),
        });
    }
    if config.polish {
        polish::run(&mut drawing, recipe, anneal(recipe.polish_softness));
    }
    let mse = drawing.mse();
    eprintln!("soft {:.2}", -10.0 * mse.log10());
    Fit {
        scene: scene_of(&drawing),
        soft: drawing.canvas.to_image(),
        stages: records,
        stop: Stop::Strokes,
        dropped: 0,
    }
}

fn scene_of(d: &Drawing) -> crate::scene::Scene {
    let g = d.canvas.grid();
    let mut s = Scene::empty(g.width as u32, g.height as u32, Some(d.background));
    s.stages = vec![crate::scene::Stage {
        strokes: d.strokes.iter().map(crate::render::unpack).collect(),
    }];
    s
}

fn mean_color(target: &Image) -> [f32; 3] {
    [0, 1, 2].map(|c| {
        let plane = &target.planes()[c];
        (plane.iter().map(|&v| f64::from(v)).sum::<f64>() / plane.len() as f64) as f32
    })
}
