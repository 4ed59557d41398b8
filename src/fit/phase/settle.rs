//! Settling: the last steps are taken against renders of the written file.
//!
//! An SVG renderer rounds to 8 bits after every stroke and has its own antialiasing. So its picture differs from our
//! canvas by an offset, which hardly changes when strokes move a little. Each round writes and renders the drawing,
//! subtracts a part of that offset from the target, and descends for a few iterations. The best file is kept.
//! [`renderers`] says which renderers count, and how much. Where they still add much to the error, the strokes are
//! [nudged](super::nudge).
//!
//! Before that, the drawing is restricted to its palette and pens, which change it by more than settling does.
//!
//! [`renderers`]: crate::fit::renderers

use super::{count, nudge, palette, pens, sharing, stack, widths};
use crate::error::Result;
use crate::fit::budget;
use crate::fit::config::Colors;
use crate::fit::descend::descend;
use crate::fit::descent::{Aim, Course};
use crate::fit::drawing::Memento;
use crate::fit::file::RenderedFile;
use crate::fit::order::Outcome;
use crate::fit::recipe::Rates;
use crate::fit::renderers::Renderings;
use crate::fit::result::Stop;
use crate::fit::session::Session;
use crate::fit::ties::Ties;
use crate::metrics::psnr_db;
use crate::svg::Group;

/// Restricts the drawing to its palette and pens, and settles it if the fit depends on its file.
pub(in crate::fit) fn settle(session: &mut Session<'_>) -> Result<Outcome> {
    session.drawing.thaw();
    session.drawing.sharpen(0.0);
    let restricted = restrict(session)?;
    let budget = &session.config.budget;
    if budget::needs_file(budget, &session.recipe) {
        let file = run_exact(session, restricted)?;
        session.history.corrections.last_db = psnr_db(file.mse);
        let best = session.best.as_ref();
        if best.is_none_or(|best| budget::is_better(budget, &file, best)) {
            session.set_best(file);
        }
    }
    // An observer may stop the fit between two rounds, where no state is kept.
    session.seal();
    Ok(Outcome::Over)
}

/// What settling leaves as it is.
struct Restricted {
    rates: Rates,
    ties: Ties,
}

/// Restricts the drawing to its palette and pens, and returns what keeps those.
fn restrict(session: &mut Session<'_>) -> Result<Restricted> {
    let mut rates = session.recipe.polish.rates;
    if let Some(mut palette) = palette::run(session)? {
        if session.config.file.group == Group::Color {
            stack::run(session, &mut palette)?;
        }
        rates = rates.without_color();
    }
    if widths::run(session, rates)? {
        rates = rates.without_radius();
    }
    if pens::run(session)? {
        rates = rates.without_pen();
    }
    // In free colours, each stroke is worth its price.
    if session.config.colors != Colors::Free {
        session.drawing.remove_hidden();
    }
    let ties = share_within_bytes(session);
    Ok(Restricted { rates, ties })
}

/// Makes strokes share widths and colours, of as many strokes as the budget of bytes allows then.
fn share_within_bytes(session: &mut Session<'_>) -> Ties {
    session.history.corrections.shortened = false;
    session.drawing.join_stages(session.layers_to_join());
    let before = session.writer.bytes(&session.drawing).max(1);
    loop {
        let unshared = session.drawing.memento();
        let ties = sharing::run(session);
        let excess = count::excess(session);
        if !session.history.corrections.shortened {
            let bytes = session.writer.bytes(&session.drawing);
            session.history.corrections.restricted = bytes as f32 / before as f32;
        }
        if excess == 0 || session.drawing.free().is_empty() {
            return ties;
        }
        session.drawing.revert(unshared);
        count::shorten(session, excess);
    }
}

/// [`run`] with errors that count as the user's mask says, but not less where detail hides them: renderers differ most at
/// the outlines of strokes, which are detail.
fn run_exact(session: &mut Session<'_>, restricted: Restricted) -> Result<RenderedFile> {
    session.drawing.focus_on(session.focus.as_ref());
    let file = run(session, restricted)?;
    session.drawing.focus_on(session.weights.as_ref());
    Ok(file)
}

