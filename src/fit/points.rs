//! Points at their price: strokes get points where these gain more than their bytes cost, and lose points that gain less.
//!
//! A survey tells how the squared error depends on the vertices of all strokes, and so what every change of a stroke's
//! points would gain; [`edits`] proposes and measures them. Each path may change by one edit at a time; descent then fits
//! it. The rule for strokes holds: a point that does not pay its price goes, and one that pays comes. If the budget has
//! no room left, points that gain more take the places of points that cost less to lose.

use rayon::prelude::*;

use super::budget::price::Price;
use super::budget::{self, typical_bytes};
use super::drawing::Drawing;
use super::edits::model::{LEAST, QuadraticModel};
use super::edits::{
    self, Change, Edit, Room, TRIALS, apply_priced, choose, disjoint, drop_marks, joins,
};
use super::run::session::Session;
use crate::render::{StrokeRef, Survey};

/// So many times the error that was foreseen may be added while descent goes on, which lessens it. A guess.
const TOLERANCE: f32 = 2.0;
/// Share of the strokes that may get a point at a time.
const SHARE: f32 = 0.5;
/// Share of the strokes that may lose a point to another stroke at a time, where the budget has no room left.
const SWAPPED: f32 = 0.2;
/// Share of a budget of bytes that is filled with points before the file is written.
const FILLED: f32 = 0.995;
/// Share of the polish after which bytes that are left are for points alone. A guess.
const ALONE: f32 = 0.5;
/// Expected gain of a point once it is fitted, in units of the gain that is found. Five photographs of 1,024 strokes: 30, 120, 200
/// instead of 60: −0.13, +0.04, +0.03 dB.
const GAIN: f32 = 120.0;
/// Quantile of stroke contribution at which a stroke counts as expendable. A guess.
const SPARED: f32 = 0.3;
/// One in this many of the points and strokes that could go for bytes goes at a time. A guess: what the next round offers may be
/// cheaper than the dearest offers of this one.
const AT_A_TIME: usize = 4;

/// Changes the points of the free strokes where that pays, when a share `done` of the polish is over. Returns the former
/// index of each number of the free strokes, `None` for a new one.
pub(super) fn rearrange(session: &mut Session<'_>, done: f32) -> Vec<Option<usize>> {
    let excess = bytes_left(session).map_or(0, |left| (-left).max(0.0) as usize);
    // A drawing over its bytes loses some before anything else: no gain makes up for bytes beyond the budget.
    if excess > 0 {
        return shed(&mut session.drawing, session.price, excess);
    }
    // Bytes that are left late in the polish are for points: no stroke will come for them.
    let has_strokes = session.config.budget.bytes.is_some() && done >= ALONE;
    let config = session.config;
    let drawing = &mut session.drawing;
    // Under a price no stroke takes the place of another.
    let is_priced = config.quality_for(drawing.pixels()).is_some();
    let spare = match has_strokes || is_priced {
        true => 0.0,
        false => quantile_contribution(drawing, SPARED),
    };
    let most = config.points.unwrap_or(usize::MAX);
    let price = session.price.in_drawing(drawing);
    let contribution = |stroke: StrokeRef<'_>| price.least_contribution(stroke).max(spare);
    // Joins first. They free points that the edits of paths can use.
    let joins = joins::joins(drawing.free(), most, contribution);
    let joined = apply_priced(drawing, joins, TRIALS).sources;
    let edited = edit(session, spare);
    // Two rearrangements in a row: a number's source is the source of its source.
    edited.iter().map(|source| joined[(*source)?]).collect()
}

/// Takes away points that are not worth their price now that the strokes are where they belong. Each path loses at most one
/// point at a time. A pass that adds more than it may is taken back, and is the last one.
pub(super) fn prune(drawing: &mut Drawing, price: Price, prunings: usize) {
    for _ in 0..prunings {
        let price = price.in_drawing(drawing);
        let losses = choose(losses(drawing, price), Room::default());
        let (of_areas, mut of_strokes): (Vec<_>, Vec<_>) =
            losses.into_iter().partition(|edit| edit.is_tried);
        let is_shorter = !apply_priced(drawing, of_areas, TRIALS).made.is_empty();
        // Losses of strokes foresee their errors well, and pay together or not at all: no descent follows that would mend them.
        of_strokes.iter_mut().for_each(|edit| edit.is_tried = true);
        let is_over = of_strokes.is_empty() && !is_shorter;
        let wanted = of_strokes.len();
        if apply_priced(drawing, of_strokes, 1).made.len() < wanted || is_over {
            return;
        }
    }
}

