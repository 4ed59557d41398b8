//! The one loop that descends: every phase runs its strokes through it.
//!
//! An iteration is one step of the optimiser ([`Descent::step`]). A joint course also goes to full resolution and
//! relocates strokes as it goes. After every iteration whoever watches is told, and the state can be kept.

use super::descent::{Aim, Descent};
use super::relocation;
use super::session::Session;
use crate::error::Result;

/// Runs `descent` to its end, or as far as time and observer let it; towards the picture, or towards an `aim`.
pub(super) fn descend(
    session: &mut Session<'_>,
    descent: &mut Descent,
    aim: Option<Aim<'_>>,
) -> Result<()> {
    while aim.is_some() || session.progress.stopped().is_none() {
        if aim.is_none() {
            session.rehearse()?;
        }
        let Some((step, done)) = descent.tick(&mut session.timer) else {
            break;
        };
        rearrange(session, descent, step, done);
        let drawing = &mut session.drawing;
        descent.step(drawing, &session.annealing, (step, done), aim);
        let goes_on = match aim {
            None => session.advance(descent.gradients.loss),
            Some(Aim { mse, .. }) => {
                session.progress.tell(&session.drawing, mse) && session.timer.allows_step()
            }
        };
        session.keep(Some(descent));
        if !goes_on {
            break;
        }
    }
    Ok(())
}

/// What a joint course does between its steps: it goes to full resolution once a share is over, and relocates
/// strokes every so often.
fn rearrange(session: &mut Session<'_>, descent: &mut Descent, step: usize, done: f32) {
    let Some(limit) = descent.course.joint else {
        return;
    };
    let (polish, relocation) = (session.recipe.polish, session.recipe.relocation);
    let drawing = &mut session.drawing;
    if done >= polish.coarse_share && drawing.is_thawed() && drawing.sharpen(0.0) {
        descent.forget(drawing, &session.recipe);
    }
    if step == 0 || !step.is_multiple_of(relocation.every) || done >= relocation.until {
        return;
    }
    let wanted = relocation::wanted(session);
    if session.timer.affordable(wanted) == wanted {
        let sources = relocation::relocate(session, limit, std::convert::identity);
        descent.follow(&sources, &session.drawing, &session.recipe);
    }
}
