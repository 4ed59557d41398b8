//! The phases of a fit; [`order`](super::order) says which follows which.
//!
//! | file | what happens there |
//! | --- | --- |
//! | `trace` | strokes are laid along the lines that are seen |
//! | `grow` | stages are seeded, fitted on frozen strokes, and keep what pays |
//! | `polish` | all strokes are fitted jointly, with relocation |
//! | `floor` | a drawing that looks too little like the picture goes on at a lower price |
//! | `recover` | small things that were lost on the way are traced again |
//! | `restrict` | strokes get the colours and widths that the file may have |
//! | `settle` | the last steps are taken against renders of the written file |
//! | `count` | files are compared, and strokes added and removed until budgets are met |

pub(super) mod count;
pub(super) mod descend;
mod floor;
pub(super) mod grow;
pub(super) mod polish;
pub(super) mod recover;
pub(super) mod relocation;
pub(super) mod restrict;
mod search;
pub(super) mod settle;
pub(super) mod trace;

use super::order::{Outcome, Phase, Purpose};
use super::run::session::Session;
use crate::error::Result;

/// Runs the phase that `session` is in.
pub(super) fn run(session: &mut Session<'_>) -> Result<Outcome> {
    Ok(match session.phase {
        Phase::Base => count::try_base(session)?,
        Phase::Trace => trace::trace_lines(session)?,
        Phase::Grow => grow::next_stage(session)?,
        Phase::Stage(purpose) => grow::stage(session, purpose)?,
        Phase::StagePolish(_) => grow::stage_polish(session)?,
        Phase::Polish(purpose) => {
            polish::polish(session, purpose)?;
            if purpose == Purpose::Recover {
                recover::drop_smudges(session);
            }
            match purpose {
                Purpose::Plan if session.config.is_open() => floor::reach_floor(session)?,
                _ => count::approach_fidelity(session),
            }
        }
        Phase::Recover => recover::recover(session)?,
        Phase::Restrict(_) => restrict::restrict(session)?,
        Phase::Settle(_) => settle::settle(session)?,
        Phase::MeetFidelity => count::meet_fidelity(session),
        Phase::MeetBytes => count::meet_bytes(session),
        Phase::Done => Outcome::Over,
    })
}