/// Descends against renders of the file and returns the best file. The drawing becomes the one that it was written
/// from.
fn run(session: &mut Session<'_>, restricted: Restricted) -> Result<RenderedFile> {
    let Restricted { rates, ties } = restricted;
    let settling = session.recipe.settling;
    session.progress.settle();
    if !allows_round(session, 0) {
        return session.render_file();
    }
    let (mut file, mut seen) = Renderings::of(session)?;
    let mut best = Best::of(session, &file, &seen);
    let (mut share, mut pace) = (seen.first_share(), 1.0);
    let mut round = 0;
    while allows_round(session, round) && session.progress.tell(&session.drawing, file.mse) {
        round += 1;
        let targets = seen.targets(&session.drawing, &file, share);
        let aim = Aim {
            targets: &targets,
            mse: file.mse,
        };
        let mut descent = session.descent(course(session, rates, pace));
        descent.ties.clone_from(&ties);
        descend(session, &mut descent, Some(aim))?;
        if session.progress.is_halted() {
            break;
        }
        let before = seen.worst_mse();
        (file, seen) = Renderings::of(session)?;
        if seen.worst_mse() < best.seen.worst_mse() {
            best = Best::of(session, &file, &seen);
        }
        if (psnr_db(seen.worst_mse()) - psnr_db(before)).abs() < settling.least_db {
            break;
        }
        share = seen.next_share(share);
        pace *= settling.next_pace;
    }
    nudged(session, best)
}

/// The best file, and its drawing, after nudging where renderers add much to the error. A nudged file has to meet what the
/// other one meets.
fn nudged(session: &mut Session<'_>, best: Best) -> Result<RenderedFile> {
    let Best {
        file,
        seen,
        memento,
    } = best;
    session.drawing.revert(memento.clone());
    let adds_much = seen.added_db() >= session.recipe.settling.nudging.added_db;
    if session.progress.is_halted() || !adds_much || !nudge::run(session, &file, &seen) {
        return Ok(file);
    }
    let (nudged, seen_nudged) = Renderings::of(session)?;
    let is_better = seen_nudged.worst_mse() < seen.worst_mse()
        && budget::meets_as_much(&session.config.budget, &nudged, &file);
    if is_better {
        return Ok(nudged);
    }
    session.drawing.revert(memento);
    Ok(file)
}

/// The best file so far, and the drawing that it was written from.
struct Best {
    file: RenderedFile,
    seen: Renderings,
    memento: Memento,
}

impl Best {
    fn of(session: &Session<'_>, file: &RenderedFile, seen: &Renderings) -> Self {
        Self {
            file: file.clone(),
            seen: seen.clone(),
            memento: session.drawing.memento(),
        }
    }
}

/// Whether to run another round after `done` rounds. If the time limit cut the descent short, rounds go on past their
/// planned number as long as there is time.
fn allows_round(session: &Session<'_>, done: usize) -> bool {
    let planned = session.recipe.settling.rounds;
    let is_cut = session.is_leaving() || session.cut_by() == Some(Stop::Time);
    let is_wanted = done < planned || (planned > 0 && is_cut);
    is_wanted && session.timer.allows_round()
}

/// The course of a round; `pace` is a factor on the rates of the geometry.
fn course(session: &Session<'_>, rates: Rates, pace: f32) -> Course {
    let settling = session.recipe.settling;
    Course {
        iterations: settling.iterations,
        before: 0,
        of: settling.iterations,
        rates: Rates {
            position: pace * rates.position,
            radius: pace * rates.radius,
            color: settling.color_rate * rates.color,
            opacity: settling.color_rate * rates.opacity,
            ..rates
        },
        pace: settling.rate,
        softness: None,
        until: f32::INFINITY,
        joint: None,
    }
}
