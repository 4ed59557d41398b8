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

mod forms;
mod given_widths;
mod inks;
mod merge;
mod occlusion;
mod palette;
mod preferences;
mod proposals;
mod rounds;
mod shared_styles;
mod shared_widths;
mod stack;
mod width_grid;

use std::f32::consts::PI;

use super::count;
use crate::error::Result;
use crate::fit::config::Colors;
use crate::fit::descent::ties::Ties;
use crate::fit::drawing::Drawing;
use crate::fit::edits::{Room, TRIALS, apply_priced, choose, drop_marks};
use crate::fit::order::Outcome;
use crate::fit::run::session::Session;
use crate::render::StrokeRef;
use crate::scene::Marks;
use crate::svg::Group;

/// Gives the strokes the colours and widths that the file may have.
pub(in crate::fit) fn restrict(session: &mut Session<'_>) -> Result<Outcome> {
    session.drawing.thaw();
    session.drawing.sharpen(0.0);
    // Colours come before widths: strokes of a palette share a pen only if they have one colour.
    if let Some(mut palette) = palette::run(session)?
        && session.config.file.group == Group::Color
    {
        stack::run(session, &mut palette)?;
    }
    given_widths::run(session)?;
    shared_styles::run(session)?;
    // In free colours, each stroke is worth its price.
    if session.config.colors != Colors::Free {
        remove_hidden(&mut session.drawing);
    }
    // The last changes of single marks; from here on shared numbers are tied.
    let inks = inks::run(session);
    if !session.drawing.is_placed() {
        forms::run(session)?;
    }
    if session.config.marks() == Marks::Areas {
        forms::fill_bands(&mut session.drawing);
    }
    let mut ties = share_within_bytes(session);
    ties.extend(inks::ties(&session.drawing, &inks));
    session.history.ties = ties;
    Ok(Outcome::Over)
}

/// Change of a channel that cannot be seen: less than half an 8-bit level.
const UNSEEN: f32 = 0.5 / 255.0;

/// Removes strokes without which the drawing is as good, since they are covered or have the colour of what they cover, and counts
/// them. A palette makes many of them, and they are in the way of whoever edits the file.
fn remove_hidden(drawing: &mut Drawing) {
    let unseen = |mark: StrokeRef<'_>| 3.0 * pixels(mark) * UNSEEN * UNSEEN;
    let losses = drop_marks(drawing, unseen);
    let tried = apply_priced(drawing, choose(losses, Room::default()), TRIALS);
    drawing.counters.hidden += tried.made.len();
}

/// About how many pixels a stroke covers. An area counts with its bounding box.
pub(super) fn pixels(stroke: StrokeRef<'_>) -> f32 {
    if stroke.is_area() {
        let side = |axis: usize| {
            let along = || stroke.points.iter().map(|p| p[axis]);
            along().fold(0.0, f32::max) - along().fold(f32::INFINITY, f32::min)
        };
        return side(0) * side(1);
    }
    let radius = stroke.radius();
    // A capsule: a rectangle of 2r × length, and two half discs.
    radius * (2.0 * stroke.length() + PI * radius)
}

/// Makes strokes share widths and colours, of as many strokes as the budget of bytes allows then.
fn share_within_bytes(session: &mut Session<'_>) -> Ties {
    session.history.corrections.shortened = false;
    session.drawing.join_stages(session.layers_to_join());
    // Bytes before sharing: their ratio lets the next polish plan with what sharing saves.
    let before = session.writer.bytes(&session.drawing).max(1);
    loop {
        let unshared = session.drawing.snapshot();
        let ties = shared_widths::run(&mut session.drawing, session.config);
        let excess = count::excess(session);
        if !session.history.corrections.shortened {
            let bytes = session.writer.bytes(&session.drawing);
            session.history.corrections.restricted = bytes as f32 / before as f32;
        }
        if excess == 0 || session.drawing.free().is_empty() {
            return ties;
        }
        // Sharing saves bytes only if it is done again, on the strokes that are left.
        session.drawing.revert(unshared);
        count::shorten(session, excess);
    }
}
