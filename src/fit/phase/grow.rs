//! Growing: stages are seeded where the residual is largest, fitted alone on what is frozen, and keep what pays.

use super::polish;
use crate::error::Result;
use crate::fit::descend::descend;
use crate::fit::descent::Course;
use crate::fit::drawing::Drawing;
use crate::fit::journal::OpenStage;
use crate::fit::order::{Outcome, Purpose};
use crate::fit::plan::PlannedStage;
use crate::fit::price::Price;
use crate::fit::result::Stop;
use crate::fit::search::search;
use crate::fit::session::Session;
use crate::metrics::psnr_db;

/// Seeds the next stage, as long as the plan or a budget does not end.
pub(in crate::fit) fn next_stage(session: &mut Session<'_>) -> Result<Outcome> {
    if session.progress.stopped().is_some() {
        return Ok(Outcome::Over);
    }
    if let Some(enough) = enough(session) {
        session.journal.stop = enough;
        return Ok(Outcome::Over);
    }
    session.rehearse()?;
    let index = session.journal.records.len();
    let Some(planned) = session.plan.stage(index, session.drawing.len()) else {
        return Ok(top_up(session));
    };
    let count = session.timer.affordable(planned.count);
    if count == 0 {
        return Ok(Outcome::Over);
    }
    seed(session, PlannedStage { count, ..planned });
    Ok(Outcome::Seeded(Purpose::Plan))
}

/// What makes further stages superfluous, if anything does.
fn enough(session: &Session<'_>) -> Option<Stop> {
    let stages = session.recipe.stages;
    let OpenStage {
        planned, accepted, ..
    } = session.journal.stage?;
    let pays = accepted? as f64 >= stages.paying_share * planned.count as f64;
    let staged_db = session.journal.records.last()?.psnr_db;
    // A base has been finished before, and gains less from polish than stages do.
    let gains = session.config.polish && session.base.is_none();
    let later_db = if gains { stages.polish_gain_db } else { 0.0 };
    let wanted_db = session.config.budget.psnr_db;
    if !pays {
        Some(Stop::Converged)
    } else if wanted_db.is_some_and(|wanted_db| staged_db + later_db >= wanted_db) {
        Some(Stop::Psnr)
    } else {
        None
    }
}

/// Where nothing is polished, seeds the strokes that were promised but not accepted as a part of the last stage.
fn top_up(session: &mut Session<'_>) -> Outcome {
    let config = session.config;
    let promised = config.budget.strokes.is_some() && !config.polish;
    let count = session.limit.saturating_sub(session.drawing.len());
    let last = session.journal.records.last();
    let Some(last) = last.filter(|_| promised && count > 0) else {
        return Outcome::Over;
    };
    let planned = PlannedStage {
        index: last.index - 1,
        count,
        scale: scale(session, session.limit),
    };
    seed(session, planned);
    Outcome::Seeded(Purpose::TopUp)
}

/// Seeds a stage of `count` strokes on top of all others, of the scale for a drawing of `in_all` strokes.
pub(super) fn seed_correction(session: &mut Session<'_>, count: usize, in_all: usize) {
    let planned = PlannedStage {
        index: session.journal.records.len(),
        count,
        scale: scale(session, in_all),
    };
    seed(session, planned);
}

/// Typical radius of the last strokes of a drawing of so many, px.
fn scale(session: &Session<'_>, strokes: usize) -> f32 {
    session.recipe.stages.scale * session.drawing.spacing(strokes)
}

/// Puts the planned strokes on top of all others, which are frozen.
fn seed(session: &mut Session<'_>, planned: PlannedStage) {
    let began = session.timer.elapsed();
    session.progress.enter(planned.index);
    let Session {
        drawing,
        recipe,
        config,
        timer,
        ..
    } = session;
    let PlannedStage {
        index,
        count,
        scale,
    } = planned;
    timer.searching(count, || {
        drawing.sharpen(scale);
        drawing.freeze();
        let candidates = search(drawing, count, scale, recipe.probing, config.seed);
        // The best candidate is drawn last, so that none of lesser gain hides it.
        drawing.extend(candidates.iter().rev().map(|c| c.stroke), index);
    });
    session.journal.stage = Some(OpenStage {
        planned,
        began,
        accepted: None,
    });
}

/// Fits the strokes of the stage alone, and keeps those that pay.
pub(in crate::fit) fn stage(session: &mut Session<'_>, purpose: Purpose) -> Result<Outcome> {
    let scale = session.journal.stage.map_or(1.0, |s| s.planned.scale);
    let stages = session.recipe.stages;
    let course = Course {
        iterations: stages.iterations,
        before: 0,
        of: stages.iterations,
        rates: stages.rates,
        pace: 1.0,
        softness: Some(scale.min(stages.softest)),
        until: f32::INFINITY,
        joint: None,
    };
    let mut descent = session.descent(course);
    descend(session, &mut descent, None)?;
    let accepted = accept(&mut session.drawing, session.price);
    if let Some(stage) = &mut session.journal.stage {
        stage.accepted = Some(accepted);
    }
    if !session.config.progressive {
        record(session, stages.iterations);
    }
    if accepted > 0 {
        return Ok(Outcome::Over);
    }
    if let (Purpose::Correct, Some(wanted_db)) = (purpose, session.config.budget.psnr_db) {
        let best_db = session.best.as_ref().map_or(0.0, |best| psnr_db(best.mse));
        session.journal.stop_at(wanted_db, best_db);
    }
    Ok(Outcome::Rejected)
}

/// Fits all strokes jointly after a stage, filling up to the strokes that it was to have.
pub(in crate::fit) fn stage_polish(session: &mut Session<'_>) -> Result<Outcome> {
    let Some(OpenStage {
        planned, accepted, ..
    }) = session.journal.stage
    else {
        return Ok(Outcome::Over);
    };
    let missing = planned.count - accepted.unwrap_or(planned.count);
    let iterations = session.recipe.polish.iterations;
    let limit = session.drawing.len() + missing;
    polish::run(session, limit, iterations)?;
    record(session, session.recipe.stages.iterations + iterations);
    Ok(match accepted {
        Some(0) => Outcome::Rejected,
        _ => Outcome::Over,
    })
}

/// Takes the free strokes that are not worth their `price` away, and says how many are left.
fn accept(drawing: &mut Drawing, price: Price) -> usize {
    let worth = drawing.judge().worth;
    let strokes = drawing.free().iter().zip(worth);
    let keep: Vec<bool> = strokes
        .map(|(stroke, worth)| worth > price.of(stroke))
        .collect();
    drawing.retain_free(&keep);
    drawing.free().len()
}

fn record(session: &mut Session<'_>, iterations: usize) {
    let mse = session.drawing.mse();
    let elapsed = session.timer.elapsed();
    session.journal.record(iterations, elapsed, mse);
}
