//! The budgets of a fit: what they allow, and when they are met.

pub(super) mod memory;
pub(super) mod paleness;
pub(super) mod plan;
pub(super) mod price;
pub(super) mod reduction;

use super::base::Base;
use super::config::{Budget, Config, MAX_STROKES};
use super::file::RenderedFile;
use super::recipe::{self, Recipe};
use super::result::Stop;
use crate::image::Image;
use crate::math::Point;
use crate::metrics::psnr_db;
use crate::scene::{Cap, Path, Stroke};
use crate::svg;

/// Most points per stroke, on average, of a drawing whose budget is in strokes or in dB. Bytes, or a quality, limit the points of
/// others. A guess.
const PER_STROKE: f32 = 7.0;
/// Points per stroke, on average, of a drawing whose budget is in bytes: an estimate, made before it is drawn.
const BOUGHT: f32 = 4.0;
/// Share of a budget of bytes that is planned for strokes of two points; the rest is for more points. A guess.
const CAPSULES: f32 = 0.8;

/// Bytes of a file without layers.
pub(super) const FILE_BYTES: usize = 200;
/// Bytes of a layer without strokes.
pub(super) const LAYER_BYTES: usize = 170;

/// Estimated number of strokes that the budgets allow, including the strokes of `base`; `None` if they set no limit.
pub(super) fn strokes(config: &Config, base: Option<&Base>, target: &Image) -> Option<usize> {
    // The file's head, or the base as a whole, is paid for first.
    let kept = base.map_or(FILE_BYTES + LAYER_BYTES, Base::bytes);
    let share = if config.allows_points() {
        CAPSULES
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
pub(super) fn max_strokes(
    config: &Config,
    limit: Option<usize>,
    base: Option<&Base>,
    pixels: usize,
) -> usize {
    // Strokes that a base brings stay, however many they are.
    let brought = base.map_or(0, |base| base.scene.len());
    let most = config.most_strokes(pixels).max(brought);
    let most = most.min(MAX_STROKES.saturating_sub(base.map_or(0, Base::elements)));
    limit.map_or(most, |limit| limit.min(most))
}

/// Most points of a drawing of `strokes` strokes, unless bytes or a price limit them.
pub(super) fn points(config: &Config, strokes: usize, pixels: usize) -> Option<usize> {
    let most = per_stroke(config, PER_STROKE);
    (!prices_points(config, pixels)).then_some((most * strokes as f32) as usize)
}

/// True if bytes or a price limit the points of a drawing, and not their number.
pub(super) fn prices_points(config: &Config, pixels: usize) -> bool {
    config.budget.bytes.is_some() || config.quality_for(pixels).is_some()
}

/// Points per stroke, where `usual` is the number of them without a limit on the points of a stroke.
fn per_stroke(config: &Config, usual: f32) -> f32 {
    match config.points {
        _ if !config.allows_points() => 2.0,
        Some(most) => usual.min(most as f32),
        None => usual,
    }
}

/// The recipe for the budget: where the number of strokes does not depend on what stages gain, these are shorter if a
/// polish follows, and the polish depends on how dense points are.
pub(super) fn recipe(config: &Config, base: Option<&Base>, target: &Image) -> Recipe {
    let pixels = target.width() * target.height();
    let mut recipe = config.recipe();
    let is_counted = config.budget.psnr_db.is_none() && config.quality_for(pixels).is_none();
    if !is_counted || !config.polish || recipe.polish.iterations == 0 {
        return recipe;
    }
    // A polish fits the strokes of all stages again, so each stage may end sooner.
    let stages = &mut recipe.stages;
    stages.iterations = (stages.iterations as f32 * stages.polished_share) as usize;
    let Some(strokes) = strokes(config, base, target) else {
        return recipe;
    };
    let usual = match config.budget.bytes {
        Some(_) => BOUGHT,
        None => PER_STROKE,
    };
    // Strokes of a budget of strokes have many points, which take their time: there a longer polish brings too little.
    let sparsest = if config.budget.bytes.is_none() && config.allows_points() {
        recipe::SPARSE
    } else {
        f32::INFINITY
    };
    let points = per_stroke(config, usual) * strokes as f32;
    recipe.for_density((pixels as f32 / points).min(sparsest))
}

/// Bytes of a typical stroke, to estimate how many strokes a budget of bytes allows.
pub(super) fn typical_bytes(config: &Config, target: &Image) -> usize {
    // At two thirds of the picture no decimal is 0; and most strokes are about as short as this one.
    let place = |share: f64, step: f64| {
        let [x, y] = [target.width(), target.height()].map(|side| side as f64 * share);
        Point::new(x + step, y - step)
    };
    let stroke = Stroke {
        path: Path::line(place(2.0 / 3.0, 0.0), place(2.0 / 3.0, 10.0 / 3.0)),
        radius: 5.0 / 3.0,
        radii: Vec::new(),
        cap: Cap::Round,
        color: [1.0 / 3.0; 3].map(|c: f32| c + 0.01),
        opacity: if config.opaque { 1.0 } else { 2.0 / 3.0 },
    };
    svg::mark_bytes(&stroke.into(), &config.file).max(1)
}

/// True if the fit depends on the render of its file, or on the file's bytes.
pub(super) fn needs_file(budget: &Budget, recipe: &Recipe) -> bool {
    recipe.settling_rounds > 0 || budget.psnr_db.is_some() || budget.bytes.is_some()
}

/// True if two files are compared by the budget rather than by price.
pub(super) fn compares_files(config: &Config, recipe: &Recipe) -> bool {
    !config.budget.is_open() && config.quality.is_none() && needs_file(&config.budget, recipe)
}

/// The reason for the end of a fit that has drawn its whole plan.
pub(super) fn planned_stop(budget: &Budget) -> Stop {
    match (budget.strokes, budget.bytes) {
        (None, Some(_)) => Stop::Bytes,
        _ => Stop::Strokes,
    }
}

/// The first budget that a drawing of `strokes` strokes, written as `file`, meets.
pub(super) fn met(budget: &Budget, strokes: usize, file: &RenderedFile) -> Option<Stop> {
    // The first limit that holds is the reason given.
    if budget.strokes.is_some_and(|most| strokes >= most) {
        Some(Stop::Strokes)
    } else if reaches(budget, file) {
        Some(Stop::Psnr)
    } else if budget.bytes.is_some_and(|most| file.bytes >= most) {
        Some(Stop::Bytes)
    } else {
        None
    }
}

/// True if `file` has no more strokes and bytes than allowed.
pub(super) fn fits(budget: &Budget, file: &RenderedFile) -> bool {
    let strokes = file.rounded.scene.len();
    budget.strokes.is_none_or(|most| strokes <= most)
        && budget.bytes.is_none_or(|most| file.bytes <= most)
}

/// True if a fidelity is asked for, and `file` has it.
fn reaches(budget: &Budget, file: &RenderedFile) -> bool {
    budget.psnr_db.is_some_and(|db| psnr_db(file.mse()) >= db)
}

/// True if `new` serves the budget better than `old`. Few enough strokes and bytes count first, then enough fidelity. Of two files
/// that have both, the one with fewer strokes is better; of two that lack fidelity, the one with less error.
pub(super) fn is_better(budget: &Budget, new: &RenderedFile, old: &RenderedFile) -> bool {
    match (fits(budget, new), fits(budget, old)) {
        // Both fit: fidelity decides, then the number of strokes or the error.
        (true, true) => match (reaches(budget, new), reaches(budget, old)) {
            (true, true) => new.rounded.scene.len() < old.rounded.scene.len(),
            (false, false) => new.mse() < old.mse(),
            // One of the two reaches the fidelity; it is better if that's the new one.
            (reaches, _) => reaches,
        },
        // Neither fits: the nearer to the limit.
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
            errors: vec![mse],
            rounded: Scene::empty(4, 3, None).quantized(2),
            drawn: Vec::new(),
            bytes,
        }
    }

    /// At 20 dB the mean squared error is 0.01.
    const BUDGET: Budget = Budget {
        strokes: Some(10),
        psnr_db: Some(20.0),
        bytes: Some(100),
        time: None,
    };

    /// The recipe for 64×64 px.
    fn recipe_for(budget: Budget, points: Option<usize>) -> Recipe {
        let config = Config {
            budget,
            points,
            ..Config::default()
        };
        recipe(&config, None, &Image::filled(64, 64, [0.5; 3]).unwrap())
    }

    fn strokes_only(strokes: usize) -> Budget {
        Budget {
            strokes: Some(strokes),
            ..Budget::default()
        }
    }

    #[test]
    fn a_polish_is_the_longer_the_sparser_points_are() {
        let usual = Config::default().recipe();
        let iterations = |budget| recipe_for(budget, None).polish.iterations;
        let all = usual.polish.iterations;
        // 29 and 12 px per point; of bytes, more than 300.
        assert_eq!(iterations(strokes_only(20)), all);
        assert_eq!(iterations(strokes_only(50)), all * 75 / 100);
        let few_bytes = Budget {
            bytes: Some(300),
            ..Budget::default()
        };
        assert_eq!(iterations(few_bytes), all * 5 / 2);
        assert_eq!(iterations(strokes_only(1)), all);
        let straight = recipe_for(strokes_only(1), Some(2));
        assert_eq!(straight.polish.iterations, all * 5 / 2);
    }

    #[test]
    fn dense_points_move_less_at_once() {
        let step = |strokes| {
            let recipe = recipe_for(strokes_only(strokes), None);
            recipe.polish.rates.position
        };
        assert_eq!(step(20), Config::default().recipe().polish.rates.position);
        assert!(step(50) < step(20));
    }

    #[test]
    fn points_have_a_price_unless_strokes_are_counted() {
        let is_priced = |budget| {
            let config = Config {
                budget,
                ..Config::default()
            };
            prices_points(&config, 4096)
        };
        let bytes = Budget {
            bytes: Some(9000),
            ..strokes_only(50)
        };
        assert!(is_priced(bytes) && is_priced(Budget::default()));
        assert!(!is_priced(strokes_only(50)));
    }

    #[test]
    fn only_dense_points_are_jittered() {
        let [dense, straight, sparse] = [(50, None), (50, Some(2)), (20, None)]
            .map(|(strokes, points)| recipe_for(strokes_only(strokes), points));
        assert!(dense.polish.jitter > 0.0);
        assert!(dense.min_opacity > sparse.min_opacity);
        assert_eq!(straight.polish.jitter, 0.0, "100 points are not dense");
        assert_eq!(sparse.polish.jitter, 0.0);
    }

    #[test]
    fn where_gains_decide_nothing_is_known_of_density() {
        let psnr = Budget {
            psnr_db: Some(30.0),
            ..strokes_only(50)
        };
        let usual = Config::default().recipe();
        for budget in [Budget::default(), psnr] {
            assert_eq!(recipe_for(budget, None), usual);
        }
    }

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
