//! Growing: each stage is seeded where the residual is largest, fitted on frozen strokes, and keeps what pays.

use super::polish;
use crate::error::Result;
use crate::fit::budget::plan::{self, PlannedStage};
use crate::fit::budget::price::Price;
use crate::fit::descent::Course;
use crate::fit::drawing::Drawing;
use crate::fit::edits::{Room, choose, drop_marks};
use crate::fit::order::{Outcome, Purpose};
use crate::fit::phase::descend::descend;
use crate::fit::phase::search::search;
use crate::fit::result::Stop;
use crate::fit::run::history::OpenStage;
use crate::fit::run::session::Session;
use crate::math;
use crate::metrics::psnr_db;
use crate::scene::Marks;

/// Greatest softness of a stage's first iteration, in units of the final one. A stage begins with the scale of its strokes (px) if
/// that is less. Half, twice: +0.03, −0.10 dB.
const SOFTEST: f32 = 4.0;
/// Growing ends when less than this share of a stage's strokes is worth its price. Half, twice, at the default quality: +0.11, −0.04
/// dB at +0.7, −5.6 % of the bytes.
const PAYING_SHARE: f64 = 0.3;
/// Growing ends this much below the fidelity asked for, dB. The polish brings 5 dB on photographs and 15 on flat art, and a search from
/// below begins with few strokes. 8 instead of 12: kodim04 at 36 dB takes 32.8 instead of 11.7 s.
const POLISH_GAIN_DB: f64 = 12.0;
/// A drawing that is placed, and as faithful, has all its strokes, dB. Of 63 clip arts no such one kept a further stroke, and two of 37 and
/// 42 dB did.
const PLACED_DB: f64 = 45.0;
/// The least that a stage has to add to the fidelity for each doubling of the strokes, where a fidelity is asked for, dB. Photographs
/// gain 2.2; flat art, whose edges strokes of two points follow badly, falls from 2 to 0.1.
const LEAST_SLOPE_DB: f64 = 1.3;

/// Seeds the next stage, unless the plan or a budget has ended.
pub(in crate::fit) fn next_stage(session: &mut Session<'_>) -> Result<Outcome> {
    if session.progress.stopped().is_some() || session.is_leaving() {
        return Ok(Outcome::Over);
    }
    if let Some(enough) = enough(session) {
        session.history.stop = enough;
        return Ok(Outcome::Over);
    }
    session.time_a_write()?;
    let index = session.history.records.len();
    let Some(planned) = session.plan.stage(index, session.drawing.len()) else {
        return Ok(top_up(session));
    };
    // A time limit may leave time for a part of the stage alone.
    let count = session.timer.affordable(planned.count);
    if count == 0 {
        return Ok(Outcome::Over);
    }
    seed(session, PlannedStage { count, ..planned });
    Ok(Outcome::Seeded(Purpose::Plan))
}

/// Why further stages are superfluous, if they are.
pub(super) fn enough(session: &Session<'_>) -> Option<Stop> {
    let staged_db = session.history.records.last()?.psnr_db;
    // What is where it is seen leaves no more than the antialiasing of a renderer.
    let is_done = session.drawing.is_placed() && staged_db >= PLACED_DB;
    if is_done && session.config.is_open() {
        return Some(Stop::Converged);
    }
    let strokes = session.drawing.len();
    let pays = session.history.stage.is_none_or(|stage| {
        let least = PAYING_SHARE * stage.planned.count as f64;
        let is_worth = |accepted: usize| accepted as f64 >= least;
        let gains = session.config.budget.psnr_db.is_none() || stage.gains(strokes, staged_db);
        gains && stage.accepted.is_none_or(is_worth)
    });
    // A base has been polished before, and gains less from another polish than new stages do.
    let gains = session.config.polish && session.task.base.is_none();
    let later_db = if gains { POLISH_GAIN_DB } else { 0.0 };
    let wanted_db = session.config.budget.psnr_db;
    if !pays {
        Some(Stop::Converged)
    } else if wanted_db.is_some_and(|wanted_db| staged_db + later_db >= wanted_db) {
        Some(Stop::Psnr)
    } else {
        None
    }
}

impl OpenStage {
    /// True if the stage added enough fidelity to be followed by others, now that the drawing has `strokes` strokes and `psnr_db`.
    /// Where it did not, strokes of two points do not help: the polish, which bends them, has to come first.
    fn gains(&self, strokes: usize, psnr_db: f64) -> bool {
        let (before, before_db) = self.before;
        // The first few strokes gain by chance.
        if before < plan::FIRST * 4 {
            return true;
        }
        // Stages differ in size, so the gain is compared by doublings of the strokes.
        let doublings = math::log2(strokes.max(1) as f64 / before.max(1) as f64);
        psnr_db - before_db >= LEAST_SLOPE_DB * doublings
    }
}

