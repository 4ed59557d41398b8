//! Relocation: strokes that contribute little make room for candidates that will gain more.
//!
//! The strokes of least contribution, by exact leave-one-out, and those not worth their price are removed, and candidates are
//! added on top instead. Both measures favour the stroke in place: a candidate's closed-form gain does not know what
//! fitting it will add, and a stroke's contribution does not know what its neighbours will make up for. So the gain of a
//! candidate is multiplied (`Relocation::gain`).

use crate::fit::edits::{Edit, Room, TOP, choose, drop_marks};
use crate::fit::phase::search::search;
use crate::fit::run::session::Session;
use crate::render::Strokes;
use crate::scene::Marks;
use crate::seed::Candidate;

/// Share of the strokes that one relocation may move. 0.1, 0.2, 0.4: −0.06, 0, +0.12 dB; since gains are multiplied, 0.15 and 0.5:
/// −0.02, 0.00.
const SHARE: f32 = 0.3;
/// A relocation that has free places to fill asks for up to this many times as many candidates as it may move strokes. Half, twice:
/// 0.00 dB.
const FILL: usize = 2;

/// Number of strokes that one relocation may move.
pub(in crate::fit) fn wanted(session: &Session<'_>) -> usize {
    let free = session.drawing.free().len();
    (free as f32 * SHARE).ceil() as usize
}

/// Replaces strokes by candidates that will gain more, and fills up to `limit` strokes with candidates that pay.
/// `adapt` changes a candidate to what the drawing may have. Returns the former index of each number of the free strokes,
/// `None` for a new one.
pub(in crate::fit) fn relocate(
    session: &mut Session<'_>,
    limit: usize,
    adapt: impl Fn(Candidate) -> Candidate,
) -> Vec<Option<usize>> {
    let wanted = wanted(session);
    let (config, recipe, timer) = (session.config, &session.recipe, &mut session.timer);
    let drawing = &mut session.drawing;
    let price = session.price;
    timer.searching(wanted, || {
        let relocation = recipe.relocation;
        let room = limit.saturating_sub(drawing.len());
        let scale = drawing.spacing(drawing.len()) * recipe.stages.scale * relocation.scale;
        // Strokes that are not worth their price go.
        let price = price.in_drawing(drawing);
        let mut edits = drop_marks(drawing, |mark| price.least_contribution(mark));
        // Candidates whose gain pays.
        let count = match config.marks() {
            Marks::Areas => 0,
            Marks::Auto | Marks::Strokes => wanted.max(room.min(wanted * FILL)),
        };
        let candidates = search(drawing, count, scale, config.seed);
        let candidates = candidates.into_iter().map(adapt);
        let paying = candidates.filter(|c| c.gain > price.least_gain_of_capsule(&c.stroke));
        edits.extend(paying.map(|c| {
            let stroke = Strokes::from_iter([&c.stroke]).get(0).to_mark();
            Edit {
                // A candidate isn't fitted yet. The factor makes its gain comparable with the contribution of fitted strokes.
                gain: c.gain * relocation.gain,
                growth: 1,
                ..Edit::replacing(TOP, vec![stroke], 0.0)
            }
        }));
        let room = Room {
            free: room,
            most: usize::MAX,
            swaps: usize::MAX,
        };
        // Not measured by trials: the descent that follows fits what was added.
        drawing.apply(&choose(edits, room))
    })
}
