//! Counting: strokes are added and removed until the file is as faithful and as short as asked for.

use super::grow;
use crate::error::Result;
use crate::fit::base::Base;
use crate::fit::budget;
use crate::fit::drawing::Drawing;
use crate::fit::edits;
use crate::fit::order::{Outcome, Purpose};
use crate::fit::points;
use crate::fit::result::Stop;
use crate::fit::run::session::Session;
use crate::math;
use crate::metrics::psnr_db;

/// Fidelity that the polish is expected to regain when strokes are removed, dB.
const REGAINED_DB: f64 = 1.5;
/// Most corrections.
const CORRECTIONS: usize = 6;
/// Fidelity gained by doubling the strokes, dB, until it is measured on two drawings. Kodak ×5 gain 2.2 per doubling from 1,024 to
/// 2,900 strokes.
const DB_PER_DOUBLING: f64 = 2.8;
/// Lower bound of the measured gain by doubling the strokes, dB.
const LEAST_DB_PER_DOUBLING: f64 = DB_PER_DOUBLING / 8.0;
/// A fidelity is met if it is exceeded by no more than this, dB.
const EXCESS_DB: f64 = 0.1;
/// The number of strokes is found if this share more than a number that missed the fidelity reaches it. A guess.
const PRECISION: f64 = 0.1;
/// Least share of the missing fidelity that more strokes have to bring, or none of them will bring the rest. Without this end,
/// parrots-256 at 42 dB takes 23 instead of 10 s for 0.3 dB.
const LEAST_GAIN: f64 = 0.2;
/// Gain of doublings to come, in units of that of the last one, at most. A guess: with 1, a photograph whose gains rise again would be
/// given up.
const HOPE: f64 = 1.3;
/// Strokes too few for their gains to tell of those of many. A guess.
const FEW_STROKES: usize = 400;
/// Strokes below which one more may be what is missing. A disc without antialiasing needs 9 for 30 dB, and gains nothing by the second
/// to fourth.
const VERY_FEW_STROKES: usize = 32;
/// A file that uses less than this share of its bytes gets more points. A guess.
const FILLED: f64 = 0.98;

