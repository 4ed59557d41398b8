//! The floor: a polished drawing that looks too little like the picture goes on at a lower price.
//!
//! The price of a byte says nothing of what people see: in dark or pale pictures 30 dB are little. So SSIMULACRA2 is asked once all
//! strokes are where they belong, since the polish alone adds 5 to 25 points to it.

use super::grow;
use crate::error::Result;
use crate::fit::config::Colors;
use crate::fit::order::Outcome;
use crate::fit::recipe::Preset;
use crate::fit::run::session::Session;
use crate::metrics::ssimulacra2;

/// Least SSIMULACRA2 of what has no paper: medium quality.
const FLOOR: f64 = 50.0;
/// Least SSIMULACRA2 of a drawing on paper, of which people see each line.
const FLOOR_ON_PAPER: f64 = 60.0;
/// SSIMULACRA2 for each decibel by which the price falls. Six photographs gain 4 to 6. 4.5 instead of 5: kodim23 has 48.5 instead of 48,
/// and a drawing in crayon 4.4 instead of 3.9 times the bytes.
const PER_DB: f64 = 5.0;
/// Least such decibels: less gets lost in what a polish does by chance.
const LEAST_DB: f64 = 0.3;
/// Most decibels by which the price falls. Paintings and photographs have up to four times the bytes then.
const MOST_DB: f64 = 5.5;

/// Lowers the price and seeds the next stage if the polished drawing, whose quality nobody has set, is below the floor.
pub(super) fn reach_floor(session: &mut Session<'_>) -> Result<Outcome> {
    if !has_floor(session) {
        return Ok(Outcome::Over);
    }
    let drawn = session.render_file()?.drawn;
    let score = ssimulacra2(session.drawing.surfaces[0].picture(), &drawn[0])?;
    let floor = match session.task.paleness_db {
        Some(_) => FLOOR_ON_PAPER,
        None => FLOOR,
    };
    let eased_db = ((floor - score) / PER_DB).min(MOST_DB);
    if eased_db < LEAST_DB {
        return Ok(Outcome::Over);
    }
    session.ease(eased_db);
    // The last stage hardly paid, but at another price.
    session.history.stage = None;
    grow::next_stage(session)
}

/// True if nobody has said how long the fit may take or which colours there are, the drawing has no floor behind it, and more strokes can make it better.
fn has_floor(session: &Session<'_>) -> bool {
    let config = session.config;
    session.task.base.is_none()
        && config.budget.time.is_none()
        && config.preset != Preset::Draft
        && config.colors == Colors::Free
        && !session.drawing.is_placed()
        && session.history.eased_db == 0.0
        && session.cut_by().is_none()
}
