//! Gradient descent on the strokes of a drawing: its parameters and its single step.
//!
//! A [`Course`] sets length, step sizes and edge. A [`Descent`] is a course under way; it includes the state of the
//! optimiser, so that a checkpoint can keep it.

pub(super) mod anneal;
pub(super) mod constraints;
pub(super) mod jitter;
pub(super) mod ties;

use serde::{Deserialize, Serialize};

use super::drawing::Drawing;
use super::drawing::objective::Target;
use super::recipe::Rates;
use super::time::Timer;
use crate::optim::{Adam, AdamParams, Schedule};
use crate::render::{Gradients, STYLE, Strokes};
use anneal::Annealing;
use constraints::Constraints;
use jitter::Jitter;
use ties::Ties;

/// Adam for strokes. β₂ is small because gradients shrink fast and change whenever neighbours are relocated. β₂ 0.99: −0.15 dB for
/// drafts, −0.06 for long fits. β₁ 0.8: −0.08; 0.95: +0.02. ε 1e-7, which no longer normalises small gradients: −0.21.
const STROKES: AdamParams = AdamParams {
    betas: [0.9, 0.9],
    eps: 1e-10,
};
/// Adam for strokes in the polish at a reduced resolution, where they are far from where they end. β₂ 0.8 instead of 0.9: five
/// photographs of 1,024 strokes have as many dB after a sixth fewer iterations.
const REDUCED: AdamParams = AdamParams {
    betas: [0.9, 0.8],
    eps: 1e-10,
};
/// Adam for the background. A guess.
const BACKGROUND: AdamParams = AdamParams {
    betas: [0.9, 0.999],
    eps: 1e-8,
};
/// Radius, px, of a stroke whose geometry moves at the rates as given. Other strokes move in proportion to the square root of their
/// radius: +0.04 dB over one rate for all, with which large strokes are slow and small ones jitter. In proportion to the radius
/// itself: 0.00. Half, twice: +0.04, +0.01.
const USUAL_RADIUS: f32 = 2.0;
/// Bounds of the factor that this gives. A guess.
const RADIUS_FACTORS: [f32; 2] = [0.25, 4.0];
/// Step sizes of the colours of areas, in units of the strokes'. A guess: traced colours are right within a level.
const AREA_COLOR: f32 = 0.1;

/// Factor on the steps of traced strokes, which are about where they belong. 0.15, 0.25, 0.4, 1: 39 icons have 42.8, 42.8, 42.5, 40.8
/// dB.
pub(super) const TRACED_PACE: f32 = 0.25;

/// The length, the step sizes and the edge of a descent.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Course {
    /// Iterations.
    pub(super) iterations: usize,
    /// Iterations of the same schedule of step sizes that come before these.
    pub(super) before: usize,
    /// Iterations of that schedule in all.
    pub(super) of: usize,
    pub(super) rates: Rates,
    /// Factor on all rates.
    pub(super) pace: f32,
    /// Softness of the first iteration, in units of the final one; `None` for the final edge throughout.
    pub(super) softness: Option<f32>,
    /// Share of a limited time for descent by which the course has to end.
    pub(super) until: f32,
    /// Set for a joint course.
    pub(super) joint: Option<Joint>,
}

/// Part of a course that only a joint one has.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Joint {
    /// Most strokes of the drawing, frozen ones included.
    pub(super) limit: usize,
    pub(super) jitter: Jitter,
}

/// Targets other than the picture: settling corrects it for the offsets of the renderers.
#[derive(Clone, Copy)]
pub(super) struct Aim<'a> {
    /// One per surface.
    pub(super) targets: &'a [Target],
    /// The mean squared error of the file, for the observer.
    pub(super) mse: f64,
}

/// A course under way, for the free strokes of a drawing.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Descent {
    pub(super) course: Course,
    /// Iterations done.
    step: usize,
    /// Share of a limited time for descent that was used before it began.
    used_before: f32,
    /// Share of the course that was over when the fit was asked to stop; the time that is left is for the rest.
    #[serde(skip)]
    hurried_from: Option<f32>,
    adam: Adam<f32>,
    background: Adam<f32>,
    /// Step size of each parameter of each stroke.
    scales: Vec<f32>,
    /// Numbers that stay equal.
    #[serde(skip)]
    pub(super) ties: Ties,
    /// Shapes and lines that stay such: bands, unless there are more.
    #[serde(skip)]
    pub(super) constraints: Constraints,
    /// Gradients of the last step.
    #[serde(skip)]
    pub(super) gradients: Gradients,
}