/// The loss of a point of each path.
fn losses(drawing: &mut Drawing, price: Price) -> Vec<Edit> {
    let to_keep = [false, true].map(|of_area| price.of_point(of_area)[1]);
    let survey = drawing.survey();
    let models = QuadraticModel::all(&survey, drawing.free());
    let loss = |model: &QuadraticModel<'_>| {
        edits::points::drop(model, to_keep[usize::from(model.is_ring)])
    };
    models.par_iter().filter_map(loss).collect()
}

/// Takes away about `excess` bytes of free strokes and of their points, or all of them: what costs least for its bytes. Returns the
/// former index of each number of the free strokes.
pub(super) fn shed(drawing: &mut Drawing, price: Price, excess: usize) -> Vec<Option<usize>> {
    let numbers = drawing.free().numbers().len();
    let mut sources: Vec<Option<usize>> = (0..numbers).map(Some).collect();
    let mut left = excess;
    // Every pass removes at least one mark or point, so that the loop ends.
    while left > 0 && !drawing.free().is_empty() {
        let mut edits = losses(drawing, price);
        let drops = drop_marks(drawing, |mark| price.least_contribution(mark));
        // Bytes beyond a budget have to go, whatever they are worth.
        edits.extend(untried(drops));
        let point_bytes = price.point_bytes();
        let bytes: Vec<usize> = drawing
            .free()
            .iter()
            .map(|mark| price.bytes_of(mark).max(1))
            .collect();
        let bytes = |edit: &Edit| match edit.changes[..] {
            [(_, Change::Path { .. })] => point_bytes,
            [(i, _), ..] => bytes[i],
            [] => 0,
        };
        // Greedy by squared error per byte, as for a knapsack.
        let loss = |edit: &Edit| (-edit.gain).max(0.0) / bytes(edit) as f32;
        edits.sort_by(|a, b| loss(a).total_cmp(&loss(b)));
        let mut edits = disjoint(edits);
        edits.truncate(edits.len().div_ceil(AT_A_TIME));
        // No more than the excess: the last edit may overshoot it by its own bytes.
        let mut wanted = left;
        edits.retain(|edit| {
            let is_wanted = wanted > 0;
            wanted = wanted.saturating_sub(bytes(edit));
            is_wanted
        });
        let mut tried = apply_priced(drawing, tolerated(edits), TRIALS);
        if tried.made.is_empty() {
            let least = untried(edits::least(drawing, 1));
            tried = apply_priced(drawing, least, 0);
        }
        left = left.saturating_sub(tried.made.iter().map(bytes).sum());
        let former = tried.sources.into_iter();
        sources = former.map(|from| sources[from?]).collect();
    }
    sources
}

/// Edits that are made without a trial.
fn untried(mut edits: Vec<Edit>) -> Vec<Edit> {
    edits.iter_mut().for_each(|edit| edit.is_tried = false);
    edits
}

/// Edits that may add more than foreseen, as descent follows.
fn tolerated(mut edits: Vec<Edit>) -> Vec<Edit> {
    for edit in &mut edits {
        edit.price = edit.price.abs() + TOLERANCE * (-edit.gain).max(0.0);
    }
    edits
}

/// Quantile of stroke contribution. Under a binding budget, a stroke below it is expendable: its bytes would be used where they
/// gain more, and a point has to gain as much for its bytes.
fn quantile_contribution(drawing: &mut Drawing, share: f32) -> f32 {
    let mut contribution = drawing.judge().contribution;
    if contribution.is_empty() {
        return 0.0;
    }
    // Select rather than sort: only the quantile is needed.
    let at = (share * contribution.len() as f32) as usize;
    let at = at.min(contribution.len() - 1);
    contribution
        .select_nth_unstable_by(at, f32::total_cmp)
        .1
        .max(0.0)
}

