//! One stage: seed where the residual is largest, fit the new strokes alone on the frozen canvas, accept.

use super::anneal::Anneal;
use super::control::Control;
use super::descent::Descent;
use super::drawing::Drawing;
use super::objective::Objective;
use super::plan::PlannedStage;
use super::recipe::Recipe;
use crate::loss::Loss;
use crate::optim::Schedule;
use crate::render::{Base, Gradients, Params};
use crate::seed::{Wanted, propose};

/// Softness of the first iteration at most, in units of the final one.
const SOFTEST: f32 = 4.0;

/// Adds the planned strokes on top of `drawing`, less those that remove no error.
pub(super) fn add(
    drawing: &mut Drawing,
    recipe: &Recipe,
    anneal: Anneal,
    plan: PlannedStage,
    control: &mut Control<'_>,
) {
    let mut strokes = seed(drawing, recipe, plan);
    let anneal = Anneal {
        from: plan.scale.min(SOFTEST),
        ..anneal
    };
    descend(drawing, recipe, anneal, &mut strokes, control);
    accept(drawing, anneal, strokes, plan.index);
}

fn seed(drawing: &mut Drawing, recipe: &Recipe, plan: PlannedStage) -> Vec<Params> {
    let wanted = Wanted {
        count: plan.count,
        scale: plan.scale,
        oversampling: recipe.oversampling,
        least_opacity: drawing.limits.least_opacity,
        key: drawing.next_key(),
    };
    let candidates = propose(drawing.level, &drawing.pyramid, &drawing.canvas, wanted);
    // The best candidate is drawn last, so that none of lesser gain hides it.
    candidates.iter().rev().map(|c| c.stroke).collect()
}

fn descend(
    drawing: &mut Drawing,
    recipe: &Recipe,
    anneal: Anneal,
    strokes: &mut [Params],
    control: &mut Control<'_>,
) {
    let steps = recipe.stage_iterations;
    let schedule = Schedule::Cosine {
        end: recipe.stage_rates.last,
    };
    let mut descent = Descent::new(strokes.len(), recipe.stage_rates, drawing.limits);
    let objective = Objective::new(Loss::L2, &drawing.target);
    let base = Base::Canvas(&drawing.canvas);
    for step in 0..steps {
        let done = step as f32 / steps as f32;
        let rate = schedule.factor(step, steps) as f32;
        descent.step(
            &mut drawing.renderer,
            strokes,
            anneal.at(done),
            base,
            &objective,
            rate,
        );
        if !control.advance(strokes.len() as f64, descent.gradients.loss) {
            return;
        }
    }
}

/// Takes the strokes into the drawing, without those that are not worth it.
fn accept(drawing: &mut Drawing, anneal: Anneal, mut strokes: Vec<Params>, stage: usize) {
    let objective = Objective::new(Loss::L2, &drawing.target);
    let mut gradients = Gradients::default();
    let base = Base::Canvas(&drawing.canvas);
    drawing
        .renderer
        .backward_with_worth(&strokes, anneal.last(), base, &objective, &mut gradients);
    let mut worth = gradients.worth.iter();
    strokes.retain(|_| worth.next().is_some_and(|&w| w > 0.0));
    drawing.extend(strokes, stage);
}
