//! Given pens: every stroke gets the width of one of them, and the rest is fitted to that.
//!
//! The drawing has been fitted with widths between the thinnest and the widest pen. Rounds come in pairs. In the first
//! round widths are free, so that strokes tend to one pen or another; then each gets the nearest pen. In the second round
//! widths stay as they are. The drawing after it is compared with the best one so far.

use super::rounds;
use crate::error::Result;
use crate::fit::recipe::Rates;
use crate::fit::session::Session;

/// Gives every stroke the width of a pen, if pens are given, and returns whether they are. The drawing is fitted at
/// `rates`. All strokes must be free.
pub(super) fn run(session: &mut Session<'_>, rates: Rates) -> Result<bool> {
    if session.radii.is_empty() {
        return Ok(false);
    }
    let rounds = session.recipe.pens.rounds;
    hand_out(session);
    let mut best = (session.drawing.mse(), session.drawing.memento());
    for round in 0..rounds.count {
        if session.progress.stopped().is_some() {
            break;
        }
        let is_held = round % 2 == 1;
        let rates = if is_held {
            rates.without_radius()
        } else {
            rates
        };
        rounds::run(session, rounds, round, rates)?;
        hand_out(session);
        let mse = session.drawing.mse();
        if is_held && mse < best.0 {
            best = (mse, session.drawing.memento());
        }
    }
    session.drawing.revert(best.1);
    Ok(true)
}

/// Gives every stroke the nearest pen.
fn hand_out(session: &mut Session<'_>) {
    let Session { drawing, radii, .. } = session;
    drawing.free_mut().change(|_, stroke| {
        stroke.look[0] = nearest(radii, stroke.look[0]);
    });
}

/// The nearest of the radii.
pub(super) fn nearest(radii: &[f32], wanted: f32) -> f32 {
    let away = |radius: &f32| (radius - wanted).abs();
    let nearest = radii
        .iter()
        .copied()
        .min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.unwrap_or(wanted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_pen_is_taken() {
        let pens = [0.6, 1.5, 4.0];
        assert_eq!(
            [0.1, 1.0, 1.1, 9.0].map(|r| nearest(&pens, r)),
            [0.6, 0.6, 1.5, 4.0]
        );
    }
}
