//! Settling: the last steps are taken against what the file really looks like.
//!
//! A renderer of SVG rounds after every stroke to 8 bits and has its own antialiasing, so that its
//! picture differs from our canvas by an offset that hardly changes when strokes move a little. Each
//! round renders the rounded drawing as SVG, takes the offset from the target, and descends a few
//! iterations; the best round, by the file's own error, is kept.

use std::time::Instant;

use super::config::{Background, Config};
use super::control::Control;
use super::descent::Descent;
use super::drawing::Drawing;
use super::recipe::Recipe;
use crate::error::Result;
use crate::image::Image;
use crate::optim::Schedule;
use crate::render::Canvas;
use crate::scene::Scene;
use crate::svg::WriteOptions;
use crate::{metrics, svg, verify};

/// How the drawing is written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Page {
    /// Whether there is a rectangle of the background's colour.
    has_ground: bool,
    file: WriteOptions,
}

impl Page {
    pub(super) fn of(config: &Config) -> Self {
        Self {
            has_ground: config.background != Background::None,
            file: config.file,
        }
    }
}

/// A drawing as its file says it.
#[derive(Debug, Clone)]
pub(super) struct Written {
    pub(super) scene: Scene,
    /// Strokes that cannot be written.
    pub(super) dropped: usize,
    /// What an SVG renderer draws.
    pub(super) drawn: Image,
    /// Bytes of SVG.
    pub(super) bytes: usize,
    /// Its mean squared error.
    pub(super) mse: f64,
}

/// Rounds and writes `drawing` and renders the file.
pub(super) fn write(drawing: &Drawing, target: &Image, page: Page) -> Result<Written> {
    let (scene, dropped) = drawing
        .scene(page.has_ground)
        .quantized(page.file.precision);
    let text = svg::write(&scene, &page.file);
    let drawn = verify::render_like(&text, target)?;
    let mse = metrics::mse(target, &drawn)?;
    Ok(Written {
        scene,
        dropped,
        bytes: text.len(),
        drawn,
        mse,
    })
}

/// Descends against the file's own picture and returns the best of the files; `drawing` becomes the
/// drawing that it was written from. All strokes must be free.
pub(super) fn run(
    drawing: &mut Drawing,
    target: &Image,
    page: Page,
    recipe: &Recipe,
    control: &Control<'_>,
) -> Result<Written> {
    let start = Instant::now();
    let mut written = write(drawing, target, page)?;
    let mut best = (written.clone(), drawing.free().to_vec());
    // A round is taken to be as long as the one before, the first as three times a writing.
    let mut span = 3 * start.elapsed();
    for _ in 0..recipe.settle_rounds {
        if !control.allows(span) {
            break;
        }
        let start = Instant::now();
        let corrected = corrected_target(drawing, target, &written);
        descend(drawing, recipe, &corrected);
        written = write(drawing, target, page)?;
        if written.mse < best.0.mse {
            best = (written.clone(), drawing.free().to_vec());
        }
        span = start.elapsed();
    }
    drawing.set_free(&best.1);
    Ok(best.0)
}

/// The target less what the file's picture differs by from our render of the same scene.
fn corrected_target(drawing: &mut Drawing, target: &Image, written: &Written) -> Canvas {
    let soft = drawing.soft(&written.scene);
    let planes = [0, 1, 2].map(|c| {
        let pixels = target.planes()[c]
            .iter()
            .zip(&soft.planes()[c])
            .zip(&written.drawn.planes()[c]);
        pixels
            .map(|((target, soft), drawn)| target - (drawn - soft))
            .collect()
    });
    Canvas::from_image(&Image::from_planes(target.width(), target.height(), planes))
}

fn descend(drawing: &mut Drawing, recipe: &Recipe, target: &Canvas) {
    let steps = recipe.settle_iterations;
    let rates = recipe.polish_rates;
    let schedule = Schedule::Cosine { end: rates.last };
    let mut descent = Descent::new(drawing.free(), rates, drawing.limits);
    for step in 0..steps {
        let rate = schedule.factor(step, steps) as f32 * recipe.settle_rate;
        drawing.step_towards(target, &mut descent, rate);
    }
}
