//! Points at their price: strokes get points where these gain more than their bytes cost, and lose points that gain less.
//!
//! A survey tells how the squared error depends on the vertices of all strokes ([`terrain`]), and so what every change of
//! a stroke's points would gain ([`edits`]): a new corner or control point, a point that is taken away, a corner that
//! becomes smooth or a control point that becomes a corner. Each stroke may change by one edit at a time; descent then
//! fits it. The rule for strokes holds: what does not pay its price goes, and what pays comes. If the budget has
//! no room left, points that gain more take the places of points that cost less to lose.

mod edits;
mod joins;
mod shed;
mod terrain;
mod verify;

use rayon::prelude::*;

use super::budget::price::Price;
use super::budget::{self, typical_bytes};
use super::config::Config;
use super::drawing::Drawing;
use super::recipe::Points;
use super::run::session::Session;
use crate::render::{StrokeRef, Strokes, Survey};
use edits::Edit;
pub(super) use shed::shed;
use terrain::Terrain;
use verify::verify;

/// Least segments of a line or a curve in a survey. A guess.
const LEAST: usize = 4;

/// Most trials of edits at a time. A guess: each renders the drawing.
const TRIALS: usize = 12;

/// Changes the points of the free strokes where that pays, when a share `done` of the polish is over. Returns the former index of each
/// number of the free strokes,
/// `None` for a new one.
pub(super) fn rearrange(session: &mut Session<'_>, done: f32) -> Vec<Option<usize>> {
    let excess = excess(session);
    if excess > 0 {
        return shed(
            &mut session.drawing,
            session.price,
            session.recipe.points.at_a_time,
            excess,
        );
    }
    // Bytes that are left late in the polish are for points: no stroke will come for them.
    let has_strokes = session.config.budget.bytes.is_some() && done >= session.recipe.points.alone;
    let (config, points) = (session.config, session.recipe.points);
    let drawing = &mut session.drawing;
    // Under a price no stroke takes the place of another.
    let is_priced = config.quality_for(drawing.pixels()).is_some();
    let spare = match has_strokes || is_priced {
        true => 0.0,
        false => quantile_worth(drawing, points.spared),
    };
    let most = config.points.unwrap_or(usize::MAX);
    let joined = joins::join(drawing, session.price, points.joins, most, spare);
    let edited = edit(session, spare);
    match joined {
        None => edited,
        Some(joined) => edited.iter().map(|source| joined[(*source)?]).collect(),
    }
}

/// Takes away points that are not worth their price now that the strokes are where they belong, as long as that adds as
/// little error as was foreseen. Each stroke loses at most one point at a time.
pub(super) fn prune(drawing: &mut Drawing, price: Price, prunings: usize) {
    for _ in 0..prunings {
        let price = price.in_drawing(drawing);
        let [of_strokes, of_areas] = [false, true].map(|of_area| price.of_point(of_area)[1]);
        let to_keep = |of_area: bool| if of_area { of_areas } else { of_strokes };
        let survey = drawing.survey(LEAST);
        let terrains = Terrain::all(&survey, drawing.free());
        let removal = |terrain: &Terrain<'_>| {
            let edit = edits::best_loss(terrain);
            edit.filter(|edit| -edit.gain < to_keep(terrain.is_ring))
        };
        let mut removals: Vec<Option<Edit>> = terrains.par_iter().map(removal).collect();
        drop(terrains);
        verify(drawing, &mut removals, of_areas, TRIALS);
        removals.iter_mut().for_each(|edit| refuse(edit, of_areas));
        let removed = removals.iter().flatten();
        let allowed: f64 = removed
            .map(|edit| f64::from(to_keep(edit.is_of_ring)))
            .sum();
        if removals.iter().all(Option::is_none) {
            return;
        }
        let (before, error) = (drawing.memento(), drawing.mse());
        drawing.edit(&removals);
        let added = (drawing.mse() - error) * (3 * drawing.pixels()) as f64;
        if added > allowed {
            drawing.revert(before);
            return;
        }
    }
}

