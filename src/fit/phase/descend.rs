//! The loop of gradient descent, which all phases share.
//!
//! An iteration is one step of the optimiser ([`Descent::step`]). A joint course also switches to full resolution and
//! relocates strokes between its steps. After every iteration the observer is called, and the state can be kept.

use std::ops::Range;

use crate::error::Result;
use crate::fit::budget;
use crate::fit::descent::{Aim, Descent, Joint};
use crate::fit::phase::relocation;
use crate::fit::points;
use crate::fit::run::session::Session;

/// Share of the polish after which nothing is relocated, so that new strokes have time to be fitted. 0.8, 0.95: 0.00 dB.
const UNTIL: f32 = 0.9;
/// Share of the polish in which points come and go.
const POINTS: Range<f32> = 0.1..0.85;
/// Share of the polish before which nothing is relocated if the drawing has areas. A guess.
const AFTER_AREAS: f32 = 0.5;

/// Runs `descent`, towards the picture or towards an `aim`, until its end or until time or observer stop it.
pub(in crate::fit) fn descend(
    session: &mut Session<'_>,
    descent: &mut Descent,
    aim: Option<Aim<'_>>,
) -> Result<()> {
    // A stop ends no descent towards an aim, which finishes the drawing and looks at the time itself.
    while aim.is_some() || session.progress.stopped().is_none() {
        if aim.is_none() {
            session.time_a_write()?;
        }
        let Some((step, done)) = descent.tick(&mut session.timer) else {
            break;
        };
        // Marks and points come and go between two iterations, and the optimiser keeps the moments of those that stay.
        rearrange(session, descent, step, done);
        let drawing = &mut session.drawing;
        descent.step(drawing, &session.annealing, (step, done), aim);
        let goes_on = match aim {
            None => session.advance(descent.left(), descent.gradients.loss),
            Some(Aim { mse, .. }) => {
                session.progress.tell(&session.drawing, mse) && session.timer.allows_file_after(1)
            }
        };
        session.keep(Some(descent));
        if session.check_for_stop() && aim.is_none() {
            descent.hurry();
        }
        if !goes_on {
            break;
        }
    }
    Ok(())
}

/// The most strokes that the drawing may have for its bytes.
fn affordable(session: &Session<'_>) -> usize {
    points::bytes_left(session).map_or(usize::MAX, |left| {
        let bytes = budget::typical_bytes(session.config, &session.target) as f32;
        session.drawing.len() + (left.max(0.0) / bytes) as usize
    })
}

/// Rearranges strokes between the steps of a joint course: it switches to full resolution after its coarse share, and at
/// intervals it changes the points of strokes and relocates strokes.
fn rearrange(session: &mut Session<'_>, descent: &mut Descent, step: usize, done: f32) {
    let Some(Joint { limit, .. }) = descent.course.joint else {
        return;
    };
    let (polish, relocation) = (session.recipe.polish, session.recipe.relocation);
    let drawing = &mut session.drawing;
    if done >= polish.coarse_share && drawing.is_thawed() && drawing.sharpen(0.0) {
        // Moments of gradients at another resolution are of another size.
        descent.forget(drawing);
    }
    if step == 0 || !step.is_multiple_of(relocation.every) || done >= UNTIL {
        return;
    }
    let changes_points = POINTS.contains(&done) && session.config.allows_points();
    if changes_points {
        let sources = points::rearrange(session, done);
        descent.follow(&sources, &session.drawing);
    }
    // Strokes would patch the edges of areas that are still to come to their places.
    if done < AFTER_AREAS && session.drawing.free().has_areas() {
        return;
    }
    // Relocation comes last, because it fills the places that joined strokes have left.
    let wanted = relocation::wanted(session);
    if session.timer.affordable(wanted) == wanted {
        let limit = limit.min(affordable(session));
        let sources = relocation::relocate(session, limit, std::convert::identity);
        descent.follow(&sources, &session.drawing);
    }
}
