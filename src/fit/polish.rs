//! Polish: all strokes and the background fitted jointly, with relocation.
//!
//! Every so often the strokes worth least by exact leave-one-out are taken away, and candidates whose
//! closed-form gain is larger are put on top instead. Their number stays the same.

use super::anneal::Anneal;
use super::control::Control;
use super::descent::Descent;
use super::drawing::Drawing;
use super::objective::Objective;
use super::recipe::Recipe;
use crate::loss::Loss;
use crate::optim::{Adam, AdamParams, Optimizer, Schedule};
use crate::render::{Base, Params};
use crate::seed::{Candidate, Wanted, propose};

/// Fits all strokes of `drawing` jointly; the background too, unless it is fixed.
pub(super) fn run(
    drawing: &mut Drawing,
    recipe: &Recipe,
    anneal: Anneal,
    control: &mut Control<'_>,
) {
    let steps = recipe.polish_iterations;
    let schedule = Schedule::Cosine {
        end: recipe.polish_rates.last,
    };
    let anneal = Anneal {
        from: recipe.polish_softness,
        ..anneal
    };
    let mut descent = Descent::new(drawing.strokes.len(), recipe.polish_rates, drawing.limits);
    let mut background = Adam::new(3, AdamParams::default());
    let mut clock = Clock::new(steps, control);
    while let Some(step) = clock.tick(control) {
        if recipe.relocates(step, clock.done()) {
            relocate(drawing, recipe, &mut descent);
        }
        let rate = schedule.factor((clock.done() * steps as f32) as usize, steps) as f32;
        let objective = Objective::new(Loss::L2, &drawing.target);
        let base = Base::Flat(drawing.background);
        let softness = anneal.at(clock.done());
        descent.step(
            &mut drawing.renderer,
            &mut drawing.strokes,
            softness,
            base,
            &objective,
            rate,
        );
        if !drawing.background_fixed {
            background.step(
                &mut drawing.background,
                &descent.gradients.base,
                rate * recipe.polish_rates.color,
            );
            drawing.background = drawing.background.map(|c| c.clamp(0.0, 1.0));
        }
        if !control.advance(drawing.strokes.len() as f64, descent.gradients.loss) {
            break;
        }
    }
    drawing.render();
}

/// Counts iterations, and hurries the schedule on when the time limit would cut it short.
struct Clock {
    step: usize,
    steps: usize,
    /// Share of the time limit that was used before.
    before: f32,
    done: f32,
}

impl Clock {
    fn new(steps: usize, control: &Control<'_>) -> Self {
        Self {
            step: 0,
            steps,
            before: control.time_used(),
            done: 0.0,
        }
    }

    /// The next iteration, or `None` when the schedule is over.
    fn tick(&mut self, control: &Control<'_>) -> Option<usize> {
        let by_count = self.step as f32 / self.steps.max(1) as f32;
        let left = (1.0 - self.before).max(f32::MIN_POSITIVE);
        let by_time = (control.time_used() - self.before) / left;
        self.done = by_count.max(by_time);
        self.step += 1;
        (self.done < 1.0).then_some(self.step - 1)
    }

    fn done(&self) -> f32 {
        self.done
    }
}

/// Swaps the strokes worth least for candidates that gain more.
fn relocate(drawing: &mut Drawing, recipe: &Recipe, descent: &mut Descent) {
    let worth = drawing.judge().worth;
    drawing.render();
    let wanted = Wanted {
        count: (drawing.strokes.len() as f32 * recipe.relocate_share).ceil() as usize,
        scale: drawing.spacing(drawing.strokes.len()) * recipe.scale * recipe.relocate_scale,
        oversampling: recipe.oversampling,
        least_opacity: drawing.limits.least_opacity,
        key: drawing.next_key(),
    };
    let candidates = propose(drawing.level, &drawing.pyramid, &drawing.canvas, wanted);
    let keep = survivors(&worth, &candidates);
    let mut sources: Vec<Option<usize>> = (0..keep.len()).filter(|&i| keep[i]).map(Some).collect();
    let newcomers = keep.len() - sources.len();
    let newcomers: Vec<Params> = candidates[..newcomers]
        .iter()
        .rev()
        .map(|c| c.stroke)
        .collect();
    let stage = drawing.last_stage();
    drawing.retain(&keep);
    drawing.extend(newcomers, stage);
    sources.resize(drawing.strokes.len(), None);
    descent.rearrange(&sources);
}

/// Which strokes stay: the i-th from the bottom goes while the i-th best candidate is worth more.
fn survivors(worth: &[f32], candidates: &[Candidate]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..worth.len()).collect();
    order.sort_by(|&i, &j| worth[i].total_cmp(&worth[j]).then(i.cmp(&j)));
    let mut keep = vec![true; worth.len()];
    for (i, candidate) in order.into_iter().zip(candidates) {
        if candidate.gain <= worth[i] {
            break;
        }
        keep[i] = false;
    }
    keep
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_worth_less_than_candidates_go() {
        let candidate = |gain| Candidate {
            stroke: [0.0; 9],
            gain,
        };
        let candidates = [candidate(5.0), candidate(3.0), candidate(1.0)];
        let keep = survivors(&[4.0, 0.5, 2.0, 9.0, -1.0], &candidates);
        // −1 < 5 and 0.5 < 3, but 2 > 1.
        assert_eq!(keep, [true, false, true, true, false]);
    }
}
