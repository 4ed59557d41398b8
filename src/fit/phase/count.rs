//! Counting: strokes are added and removed until the file is as faithful and as short as asked for.

use super::grow;
use crate::error::Result;
use crate::fit::budget;
use crate::fit::order::{Outcome, Purpose};
use crate::fit::recipe::Correction;
use crate::fit::result::Stop;
use crate::fit::session::Session;
use crate::math;

/// Ends the fit if the base, as it is, already meets a budget. Otherwise the base is the best file until another one is
/// better.
pub(in crate::fit) fn try_base(session: &mut Session<'_>) -> Result<Outcome> {
    let file = session.writer.render(&session.drawing)?;
    let strokes = session.drawing.len();
    let Some(stop) = budget::met(&session.config.budget, strokes, &file) else {
        let allows = |stroke| session.config.allows(stroke);
        let is_allowed = file.rounded.scene.strokes().all(allows);
        if is_allowed && budget::compares_files(session.config, &session.recipe) {
            session.set_best(file);
        }
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
    // What more strokes would add, bytes have taken away.
    let is_full = missing_db > 0.0 && corrections.shortened;
    let is_last = corrections.count >= correction.count || session.cut_by().is_some();
    let ends = is_met || is_full || is_last;
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

/// By how many bytes the drawing will exceed the budget when it has settled; 0 if it will not.
pub(in crate::fit) fn excess(session: &Session<'_>) -> usize {
    let Some(most) = session.config.budget.bytes else {
        return 0;
    };
    let bytes = session.writer.bytes(&session.drawing) as f64 * session.recipe.settling.growth;
    (bytes as usize).saturating_sub(most)
}

/// Removes the strokes that are worth least for their bytes, until `excess` bytes are gone or all strokes are.
pub(in crate::fit) fn shorten(session: &mut Session<'_>, excess: usize) {
    let worth = session.drawing.judge().worth;
    let strokes = session.drawing.free().iter();
    let bytes: Vec<usize> = strokes.map(|s| session.price.bytes_of(s)).collect();
    let per_byte = |i: usize| worth[i] / bytes[i] as f32;
    let mut order: Vec<usize> = (0..worth.len()).collect();
    order.sort_by(|&i, &j| per_byte(i).total_cmp(&per_byte(j)).then(i.cmp(&j)));
    let mut keep = vec![true; worth.len()];
    let mut gone = 0;
    for i in order {
        if gone >= excess {
            break;
        }
        gone += bytes[i];
        keep[i] = false;
    }
    session.drawing.retain_free(&keep);
    session.history.stop = Stop::Bytes;
    session.history.corrections.shortened = true;
}

/// Removes strokes if the best file has more bytes than allowed.
pub(in crate::fit) fn meet_bytes(session: &mut Session<'_>) -> Outcome {
    let bytes = session.best.as_ref().map_or(0, |best| best.bytes);
    let most = session.config.budget.bytes.unwrap_or(usize::MAX);
    if bytes <= most || session.drawing.len() == 0 {
        return Outcome::Over;
    }
    shorten(session, bytes - most);
    Outcome::Removed
}
