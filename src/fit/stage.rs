//! One stage: seed where the residual is largest, fit the new strokes alone on the frozen ones below,
//! keep what pays.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::anneal::Anneal;
use super::control::Control;
use super::descent::Descent;
use super::drawing::Drawing;
use super::plan::PlannedStage;
use super::price::Price;
use super::recipe::Recipe;
use crate::optim::Schedule;

/// Softness of the first iteration at most, in units of the final one.
const SOFTEST: f32 = 4.0;

/// A stage under way. Its strokes are the free ones of the drawing.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Stage {
    pub(super) planned: PlannedStage,
    /// When it began, since the fit began.
    pub(super) began: Duration,
    /// Iterations that are done.
    step: usize,
    descent: Descent,
}

impl Stage {
    /// Puts the planned strokes on top of `drawing`.
    pub(super) fn seed(
        drawing: &mut Drawing,
        recipe: &Recipe,
        planned: PlannedStage,
        began: Duration,
    ) -> Self {
        drawing.refine(planned.scale);
        drawing.freeze();
        let candidates = drawing.propose(planned.count, planned.scale, recipe.oversampling);
        // The best candidate is drawn last, so that none of lesser gain hides it.
        drawing.extend(candidates.iter().rev().map(|c| c.stroke), planned.index);
        Self {
            planned,
            began,
            step: 0,
            descent: Descent::new(drawing.free(), recipe.stage_rates, drawing.limits),
        }
    }

    /// One iteration; false when none is left.
    pub(super) fn step(
        &mut self,
        drawing: &mut Drawing,
        recipe: &Recipe,
        anneal: Anneal,
        control: &mut Control<'_>,
    ) -> bool {
        let (step, steps) = (self.step, recipe.stage_iterations);
        if step >= steps {
            return false;
        }
        let anneal = Anneal {
            from: self.planned.scale.min(SOFTEST),
            ..anneal
        };
        let end = recipe.stage_rates.last;
        let rate = Schedule::Cosine { end }.factor(step, steps) as f32;
        let softness = anneal.at(step as f32 / steps as f32);
        drawing.step(&mut self.descent, softness, rate);
        control.advance(drawing, self.descent.gradients.loss);
        self.step += 1;
        true
    }
}

/// Takes the free strokes that are not worth their `price` away, and says how many are left.
pub(super) fn accept(drawing: &mut Drawing, price: Price) -> usize {
    let worth = drawing.judge().worth;
    let strokes = drawing.free().iter().zip(worth);
    let keep: Vec<bool> = strokes
        .map(|(stroke, worth)| worth > price.of(stroke))
        .collect();
    drawing.retain_free(&keep);
    drawing.free().len()
}
