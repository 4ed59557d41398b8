//! Polish: all strokes of the drawing fitted jointly, with relocation.
//!
//! Every so often the strokes worth least by exact leave-one-out are taken away, and candidates whose
//! closed-form gain is larger are put on top instead.

use super::anneal::Anneal;
use super::descent::Descent;
use super::drawing::Drawing;
use super::objective::Objective;
use super::recipe::Recipe;
use crate::loss::Loss;
use crate::optim::{Adam, AdamParams, Optimizer, Schedule};
use crate::render::{Base, Gradients, Params};
use crate::seed::{Candidate, Wanted, propose};

/// Fits all strokes and the background jointly; strokes are relocated, their number stays.
pub(super) fn run(drawing: &mut Drawing, recipe: &Recipe, anneal: Anneal) {
    let steps = recipe.polish_iterations;
    let rates = recipe.polish_rates;
    let schedule = Schedule::Cosine { end: rates.last };
    let mut descent = Descent::new(drawing.strokes.len(), rates, drawing.limits);
    let mut background = Adam::new(3, AdamParams::default());
    for step in 0..steps {
        if step > 0 && step % recipe.relocate_every == 0 && step + recipe.relocate_every / 2 < steps
        {
            relocate(drawing, recipe, anneal, &mut descent);
        }
        let rate = schedule.factor(step, steps) as f32;
        let objective = Objective::new(Loss::L2, &drawing.target);
        let base = Base::Flat(drawing.background);
        descent.step(
            &mut drawing.renderer,
            &mut drawing.strokes,
            anneal.at(step, steps),
            base,
            &objective,
            rate,
        );
        background.step(
            &mut drawing.background,
            &descent.gradients.base,
            rate * rates.color,
        );
        drawing.background = drawing.background.map(|c| c.clamp(0.0, 1.0));
    }
    drawing.render(&anneal);
}

/// Swaps the strokes worth least for candidates that gain more.
fn relocate(drawing: &mut Drawing, recipe: &Recipe, anneal: Anneal, descent: &mut Descent) {
    let worth = worths(drawing, anneal);
    let count = (drawing.strokes.len() as f64 * recipe.relocate_share).ceil() as usize;
    let scale = (drawing.pixels() as f32 / drawing.strokes.len() as f32).sqrt()
        * recipe.scale
        * recipe.relocate_scale;
    let wanted = Wanted {
        count,
        scale,
        oversampling: recipe.oversampling,
        least_opacity: drawing.limits.least_opacity,
    };
    drawing.render(&anneal);
    let candidates = propose(drawing.level, &drawing.pyramid, &drawing.canvas, wanted);
    let losers = swaps(&worth, &candidates);
    let newcomers: Vec<Params> = candidates[..losers.len()]
        .iter()
        .rev()
        .map(|c| c.stroke)
        .collect();
    let mut leaves = vec![false; worth.len()];
    losers.iter().for_each(|&i| leaves[i] = true);
    let stays: Vec<usize> = (0..worth.len()).filter(|&i| !leaves[i]).collect();
    let strokes = stays
        .iter()
        .map(|&i| drawing.strokes[i])
        .chain(newcomers)
        .collect();
    drawing.strokes = strokes;
    let mut sources: Vec<Option<usize>> = stays.into_iter().map(Some).collect();
    sources.resize(drawing.strokes.len(), None);
    descent.rearrange(&sources);
}

/// What each stroke is worth at the final softness: the squared error that it removes.
fn worths(drawing: &mut Drawing, anneal: Anneal) -> Vec<f32> {
    let objective = Objective::new(Loss::L2, &drawing.target);
    let mut gradients = Gradients::default();
    let base = Base::Flat(drawing.background);
    drawing.renderer.backward_with_worth(
        &drawing.strokes,
        anneal.last(),
        base,
        &objective,
        &mut gradients,
    );
    gradients.worth
}

/// The strokes to give up, the i-th for the i-th candidate, while the candidate is worth more.
fn swaps(worth: &[f32], candidates: &[Candidate]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..worth.len()).collect();
    order.sort_by(|&i, &j| worth[i].total_cmp(&worth[j]).then(i.cmp(&j)));
    let pairs = order.into_iter().zip(candidates);
    pairs
        .take_while(|&(i, candidate)| candidate.gain > worth[i])
        .map(|(i, _)| i)
        .collect()
}
