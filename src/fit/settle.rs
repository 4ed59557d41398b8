//! Settling: the last steps are taken against what the file really looks like.
//!
//! A renderer of SVG rounds after every stroke to 8 bits and has its own antialiasing, so that its
//! picture differs from our canvas by an offset that hardly changes when strokes move a little. Each
//! round renders the rounded drawing as SVG, takes of the offsets of those who will look at it ([`panel`]
//! says of whose, and how much) from the target, and descends a few iterations; the best file is kept.
//!
//! [`panel`]: super::panel

use super::background::Background;
use super::base::Base;
use super::config::Config;
use super::control::Control;
use super::descent::Descent;
use super::drawing::Drawing;
use super::panel::Views;
use super::recipe::{Rates, Recipe};
use crate::error::Result;
use crate::image::Image;
use crate::optim::Schedule;
use crate::render::{Canvas, Params};
use crate::scene::Quantized;
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

/// A drawing as its file says it, and what that looks like.
#[derive(Debug, Clone)]
pub(super) struct Written {
    pub(super) rounded: Quantized,
    /// What an SVG renderer draws on each ground.
    pub(super) drawn: Vec<Image>,
    /// Bytes of SVG.
    pub(super) bytes: usize,
    /// The mean squared error on the ground where it is largest.
    pub(super) mse: f64,
}

/// Rounds `drawing` to what its file says.
pub(super) fn round(drawing: &Drawing, page: Page<'_>) -> Quantized {
    let scene = drawing.scene(page.has_ground);
    scene.quantized(page.file.precision)
}

/// Rounds and writes `drawing` and renders the file.
pub(super) fn write(drawing: &Drawing, page: Page<'_>) -> Result<Written> {
    let rounded = round(drawing, page);
    let text = Base::write(page.base, &rounded.scene, &page.file);
    let (mut drawn, mut mse) = (Vec::new(), 0.0_f64);
    for ground in drawing.grounds() {
        let image = verify::render_like(&text, ground.picture(), ground.paper)?;
        mse = mse.max(metrics::mse(ground.picture(), &image)?);
        drawn.push(image);
    }
    Ok(Written {
        rounded,
        bytes: text.len(),
        drawn,
        mse,
    })
}

/// Descends against the file's own pictures and returns the best of the files; `drawing` becomes the
/// drawing that it was written from. All strokes must be free.
pub(super) fn run(
    drawing: &mut Drawing,
    page: Page<'_>,
    recipe: &Recipe,
    control: &mut Control<'_>,
) -> Result<Written> {
    let mut written = control.writing(drawing.len(), || write(drawing, page))?;
    if !control.allows_round(0, recipe.settle_rounds) {
        return Ok(written);
    }
    let mut views = Views::of(drawing, &written)?;
    let mut best = Best::of(drawing, &written, views.badness());
    let (mut share, mut pace) = (views.first_share(), 1.0);
    let mut round = 0;
    while control.allows_round(round, recipe.settle_rounds) {
        if !control.goes_on(drawing, written.mse) {
            break;
        }
        round += 1;
        let targets = views.targets(drawing, &written, share);
        let rates = rates(recipe, pace);
        if !descend(drawing, recipe, rates, &targets, written.mse, control) {
            break;
        }
        written = control.writing(drawing.len(), || write(drawing, page))?;
        views = Views::of(drawing, &written)?;
        if views.badness() < best.badness {
            best = Best::of(drawing, &written, views.badness());
        }
        share = views.next_share(share);
        pace *= NEXT_PACE;
    }
    drawing.set_free(&best.free);
    Ok(best.written)
}

/// The best file so far, and the strokes that it was written from.
struct Best {
    written: Written,
    free: Vec<Params>,
    badness: f64,
}

impl Best {
    fn of(drawing: &Drawing, written: &Written, badness: f64) -> Self {
        Self {
            written: written.clone(),
            free: drawing.free().to_vec(),
            badness,
        }
    }
}

/// How much farther than in the joint fit colours and opacities go, as the strokes hardly move.
const COLOR_RATE: f32 = 5.0;

/// How far strokes move in a round, in units of the round before. What programs make of an edge changes with
/// its place, so that a correction holds for edges that stay where they are.
const NEXT_PACE: f32 = 0.1;

/// Step sizes, with strokes moving by a share `pace` of what they do in the joint fit.
fn rates(recipe: &Recipe, pace: f32) -> Rates {
    let rates = recipe.polish_rates;
    Rates {
        position: pace * rates.position,
        radius: pace * rates.radius,
        color: COLOR_RATE * rates.color,
        opacity: COLOR_RATE * rates.opacity,
        ..rates
    }
}

/// Says whether it came to its end.
fn descend(
    drawing: &mut Drawing,
    recipe: &Recipe,
    rates: Rates,
    targets: &[Canvas],
    mse: f64,
    control: &mut Control<'_>,
) -> bool {
    let steps = recipe.settle_iterations;
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
