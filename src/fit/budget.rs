//! The budgets of a fit: what they allow, and when they are met.

use super::base::Base;
use super::config::{Budget, Config, MAX_STROKES};
use super::file::RenderedFile;
use super::recipe::{Points, Recipe};
use super::result::Stop;
use crate::image::Image;
use crate::math::Point;
use crate::metrics::psnr_db;
use crate::scene::{Path, Stroke};
use crate::svg;

/// An estimate of how many strokes the budgets allow, those of `base` included; `None` if they set no limit.
pub(super) fn strokes(
    config: &Config,
    recipe: &Recipe,
    base: Option<&Base>,
    target: &Image,
) -> Option<usize> {
    let kept = base.map_or(0, Base::bytes);
    let share = if config.allows_points() {
        recipe.points.capsules
    } else {
        1.0
    };
    let by_bytes = config
        .budget
        .bytes
        .map(|bytes| bytes.saturating_sub(kept) as f32 * share)
        .map(|bytes| (bytes as usize / typical_bytes(config, target)).max(1));
    [config.budget.strokes, by_bytes]
        .into_iter()
        .flatten()
        .min()
}

/// Most strokes of the drawing if the budgets allow `limit`.
pub(super) fn max_strokes(config: &Config, limit: Option<usize>, base: Option<&Base>) -> usize {
    // What a base brings stays, however much that is.
    let brought = base.map_or(0, |base| base.scene.len());
    let most = config.most_strokes().max(brought);
    let most = most.min(MAX_STROKES.saturating_sub(base.map_or(0, Base::elements)));
    limit.map_or(most, |limit| limit.min(most))
}

/// Most points of a drawing of `strokes` strokes, unless bytes or a price limit them.
pub(super) fn points(
    config: &Config,
    recipe: &Points,
    strokes: usize,
    pixels: usize,
) -> Option<usize> {
    let is_limited = config.budget.bytes.is_some() || config.quality_for(pixels).is_some();
    let most = match config.points {
        _ if !config.allows_points() => 2.0,
        Some(most) => recipe.per_stroke.min(most as f32),
        None => recipe.per_stroke,
    };
    (!is_limited).then_some((most * strokes as f32) as usize)
}

/// The recipe for the budget: shorter stages where a polish follows and the number of strokes does not depend on what
/// stages gain, and a shorter polish where a budget of strokes makes points dense.
pub(super) fn recipe(config: &Config, pixels: usize) -> Recipe {
    let mut recipe = config.recipe();
    let stages = &mut recipe.stages;
    let is_counted = config.budget.psnr_db.is_none() && config.quality_for(pixels).is_none();
    if is_counted && config.polish && recipe.polish.iterations > 0 {
        stages.iterations = (stages.iterations as f32 * stages.polished_share) as usize;
    }
    let (polish, most) = (&mut recipe.polish, recipe.points);
    let strokes = config.budget.strokes;
    let points = strokes.and_then(|strokes| points(config, &most, strokes, pixels));
    if points.is_some_and(|points| points as f32 * polish.dense > pixels as f32) {
        polish.iterations = (polish.iterations as f32 * polish.dense_share) as usize;
    }
    recipe
}

/// Bytes of a typical stroke, to estimate how many strokes a budget of bytes allows.
pub(super) fn typical_bytes(config: &Config, target: &Image) -> usize {
    // At two thirds of the picture no decimal is 0; and most strokes are about as short as this one.
    let place = |share: f32, step: f32| {
        let [x, y] = [target.width(), target.height()].map(|side| side as f32 * share);
        Point::new(x + step, y - step)
    };
    let stroke = Stroke {
        path: Path::line(place(2.0 / 3.0, 0.0), place(2.0 / 3.0, 10.0 / 3.0)),
        radius: 5.0 / 3.0,
        color: [1.0 / 3.0; 3].map(|c: f32| c + 0.01),
        opacity: if config.opaque { 1.0 } else { 2.0 / 3.0 },
    };
    svg::stroke_bytes(&stroke, &config.file).max(1)
}

/// Whether the fit depends on the render of its file, or on the file's bytes.
pub(super) fn needs_file(budget: &Budget, recipe: &Recipe) -> bool {
    recipe.settling.rounds > 0 || budget.psnr_db.is_some() || budget.bytes.is_some()
}

/// The first budget that a drawing of `strokes` strokes, written as `file`, meets.
pub(super) fn met(budget: &Budget, strokes: usize, file: &RenderedFile) -> Option<Stop> {
    let is_reached = |db| psnr_db(file.mse) >= db;
    if budget.strokes.is_some_and(|most| strokes >= most) {
        Some(Stop::Strokes)
    } else if budget.psnr_db.is_some_and(is_reached) {
        Some(Stop::Psnr)
    } else if budget.bytes.is_some_and(|most| file.bytes >= most) {
        Some(Stop::Bytes)
    } else {
        None
    }
}

/// Whether `new` serves the budget better than `old`. Few enough bytes count first, then enough fidelity. Of two files
/// that have both, the one with fewer strokes is better; of two that lack fidelity, the one with less error.
pub(super) fn is_better(budget: &Budget, new: &RenderedFile, old: &RenderedFile) -> bool {
    let fits = |f: &RenderedFile| budget.bytes.is_none_or(|most| f.bytes <= most);
    let reached = |f: &RenderedFile| budget.psnr_db.is_some_and(|db| psnr_db(f.mse) >= db);
    match (fits(new), fits(old)) {
        (true, true) => match (reached(new), reached(old)) {
            (true, true) => new.rounded.scene.len() < old.rounded.scene.len(),
            (false, false) => new.mse < old.mse,
            (reaches, _) => reaches,
        },
        (false, false) => new.bytes < old.bytes,
        (fits, _) => fits,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// A file of no strokes.
    fn file(bytes: usize, mse: f64) -> RenderedFile {
        RenderedFile {
            rounded: Scene::empty(4, 3, None).quantized(2),
            drawn: Vec::new(),
            bytes,
            mse,
        }
    }

    /// At 20 dB the mean squared error is 0.01.
    const BUDGET: Budget = Budget {
        strokes: Some(10),
        psnr_db: Some(20.0),
        bytes: Some(100),
        time: None,
    };

    #[test]
    fn a_drawing_meets_the_first_of_its_budgets() {
        let (poor, good, long) = (file(99, 0.02), file(99, 0.005), file(100, 0.02));
        assert_eq!(met(&BUDGET, 9, &poor), None);
        assert_eq!(met(&BUDGET, 9, &good), Some(Stop::Psnr));
        assert_eq!(met(&BUDGET, 9, &long), Some(Stop::Bytes));
        assert_eq!(met(&BUDGET, 10, &good), Some(Stop::Strokes));
        assert_eq!(met(&Budget::default(), 10, &good), None);
    }

    #[test]
    fn bytes_bind_before_fidelity_does() {
        let order = [
            file(200, 0.001),
            file(150, 0.5),
            file(100, 0.03),
            file(100, 0.02),
            file(90, 0.009),
        ];
        for pair in order.windows(2) {
            assert!(is_better(&BUDGET, &pair[1], &pair[0]), "{pair:?}");
            assert!(!is_better(&BUDGET, &pair[0], &pair[1]), "{pair:?}");
        }
    }
}
