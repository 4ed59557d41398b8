//! Settling: the last steps are taken against what the file really looks like.
//!
//! A renderer of SVG rounds after every stroke to 8 bits and has its own antialiasing, so that its
//! picture differs from our canvas by an offset that hardly changes when strokes move a little. Each
//! round renders the rounded drawing as SVG, takes the offset from the target, and descends a few
//! iterations; the best round, by the file's own error, is kept.

use super::background::Background;
use super::base::Base;
use super::config::Config;
use super::control::Control;
use super::descent::Descent;
use super::drawing::Drawing;
use super::recipe::Recipe;
use crate::error::Result;
use crate::image::Image;
use crate::optim::Schedule;
use crate::render::Canvas;
use crate::scene::{Dropped, Scene};
use crate::svg::WriteOptions;
use crate::{metrics, verify};

/// How the drawing is written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Page<'a> {
    base: Option<&'a Base>,
    /// Whether there is a rectangle of the background's colour.
    pub(super) has_ground: bool,
    file: WriteOptions,
}

impl<'a> Page<'a> {
    pub(super) fn of(config: &Config, base: Option<&'a Base>) -> Self {
        let has_ground = match base {
            Some(base) => base.document.is_none() && base.scene.background.is_some(),
            None => config.background != Background::None,
        };
        Self {
            base,
            has_ground,
            file: config.file,
        }
    }
}

/// A drawing as its file says it.
#[derive(Debug, Clone)]
pub(super) struct Written {
    pub(super) scene: Scene,
    /// Which stage of the drawing each layer is.
    pub(super) origins: Vec<usize>,
    /// Strokes that cannot be written.
    pub(super) dropped: Dropped,
    /// What an SVG renderer draws on each ground.
    pub(super) drawn: Vec<Image>,
    /// Bytes of SVG.
    pub(super) bytes: usize,
    /// The mean squared error on the ground where it is largest.
    pub(super) mse: f64,
}

/// Rounds and writes `drawing` and renders the file.
pub(super) fn write(drawing: &Drawing, page: Page<'_>) -> Result<Written> {
    let quantized = drawing
        .scene(page.has_ground)
        .quantized(page.file.precision);
    let scene = quantized.scene;
    let text = Base::write(page.base, &scene, &page.file);
    let (mut drawn, mut mse) = (Vec::new(), 0.0_f64);
    for ground in drawing.grounds() {
        let image = verify::render_like(&text, ground.picture(), ground.paper)?;
        mse = mse.max(metrics::mse(ground.picture(), &image)?);
        drawn.push(image);
    }
    Ok(Written {
        scene,
        origins: quantized.origins,
        dropped: quantized.dropped,
        bytes: text.len(),
        drawn,
        mse,
    })
}

/// Descends against the file's own picture and returns the best of the files; `drawing` becomes the
/// drawing that it was written from. All strokes must be free.
pub(super) fn run(
    drawing: &mut Drawing,
    page: Page<'_>,
    recipe: &Recipe,
    control: &mut Control<'_>,
) -> Result<Written> {
    let mut written = control.writing(drawing.len(), || write(drawing, page))?;
    let mut best = (written.clone(), drawing.free().to_vec());
    let mut round = 0;
    while control.allows_round(round, recipe.settle_rounds) {
        if !control.goes_on(drawing, written.mse) {
            break;
        }
        round += 1;
        let corrected = corrected_targets(drawing, &written);
        if !descend(drawing, recipe, &corrected, written.mse, control) {
            break;
        }
        written = control.writing(drawing.len(), || write(drawing, page))?;
        if written.mse < best.0.mse {
            best = (written.clone(), drawing.free().to_vec());
        }
    }
    drawing.set_free(&best.1);
    Ok(best.0)
}

/// Share of the offset that a round takes from the target. All of it is more than comes back on edges, and
/// spoils the picture in renderers that round otherwise than resvg: half of it is better in resvg by up to
/// 1.3 dB, and by 0.1 to 2.2 dB in others (docs/engines.md).
const OFFSET_TAKEN: f32 = 0.5;

/// What is to be drawn on each ground, less a share of what the file's picture differs by from our render
/// of the same scene.
fn corrected_targets(drawing: &mut Drawing, written: &Written) -> Vec<Canvas> {
    let softs = drawing.soft(&written.scene);
    let grounds = drawing.grounds().iter().zip(&softs).zip(&written.drawn);
    grounds
        .map(|((ground, soft), drawn)| corrected(ground.picture(), soft, drawn))
        .collect()
}

fn corrected(target: &Image, soft: &Image, drawn: &Image) -> Canvas {
    let planes = [0, 1, 2].map(|c| {
        let pixels = target.planes()[c]
            .iter()
            .zip(&soft.planes()[c])
            .zip(&drawn.planes()[c]);
        pixels
            .map(|((target, soft), drawn)| target - OFFSET_TAKEN * (drawn - soft))
            .collect()
    });
    Canvas::from_image(&Image::from_planes(target.width(), target.height(), planes))
}

/// Says whether it came to its end.
fn descend(
    drawing: &mut Drawing,
    recipe: &Recipe,
    targets: &[Canvas],
    mse: f64,
    control: &mut Control<'_>,
) -> bool {
    let steps = recipe.settle_iterations;
    let rates = recipe.polish_rates;
    let schedule = Schedule::Cosine { end: rates.last };
    let mut descent = Descent::new(drawing.free(), rates, drawing.limits);
    for step in 0..steps {
        let rate = schedule.factor(step, steps) as f32 * recipe.settle_rate;
        drawing.step_towards(targets, &mut descent, rate);
        if !control.goes_on(drawing, mse) {
            return false;
        }
        if !control.allows_step() {
            break;
        }
    }
    true
}
