//! Descent in rounds. Colours or pens are chosen between two rounds; one schedule of rates spans all of them.

use crate::error::Result;
use crate::fit::descend::descend;
use crate::fit::descent::Course;
use crate::fit::recipe::{Rates, Rounds};
use crate::fit::session::Session;

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
        iterations,
        before: index * iterations,
        of: rounds.count * iterations,
        rates,
        pace: rounds.rate,
        softness: None,
        until: used + (1.0 - used) / (rounds.count - index) as f32,
        joint: None,
    };
    let mut descent = session.descent(course);
    descend(session, &mut descent, None)
}
