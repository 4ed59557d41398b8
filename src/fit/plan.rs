//! How many strokes each stage adds, and how large they are.

use super::config::Config;
use super::drawing::Drawing;
use super::recipe::Recipe;

/// One planned stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlannedStage {
    /// From 0.
    pub(super) index: usize,
    /// Strokes to add.
    pub(super) count: usize,
    /// Their typical radius, px.
    pub(super) scale: f32,
}

/// Strokes of a drawing whose budget does not say.
const DEFAULT_STROKES: usize = 1000;

/// The stages of a fit.
pub(super) fn stages(drawing: &Drawing, config: &Config, recipe: &Recipe) -> Vec<PlannedStage> {
    let total = config.budget.strokes.unwrap_or(DEFAULT_STROKES);
    let stages = config.stages.unwrap_or(recipe.stages);
    counts(total, stages, recipe.growth)
        .into_iter()
        .scan(0, |reached, count| {
            *reached += count;
            Some((count, recipe.scale * drawing.spacing(*reached)))
        })
        .enumerate()
        .map(|(index, (count, scale))| PlannedStage {
            index,
            count,
            scale,
        })
        .collect()
}

/// The work of all stages and the polish, in strokes × iterations.
pub(super) fn work(plan: &[PlannedStage], config: &Config, recipe: &Recipe) -> f64 {
    let strokes: usize = plan.iter().map(|stage| stage.count).sum();
    let polish = if config.polish {
        recipe.polish_iterations
    } else {
        0
    };
    (strokes * (recipe.stage_iterations + polish)) as f64
}

/// `total` strokes in at most `stages` stages, each `growth` times the one before.
fn counts(total: usize, stages: usize, growth: f64) -> Vec<usize> {
    let weights: Vec<f64> = (0..stages).map(|k| growth.powi(k as i32)).collect();
    let whole: f64 = weights.iter().sum();
    let (mut counts, mut before, mut reached) = (Vec::new(), 0, 0.0);
    for weight in weights {
        reached += weight;
        let after = (total as f64 * reached / whole).round() as usize;
        if after > before {
            counts.push(after - before);
        }
        before = after;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_grow_and_add_up() {
        let counts = counts(1000, 8, 1.6);
        assert_eq!(counts.len(), 8);
        assert_eq!(counts.iter().sum::<usize>(), 1000);
        assert!(counts.windows(2).all(|w| w[1] > w[0]));
    }

    #[test]
    fn few_strokes_make_few_stages() {
        let counts = counts(2, 8, 1.6);
        assert_eq!(counts.iter().sum::<usize>(), 2);
        assert!(counts.iter().all(|&count| count > 0));
        assert!(counts.len() <= 2);
    }
}
