//! Settling: the last steps are taken against renders of the written file.
//!
//! An SVG renderer rounds to 8 bits after every stroke and has its own antialiasing. So its picture differs from our
//! canvas by an offset, which hardly changes when strokes move a little. Each round writes and renders the drawing,
//! subtracts a part of that offset from the target, and descends for a few iterations. The best file is kept.
//! [`renderers`](crate::fit::renderers) says which renderers count, and how much.

mod decimals;

use crate::error::Result;
use crate::fit::budget;
use crate::fit::descent::held::Held;
use crate::fit::descent::{Aim, Course};
use crate::fit::drawing::Memento;
use crate::fit::file::RenderedFile;
use crate::fit::order::Outcome;
use crate::fit::phase::descend::descend;
use crate::fit::recipe::{Rates, Settling};
use crate::fit::renderers::Renderings;
use crate::fit::result::Stop;
use crate::fit::run::session::Session;
use crate::metrics::psnr_db;

/// Settles the restricted drawing if the fit depends on its file, which the session then has.
pub(in crate::fit) fn settle(session: &mut Session<'_>) -> Result<Outcome> {
    if budget::needs_file(&session.config.budget, &session.recipe) {
        // Errors count as the user's mask says, but not less where detail hides them: renderers differ most at the
        // outlines of strokes, which are detail.
        session.drawing.focus_on(session.focus.as_ref());
        run(session)?;
        session.drawing.focus_on(session.weights.as_ref());
    }
    Ok(Outcome::Over)
}

/// Descends against renders of the file. The session gets the best file, and the drawing becomes the one that it was
/// written from.
fn run(session: &mut Session<'_>) -> Result<()> {
    session.progress.settle();
    if !allows_round(session, 0) {
        session.file = Some(session.render_file()?);
        return Ok(());
    }
    let settling = session.recipe.settling;
    let rates = session.restricted_rates();
    let (mut file, mut seen) = session.render_for_settling()?;
    let mut best = Best::of(session, &file, &seen);
    let (mut share, mut pace) = (seen.first_share(&file)?, 1.0);
    let mut round = 0;
    while allows_round(session, round) && session.progress.tell(&session.drawing, file.mse()) {
        round += 1;
        // Descend towards the picture less a part of what renderers add to it.
        let targets = seen.targets(&session.drawing, &file, share);
        let aim = Aim {
            targets: &targets,
            mse: file.mse(),
        };
        let mut descent = session.descent(course(settling, rates, pace));
        descent.ties.clone_from(&session.history.ties);
        descent.held = Held::of(session.drawing.free(), session.drawing.formed());
        descend(session, &mut descent, Some(aim))?;
        if session.progress.is_halted() {
            break;
        }
        // Look at the file that this has led to.
        let before = seen.worst_mse();
        (file, seen) = session.render_for_settling()?;
        if seen.worst_mse() < best.seen.worst_mse() {
            best = Best::of(session, &file, &seen);
        }
        if (psnr_db(seen.worst_mse()) - psnr_db(before)).abs() < settling.least_db {
            break;
        }
        share = seen.next_share(share);
        pace *= settling.next_pace;
    }
    session.drawing.revert(best.memento);
    (session.file, session.renderings) = (Some(best.file), Some(best.seen));
    drop_decimals(session)
}

/// Rounds areas where that pays, and looks at the file that this has led to.
fn drop_decimals(session: &mut Session<'_>) -> Result<()> {
    let Some(file) = session.file.take() else {
        return Ok(());
    };
    let (scene, precision) = (&file.rounded.scene, session.config.file.precision);
    if decimals::drop_decimals(&mut session.drawing, session.price, scene, precision) {
        let (file, seen) = session.render_for_settling()?;
        (session.file, session.renderings) = (Some(file), Some(seen));
    } else {
        session.file = Some(file);
    }
    Ok(())
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

/// True if another round runs after `done` rounds. If the time limit cut the descent short, rounds go on past their
/// planned number as long as there is time.
fn allows_round(session: &Session<'_>, done: usize) -> bool {
    let planned = session.recipe.settling.rounds;
    let is_cut = session.is_leaving() || session.cut_by() == Some(Stop::Time);
    let is_wanted = done < planned || (planned > 0 && is_cut);
    is_wanted && session.timer.allows_round()
}

/// The course of a round; `pace` is a factor on the rates of the geometry.
fn course(settling: Settling, rates: Rates, pace: f32) -> Course {
    Course {
        iterations: settling.iterations,
        before: 0,
        of: settling.iterations,
        rates: Rates {
            position: pace * rates.position,
            area: pace * settling.area,
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
