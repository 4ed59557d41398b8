//! One stage: seed where the residual is largest, fit the new strokes alone on the frozen canvas, accept.

use super::anneal::Anneal;
use super::descent::{Descent, Limits};
use super::drawing::Drawing;
use super::objective::Objective;
use super::recipe::Recipe;
use crate::loss::Loss;
use crate::optim::Schedule;
use crate::render::{Base, Gradients, Params};
use crate::seed::{Wanted, propose};

/// Adds up to `count` strokes of about `scale` px on top of `drawing`.
pub(super) fn add(
    drawing: &mut Drawing,
    recipe: &Recipe,
    anneal: Anneal,
    count: usize,
    scale: f32,
) {
    let mut strokes = seed(drawing, recipe, count, scale);
    descend(drawing, recipe, anneal, &mut strokes);
    accept(drawing, anneal, strokes);
}

fn seed(drawing: &Drawing, recipe: &Recipe, count: usize, scale: f32) -> Vec<Params> {
    let wanted = Wanted {
        count,
        scale,
        oversampling: recipe.oversampling,
        least_opacity: drawing.limits.least_opacity,
    };
    let candidates = propose(drawing.level, &drawing.pyramid, &drawing.canvas, wanted);
    // The best candidate is drawn last, so that none of lesser gain hides it.
    candidates.iter().rev().map(|c| c.stroke).collect()
}

fn descend(drawing: &mut Drawing, recipe: &Recipe, anneal: Anneal, strokes: &mut [Params]) {
    let steps = recipe.stage_iterations;
    let rates = recipe.stage_rates;
    let schedule = Schedule::Cosine { end: rates.last };
    let mut descent = Descent::new(strokes.len(), rates, drawing.limits);
    let objective = Objective::new(Loss::L2, &drawing.target);
    let base = Base::Canvas(&drawing.canvas);
    for step in 0..steps {
        let rate = schedule.factor(step, steps) as f32;
        descent.step(
            &mut drawing.renderer,
            strokes,
            anneal.at(step, steps),
            base,
            &objective,
            rate,
        );
    }
}

/// Takes the strokes into the drawing, without those that make it worse.
fn accept(drawing: &mut Drawing, anneal: Anneal, mut strokes: Vec<Params>) {
    let objective = Objective::new(Loss::L2, &drawing.target);
    let mut gradients = Gradients::default();
    let base = Base::Canvas(&drawing.canvas);
    drawing
        .renderer
        .backward_with_worth(&strokes, anneal.last(), base, &objective, &mut gradients);
    let mut worth = gradients.worth.iter();
    strokes.retain(|_| worth.next().is_some_and(|&w| w > 0.0));
    let below = drawing.canvas.clone();
    drawing.renderer.forward(
        &strokes,
        anneal.last(),
        Base::Canvas(&below),
        &mut drawing.canvas,
    );
    drawing.stages.push(strokes.len());
    drawing.strokes.extend(strokes);
}
