//! Nudging: points move by a tenth of a px at most, to where rasterisers draw the strokes better.
//!
//! A rasteriser rounds where edges are: tiny-skia takes samples a quarter of a px apart, Chromium rounds the heights of the
//! ends of lines and chords to quarters of a px. Where lines are thin, or a drawing is exact, that is most of the error, and no
//! gradient knows of it. So each stroke in turn tries a few random places, and goes to the best of them if that is
//! better than the present one.
//!
//! Three [rasterisers](Rasterizer) judge a place, so that a drawing does not become better in one program and worse in others.
//! The larger the error of a rasteriser is, the more it counts. Each trial draws one stroke, on its own: [`Fragments`] know what
//! its footprint does to the pictures. Strokes that have no pixel in common are visited at once, by all threads.

mod fragments;

use std::f32::consts::SQRT_2;

use rayon::prelude::*;

use crate::error::Result;
use crate::fit::budget;
use crate::fit::descent::held::Held;
use crate::fit::drawing::Drawing;
use crate::fit::file::RenderedFile;
use crate::fit::order::Outcome;
use crate::fit::recipe::Nudging;
use crate::fit::renderers::Renderings;
use crate::fit::run::session::Session;
use crate::math;
use crate::metrics::psnr_db;
use crate::rasters::{Footprint, PerRasterizer, Rasterizer, Rasters, Selection};
use crate::render::Strokes;
use crate::rng;
use crate::scene::{Mark, Scene};
use crate::threads::PerWorker;
use fragments::{Change, Fragments, Response, changes};

/// First word of the keys of random draws, so that nothing else uses the same.
const DRAWS: u64 = 1 << 40;

/// Farthest from its outline that a rasteriser covers a part of a pixel, rounding to the file's decimals included, px.
const FRINGE: f32 = 1.5;

/// Nudges the strokes of the settled drawing where renderers add much to its error. The nudged file stays if it is more
/// faithful, and meets what the settled one meets.
pub(in crate::fit) fn nudge(session: &mut Session<'_>) -> Result<Outcome> {
    if let Some(seen) = session.renderings.take()
        && let Some(file) = session.file.take()
    {
        session.file = Some(nudged(session, file, &seen)?);
    }
    Ok(Outcome::Over)
}

/// The better one of `file`, whose renders are `seen`, and the file of the nudged drawing.
fn nudged(
    session: &mut Session<'_>,
    file: RenderedFile,
    seen: &Renderings,
) -> Result<RenderedFile> {
    let adds_much = seen.added_db() >= session.recipe.settling.nudging.added_db;
    let memento = session.drawing.memento();
    if session.progress.is_halted() || !adds_much || !run(session, &file, seen) {
        return Ok(file);
    }
    let (nudged, seen_nudged) = session.render_for_settling()?;
    let is_better = seen_nudged.worst_mse() < seen.worst_mse()
        && budget::meets_as_much(&session.config.budget, &nudged, &file);
    if is_better {
        return Ok(nudged);
    }
    session.drawing.revert(memento);
    Ok(file)
}

/// Nudges the strokes of the drawing. `file` is the SVG written from it, `seen` the renders of that file. Returns true if a
/// stroke has moved.
fn run(session: &mut Session<'_>, file: &RenderedFile, seen: &Renderings) -> bool {
    let nudging = session.recipe.settling.nudging;
    let sweeps = affordable(&session.drawing, session.config.file.precision, nudging);
    if sweeps == 0 || !goes_on(session, file.mse()) {
        return false;
    }
    let mut nudger = Nudger::of(session, file, seen);
    'sweeps: for sweep in 0..sweeps {
        let before = nudger.fragments.errors();
        if worst_db(before) >= nudging.until_db {
            break;
        }
        let weights = weights(before);
        for set in 0..nudger.sets.len() {
            if !goes_on(session, file.mse()) {
                break 'sweeps;
            }
            nudger.visit_all(set, sweep, weights);
        }
        if worst_db(nudger.fragments.errors()) - worst_db(before) < nudging.least_db {
            break;
        }
    }
    let has_moved = nudger.strokes != *session.drawing.free();
    *session.drawing.free_mut() = nudger.strokes;
    has_moved
}