/// Shortens a base of more strokes or bytes than may be, and ends the fit if the base, as it is, already meets a budget. Otherwise
/// the base is the best file until another one is better.
pub(in crate::fit) fn try_base(session: &mut Session<'_>) -> Result<Outcome> {
    let strokes = session.drawing.len();
    if let Some(most) = session.config.budget.strokes.filter(|&most| most < strokes) {
        keep_best(&mut session.drawing, most);
        session.history.stop = Stop::Strokes;
        return Ok(Outcome::Removed);
    }
    let excess = excess(session);
    if excess > 0 && strokes > 0 {
        shorten(session, excess);
        return Ok(Outcome::Removed);
    }
    // A base that uses colours outside the palette, or other pens, cannot stay as it is.
    let config = session.config;
    let may_stay = |base: &Base| config.pens.is_none() && config.colors.allow(&base.scene);
    if !session.task.base.as_ref().is_some_and(may_stay) {
        return Ok(Outcome::Over);
    }
    // Does the base meet a budget as it is?
    let file = session.writer.render(&session.drawing)?;
    let Some(stop) = budget::met(&session.config.budget, strokes, &file) else {
        let allows = |stroke| session.config.allows(stroke);
        let is_allowed = file.rounded.scene.marks().all(allows);
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

/// Removes the strokes of least contribution until `most` are left.
fn keep_best(drawing: &mut Drawing, most: usize) {
    while drawing.len() > most {
        // A contribution is measured by removing one stroke alone; with its neighbours gone, a stroke is worth more.
        let at_a_time = drawing.len().div_ceil(8);
        let least = edits::least(drawing, at_a_time.min(drawing.len() - most));
        drawing.apply(&least);
    }
}

/// Doubles the strokes if the polished drawing is so far below the fidelity asked for that its file need not be looked at.
pub(in crate::fit) fn approach_fidelity(session: &mut Session<'_>) -> Outcome {
    let Some(wanted_db) = session.config.budget.psnr_db else {
        return Outcome::Over;
    };
    let now = (session.drawing.len(), psnr_db(session.drawing.mse()));
    let before = session.history.corrections.approached.replace(now);
    // Two drawings give the slope; before there are two, doubling is worth a try.
    let missing_db = wanted_db - now.1;
    let leads_there = before.is_none_or(|before| {
        let slope = db_per_doubling(before, now);
        slope >= LEAST_DB_PER_DOUBLING && is_within_reach(now.0, missing_db, slope, session.limit)
    });
    let is_far = missing_db >= DB_PER_DOUBLING;
    if is_far && leads_there && session.cut_by().is_none() {
        resize(session, 2 * now.0)
    } else {
        Outcome::Over
    }
}

/// True if `strokes` strokes, which gain `slope` dB per doubling, gain `missing_db` before there are more than `most`. The next
/// doublings may gain more than the last one.
fn is_within_reach(strokes: usize, missing_db: f64, slope: f64, most: usize) -> bool {
    // log₂ of the factor that closes the gap, at a slope that may get better by `hope`.
    let doublings = missing_db / (HOPE * slope);
    strokes < FEW_STROKES || strokes as f64 * math::exp2(doublings) <= most as f64
}

/// Adds or removes strokes if the last file misses or exceeds the fidelity asked for.
pub(in crate::fit) fn meet_fidelity(session: &mut Session<'_>) -> Outcome {
    let Some(wanted_db) = session.config.budget.psnr_db else {
        return Outcome::Over;
    };
    let corrections = &mut session.history.corrections;
    let (strokes, last_db) = (session.drawing.len(), corrections.last_db);
    corrections.files.push((strokes, last_db));
    let (files, missing_db) = (&corrections.files, wanted_db - last_db);
    // 1. Is the fidelity met, without much more than asked for?
    let is_met = (0.0..=EXCESS_DB).contains(&-missing_db);
    // 2. Has the limit on bytes taken away what more strokes would add, or may there not be as many as it takes?
    let slope = slope(files);
    let is_full = missing_db > 0.0 && corrections.shortened
        || !is_within_reach(strokes, missing_db, slope, session.limit);
    // 3. Otherwise take the next number, unless the search has used its trials or its time.
    let next = next(files, wanted_db).filter(|_| files.len() <= CORRECTIONS);
    let is_over = is_met || is_full || session.cut_by().is_some();
    let outcome = match next {
        Some(next) if !is_over => resize(session, next),
        _ => Outcome::Over,
    };
    // The search is over, with the fidelity or without it.
    if outcome == Outcome::Over {
        session.stop_at(wanted_db);
    }
    outcome
}

/// Adds or removes strokes, so that there are `wanted` of them. The outcome is `Over` if none can be added or removed.
fn resize(session: &mut Session<'_>, wanted: usize) -> Outcome {
    let strokes = session.drawing.len();
    let wanted = wanted.min(session.limit);
    if wanted > strokes {
        grow::seed_correction(session, wanted - strokes, wanted);
        return Outcome::Seeded(Purpose::Correct);
    }
    // The polish regains this much, so it may go.
    let wanted_db = session.config.budget.psnr_db.unwrap_or(0.0);
    let least_db = wanted_db - REGAINED_DB;
    let removed = (strokes - wanted).min(dispensable(&mut session.drawing, least_db));
    if removed == 0 {
        return Outcome::Over;
    }
    let least = edits::least(&mut session.drawing, removed);
    session.drawing.apply(&least);
    Outcome::Removed
}

/// Fidelity gained by doubling the strokes, dB, as the last two files show.
fn slope(files: &[(usize, f64)]) -> f64 {
    match files {
        [.., before, last] => {
            db_per_doubling(*before, *last).clamp(LEAST_DB_PER_DOUBLING, DB_PER_DOUBLING)
        }
        _ => DB_PER_DOUBLING,
    }
}

/// The number of strokes to try after these files: at most twice and at least half as many as the last one has. `None` if the last
/// strokes brought too little for others to be of use, or the numbers that missed and reached the fidelity are too close together.
fn next(files: &[(usize, f64)], wanted_db: f64) -> Option<usize> {
    let &(strokes, last_db) = files.last()?;
    if let [.., before, _] = files {
        let (missed_db, brought_db) = (wanted_db - before.1, last_db - before.1);
        // Fewer strokes than before, or a file that reached the fidelity, leave hope.
        let helps = missed_db <= 0.0 || brought_db >= LEAST_GAIN * missed_db;
        if strokes > before.0.max(VERY_FEW_STROKES) && !helps {
            return None;
        }
    }
    // A secant step in the logarithm of the number, in which fidelity is about linear.
    let doublings = ((wanted_db - last_db) / slope(files)).clamp(-1.0, 1.0);
    let wanted = (strokes as f64 * math::exp2(doublings)).round() as usize;
    // The bracket: the most strokes that missed, and the fewest that reached it. A file of more strokes may miss what one of fewer
    // reached.
    let of = |reaches: bool| {
        let some = files
            .iter()
            .filter(move |(_, db)| (*db >= wanted_db) == reaches);
        some.map(|(strokes, _)| *strokes)
    };
    let (missed, reached) = (of(false).max().unwrap_or(0), of(true).min());
    let [low, high] = [missed + 1, reached.unwrap_or(usize::MAX).saturating_sub(1)];
    let is_narrow = reached.is_some_and(|n| n as f64 <= missed as f64 * (1.0 + PRECISION));
    (low <= high && !is_narrow).then(|| wanted.clamp(low, high).max(1))
}

/// Number of strokes of least contribution that could go before the drawing falls below a fidelity of `least_db`.
fn dispensable(drawing: &mut Drawing, least_db: f64) -> usize {
    let values = 3.0 * drawing.pixels() as f64;
    let gradients = drawing.judge();
    let mut contribution = gradients.contribution;
    contribution.sort_by(f32::total_cmp);
    // The squared error at `least_db`, summed over pixels and channels, as contributions are.
    let most = math::powf(10.0, -least_db / 10.0) * values;
    let mut error = gradients.loss * values;
    let is_spared = |contribution: &&f32| {
        // Worths are added as if strokes were independent. A stroke that does harm may go, too, but makes no room for others.
        error += f64::from(contribution.max(0.0));
        error <= most
    };
    contribution.iter().take_while(is_spared).count()
}

/// Fidelity gained by doubling the strokes, dB, measured on two drawings with these numbers of strokes and fidelities; the sign of
/// an infinity if the numbers are equal.
fn db_per_doubling((few, few_db): (usize, f64), (many, many_db): (usize, f64)) -> f64 {
    let doublings = math::log2(many.max(1) as f64 / few.max(1) as f64);
    let slope = (many_db - few_db) / doublings;
    if slope.is_nan() { 0.0 } else { slope }
}

/// Bytes of a settled file in units of those before, at most; photographs 1.003, flat art 0.994 to 1.005.
const GROWTH: f64 = 1.005;

/// Bytes by which the settled drawing will exceed the budget; 0 if it will not.
pub(super) fn excess(session: &Session<'_>) -> usize {
    let Some(most) = session.config.budget.bytes else {
        return 0;
    };
    let growth = match session.recipe.settling_rounds {
        0 => 1.0,
        _ => GROWTH,
    };
    // The drawing is measured before settling, which may add a few bytes.
    let bytes = growth * session.writer.bytes(&session.drawing) as f64;
    (bytes as usize).saturating_sub(most)
}

/// Takes away `excess` bytes of points and strokes, or all strokes.
pub(super) fn shorten(session: &mut Session<'_>, excess: usize) {
    points::shed(&mut session.drawing, session.price, excess);
    session.history.stop = Stop::Bytes;
    session.history.corrections.shortened = true;
}

/// Takes away points and strokes if the best file has more bytes than allowed. If it has clearly fewer, because strokes came to share
/// widths and colours, more points are to be added.
pub(in crate::fit) fn meet_bytes(session: &mut Session<'_>) -> Outcome {
    let Some(most) = session.config.budget.bytes else {
        return Outcome::Over;
    };
    let bytes = session.best.as_ref().map_or(0, |best| best.bytes);
    if session.drawing.len() == 0 {
        return Outcome::Over;
    }
    // A fit that is cut short keeps its bytes, too; it only adds nothing.
    if bytes > most {
        shorten(session, bytes - most);
        return Outcome::Removed;
    }
    let is_cut = session.cut_by().is_some();
    let corrections = &mut session.history.corrections;
    let is_filled = bytes as f64 >= FILLED * most as f64;
    // Bytes are refilled once at most, since each refill takes another polish.
    let is_last = std::mem::replace(&mut corrections.refilled, true);
    let may_polish = session.config.polish && session.config.allows_points();
    if is_filled || is_last || is_cut || !may_polish || session.config.budget.psnr_db.is_some() {
        return Outcome::Over;
    }
    Outcome::Short
}