impl Descent {
    /// A descent for the free strokes of `drawing`, which begins when a share `used_before` of a limited time is used.
    pub(super) fn new(drawing: &Drawing, course: Course, used_before: f32) -> Self {
        Self {
            course,
            step: 0,
            used_before,
            hurried_from: None,
            adam: adam(drawing, &course),
            background: Adam::new(3, BACKGROUND),
            scales: scales(&course.rates, drawing),
            ties: Ties::default(),
            constraints: Constraints::forms(drawing.free()),
            gradients: Gradients::default(),
        }
    }

    /// The descent that keeps the bands of the drawing bands: a stored descent does not hold them.
    pub(super) fn holding_forms(self, drawing: &Drawing) -> Self {
        let constraints = Constraints::forms(drawing.free());
        Self {
            constraints,
            ..self
        }
    }

    /// Number of iterations to come.
    pub(super) fn left(&self) -> usize {
        self.course.iterations - self.step
    }

    /// The index of the next iteration and the share of the course that is over, or `None` at its end. If a limited
    /// time runs out faster than the iterations, the share follows the time.
    pub(super) fn tick(&mut self, timer: &mut Timer) -> Option<(usize, f32)> {
        let Course {
            iterations, until, ..
        } = self.course;
        if self.step >= iterations {
            return None;
        }
        // Two clocks, and the later one counts: iterations, and a limited time if it runs out first.
        let by_count = self.step as f32 / iterations as f32;
        let left = (until - self.used_before).max(f32::MIN_POSITIVE);
        let by_time = (timer.used() - self.used_before) / left;
        // After a request to stop, the time that is left is spread over the share 1 − from of the course that was still to come.
        let from = self.hurried_from.unwrap_or(0.0);
        let by_time = from + (1.0 - from) * by_time;
        // The time is used up: whatever follows this descent has to hurry, too.
        if by_time >= 1.0 {
            timer.is_hurried = true;
            return None;
        }
        self.step += 1;
        Some((self.step - 1, by_count.max(by_time)))
    }

    /// Makes the rest of the course follow the time that is left, which begins now.
    pub(super) fn hurry(&mut self) {
        self.hurried_from = Some(self.step as f32 / self.course.iterations.max(1) as f32);
        self.used_before = 0.0;
        self.course.until = self.course.until.min(1.0);
    }

    /// Moves the free strokes, and in a joint course the background, one step down the gradient.
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
        // The gradient, beside the strokes' places if they are jittered.
        let jitter = course.joint.map(|joint| joint.jitter);
        let jitter = jitter.filter(|jitter| jitter.begins_by(done));
        let still = jitter.map(|jitter| jitter.apply(drawing.free_mut(), step));
        drawing.differentiate::<false>(edge, aim.map(|aim| aim.targets), &mut self.gradients);
        // The step starts from the strokes' own places; the gradient alone was taken beside them.
        if let Some(still) = still {
            drawing.free_mut().numbers_mut().copy_from_slice(&still);
        }
        // A time limit may have shortened the course.
        let by_time = course.joint.is_some() || self.hurried_from.is_some();
        // So step sizes still end at their last value, although some iterations of the schedule are skipped.
        let at = if by_time {
            (done * course.iterations as f32) as usize
        } else {
            step
        };
        let rate = course.rate(at);
        // A step of Adam, within the domains.
        let bounds = drawing.bounds;
        let strokes = drawing.free_mut();
        let slopes = &mut self.gradients.strokes;
        // Ties first: a projection onto a form must see the derivative of the whole group.
        self.ties.gather(slopes);
        self.constraints.project(strokes, slopes);
        let (adam, scales) = (&mut self.adam, &self.scales);
        // Adam scales each number by its own second moment, which would turn the step away from the gradient. Where points have to
        // move as one, they share the moment.
        match squares(strokes, slopes, &self.constraints) {
            None => adam.step_scaled(strokes.numbers_mut(), slopes, rate, scales),
            Some(squares) => {
                adam.step_with_squares(strokes.numbers_mut(), slopes, rate, scales, &squares);
            }
        }
        // Bounds clamp single numbers and may break a form, so forms are restored after them.
        strokes.change(|_, stroke| bounds.apply(stroke));
        self.constraints.restore(strokes);
        // The canvas of frozen strokes has the background in it, so it moves only while none is frozen.
        if course.joint.is_some() && drawing.is_thawed() && !drawing.background_fixed {
            let rate = rate * course.rates.color;
            let (slope, background) = (&self.gradients.backdrop, &mut self.background);
            drawing.change_background(|color| background.step(color, slope, rate));
        }
    }

    /// Resets the optimiser after a change of resolution, which changes the size of all gradients.
    pub(super) fn forget(&mut self, drawing: &Drawing) {
        self.adam = adam(drawing, &self.course);
        self.scales = scales(&self.course.rates, drawing);
    }

    /// Rearranges the state of the optimiser like the numbers of the free strokes: number `i` was number `sources[i]`, or
    /// is new.
    pub(super) fn follow(&mut self, sources: &[Option<usize>], drawing: &Drawing) {
        self.adam.rearrange(1, sources);
        self.constraints = Constraints::forms(drawing.free());
        self.scales = scales(&self.course.rates, drawing);
    }
}

