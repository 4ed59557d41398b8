//! Descent in rounds: colours or pens are chosen between them, and one schedule of rates goes on over all.

use super::anneal::Anneal;
use super::control::Control;
use super::descent::Descent;
use super::drawing::Drawing;
use super::recipe::Recipe;
use crate::optim::Schedule;

/// So many rounds, short beside the joint fit.
pub(super) struct Rounds {
    pub(super) count: usize,
    /// Iterations of all rounds, in units of those of the joint fit.
    pub(super) iterations: f64,
    /// Step sizes, in units of those of the joint fit.
    pub(super) rate: f32,
}

impl Rounds {
    /// The `descent` of the free strokes of `drawing` in round `round`, from 0; less where the time for it is over,
    /// which is the same for each of the rounds that are left.
    pub(super) fn descend(
        &self,
        round: usize,
        drawing: &mut Drawing,
        mut descent: Descent,
        recipe: &Recipe,
        anneal: Anneal,
        control: &mut Control<'_>,
    ) {
        let steps = (recipe.polish_iterations as f64 * self.iterations) as usize / self.count;
        let end = recipe.polish_rates.last;
        let schedule = Schedule::Cosine { end };
        let used = control.time_used();
        let until = used + (1.0 - used) / (self.count - round) as f32;
        for step in 0..steps {
            let rate = schedule.factor(round * steps + step, self.count * steps) as f32;
            drawing.step(&mut descent, anneal.last(), rate * self.rate);
            if !control.advance(drawing, descent.gradients.loss) {
                return;
            }
            if control.time_used() >= until {
                control.hurry();
                return;
            }
        }
    }
}
