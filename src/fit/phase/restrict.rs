//! Restricting: strokes get the colours and widths that the file may have, one kind of restriction after the other.
//!
//! | file | what happens there |
//! | --- | --- |
//! | `palette` | strokes take their colours from a palette |
//! | `stack` | strokes of one colour become neighbours, for one layer each |
//! | `given_widths` | strokes take the widths of given pens |
//! | `shared_styles` | strokes come to share colour and width at once, for the smallest form of a file |
//! | `shared_widths` | strokes of a drawing of lines come to share widths, and colours |
//! | `inks` | thin lines take the colours of the picture |
//! | `forms` | circles, rectangles and level lines become exactly such |
//! | `covers` | what other marks hide of a border |
//! | `proposals` | marks in the place of others, which stay if they pay |
//! | `merge` | the agglomeration that decides which strokes share |
//! | `preferences` | the colour that would suit each stroke best |
//! | `rounds` | the descent between two choices |

mod covers;
mod forms;
mod given_widths;
mod inks;
mod merge;
mod palette;
mod preferences;
mod proposals;
mod rounds;
mod shared_styles;
mod shared_widths;
mod stack;
mod width_grid;

use super::count;
use crate::error::Result;
use crate::fit::config::Colors;
use crate::fit::descent::ties::Ties;
use crate::fit::order::Outcome;
use crate::fit::run::session::Session;
use crate::svg::Group;

/// Gives the strokes the colours and widths that the file may have.
pub(in crate::fit) fn restrict(session: &mut Session<'_>) -> Result<Outcome> {
    session.drawing.thaw();
    session.drawing.sharpen(0.0);
    if let Some(mut palette) = palette::run(session)?
        && session.config.file.group == Group::Color
    {
        stack::run(session, &mut palette)?;
    }
    given_widths::run(session)?;
    shared_styles::run(session)?;
    // In free colours, each stroke is worth its price.
    if session.config.colors != Colors::Free {
        session.drawing.remove_hidden();
    }
    let inks = inks::run(session);
    forms::run(session)?;
    let mut ties = share_within_bytes(session);
    ties.extend(inks::ties(&session.drawing, &inks));
    session.history.ties = ties;
    Ok(Outcome::Over)
}

/// Makes strokes share widths and colours, of as many strokes as the budget of bytes allows then.
fn share_within_bytes(session: &mut Session<'_>) -> Ties {
    session.history.corrections.shortened = false;
    session.drawing.join_stages(session.layers_to_join());
    let before = session.writer.bytes(&session.drawing).max(1);
    loop {
        let unshared = session.drawing.memento();
        let ties = shared_widths::run(&mut session.drawing, session.config, &session.recipe);
        let excess = count::excess(session);
        if !session.history.corrections.shortened {
            let bytes = session.writer.bytes(&session.drawing);
            session.history.corrections.restricted = bytes as f32 / before as f32;
        }
        if excess == 0 || session.drawing.free().is_empty() {
            return ties;
        }
        // Sharing saves bytes only if it is done again, on what is left.
        session.drawing.revert(unshared);
        count::shorten(session, excess);
    }
}