/// Makes an edit of each path that gains by one. A stroke could be spared that is worth `spare`.
fn edit(session: &mut Session<'_>, spare: f32) -> Vec<Option<usize>> {
    let stroke_bytes = typical_bytes(session.config, &session.target) as f32;
    // A point's part of the bytes of a stroke, by which a point competes with the strokes that could be spared.
    let share = session.price.point_bytes() as f32 / stroke_bytes;
    let room = room(session);
    let most = session.config.points.unwrap_or(usize::MAX);
    let drawing = &mut session.drawing;
    // Toggles need no point more, but disturb a fit. So they are for drawings whose points have a price; others have more of
    // them than they use.
    let toggles = budget::prices_points(session.config, drawing.pixels());
    let price = session.price.in_drawing(drawing);
    let least = |of_area: bool| {
        let prices = price.of_point(of_area);
        prices.map(|least| least.max(spare * share / GAIN))
    };
    let prices = [false, true].map(least);
    let survey = drawing.survey();
    let models = QuadraticModel::all(&survey, drawing.free());
    let propose = |model: &QuadraticModel<'_>| {
        let [to_add, to_keep] = prices[usize::from(model.is_ring)];
        let fits = |edit: &Edit| model.is_ring || model.written_points(edit) <= most;
        // One stroke may have most of all points.
        let (loss, (toggle, new)) = rayon::join(
            || edits::points::remove(model, to_keep),
            || {
                let toggled = toggles.then_some(model);
                let toggle = toggled.and_then(|of| edits::points::toggle(of, to_keep * 0.1));
                let may_grow = (model.stroke.points.len() < most).then_some(model);
                let new = may_grow.and_then(|of| edits::points::add(of, to_add));
                (toggle.filter(fits), new.filter(fits))
            },
        );
        // A point that does not pay goes first; the corners around it may change later.
        let toggle = toggle.filter(|_| !loss.as_ref().is_some_and(|loss| loss.surplus() > 0.0));
        [loss, toggle, new].into_iter().flatten()
    };
    let proposed: Vec<Edit> = models.par_iter().flat_map_iter(propose).collect();
    let paths = models.len() as f32;
    // Limits of one pass, so that descent adapts the paths before the next one.
    let room = Room {
        free: room,
        most: (SHARE * paths).ceil() as usize,
        swaps: (SWAPPED * paths) as usize,
    };
    apply_priced(drawing, tolerated(choose(proposed, room)), TRIALS).sources
}

/// The bytes that are left for more points and strokes, less than 0 if there are too many; `None` without a budget of bytes.
pub(super) fn bytes_left(session: &Session<'_>) -> Option<f32> {
    let most = session.config.budget.bytes? as f32 * FILLED;
    // Layers that will be joined are bytes that the finished file won't have.
    let layers = session.layers_to_join() * budget::LAYER_BYTES;
    let bytes = session.bytes().saturating_sub(layers) as f32;
    Some(most - bytes * session.history.corrections.restricted)
}

/// Number of points that the drawing may have more.
fn room(session: &Session<'_>) -> usize {
    let (config, strokes) = (session.config, session.drawing.free());
    let pixels = session.target.width() * session.target.height();
    let most = budget::points(config, strokes.len(), pixels);
    let by_strokes = most.map_or(usize::MAX, |most| most.saturating_sub(strokes.points()));
    // Whichever limit binds first: points by count, or points by bytes.
    let by_bytes = bytes_left(session).map_or(usize::MAX, |left| {
        (left.max(0.0) / session.price.point_bytes() as f32) as usize
    });
    by_strokes.min(by_bytes)
}

impl Drawing {
    /// A survey of the free strokes, in squared error, summed over the channels and the pixels of the picture.
    fn survey(&mut self) -> Survey {
        let mut survey = self.survey_at_resolution(LEAST);
        // The slopes are of the mean, the stiffness is of the sum at this resolution.
        let (values, area) = (3.0 * self.pixels() as f32, self.pixel_area());
        let slopes = survey.slopes.as_flattened_mut().iter_mut();
        slopes.for_each(|slope| *slope *= values);
        survey.stiffness.iter_mut().for_each(|k| *k *= area);
        survey
    }
}