/// Number of visits that each stroke may have.
fn affordable(drawing: &Drawing, precision: u8, nudging: Nudging) -> usize {
    // Whole px are coarser than any nudge.
    let is_coarse = precision == 0;
    if is_coarse || drawing.pixels() > nudging.most_pixels || drawing.free().is_empty() {
        return 0;
    }
    let affordable = nudging.trials / (nudging.tries * drawing.free().len());
    nudging.sweeps.min(affordable)
}

/// Tells the observer, and says whether there is time to go on.
fn goes_on(session: &mut Session<'_>, mse: f64) -> bool {
    let goes_on = session.progress.tell(&session.drawing, mse);
    session.check_for_stop();
    goes_on && session.timer.allows_round()
}

/// The fidelity of the worst rasteriser, dB.
fn worst_db(errors: PerRasterizer<f64>) -> f64 {
    psnr_db(largest(errors))
}

fn largest(errors: PerRasterizer<f64>) -> f64 {
    errors.into_iter().fold(f64::MIN_POSITIVE, f64::max)
}

/// Weights of the rasterisers: derivatives of the sum of the fourth powers of all errors.
fn weights(errors: PerRasterizer<f64>) -> PerRasterizer<f32> {
    let largest = largest(errors);
    errors.map(|error| math::powi(error / largest, 3) as f32)
}

/// The strokes as they are moved, and what rasterisers make of them.
struct Nudger<'a> {
    nudging: Nudging,
    seed: u64,
    scene: &'a Scene,
    /// Decimals of the file.
    precision: u8,
    /// The strokes before they were nudged, and now.
    homes: Strokes,
    strokes: Strokes,
    /// True for strokes whose points may only move together.
    has_form: Vec<bool>,
    /// The strokes as the file has them; `None` for one that is not written.
    written: Vec<Option<Mark>>,
    /// Pixels of each stroke whose coverage may change.
    fringes: Vec<Vec<u32>>,
    /// Sets of strokes whose fringes have no pixel in common.
    sets: Vec<Vec<usize>>,
    fragments: Fragments,
    scratch: PerWorker<Rasters>,
}

/// A better place for a stroke.
struct Nudge {
    id: usize,
    points: Vec<[f32; 2]>,
    written: Mark,
    changes: Vec<Change>,
}

impl<'a> Nudger<'a> {
    fn of(session: &Session<'_>, file: &'a RenderedFile, seen: &Renderings) -> Self {
        let (drawing, config) = (&session.drawing, session.config);
        let (scene, precision) = (&file.rounded.scene, config.file.precision);
        let nudging = session.recipe.settling.nudging;
        let picture = drawing.surface().picture();
        let size = [picture.width(), picture.height()];
        let scratch = PerWorker::new(|| Rasters::new(size));
        let strokes = drawing.free().clone();
        let written: Vec<Option<Mark>> = strokes
            .iter()
            .map(|stroke| scene.quantized_mark(&stroke.to_mark(), precision))
            .collect();
        let drawn = |mark: &Option<Mark>| match mark {
            Some(mark) => scratch.with(|scratch| drawn(mark, nudging.reach_px, scratch)),
            None => Default::default(),
        };
        let (footprints, fringes): (Vec<PerRasterizer<Footprint>>, Vec<Vec<u32>>) =
            written.par_iter().map(drawn).unzip();
        let mut order: Vec<usize> = (0..strokes.len()).collect();
        order.sort_by_key(|&i| rng::bits(config.seed, DRAWS, i as u64, 0));
        let formed = drawing.formed();
        let has_form = strokes
            .iter()
            .enumerate()
            .map(|(i, stroke)| i < formed && Held::has(stroke));
        let has_form = has_form.collect();
        Self {
            nudging,
            seed: config.seed,
            scene,
            precision,
            homes: strokes.clone(),
            has_form,
            strokes,
            sets: independent_sets(order, &fringes, drawing.pixels()),
            fragments: Fragments::of(session, file, seen, &written, &footprints),
            written,
            fringes,
            scratch,
        }
    }