impl Course {
    /// A course of its own schedule, with the final edge and all the time that there is.
    pub(super) fn new(iterations: usize, rates: Rates) -> Self {
        Self {
            iterations,
            before: 0,
            of: iterations,
            rates,
            pace: 1.0,
            softness: None,
            until: f32::INFINITY,
            joint: None,
        }
    }

    /// The factor of the step sizes of iteration `at`.
    fn rate(&self, at: usize) -> f32 {
        let end = self.rates.last;
        Schedule::Cosine { end }.factor(self.before + at, self.of) as f32 * self.pace
    }
}

/// The optimiser of the free strokes, at the resolution that the drawing has now.
fn adam(drawing: &Drawing, course: &Course) -> Adam<f32> {
    let is_reduced = course.joint.is_some() && drawing.surface().halvings() > 0;
    let params = if is_reduced { REDUCED } else { STROKES };
    Adam::new(drawing.free().numbers().len(), params)
}

/// The squares of the derivatives, where both coordinates of an area's point share one: without that, points drift along
/// the outline. All points of a shape share one. `None` if there is neither.
fn squares(strokes: &Strokes, slopes: &[f32], constraints: &Constraints) -> Option<Vec<f32>> {
    if !strokes.has_areas() && constraints.is_empty() {
        return None;
    }
    let mut squares: Vec<f32> = slopes.iter().map(|slope| slope * slope).collect();
    let areas = (0..strokes.len()).filter(|&i| strokes.get(i).is_area());
    for i in areas {
        let start = strokes.range(i).start;
        let points = &mut squares[start..start + 2 * strokes.get(i).points.len()];
        for point in points.as_chunks_mut::<2>().0 {
            // Invariant under rotation: the step of a point keeps the direction of its gradient.
            *point = [point[0] + point[1]; 2];
        }
    }
    constraints.share(strokes, &mut squares);
    Some(squares)
}

/// The step size of each number of the free strokes. The geometry of large strokes moves farther, and that of traced
/// strokes, which are about where they belong, less far. Areas are where they belong, too, and keep their opacity.
fn scales(rates: &Rates, drawing: &Drawing) -> Vec<f32> {
    let Rates {
        position,
        radius,
        color,
        opacity,
        area,
        ..
    } = *rates;
    let [least, most] = RADIUS_FACTORS;
    let (strokes, traced, placed) = (drawing.free(), drawing.traced(), drawing.placed());
    let mut scales = Vec::with_capacity(strokes.numbers().len());
    for (i, stroke) in strokes.iter().enumerate() {
        if stroke.is_area() {
            // Areas that are where they are seen stay. With a tenth of the steps 16 icons of 128 px had 0.077 instead of 0.058 ΔE00.
            let [area, color] = [area, color].map(|scale| if i < placed { 0.0 } else { scale });
            scales.resize(scales.len() + 2 * stroke.points.len(), area);
            let color = color * AREA_COLOR;
            // Radius, three channels, opacity: an area has no radius and keeps its opacity.
            scales.extend([0.0, color, color, color, 0.0]);
            continue;
        }
        let factor = (stroke.radius() / USUAL_RADIUS).sqrt().clamp(least, most);
        let pace = if i < traced { TRACED_PACE } else { 1.0 };
        let ends = position * factor * pace;
        scales.resize(scales.len() + 2 * stroke.points.len(), ends);
        let style: [f32; STYLE] = [radius * factor, color, color, color, opacity];
        scales.extend(style);
    }
    scales
}