/// Takes back an edit of a ring that turned out to cost more than a point has to gain `to_keep` it.
fn refuse(edit: &mut Option<Edit>, to_keep: f32) {
    edit.take_if(|edit| edit.is_of_ring && -edit.gain > to_keep);
}

/// The worth that a `share` of the strokes is below: what a stroke is worth that could be spared, where a budget binds. It
/// would be used where it is worth more, and a point has to be worth as much for its bytes.
fn quantile_worth(drawing: &mut Drawing, share: f32) -> f32 {
    let mut worth = drawing.judge().worth;
    if worth.is_empty() {
        return 0.0;
    }
    let at = (share * worth.len() as f32) as usize;
    let at = at.min(worth.len() - 1);
    worth.select_nth_unstable_by(at, f32::total_cmp).1.max(0.0)
}

/// Chooses an edit for each stroke that gains by one. A stroke could be spared that is worth `spare`.
fn edit(session: &mut Session<'_>, spare: f32) -> Vec<Option<usize>> {
    let points = session.recipe.points;
    let stroke_bytes = typical_bytes(session.config, &session.target) as f32;
    let share = session.price.point_bytes() as f32 / stroke_bytes;
    let room = room(session);
    let drawing = &mut session.drawing;
    let limits = Limits::of(session.config, drawing.pixels());
    let price = session.price.in_drawing(drawing);
    let least = |of_area: bool| {
        let prices = price.of_point(of_area);
        prices.map(|least| least.max(spare * share / points.gain))
    };
    let prices = [false, true].map(least);
    let survey = drawing.survey(LEAST);
    let terrains = Terrain::all(&survey, drawing.free());
    let options = |terrain: &Terrain<'_>| {
        let [of_strokes, of_areas] = prices;
        let prices = if terrain.is_ring {
            of_areas
        } else {
            of_strokes
        };
        Options::new(terrain, limits, &points).at(prices)
    };
    let options: Vec<Options> = terrains.par_iter().map(options).collect();
    drop(terrains);
    let mut chosen = choose(options, room, &points);
    let [_, [_, to_keep]] = prices;
    verify(drawing, &mut chosen, to_keep, TRIALS);
    chosen.iter_mut().for_each(|edit| refuse(edit, to_keep));
    drawing.edit(&chosen)
}

/// The bytes that are left for more points and strokes, less than 0 if there are too many of these; `None` without a budget of bytes.
pub(super) fn bytes_left(session: &Session<'_>) -> Option<f32> {
    let most = session.config.budget.bytes? as f32 * session.recipe.points.filled;
    let layers = session.layers_to_join() * budget::LAYER_BYTES;
    let bytes = session.bytes().saturating_sub(layers) as f32;
    Some(most - bytes * session.history.corrections.restricted)
}

/// By how many bytes the drawing exceeds its budget.
fn excess(session: &Session<'_>) -> usize {
    bytes_left(session).map_or(0, |left| (-left).max(0.0) as usize)
}

/// Number of points that the drawing may have more.
fn room(session: &Session<'_>) -> usize {
    let (config, strokes) = (session.config, session.drawing.free());
    let pixels = session.target.width() * session.target.height();
    let most = budget::points(config, &session.recipe.points, strokes.len(), pixels);
    let by_strokes = most.map_or(usize::MAX, |most| most.saturating_sub(strokes.points()));
    let by_bytes = bytes_left(session).map_or(usize::MAX, |left| {
        (left.max(0.0) / session.price.point_bytes() as f32) as usize
    });
    by_strokes.min(by_bytes)
}

/// Which edits a stroke may have.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// Most points of a stroke.
    most: usize,
    /// True if corners may become smooth and control points corners. That needs no point more, but disturbs a fit. So it
    /// is for drawings whose points have a price; others have more of them than they use.
    toggles: bool,
}

impl Limits {
    fn of(config: &Config, pixels: usize) -> Self {
        Self {
            most: config.points.unwrap_or(usize::MAX),
            toggles: budget::prices_points(config, pixels),
        }
    }
}

