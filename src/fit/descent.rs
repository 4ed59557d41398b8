//! A descent of the strokes of a drawing: how it is set up, and one step of it.
//!
//! A [`Course`] says how long, at what step sizes and with which edge; a [`Descent`] is a course under way, with the
//! optimiser's memory, so that it can be kept and gone on with.

use serde::{Deserialize, Serialize};

use super::anneal::Annealing;
use super::deadline::Timer;
use super::drawing::Drawing;
use super::recipe::{Rates, Recipe};
use crate::optim::{Adam, Optimizer, Schedule};
use crate::render::{AX, Canvas, Gradients, PARAMS, Params, RADIUS};

/// How long to descend, at what step sizes, and with which edge.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Course {
    /// Iterations.
    pub(super) iterations: usize,
    /// The schedule of step sizes that they are a part of: how many iterations come before, and how many there are.
    pub(super) before: usize,
    pub(super) of: usize,
    pub(super) rates: Rates,
    /// Factor of the rates.
    pub(super) pace: f32,
    /// Softness of the first iteration, in units of the final one; `None` for the final edge throughout.
    pub(super) softness: Option<f32>,
    /// The share of a limited time for descent after which the course has to be over.
    pub(super) until: f32,
    /// For a joint course: strokes of the drawing at most, frozen ones included.
    pub(super) joint: Option<usize>,
}

/// What to descend towards, other than the picture: settling takes the offset of other renderers from it.
#[derive(Clone, Copy)]
pub(super) struct Aim<'a> {
    /// One per surface.
    pub(super) targets: &'a [Canvas],
    /// The mean squared error of the file, for whoever watches.
    pub(super) mse: f64,
}

/// A course under way, of the free strokes of a drawing.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Descent {
    pub(super) course: Course,
    /// Iterations that are done.
    step: usize,
    /// Share of a limited time for descent that was used before.
    used_before: f32,
    adam: Adam<f32>,
    background: Adam<f32>,
    /// The step sizes of all numbers of the strokes.
    scales: Vec<f32>,
    /// Those of the last step.
    #[serde(skip)]
    pub(super) gradients: Gradients,
}

impl Descent {
    /// The descent of the free strokes of `drawing`, begun when a share `used_before` of a limited time is used.
    pub(super) fn new(
        drawing: &Drawing,
        recipe: &Recipe,
        course: Course,
        used_before: f32,
    ) -> Self {
        Self {
            course,
            step: 0,
            used_before,
            adam: Adam::new(drawing.free().len() * PARAMS, recipe.optimizer.strokes),
            background: Adam::new(3, recipe.optimizer.background),
            scales: scales(&course.rates, drawing.free(), recipe),
            gradients: Gradients::default(),
        }
    }

    /// The next iteration and the share of the course that is over; `None` when all of it is. Where the time
    /// runs faster than the count, the share follows the time.
    pub(super) fn tick(&mut self, timer: &mut Timer) -> Option<(usize, f32)> {
        let Course {
            iterations, until, ..
        } = self.course;
        if self.step >= iterations {
            return None;
        }
        let by_count = self.step as f32 / iterations as f32;
        let left = (until - self.used_before).max(f32::MIN_POSITIVE);
        let by_time = (timer.used() - self.used_before) / left;
        if by_time >= 1.0 {
            timer.hurry();
            return None;
        }
        self.step += 1;
        Some((self.step - 1, by_count.max(by_time)))
    }

    /// One step of the free strokes down the gradient, and of the background in a joint course.
    pub(super) fn step(
        &mut self,
        drawing: &mut Drawing,
        annealing: &Annealing,
        (step, done): (usize, f32),
        aim: Option<Aim<'_>>,
    ) {
        let course = &self.course;
        let edge = match course.softness {
            Some(from) => annealing.at(from, done),
            None => annealing.last(),
        };
        drawing.differentiate::<false>(edge, aim.map(|aim| aim.targets), &mut self.gradients);
        let rate = course.rate(step, done);
        let flat = self.gradients.strokes.as_flattened();
        let limits = drawing.limits;
        let strokes = drawing.free_mut();
        self.adam
            .step_scaled(strokes.as_flattened_mut(), flat, rate, &self.scales);
        strokes.iter_mut().for_each(|p| limits.apply(p));
        if course.joint.is_some() && drawing.is_thawed() && !drawing.background_fixed {
            let rate = rate * course.rates.color;
            let (slope, background) = (&self.gradients.backdrop, &mut self.background);
            drawing.change_background(|color| background.step(color, slope, rate));
        }
    }

    /// Forgets the past of all strokes, as after a change of resolution: gradients are of another size then.
    pub(super) fn forget(&mut self, drawing: &Drawing, recipe: &Recipe) {
        self.adam = Adam::new(drawing.free().len() * PARAMS, recipe.optimizer.strokes);
        self.scales = scales(&self.course.rates, drawing.free(), recipe);
    }

    /// Follows a rearrangement of the free strokes: the i-th was the `sources[i]`-th, or is new.
    pub(super) fn follow(&mut self, sources: &[Option<usize>], drawing: &Drawing, recipe: &Recipe) {
        self.adam.rearrange(PARAMS, sources);
        self.scales = scales(&self.course.rates, drawing.free(), recipe);
    }
}

impl Course {
    /// The factor of the step sizes of iteration `step`, when a share `done` of the course is over.
    fn rate(&self, step: usize, done: f32) -> f32 {
        let at = match self.joint {
            // Time may have hurried the course on.
            Some(_) => (done * self.iterations as f32) as usize,
            None => step,
        };
        let end = self.rates.last;
        Schedule::Cosine { end }.factor(self.before + at, self.of) as f32 * self.pace
    }
}

/// The step sizes of all numbers of `strokes`: the geometry of large ones moves farther.
fn scales(rates: &Rates, strokes: &[Params], recipe: &Recipe) -> Vec<f32> {
    let Rates {
        position,
        radius,
        color,
        opacity,
        ..
    } = *rates;
    let rates: Params = [
        position, position, position, position, radius, color, color, color, opacity,
    ];
    let usual = recipe.optimizer.usual_radius;
    let [least, most] = recipe.optimizer.radius_factors;
    let mut scales = rates.repeat(strokes.len());
    for (rates, stroke) in scales.chunks_exact_mut(PARAMS).zip(strokes) {
        let factor = (stroke[RADIUS] / usual).sqrt().clamp(least, most);
        rates[AX..=RADIUS]
            .iter_mut()
            .for_each(|rate| *rate *= factor);
    }
    scales
}
