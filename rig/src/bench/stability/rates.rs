//! Extreme learning rates, non-finite numbers and very long runs: the drawing has to stay valid.

use super::pictures::{Sound, sound};
use super::{Check, Extent, Observation};
use crate::lab::article::{Capsules, Reproduction};
use strokefit::Result;
use strokefit::fit::{Budget, Config, Execution, Fit, Fitter, Preset, Rates, Recipe};
use strokefit::image::Image;
use strokefit::math;
use strokefit::metrics;
use strokefit::svg::{self, WriteOptions};

const STROKES: usize = 40;

pub(super) fn checks(extent: Extent) -> Vec<Check<'static>> {
    let rates = [
        ("rates-tiny", "all learning rates × 10⁻⁶", 1e-6),
        ("rates-large", "all learning rates × 10²", 1e2),
        ("rates-huge", "all learning rates × 10⁶", 1e6),
        (
            "rates-nan",
            "NaN learning rates: every stroke becomes NaN",
            f32::NAN,
        ),
        (
            "rates-infinite",
            "infinite learning rates: every stroke moves to the limits",
            f32::INFINITY,
        ),
    ];
    let wild = rates
        .into_iter()
        .map(|(name, what, factor)| Check::new("rates", name, what, move || with_rates(factor)));
    let steps = match extent {
        Extent::Short => 2_000,
        Extent::Full => 100_000,
    };
    let long = [
        Check::new(
            "rates",
            "long-polish",
            format!("{steps} iterations of polish"),
            move || long_polish(steps),
        ),
        Check::new(
            "rates",
            "long-descent",
            format!("{steps} iterations of the article's recipe"),
            move || long_descent(steps),
        ),
    ];
    wild.chain(long).collect()
}

fn config(recipe: Recipe) -> Config {
    Config {
        budget: Budget {
            strokes: Some(STROKES),
            ..Budget::default()
        },
        preset: Preset::Draft,
        recipe: Some(recipe),
        ..Config::default()
    }
}

/// A disc on a ramp.
fn picture() -> Result<Image> {
    let (width, height) = (64, 48);
    let value = |c: usize, i: usize| {
        let (x, y) = ((i % width) as f32, (i / width) as f32);
        let away = math::hypot(x - 30.0, y - 24.0);
        if away < 14.0 {
            0.1 * c as f32 + away / 40.0
        } else {
            0.5 + 0.4 * x / width as f32
        }
    };
    let plane = |c| (0..width * height).map(|i| value(c, i)).collect();
    Image::new(width, height, [plane(0), plane(1), plane(2)])
}

fn fitted(recipe: Recipe) -> Result<(Fit, Sound)> {
    let fit = Fitter::new(config(recipe)).fit(&picture()?)?;
    let text = svg::write(&fit.scene, &WriteOptions::default());
    let sound = sound(&fit, &text)?;
    Ok((fit, sound))
}

/// Sensible rates, or tiny ones, have to make a useful drawing; others a valid one. Rates that are no
/// numbers poison every stroke: all have to be dropped and counted.
fn with_rates(factor: f32) -> Result<Observation> {
    let mut recipe = Recipe::of(Preset::Draft);
    let times = |rates: Rates| Rates {
        position: rates.position * factor,
        radius: rates.radius * factor,
        color: rates.color * factor,
        opacity: rates.opacity * factor,
        ..rates
    };
    recipe.stages.rates = times(recipe.stages.rates);
    recipe.polish.rates = times(recipe.polish.rates);
    let (fit, sound) = fitted(recipe)?;
    let sensible = factor <= 1.0;
    let useful = sound.holds() || !sensible;
    let counted = !factor.is_nan() || fit.dropped.total() > 0 && fit.scene.is_empty();
    let figure = format!("{sound}, {} dropped and counted", fit.dropped.total());
    Ok(Observation::new(
        figure,
        sound.is_valid() && useful && counted,
    ))
}

fn long_polish(steps: usize) -> Result<Observation> {
    let mut recipe = Recipe::of(Preset::Draft);
    recipe.polish.iterations = steps;
    let (_, sound) = fitted(recipe)?;
    Ok(Observation::new(sound.to_string(), sound.holds()))
}

/// All numbers have to stay finite, and the end may not be much worse than the middle.
fn long_descent(steps: usize) -> Result<Observation> {
    let picture = picture()?;
    let start = Capsules::random(picture.width(), picture.height(), STROKES, 1);
    let mut descent = Reproduction::new(&picture, start, Execution::default())?;
    let coverage = strokefit::coverage::Coverage::Smoothstep;
    let mut l1_after = |count: usize| -> Result<f64> {
        (0..count).for_each(|_| {
            descent.step(coverage);
        });
        let finite = descent
            .drawing()
            .strokes
            .numbers()
            .iter()
            .all(|v| v.is_finite());
        let l1 = metrics::l1(&picture, &descent.render(coverage))?;
        Ok(if finite { l1 } else { f64::NAN })
    };
    let (middle, end) = (l1_after(steps / 10)?, l1_after(steps - steps / 10)?);
    let figure =
        format!("L1 {middle:.4} after a tenth of the run, {end:.4} at its end, all finite");
    Ok(Observation::new(figure, end <= 1.1 * middle))
}
