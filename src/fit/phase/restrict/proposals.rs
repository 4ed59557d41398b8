//! Proposals: marks in the place of one. They are fitted, shapes as shapes, before they are measured.

use std::ops::Range;

use crate::fit::descent::constraints::Constraints;
use crate::fit::descent::{Course, Descent, TRACED_PACE};
use crate::fit::drawing::Drawing;
use crate::fit::edits::{Change, Edit, apply_priced};
use crate::fit::recipe::Rates;
use crate::fit::run::session::Session;
use crate::render::StrokeRef;
use crate::scene::{Cap, Mark};
use crate::svg::mark_bytes;

/// The proposals for areas, and for strokes that were traced.
pub(super) fn traced(
    drawing: &Drawing,
    mut propose: impl FnMut(usize, Mark) -> Option<Vec<Mark>>,
) -> Vec<Edit> {
    let formed = drawing.formed();
    let free = drawing.free().iter().enumerate();
    let found = free.filter(|(i, mark)| *i < formed || mark.is_area());
    let edit = |(i, mark): (usize, StrokeRef<'_>)| {
        let marks = propose(i, mark.to_mark())?;
        Some(Edit::replacing(i, marks, 0.0))
    };
    found.filter_map(edit).collect()
}

/// The demands on each proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Each {
    /// It may cost more than it saves if others pay for that.
    MayLose,
    /// It pays by itself. It is one mark for one.
    Gains,
}

/// Iterations in which what is proposed is fitted. After 30, centres and radii of circles are within 0.005 px.
const ITERATIONS: usize = 20;
/// Step sizes of the points of areas and of traced strokes of the usual radius, and of radii, px. With ten times as much, circles stay
/// 0.1 px beside their places, and are refused.
const RATE: f32 = 0.03;
/// Bytes that a form is worth to an editor, besides those that it saves. A guess.
const WORTH_BYTES: isize = 30;
/// Most proposals that do not seem to pay and are tried one by one. A guess.
const MOST_SINGLES: usize = 24;

/// Fits the proposals, and makes those that pay. Returns whether any does.
pub(super) fn adopt(session: &mut Session<'_>, mut edits: Vec<Edit>, each: Each) -> bool {
    if edits.is_empty() {
        return false;
    }
    // 1. Make all proposals at once and fit them together, as a fit of all costs as much as a fit of one.
    let home = session.drawing.marks();
    let contribution_before = session.drawing.judge().contribution;
    let price = session.price.in_drawing(&mut session.drawing);
    session.drawing.apply(&edits);
    let spans = spans(&edits);
    fit(session, &spans);
    // 2. The marks as fitted, and the contribution of each.
    let contribution = session.drawing.judge().contribution;
    for (edit, span) in edits.iter_mut().zip(spans) {
        let fitted: Vec<Mark> = span
            .clone()
            .map(|k| session.drawing.free().get(k).to_mark())
            .collect();
        // 3. Price and gain of each: bytes saved against error added.
        let (i, _) = edit.changes[0];
        let bytes = bytes(&home.0.get(i).to_mark(), &fitted, session);
        edit.price =
            price.of_saved(bytes.max(0) as usize) - price.of_saved((-bytes).max(0) as usize);
        edit.gain = match each {
            // All are tried at once: no contribution of one tells what several parts, or marks that share pixels, are worth.
            Each::MayLose => f32::INFINITY,
            Each::Gains => contribution[span].iter().sum::<f32>() - contribution_before[i],
        };
        edit.changes = vec![(i, Change::Marks(fitted))];
    }
    // 4. Back to the marks before, on which trials of the fitted ones decide.
    session.drawing.set_marks(home);
    if each == Each::Gains {
        edits.sort_by(|a, b| b.surplus().total_cmp(&a.surplus()));
        let paying = edits.partition_point(|edit| edit.surplus() >= 0.0);
        edits.truncate(paying + MOST_SINGLES);
    } else {
        // Those on top are tried first.
        edits.reverse();
    }
    let tried = apply_priced(&mut session.drawing, edits, usize::MAX);
    !tried.made.is_empty()
}

/// Bytes that `new` marks save in the place of `old`, and those that the form is worth to an editor.
fn bytes(old: &Mark, new: &[Mark], session: &Session<'_>) -> isize {
    let of = |mark: &Mark| mark_bytes(mark, &session.config.file) as isize;
    let bands = new.iter().filter(|mark| mark.is_butt()).count() as isize;
    let saved = of(old) - new.iter().map(of).sum::<isize>();
    match old {
        // A stroke with square ends is no better to an editor than one with round ends.
        Mark::Stroke(old) if bands > 0 && old.cap == Cap::Round => saved,
        Mark::Stroke(_) if bands == 0 => saved + WORTH_BYTES,
        // Of areas, the attributes of the ends and elements of their own are no loss, and buy no error either.
        _ => {
            let saved = saved + WORTH_BYTES;
            saved.max((saved + bands * (WORTH_BYTES + ENDS_BYTES)).min(0))
        }
    }
}

/// Bytes of the attributes that give a path square ends and mitred corners: its ends are not worse for them.
const ENDS_BYTES: isize = " stroke-linecap=\"butt\" stroke-linejoin=\"miter\"".len() as isize;

/// The indices of the new marks of each edit once all are made. Edits are in the order of their marks.
fn spans(edits: &[Edit]) -> Vec<Range<usize>> {
    let mut shift = 0;
    let span = |edit: &Edit| {
        // Every edit before it moves the index by the marks that it adds.
        let start = edit.changes[0].0.saturating_add_signed(shift);
        shift += edit.growth;
        start..(start + 1).saturating_add_signed(edit.growth)
    };
    edits.iter().map(span).collect()
}

/// Descends with the marks of these indices alone.
fn fit(session: &mut Session<'_>, moving: &[Range<usize>]) {
    let restricted = session.restricted_rates().without_color();
    let rates = Rates {
        // A traced stroke moves as far as an area does.
        position: RATE / TRACED_PACE,
        radius: RATE.min(restricted.radius),
        area: RATE,
        opacity: 0.0,
        ..restricted
    };
    let course = Course::new(ITERATIONS, rates);
    let drawing = &mut session.drawing;
    let mut descent = Descent::new(drawing, course, 0.0);
    descent.constraints = Constraints::of(drawing.free(), drawing.formed());
    let mut moves = vec![false; drawing.free().len()];
    moving
        .iter()
        .for_each(|span| moves[span.clone()].fill(true));
    // All numbers of other marks are fixed, so that gains come from the proposals alone.
    for i in (0..moves.len()).filter(|&i| !moves[i]) {
        let places = drawing.free().range(i);
        places.for_each(|place| descent.ties.fix(place));
    }
    for step in 0..ITERATIONS {
        let done = step as f32 / ITERATIONS as f32;
        descent.step(drawing, &session.annealing, (step, done), None);
    }
}
