//! Shedding: the points and strokes that are worth least for their bytes go, until a drawing is short enough.

use rayon::prelude::*;

use super::LEAST;
use super::edits::{self, Edit};
use super::terrain::Terrain;
use super::verify::verify;
use crate::fit::budget::price::Price;
use crate::fit::drawing::Drawing;

/// Most trials of losses of points at a time, so that no whole area goes in the place of a point. A guess.
const TRIALS: usize = 64;

/// A part that a stroke can spare, with its worth.
struct Offer {
    stroke: usize,
    /// A point that goes; `None` if it is the whole stroke.
    edit: Option<Edit>,
    bytes: usize,
    loss_per_byte: f32,
}

/// Takes away about `excess` bytes of free strokes and of their points, or all of them, one in `at_a_time`
/// of what could go at a time. Returns the former index of each number of the
/// free strokes.
pub(in crate::fit) fn shed(
    drawing: &mut Drawing,
    price: Price,
    at_a_time: usize,
    excess: usize,
) -> Vec<Option<usize>> {
    let numbers = drawing.free().numbers().len();
    let mut sources: Vec<Option<usize>> = (0..numbers).map(Some).collect();
    let mut left = excess;
    while left > 0 && !drawing.free().is_empty() {
        let mut offers = offers(drawing, price);
        // A stroke loses a point at a time, so that each loss is that of the stroke as it is; and what the next round offers may be
        // cheaper than the dearest offers of this one.
        offers.truncate(offers.len().div_ceil(at_a_time));
        let is_wanted = |offer: &Offer| {
            let before = left;
            left = left.saturating_sub(offer.bytes);
            before > 0
        };
        let taken = offers.into_iter().take_while(is_wanted).collect();
        let kept = take(drawing, taken);
        sources = kept.into_iter().map(|from| sources[from?]).collect();
    }
    sources
}

/// The best offer of each free stroke, the cheapest first.
fn offers(drawing: &mut Drawing, price: Price) -> Vec<Offer> {
    let point_bytes = price.point_bytes();
    let survey = drawing.survey(LEAST);
    let worth = drawing.judge().worth;
    let strokes = drawing.free();
    let terrains = Terrain::all(&survey, strokes);
    let edit = |terrain: &Terrain<'_>| {
        let is_finite = terrain.stroke.is_finite();
        is_finite.then(|| edits::best_loss(terrain))?
    };
    let mut edits: Vec<Option<Edit>> = terrains.par_iter().map(edit).collect();
    let marks: Vec<usize> = terrains.iter().map(|terrain| terrain.mark).collect();
    drop(terrains);
    let [_, to_keep] = price.of_point(true);
    verify(drawing, &mut edits, to_keep, TRIALS);
    let strokes = drawing.free();
    // Of the rings of an area, the one whose point costs least.
    let mut cheapest: Vec<Option<Edit>> = vec![None; strokes.len()];
    for (edit, mark) in edits.into_iter().zip(marks) {
        let is_cheaper = |edit: &Edit| cheapest[mark].as_ref().is_none_or(|c| edit.gain > c.gain);
        if edit.as_ref().is_some_and(is_cheaper) {
            cheapest[mark] = edit;
        }
    }
    // A stroke offers the part that is worth least for its bytes: a point, or all of it.
    let offer = |(i, edit): (usize, Option<Edit>)| {
        let stroke = strokes.get(i);
        let bytes = price.bytes_of(stroke).max(1);
        let whole = Offer {
            stroke: i,
            edit: None,
            bytes,
            loss_per_byte: worth[i].max(0.0) / bytes as f32,
        };
        let part = edit.map(|edit| Offer {
            stroke: i,
            bytes: point_bytes,
            loss_per_byte: -edit.gain / point_bytes as f32,
            edit: Some(edit),
        });
        match part {
            Some(part) if part.loss_per_byte < whole.loss_per_byte => part,
            _ => whole,
        }
    };
    let mut offers: Vec<Offer> = cheapest.into_iter().enumerate().map(offer).collect();
    let order = |a: &Offer, b: &Offer| {
        let by_loss = a.loss_per_byte.total_cmp(&b.loss_per_byte);
        by_loss.then(a.stroke.cmp(&b.stroke))
    };
    offers.sort_by(order);
    offers
}

/// Applies the offers. Returns the former index of each number of the free strokes.
fn take(drawing: &mut Drawing, offers: Vec<Offer>) -> Vec<Option<usize>> {
    let count = drawing.free().len();
    let paths = drawing.free().iter().map(|stroke| stroke.paths().count());
    let mut edits: Vec<Option<Edit>> = vec![None; paths.sum()];
    let mut keep = vec![true; count];
    for offer in offers {
        keep[offer.stroke] = offer.edit.is_some();
        if let Some(edit) = offer.edit {
            let path = edit.path;
            edits[path] = Some(edit);
        }
    }
    let edited = drawing.edit(&edits);
    let strokes = drawing.free();
    let stay = (0..count).filter(|&i| keep[i]).map(|i| strokes.range(i));
    let sources = stay
        .flat_map(|range| edited[range].iter().copied())
        .collect();
    drawing.retain_free(&keep);
    sources
}
