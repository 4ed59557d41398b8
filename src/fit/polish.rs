//! Polish: all free strokes, and the background, fitted jointly, with relocation.
//!
//! Every so often the strokes worth least by exact leave-one-out, and those not worth their price, are
//! taken away, and candidates that will gain more are put on top instead. A candidate's closed-form gain
//! is that before it is fitted, and a stroke's worth that before its neighbours take over, so that both
//! speak for the stroke in place: the gain counts several times ([`Recipe::relocate_gain`]).

use std::convert::identity;

use serde::{Deserialize, Serialize};

use super::anneal::Anneal;
use super::control::Control;
use super::descent::Descent;
use super::drawing::Drawing;
use super::price::Price;
use super::recipe::Recipe;
use crate::optim::{Adam, AdamParams, Optimizer, Schedule};
use crate::render::Params;
use crate::seed::Candidate;

/// How many strokes there may be, and what each has to be worth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Terms {
    /// Strokes of the drawing at most, frozen ones included.
    pub(super) limit: usize,
    pub(super) price: Price,
}

/// A polish under way: the free strokes of the drawing are fitted jointly; the background too, where it
/// shows through to them and is not fixed. A first share of the iterations is done at the resolution that
/// the drawing has.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Polish {
    /// Strokes of the drawing at most, frozen ones included.
    limit: usize,
    clock: Clock,
    descent: Descent,
    background: Adam<f32>,
}

impl Polish {
    /// A polish of the free strokes of `drawing` in `steps` iterations, which may make them `limit` strokes, and
    /// is over when a share `until` of a limited time is used.
    pub(super) fn new(
        drawing: &Drawing,
        recipe: &Recipe,
        limit: usize,
        steps: usize,
        until: f32,
        control: &Control<'_>,
    ) -> Self {
        Self {
            limit,
            clock: Clock::new(steps, until, control),
            descent: Descent::new(drawing.free(), recipe.polish_rates, drawing.limits),
            background: Adam::new(3, AdamParams::default()),
        }
    }

    /// One iteration; false when none is left.
    pub(super) fn step(
        &mut self,
        drawing: &mut Drawing,
        recipe: &Recipe,
        anneal: Anneal,
        price: Price,
        control: &mut Control<'_>,
    ) -> bool {
        let Some((step, done)) = self.clock.tick(control) else {
            return false;
        };
        let anneal = Anneal {
            from: recipe.polish_softness,
            ..anneal
        };
        let descent = &mut self.descent;
        if done >= recipe.coarse_share && drawing.is_thawed() && drawing.refine(0.0) {
            *descent = Descent::new(drawing.free(), recipe.polish_rates, drawing.limits);
        }
        let share = relocated(drawing, recipe);
        if recipe.relocates(step, done) && control.affordable(share) == share {
            let terms = Terms {
                limit: self.limit,
                price,
            };
            control.searching(share, || {
                relocate(drawing, recipe, terms, identity, descent);
            });
        }
        let (steps, end) = (self.clock.steps, recipe.polish_rates.last);
        let at = (done * steps as f32) as usize;
        let rate = Schedule::Cosine { end }.factor(at, steps) as f32;
        drawing.step(descent, anneal.at(done), rate);
        if drawing.is_thawed() && !drawing.background_fixed {
            let rate = rate * recipe.polish_rates.color;
            let (slope, background) = (&descent.gradients.backdrop, &mut self.background);
            drawing.change_background(|color| background.step(color, slope, rate));
        }
        control.advance(drawing, descent.gradients.loss);
        true
    }
}

/// Counts iterations, and hurries the schedule on when the time limit would cut it short.
#[derive(Debug, Serialize, Deserialize)]
struct Clock {
    step: usize,
    steps: usize,
    /// Share of the time for descent that was used before.
    before: f32,
    /// Share of it that is used when the schedule has to be over.
    until: f32,
}

impl Clock {
    fn new(steps: usize, until: f32, control: &Control<'_>) -> Self {
        Self {
            step: 0,
            steps,
            before: control.time_used(),
            until,
        }
    }

    /// The next iteration and the share of the schedule that is over, or `None` when all of it is.
    fn tick(&mut self, control: &mut Control<'_>) -> Option<(usize, f32)> {
        let by_count = self.step as f32 / self.steps.max(1) as f32;
        let left = (self.until - self.before).max(f32::MIN_POSITIVE);
        let by_time = (control.time_used() - self.before) / left;
        let done = by_count.max(by_time);
        if by_count < 1.0 && by_time >= 1.0 {
            control.hurry();
        }
        self.step += 1;
        (done < 1.0).then_some((self.step - 1, done))
    }
}

/// How many strokes may be relocated at a time.
fn relocated(drawing: &Drawing, recipe: &Recipe) -> usize {
    (drawing.free().len() as f32 * recipe.relocate_share).ceil() as usize
}

/// Swaps strokes for candidates that will gain more, and fills up to the limit with those that pay.
/// `adapt` makes of a candidate what may come in its place.
pub(super) fn relocate(
    drawing: &mut Drawing,
    recipe: &Recipe,
    terms: Terms,
    adapt: impl Fn(Candidate) -> Candidate,
    descent: &mut Descent,
) {
    let room = terms.limit.saturating_sub(drawing.len());
    let share = relocated(drawing, recipe);
    let scale = drawing.spacing(drawing.len()) * recipe.scale * recipe.relocate_scale;
    let worth = drawing.judge().worth;
    let candidates = drawing.propose(share.max(room.min(share * 2)), scale, recipe.oversampling);
    let prices: Vec<f32> = drawing
        .free()
        .iter()
        .map(|stroke| terms.price.of(stroke))
        .collect();
    let candidate_price = |c: &Candidate| terms.price.of(&c.stroke);
    let mut paying: Vec<Candidate> = candidates
        .into_iter()
        .map(adapt)
        .filter(|c| c.gain > candidate_price(c))
        .collect();
    paying.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let gains: Vec<f32> = paying
        .iter()
        .map(|c| c.gain * recipe.relocate_gain)
        .collect();
    let (keep, newcomers) = exchange(&worth, &prices, &gains, room);
    let mut sources: Vec<Option<usize>> = (0..keep.len()).filter(|&i| keep[i]).map(Some).collect();
    let newcomers: Vec<Params> = paying[..newcomers].iter().rev().map(|c| c.stroke).collect();
    sources.resize(sources.len() + newcomers.len(), None);
    let stage = drawing.last_stage();
    drawing.retain_free(&keep);
    drawing.extend(newcomers, stage);
    descent.rearrange(drawing.free(), &sources);
}

/// Which strokes stay, and how many candidates come, of those that will gain `gains`, best first.
///
/// Strokes not worth their price go. Candidates first take the places that are free, then, the best of
/// them against the worst of those, the places of strokes worth less than they gain.
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