/// Without polish, which would fill up the budget of strokes, adds the strokes missing from it to the last stage.
fn top_up(session: &mut Session<'_>) -> Outcome {
    let config = session.config;
    let promised = config.budget.strokes.is_some() && !config.polish;
    let count = session.limit.saturating_sub(session.drawing.len());
    let last = session.history.records.last();
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

/// Seeds a stage of `count` strokes on top of all others, at the scale for a drawing of `in_all` strokes.
pub(super) fn seed_correction(session: &mut Session<'_>, count: usize, in_all: usize) {
    let planned = PlannedStage {
        index: session.history.records.len(),
        count,
        scale: scale(session, in_all),
    };
    seed(session, planned);
}

/// Typical radius, px, of the last strokes of a drawing of `strokes` strokes.
fn scale(session: &Session<'_>, strokes: usize) -> f32 {
    session.recipe.stages.scale * session.drawing.spacing(strokes)
}

/// Adds the planned strokes on top of all others, which it freezes.
fn seed(session: &mut Session<'_>, planned: PlannedStage) {
    let began = session.timer.elapsed();
    session.progress.enter(planned.index);
    let (drawing, timer) = (&mut session.drawing, &mut session.timer);
    let key = session.config.seed;
    let marks = session.config.marks();
    let PlannedStage {
        index,
        count,
        scale,
    } = planned;
    let before = timer.searching(count, || {
        // Candidates are found in the residual of all that is frozen, at the resolution of their own scale.
        drawing.sharpen(drawing.bounds.drawable(scale));
        drawing.freeze();
        let before = (drawing.len(), psnr_db(drawing.mse()));
        let candidates = match marks {
            Marks::Areas => Vec::new(),
            Marks::Auto | Marks::Strokes => search(drawing, count, scale, key),
        };
        // The best candidate is drawn last, so that none of lesser gain hides it.
        drawing.extend(candidates.iter().rev().map(|c| c.stroke), index);
        before
    });
    session.history.stage = Some(OpenStage {
        planned,
        began,
        before,
        accepted: None,
    });
}

/// Fits the strokes of the stage on the frozen ones, and keeps those that pay.
pub(in crate::fit) fn stage(session: &mut Session<'_>, purpose: Purpose) -> Result<Outcome> {
    let scale = session.history.stage.map_or(1.0, |s| s.planned.scale);
    // A stage's strokes are fitted alone, on the canvas of the frozen ones, which is rendered once.
    let stages = session.recipe.stages;
    let course = Course {
        // A soft edge gives a stroke a slope from the residual as far away as the edge is wide.
        softness: Some(scale.min(SOFTEST)),
        ..Course::new(stages.iterations, stages.rates)
    };
    if session.drawing.is_placed() {
        session.show();
    } else {
        let mut descent = session.descent(course);
        descend(session, &mut descent, None)?;
    }
    let accepted = accept(&mut session.drawing, session.price);
    if purpose == Purpose::Trace {
        let [layers, strokes] = &mut session.history.traced;
        (*layers, *strokes) = (*layers + 1, *strokes + accepted);
    }
    if let Some(stage) = &mut session.history.stage {
        stage.accepted = Some(accepted);
    }
    if !session.config.progressive {
        record(session, stages.iterations);
    }
    if accepted > 0 {
        return Ok(Outcome::Over);
    }
    if let (Purpose::Correct, Some(wanted_db)) = (purpose, session.config.budget.psnr_db) {
        session.stop_at(wanted_db);
    }
    Ok(Outcome::Rejected)
}

/// Polishes the strokes of a stage, and fills it up to its planned number of strokes.
pub(in crate::fit) fn stage_polish(session: &mut Session<'_>) -> Result<Outcome> {
    let Some(OpenStage {
        planned, accepted, ..
    }) = session.history.stage
    else {
        return Ok(Outcome::Over);
    };
    let missing = planned.count - accepted.unwrap_or(planned.count);
    let polish = session.recipe.polish;
    let limit = session.drawing.len() + missing;
    polish::run(session, limit, polish)?;
    record(
        session,
        session.recipe.stages.iterations + polish.iterations,
    );
    Ok(match accepted {
        Some(0) => Outcome::Rejected,
        _ => Outcome::Over,
    })
}

/// Removes the free strokes that are not worth their `price`, and returns how many are left.
fn accept(drawing: &mut Drawing, price: Price) -> usize {
    let price = price.in_drawing(drawing);
    let losses = drop_marks(drawing, |mark| price.least_contribution(mark));
    // Not measured by trials: strokes that share pixels are worth little each, and the next stage makes up for them.
    drawing.apply(&choose(losses, Room::default()));
    drawing.free().len()
}

fn record(session: &mut Session<'_>, iterations: usize) {
    let mse = session.drawing.mse();
    let elapsed = session.timer.elapsed();
    session.history.record(iterations, elapsed, mse);
}