/// The best edit of each kind of one path.
#[derive(Debug, Default)]
struct Options {
    insertion: Option<Edit>,
    removal: Option<Edit>,
    toggle: Option<Edit>,
    /// The least gains of a point to be added, and to stay.
    prices: [f32; 2],
}

impl Options {
    fn new(terrain: &Terrain<'_>, limits: Limits, points: &Points) -> Self {
        let stroke = terrain.stroke;
        if !stroke.is_finite() || terrain.is_band {
            return Self::default();
        }
        let may_grow = stroke.points.len() < limits.most;
        let fits = |edit: &Edit| terrain.is_ring || written_points(edit.of(stroke)) <= limits.most;
        let insertion = || edits::best_insertion(terrain, points).filter(fits);
        let toggled = limits.toggles.then_some(terrain);
        // One stroke may have most of all points.
        let (removal, toggle) = rayon::join(
            || edits::best_removal(terrain),
            || edits::best_toggle(toggled?).filter(fits),
        );
        Self {
            insertion: may_grow.then(insertion).flatten(),
            removal,
            toggle,
            prices: [0.0; 2],
        }
    }

    /// These options at these prices.
    fn at(self, prices: [f32; 2]) -> Self {
        Self { prices, ..self }
    }
}

/// Most points of a stroke in its file. A curve that turns back is written as a corner, and then the implied points at its
/// ends are points.
pub(super) fn written_points(stroke: StrokeRef<'_>) -> usize {
    let next = stroke.off.iter().cycle().skip(1);
    let pairs = stroke.off.iter().zip(next);
    let last = usize::from(!stroke.closed);
    let implied = pairs
        .take(stroke.off.len() - last)
        .filter(|(a, b)| **a && **b);
    stroke.points.len() + implied.count()
}

/// At most one edit of each path. At most `room` points may be added.
fn choose(mut options: Vec<Options>, room: usize, points: &Points) -> Vec<Option<Edit>> {
    let count = options.len();
    let mut chosen: Vec<Option<Edit>> = (0..count).map(|_| None).collect();
    // Points that are not worth their price go, and corners change where that alone gains something.
    for (chosen, options) in chosen.iter_mut().zip(&mut options) {
        let [_, to_keep] = options.prices;
        let leaving = options.removal.take_if(|edit| -edit.gain < to_keep);
        *chosen = leaving.or_else(|| options.toggle.take_if(|edit| edit.gain > to_keep * 0.1));
    }
    let wanted = (points.share * count as f32).ceil() as usize;
    let mut coming = sorted(&mut options, |o| {
        let [to_add, _] = o.prices;
        o.insertion.take_if(|edit| edit.gain > to_add)
    });
    coming.retain(|edit| chosen[edit.path].is_none());
    let mut coming = coming.into_iter();
    for edit in coming.by_ref().take(wanted.min(room)) {
        let path = edit.path;
        chosen[path] = Some(edit);
    }
    if room < wanted {
        let leaving = sorted(&mut options, |o| o.removal.take());
        let swaps = (points.swapped * count as f32) as usize;
        swap(&mut chosen, coming, leaving, swaps);
    }
    chosen
}

/// The edits that `take` takes, the most gaining first.
fn sorted(options: &mut [Options], take: impl Fn(&mut Options) -> Option<Edit>) -> Vec<Edit> {
    let mut edits: Vec<Edit> = options.iter_mut().filter_map(take).collect();
    edits.sort_by(|a, b| b.gain.total_cmp(&a.gain).then(a.path.cmp(&b.path)));
    edits
}

/// Puts the new point that gains most in the place of the point whose loss costs least, and so on, at most `count`
/// times, as long as this gains something.
fn swap(
    chosen: &mut [Option<Edit>],
    coming: impl Iterator<Item = Edit>,
    leaving: Vec<Edit>,
    count: usize,
) {
    for (new, old) in coming.zip(leaving).take(count) {
        if new.gain + old.gain <= 0.0 {
            return;
        }
        let (i, k) = (new.path, old.path);
        if i != k && chosen[i].is_none() && chosen[k].is_none() {
            (chosen[i], chosen[k]) = (Some(new), Some(old));
        }
    }
}

