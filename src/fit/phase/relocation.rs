//! Relocation: strokes of little worth make room for candidates that will gain more.
//!
//! The strokes of least worth, by exact leave-one-out, and those not worth their price are removed, and candidates are
//! added on top instead. Both measures favour the stroke in place: a candidate's closed-form gain does not know what
//! fitting it will add, and a stroke's worth does not know what its neighbours will make up for. So the gain of a
//! candidate is multiplied ([`Relocation::gain`]).
//!
//! [`Relocation::gain`]: crate::fit::recipe::Relocation::gain

use crate::fit::phase::search::search;
use crate::fit::run::session::Session;
use crate::render::Params;
use crate::scene::Marks;
use crate::seed::Candidate;

/// Number of strokes that one relocation may move.
pub(in crate::fit) fn wanted(session: &Session<'_>) -> usize {
    let free = session.drawing.free().len();
    (free as f32 * session.recipe.relocation.share).ceil() as usize
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
        // Worth of the strokes that are there, and the least worth that pays.
        let worth = drawing.judge().worth;
        let price = price.in_drawing(drawing);
        let prices: Vec<f32> = drawing
            .free()
            .iter()
            .map(|p| price.least_worth(p))
            .collect();
        // Candidates whose gain pays.
        let count = match config.marks() {
            Marks::Areas => 0,
            Marks::Auto | Marks::Strokes => wanted.max(room.min(wanted * relocation.fill)),
        };
        let candidates = search(drawing, count, scale, recipe.probing, config.seed);
        let mut paying: Vec<Candidate> = candidates
            .into_iter()
            .map(adapt)
            .filter(|c| c.gain > price.least_gain_of_capsule(&c.stroke))
            .collect();
        paying.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let gains: Vec<f32> = paying.iter().map(|c| c.gain * relocation.gain).collect();
        let (keep, coming) = exchange(&worth, &prices, &gains, room);
        // The optimiser has to know which numbers moved to where.
        let kept = (0..keep.len()).filter(|&i| keep[i]);
        let mut sources: Vec<Option<usize>> = kept
            .flat_map(|i| drawing.free().range(i).map(Some))
            .collect();
        // The best candidate is drawn last, so that none of lesser gain hides it.
        let newcomers: Vec<Params> = paying[..coming].iter().rev().map(|c| c.stroke).collect();
        let stage = drawing.last_stage();
        drawing.retain_free(&keep);
        drawing.extend(newcomers, stage);
        sources.resize(drawing.free().numbers().len(), None);
        sources
    })
}

/// Which strokes stay, and how many candidates are added, of those that will gain `gains`, best first.
///
/// Strokes not worth their price go. Candidates take the free places first. Then the best remaining candidate replaces
/// the stroke of least worth, and so on, as long as its gain exceeds the worth.
fn exchange(worth: &[f32], prices: &[f32], gains: &[f32], room: usize) -> (Vec<bool>, usize) {
    let mut keep: Vec<bool> = worth
        .iter()
        .zip(prices)
        .map(|(worth, price)| worth > price)
        .collect();
    let vacated = keep.iter().filter(|&&stays| !stays).count();
    let mut coming = gains.len().min(room + vacated);
    let mut order: Vec<usize> = (0..worth.len()).filter(|&i| keep[i]).collect();
    order.sort_by(|&i, &j| worth[i].total_cmp(&worth[j]).then(i.cmp(&j)));
    for (i, &gain) in order.into_iter().zip(&gains[coming..]) {
        if gain <= worth[i] {
            break;
        }
        keep[i] = false;
        coming += 1;
    }
    (keep, coming)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_worth_less_than_candidates_go() {
        let worth = [4.0, 0.5, 2.0, 9.0, 0.1];
        let (keep, coming) = exchange(&worth, &[0.0; 5], &[5.0, 3.0, 1.0], 0);
        // 0.1 < 5 and 0.5 < 3, but 2 > 1.
        assert_eq!((keep, coming), (vec![true, false, true, true, false], 2));
    }

    #[test]
    fn strokes_not_worth_their_price_go_anyway() {
        let (keep, coming) = exchange(&[4.0, -1.0, 0.5], &[1.0; 3], &[], 0);
        assert_eq!((keep, coming), (vec![true, false, false], 0));
    }

    #[test]
    fn free_places_are_filled_first() {
        let (keep, coming) = exchange(&[4.0, 8.0], &[0.0; 2], &[3.0, 2.0], 2);
        assert_eq!((keep, coming), (vec![true, true], 2));
    }
}