    /// Visits the strokes of a set. How one of them is best drawn does not depend on the others.
    fn visit_all(&mut self, set: usize, sweep: usize, weights: PerRasterizer<f32>) {
        let this = &*self;
        let visit = |&id: &usize| {
            let visit = |selection: &mut Selection<'_>| this.visit(id, sweep, weights, selection);
            this.scratch
                .with(|scratch| scratch.on(&this.fringes[id], visit))
        };
        let nudges: Vec<Option<Nudge>> = this.sets[set].par_iter().map(visit).collect();
        let nudges = nudges.into_iter().flatten();
        nudges.for_each(|nudge| self.take(nudge));
    }

    /// Tries a few places for stroke `id`.
    fn visit(
        &self,
        id: usize,
        sweep: usize,
        weights: PerRasterizer<f32>,
        selection: &mut Selection<'_>,
    ) -> Option<Nudge> {
        let present = self.written[id].as_ref()?;
        let responses = self
            .fragments
            .responses(id, &self.written, &self.fringes[id]);
        let trial = Trial::new(&responses, weights);
        let (mut least, mut best) = (0.0, None);
        for k in 0..self.nudging.tries {
            let points = self.place(id, sweep, k);
            let tried = self.written_at(id, &points);
            let Some(tried) = tried.filter(|tried| tried != present) else {
                continue;
            };
            if let Some((change, footprints)) = trial.judge(&tried, least, selection) {
                least = change;
                best = Some((points, tried, footprints));
            }
        }
        best.map(|(points, written, footprints)| Nudge {
            id,
            points,
            written,
            changes: changes(&responses, &footprints, selection),
        })
    }

    /// Stroke `id` with these points, as the file would have it.
    fn written_at(&self, id: usize, points: &[[f32; 2]]) -> Option<Mark> {
        let mut stroke = self.strokes.get(id);
        stroke.points = points;
        self.scene.quantized_mark(&stroke.to_mark(), self.precision)
    }

    /// A place to try for stroke `id`: near its present one, and within reach of its first one.
    fn place(&self, id: usize, sweep: usize, k: usize) -> Vec<[f32; 2]> {
        let key = DRAWS + 1 + (sweep * self.nudging.tries + k) as u64;
        let draw = |n| rng::draw(self.seed, key, id as u64, n);
        let reach = self.nudging.reach_px;
        let shift = [0, 1].map(|axis| reach * (2.0 * draw(axis) - 1.0));
        let homes = self.homes.get(id).points;
        let one = if draw(2) < self.nudging.whole || self.has_form[id] {
            None
        } else {
            Some((draw(3) * homes.len() as f32) as usize)
        };
        let mut points = self.strokes.get(id).points.to_vec();
        for (i, (point, home)) in points.iter_mut().zip(homes).enumerate() {
            if one.is_none_or(|one| one == i) {
                for ((at, shift), home) in point.iter_mut().zip(shift).zip(home) {
                    *at = (*at + shift).clamp(home - reach, home + reach);
                }
            }
        }
        points
    }

    fn take(&mut self, nudge: Nudge) {
        let Nudge {
            id,
            points,
            written,
            changes,
        } = nudge;
        self.written[id] = Some(written);
        self.strokes.move_points(id, &points);
        self.fragments.change(id, &self.fringes[id], &changes);
    }
}