impl Drawing {
    /// A survey of the free strokes, in squared error, summed over the channels and the pixels of the picture.
    fn survey(&mut self, least: usize) -> Survey {
        let mut survey = self.survey_at_resolution(least);
        // The slopes are of the mean, the stiffness is of the sum at this resolution.
        let (values, area) = (3.0 * self.pixels() as f32, self.pixel_area());
        let slopes = survey.slopes.as_flattened_mut().iter_mut();
        slopes.for_each(|slope| *slope *= values);
        survey.stiffness.iter_mut().for_each(|k| *k *= area);
        survey
    }

    /// Applies the edits, at most one for each path of the free strokes.
    fn edit(&mut self, edits: &[Option<Edit>]) -> Vec<Option<usize>> {
        let strokes = self.free();
        let mut edited = Strokes::new();
        let mut sources = Vec::with_capacity(strokes.numbers().len());
        let mut edits = edits.iter();
        for (i, stroke) in strokes.iter().enumerate() {
            let range = strokes.range(i);
            let (mut points, mut off, mut rings) = (Vec::new(), Vec::new(), Vec::new());
            for ((first, path), edit) in stroke.paths().zip(&mut edits) {
                let place = |k: usize| range.start + 2 * (first + k);
                let from: Vec<Option<usize>> = match edit {
                    Some(edit) => edit.sources.clone(),
                    None => (0..path.points.len()).map(Some).collect(),
                };
                let path = edit.as_ref().map_or(path, |edit| edit.of(path));
                points.extend(path.points);
                off.extend(path.off);
                rings.push(points.len() as u32);
                for source in from {
                    let at = source.map(place);
                    sources.extend([at, at.map(|at| at + 1)]);
                }
            }
            edited.push(StrokeRef {
                points: &points,
                off: &off,
                rings: if stroke.is_area() { &rings } else { &[] },
                ..stroke
            });
            let style = range.start + 2 * stroke.points.len()..range.end;
            sources.extend(style.map(Some));
        }
        *self.free_mut() = edited;
        sources
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edit(path: usize, gain: f32) -> Option<Edit> {
        Some(Edit {
            path,
            is_of_ring: false,
            gain,
            points: Vec::new(),
            off: Vec::new(),
            sources: Vec::new(),
        })
    }

    /// Gains of the edits chosen of strokes with a new point and a removal of these gains each.
    fn gains(options: &[(f32, f32)], room: usize, price: f32) -> Vec<Option<f32>> {
        let options = options.iter().enumerate();
        let options = options.map(|(i, &(new, old))| Options {
            insertion: edit(i, new),
            removal: edit(i, old),
            toggle: None,
            prices: [price; 2],
        });
        let points = crate::fit::Recipe::of(crate::fit::Preset::Balanced).points;
        let points = Points {
            share: 1.0,
            swapped: 1.0,
            ..points
        };
        let chosen = choose(options.collect(), room, &points);
        let gain = |edit: Option<Edit>| edit.map(|edit| edit.gain);
        chosen.into_iter().map(gain).collect()
    }

    #[test]
    fn points_that_pay_come_and_points_that_do_not_go() {
        let chosen = gains(&[(5.0, -9.0), (1.0, -9.0), (1.0, -1.0)], 9, 2.0);
        assert_eq!(chosen, [Some(5.0), None, Some(-1.0)]);
    }

    #[test]
    fn the_most_gaining_points_come_first() {
        let chosen = gains(&[(3.0, -9.0), (5.0, -9.0), (4.0, -9.0)], 2, 0.0);
        assert_eq!(chosen, [None, Some(5.0), Some(4.0)]);
    }

    #[test]
    fn without_room_points_take_the_places_of_others() {
        let chosen = gains(&[(1.0, -0.5), (8.0, -9.0), (1.0, -3.0)], 0, 0.0);
        assert_eq!(chosen, [Some(-0.5), Some(8.0), None]);
    }
}
