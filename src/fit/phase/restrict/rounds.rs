//! Descent in rounds. Colours or widths are chosen between two rounds; one schedule of rates spans all of them.

use crate::error::Result;
use crate::fit::descent::Course;
use crate::fit::phase::descend::descend;
use crate::fit::recipe::Rates;
use crate::fit::run::session::Session;

/// Rounds of descent, between which colours or pens are chosen again. One schedule of rates spans all of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounds {
    /// Number of rounds.
    pub(super) count: usize,
    /// Iterations of all rounds together, in units of those of the polish.
    pub(super) iterations: f64,
    /// Step sizes, in units of those of the polish.
    pub(super) rate: f32,
}

/// Runs round `index`, from 0, with the final edge. A time limit may shorten it: what is left is divided equally among
/// the remaining rounds.
pub(super) fn run(
    session: &mut Session<'_>,
    rounds: Rounds,
    index: usize,
    rates: Rates,
) -> Result<()> {
    let polish = session.recipe.polish;
    let iterations = (polish.iterations as f64 * rounds.iterations) as usize / rounds.count;
    let used = session.timer.used();
    let course = Course {
        // The rounds share one schedule, so that step sizes go on falling across them.
        before: index * iterations,
        of: rounds.count * iterations,
        pace: rounds.rate,
        until: used + (1.0 - used) / (rounds.count - index) as f32,
        ..Course::new(iterations, rates)
    };
    let mut descent = session.descent(course);
    descend(session, &mut descent, None)
}

/// Runs `round` for each of the `rounds`, goes back to the best drawing, and returns its mean squared error. A round says
/// whether the drawing after it is one to go back to.
pub(super) fn best(
    session: &mut Session<'_>,
    rounds: Rounds,
    mut round: impl FnMut(&mut Session<'_>, usize) -> Result<bool>,
) -> Result<f64> {
    let mut best = (session.drawing.mse(), session.drawing.snapshot());
    for index in 0..rounds.count {
        if session.progress.stopped().is_some() {
            break;
        }
        let counts = round(session, index)?;
        let mse = session.drawing.mse();
        if counts && mse < best.0 {
            best = (mse, session.drawing.snapshot());
        }
    }
    session.drawing.revert(best.1);
    Ok(best.0)
}
