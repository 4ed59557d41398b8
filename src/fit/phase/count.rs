//! Counting: strokes are added and removed until the file is as faithful and as short as asked for.

use super::grow;
use crate::error::Result;
use crate::fit::budget;
use crate::fit::order::{Outcome, Purpose};
use crate::fit::recipe::Correction;
use crate::fit::result::Stop;
use crate::fit::session::Session;
use crate::math;

/// Ends the fit if the base, as it is, already meets a budget.
pub(in crate::fit) fn try_base(session: &mut Session<'_>) -> Result<Outcome> {
    let file = session.writer.render(&session.drawing)?;
    let strokes = session.drawing.len();
    let Some(stop) = budget::met(&session.config.budget, strokes, &file) else {
        return Ok(Outcome::Over);
    };
    session.history.stop = stop;
    session.drawing.sharpen(0.0);
    session.set_best(file);
    Ok(Outcome::Met)
}

/// Adds or removes strokes if the last file misses or exceeds the fidelity asked for.
pub(in crate::fit) fn meet_fidelity(session: &mut Session<'_>) -> Outcome {
    let Some(wanted_db) = session.config.budget.psnr_db else {
        return Outcome::Over;
    };
    let correction = session.recipe.correction;
    let corrections = &mut session.history.corrections;
    let now = (session.drawing.len(), corrections.last_db);
    // What new strokes gain on a base depends on that base, so that it is measured.
    if let Some(before) = corrections.before.filter(|_| session.base.is_some()) {
        corrections.db_per_doubling = slope(&correction, before, now);
    }
    corrections.before = Some(now);
    let missing_db = wanted_db - corrections.last_db;
    let doublings = missing_db / corrections.db_per_doubling;
    let is_met = (0.0..=correction.excess_db).contains(&-missing_db);
    let ends = is_met || corrections.count >= correction.count || session.cut_by().is_some();
    let outcome = if ends {
        Outcome::Over
    } else {
        resize(session, doublings)
    };
    if outcome == Outcome::Over {
        session.stop_at(wanted_db);
    }
    outcome
}

/// Multiplies the number of strokes by `2^doublings`, within ½ and 2. The outcome is `Over` if none can be added or
/// removed.
fn resize(session: &mut Session<'_>, doublings: f64) -> Outcome {
    let (strokes, most) = (session.drawing.len(), session.limit);
    let factor = math::exp2(doublings.clamp(-1.0, 1.0));
    let wanted = ((strokes as f64 * factor) as usize).clamp(1, most);
    let outcome = if doublings > 0.0 {
        let added = wanted.max(strokes + 1).min(most).saturating_sub(strokes);
        if added == 0 {
            return Outcome::Over;
        }
        grow::seed_correction(session, added, wanted);
        Outcome::Seeded(Purpose::Correct)
    } else {
        let removed = strokes.saturating_sub(wanted);
        let removed = removed.min(dispensable(session));
        if removed == 0 {
            return Outcome::Over;
        }
        session.drawing.remove_least(removed);
        Outcome::Removed
    };
    session.history.corrections.count += 1;
    outcome
}

/// How many of the strokes of least worth could go before the drawing is clearly below the fidelity asked for.
fn dispensable(session: &mut Session<'_>) -> usize {
    let least_db =
        session.config.budget.psnr_db.unwrap_or(0.0) - session.recipe.correction.regained_db;
    let drawing = &mut session.drawing;
    let values = 3.0 * drawing.pixels() as f64;
    let gradients = drawing.judge();
    let mut worth = gradients.worth;
    worth.sort_by(f32::total_cmp);
    let most = math::powf(10.0, -least_db / 10.0) * values;
    let mut error = gradients.loss * values;
    let is_spared = |worth: &&f32| {
        error += f64::from(worth.max(0.0));
        error <= most
    };
    worth.iter().take_while(is_spared).count()
}

/// Fidelity gained by doubling the strokes, dB, measured on two drawings with these numbers of strokes and fidelities.
fn slope(
    correction: &Correction,
    (few, few_db): (usize, f64),
    (many, many_db): (usize, f64),
) -> f64 {
    let usual = correction.db_per_doubling;
    let doublings = math::log2(many.max(1) as f64 / few.max(1) as f64);
    let slope = (many_db - few_db) / doublings;
    if slope.is_finite() {
        slope.clamp(usual * correction.least_part, usual)
    } else {
        usual
    }
}

/// Removes the strokes of least worth if the best file has more bytes than allowed.
pub(in crate::fit) fn meet_bytes(session: &mut Session<'_>) -> Outcome {
    let bytes = session.best.as_ref().map_or(0, |best| best.bytes);
    let most = session.config.budget.bytes.unwrap_or(usize::MAX);
    if bytes <= most || session.drawing.len() == 0 {
        return Outcome::Over;
    }
    if session.history.stop != Stop::Bytes
        && let Some(best) = session.history.best.clone()
    {
        session.drawing.restore(best);
    }
    session.history.stop = Stop::Bytes;
    let share = (bytes - most) as f64 / bytes as f64;
    let count = (session.drawing.len() as f64 * share).ceil() as usize;
    session.drawing.remove_least(count.max(1));
    Outcome::Removed
}
