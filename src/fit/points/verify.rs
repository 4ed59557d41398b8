//! Verification: edits of areas are tried on the canvas.
//!
//! A survey knows nothing of edges that are off the page or under other marks, so that the loss of a point there seems to
//! cost nothing, even where it moves an edge to where it is seen; and an edge that comes to cross another one turns its
//! inside out. So edits are tried: all at once and, where that adds more error than foreseen, each half of them. What is
//! still in doubt after so many trials stays as it is.

use super::edits::Edit;
use crate::fit::drawing::Drawing;
use crate::fit::halves::by_halves;

/// So many times the error that was foreseen may be added. A guess: descent will lessen it.
const TOLERANCE: f64 = 2.0;

/// Gives those of the `edits` of areas that add more than foreseen, and more than the least gain of a point `to_keep` it, the
/// gain that they have in truth, and takes back those that are in doubt after so many `trials`.
pub(super) fn verify(
    drawing: &mut Drawing,
    edits: &mut [Option<Edit>],
    to_keep: f32,
    trials: usize,
) {
    let of_rings = edits.iter().flatten().filter(|edit| edit.is_of_ring);
    let of_rings: Vec<usize> = of_rings.map(|edit| edit.path).collect();
    if of_rings.is_empty() {
        return;
    }
    let (before, error) = (drawing.free().clone(), drawing.mse());
    let values = (3 * drawing.pixels()) as f64;
    let mut done = 0;
    by_halves(of_rings, |group| {
        done += 1;
        if done > trials {
            group.iter().for_each(|&path| edits[path] = None);
            return true;
        }
        let mut tried: Vec<Option<Edit>> = vec![None; edits.len()];
        group.iter().for_each(|&i| tried[i].clone_from(&edits[i]));
        drawing.edit(&tried);
        let added = (drawing.mse() - error) * values;
        drawing.free_mut().clone_from(&before);
        let foreseen =
            |edit: &Edit| TOLERANCE * f64::from(-edit.gain).max(0.0) + f64::from(to_keep);
        let allowed: f64 = tried.iter().flatten().map(foreseen).sum();
        let is_allowed = added <= allowed;
        if let ([only], false) = (group, is_allowed)
            && let Some(edit) = &mut edits[*only]
        {
            edit.gain = -added as f32;
        }
        is_allowed
    });
}