/// Footprints of a mark, and the pixels whose coverage may change once it is moved within `reach` px. Areas are not moved:
/// each trial would draw all of their pixels.
fn drawn(mark: &Mark, reach: f32, scratch: &mut Rasters) -> (PerRasterizer<Footprint>, Vec<u32>) {
    let Some(stroke) = mark.as_stroke() else {
        let footprint =
            |rasterizer, selection: &mut Selection<'_>| selection.footprint(rasterizer, mark);
        let footprints = scratch.on(&[], |s| Rasterizer::ALL.map(|r| footprint(r, s)));
        return (footprints, Vec::new());
    };
    let beyond = reach * SQRT_2 + FRINGE;
    let wide = scratch.swept(stroke, beyond);
    let narrow = scratch.swept(stroke, -beyond);
    let footprints = scratch.on(wide.pixels(), |selection| {
        Rasterizer::ALL.map(|rasterizer| selection.footprint(rasterizer, mark))
    });
    let mut inside = narrow
        .iter()
        .filter(|&(_, level)| level == u8::MAX)
        .peekable();
    let is_fringe = |pixel: &u32| {
        while inside.next_if(|(inside, _)| inside < pixel).is_some() {}
        inside.peek().is_none_or(|(inside, _)| inside != pixel)
    };
    (
        footprints,
        wide.pixels().iter().copied().filter(is_fringe).collect(),
    )
}

/// State of a stroke before it is tried elsewhere.
struct Trial<'a> {
    responses: &'a [PerRasterizer<Response>],
    weights: PerRasterizer<f32>,
    /// The squared error that the stroke adds, for each rasteriser.
    present: PerRasterizer<f32>,
    /// The rasterisers, the one that counts most first.
    order: PerRasterizer<usize>,
}

impl<'a> Trial<'a> {
    fn new(responses: &'a [PerRasterizer<Response>], weights: PerRasterizer<f32>) -> Self {
        let mut order = std::array::from_fn(|i| i);
        order.sort_by(|&i, &j| f32::total_cmp(&weights[j], &weights[i]));
        let present = |i: usize| responses.iter().map(|response| response[i].error()).sum();
        Self {
            responses,
            weights,
            present: std::array::from_fn(present),
            order,
        }
    }

    /// By how much the stroke changes the squared error if it is drawn as `tried`, and what it covers then; `None` as soon as
    /// the change, added up in the order of the rasterisers, is not below `least`.
    fn judge(
        &self,
        tried: &Mark,
        least: f32,
        selection: &mut Selection<'_>,
    ) -> Option<(f32, PerRasterizer<Footprint>)> {
        let mut footprints = PerRasterizer::<Footprint>::default();
        let mut change = 0.0;
        for i in self.order {
            footprints[i] = selection.footprint(Rasterizer::ALL[i], tried);
            let errors = selection
                .covered(&footprints[i])
                .map(|(slot, level)| self.responses[slot][i].error_at(level));
            change += self.weights[i] * (errors.sum::<f32>() - self.present[i]);
            if change >= least {
                return None;
            }
        }
        Some((change, footprints))
    }
}

/// Sets of strokes, those in each with fringes that have no pixel in common.
fn independent_sets(
    mut waiting: Vec<usize>,
    fringes: &[Vec<u32>],
    pixels: usize,
) -> Vec<Vec<usize>> {
    waiting.retain(|&id| !fringes[id].is_empty());
    let mut sets = Vec::new();
    while !waiting.is_empty() {
        let mut taken = vec![false; pixels];
        let (set, later) = waiting.into_iter().partition(|&id| {
            let is_free = !fringes[id].iter().any(|&pixel| taken[pixel as usize]);
            if is_free {
                fringes[id]
                    .iter()
                    .for_each(|&pixel| taken[pixel as usize] = true);
            }
            is_free
        });
        sets.push(set);
        waiting = later;
    }
    sets
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_of_a_set_have_no_pixel_in_common_and_none_is_left_out() {
        let fringes = [vec![0, 1], vec![1, 2], vec![2, 3], Vec::new(), vec![4]];
        let sets = independent_sets(vec![4, 1, 0, 2, 3], &fringes, 5);
        assert_eq!(sets, [vec![4, 1], vec![0, 2]]);
    }

    #[test]
    fn a_rasteriser_counts_the_more_the_larger_its_error_is() {
        assert_eq!(weights([2.0, 1.0, 0.0]), [1.0, 0.125, 0.0]);
        assert_eq!(weights([0.0; 3]), [0.0; 3]);
    }
}
