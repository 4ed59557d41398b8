//! One stage: seed where the residual is largest, fit the new strokes alone on the frozen ones below,
//! keep what pays.

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

/// Adds the planned strokes on top of `drawing`, less those that are not worth their `price`; they stay
/// free. Returns how many there are.
pub(super) fn add(
    drawing: &mut Drawing,
    recipe: &Recipe,
    anneal: Anneal,
    plan: PlannedStage,
    price: Price,
    control: &mut Control<'_>,
) -> usize {
    drawing.refine(plan.scale);
    drawing.freeze();
    let candidates = drawing.propose(plan.count, plan.scale, recipe.oversampling);
    // The best candidate is drawn last, so that none of lesser gain hides it.
    drawing.extend(candidates.iter().rev().map(|c| c.stroke), plan.index);
    let anneal = Anneal {
        from: plan.scale.min(SOFTEST),
        ..anneal
    };
    descend(drawing, recipe, anneal, control);
    accept(drawing, price);
    drawing.free().len()
}

fn descend(drawing: &mut Drawing, recipe: &Recipe, anneal: Anneal, control: &mut Control<'_>) {
    let steps = recipe.stage_iterations;
    let schedule = Schedule::Cosine {
        end: recipe.stage_rates.last,
    };
    let mut descent = Descent::new(drawing.free(), recipe.stage_rates, drawing.limits);
    for step in 0..steps {
        let rate = schedule.factor(step, steps) as f32;
        drawing.step(&mut descent, anneal.at(step as f32 / steps as f32), rate);
        if !control.advance(drawing, descent.gradients.loss) {
            return;
        }
    }
}

fn accept(drawing: &mut Drawing, price: Price) {
    let worth = drawing.judge().worth;
    let strokes = drawing.free().iter().zip(worth);
    let keep: Vec<bool> = strokes
        .map(|(stroke, worth)| worth > price.of(stroke))
        .collect();
    drawing.retain_free(&keep);
}
