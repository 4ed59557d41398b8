//! Spans: a line or a quadratic spline along some samples of an outline, whose ends are given.

use super::super::contour::Place;
use crate::math::Normal;

/// A sample of an outline that a span has to be near to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) at: Place,
    /// The direction out of the shape.
    pub(super) outward: Place,
    /// Farthest that the outline may be inside and outside of it, px.
    pub(super) tolerance: [f32; 2],
    /// Its weight among others.
    pub(super) weight: f32,
}

/// Most off-points of a span.
pub(super) const MOST: usize = 8;

/// The off-points of a span.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Span {
    pub(super) count: usize,
    pub(super) off: [Place; MOST],
}

/// The span with `count` off-points that is nearest to the samples, and how far it is from them in units of their
/// tolerances. It goes from the first to the last sample.
pub(super) fn fit(samples: &[Sample], count: usize) -> (Span, f32) {
    let mut span = Span {
        count,
        ..Span::default()
    };
    let last = samples.len() - 1;
    let ends = [samples[0].at, samples[last].at];
    let inner = &samples[1..last.max(1)];
    if count == 0 {
        let worst = inner.iter().map(|s| violation(s, on_line(s.at, ends)));
        return (span, worst.fold(0.0, f32::max));
    }
    let mut at = lengths(samples, count as f32);
    let mut worst = f32::INFINITY;
    for _ in 0..ROUNDS {
        solve(&mut span, samples, &at);
        // The nearest place to each sample, by Newton's method along the span.
        worst = 0.0;
        for (sample, t) in samples.iter().zip(&mut at).take(last).skip(1) {
            *t = nearest(&span, ends, sample.at, *t);
            worst = violation(sample, span.at(ends, *t).0).max(worst);
        }
        if worst <= 1.0 {
            break;
        }
    }
    (span, worst)
}

/// Times that the places along a span are found again. A guess.
const ROUNDS: usize = 4;

/// Distance of a place of an outline from a sample, in units of its tolerance.
fn violation(sample: &Sample, at: Place) -> f32 {
    let [x, y] = [at[0] - sample.at[0], at[1] - sample.at[1]];
    let is_outside = x * sample.outward[0] + y * sample.outward[1] >= 0.0;
    let tolerance = sample.tolerance[usize::from(is_outside)];
    (x * x + y * y).sqrt() / tolerance
}

fn on_line(p: Place, ends: [Place; 2]) -> Place {
    crate::math::nearest_on_segment(p, ends).0
}

/// The lengths from the first sample to each, scaled to end at `end`.
fn lengths(samples: &[Sample], end: f32) -> Vec<f32> {
    let mut sum = 0.0;
    let mut lengths = vec![0.0];
    for pair in samples.windows(2) {
        sum += crate::math::distance(pair[0].at, pair[1].at);
        lengths.push(sum);
    }
    let scale = end / sum.max(f32::MIN_POSITIVE);
    lengths.iter_mut().for_each(|length| *length *= scale);
    lengths
}

impl Span {
    /// Start, control point and end of piece `i`.
    fn piece(&self, ends: [Place; 2], i: usize) -> [Place; 3] {
        let middle = |a: Place, b: Place| [0, 1].map(|k| 0.5 * (a[k] + b[k]));
        let control = self.off[i];
        let start = match i {
            0 => ends[0],
            _ => middle(self.off[i - 1], control),
        };
        let end = match i + 1 == self.count {
            true => ends[1],
            false => middle(control, self.off[i + 1]),
        };
        [start, control, end]
    }

    /// The place at `t`, 0 to `count`, with its first and second derivative.
    fn at(&self, ends: [Place; 2], t: f32) -> (Place, Place, Place) {
        let i = (t as usize).min(self.count - 1);
        let [a, c, b] = self.piece(ends, i);
        let u = t - i as f32;
        let v = 1.0 - u;
        let at = [0, 1].map(|k| v * v * a[k] + 2.0 * u * v * c[k] + u * u * b[k]);
        let first = [0, 1].map(|k| 2.0 * (v * (c[k] - a[k]) + u * (b[k] - c[k])));
        let second = [0, 1].map(|k| 2.0 * (a[k] - 2.0 * c[k] + b[k]));
        (at, first, second)
    }
}

/// The parameter near `t` at which a span is nearest to `p`.
fn nearest(span: &Span, ends: [Place; 2], p: Place, mut t: f32) -> f32 {
    for _ in 0..2 {
        let (at, first, second) = span.at(ends, t);
        let away = [at[0] - p[0], at[1] - p[1]];
        let slope = away[0] * first[0] + away[1] * first[1];
        let square = first[0] * first[0] + first[1] * first[1];
        let bend = square + away[0] * second[0] + away[1] * second[1];
        let step = slope / bend.max(0.3 * square).max(1e-6);
        t = (t - step.clamp(-0.5, 0.5)).clamp(0.0, span.count as f32);
    }
    t
}

/// The weights of the start, the off-points and the end, at `t`: the first one that is not 0, and three in a row.
fn weights(count: usize, t: f32) -> (usize, [f32; 3]) {
    let i = (t as usize).min(count - 1);
    let u = t - i as f32;
    let v = 1.0 - u;
    // The piece goes from the middle of two off-points to the next middle, or from and to the ends.
    let before = if i == 0 { v * v } else { 0.5 * v * v };
    let after = if i + 1 == count { u * u } else { 0.5 * u * u };
    (i, [before, 1.0 - before - after, after])
}

/// Moves the off-points to where the span is nearest to the samples, in least squares.
fn solve(span: &mut Span, samples: &[Sample], at: &[f32]) {
    let count = span.count;
    let last = samples.len() - 1;
    let mut equations = Normal::of(count);
    for (sample, &t) in samples.iter().zip(at).take(last).skip(1) {
        let (first, weights) = weights(count, t);
        let (mut terms, mut free) = ([(0, 0.0); 3], 0);
        // What the given ends leave.
        let mut rest = sample.at.map(f64::from);
        for (k, w) in (first..).zip(weights) {
            let end = match k {
                0 => samples[0].at,
                k if k == count + 1 => samples[last].at,
                _ => {
                    (terms[free], free) = ((k - 1, w.into()), free + 1);
                    continue;
                }
            };
            rest = [0, 1].map(|axis| rest[axis] - f64::from(w * end[axis]));
        }
        let terms = terms.get(..free).unwrap_or_default();
        equations.add(terms, rest, sample.weight.into());
    }
    // A small pull to the samples keeps it regular.
    const PULL: f64 = 1e-4;
    for k in 0..count {
        let near = ((k as f32 + 0.5) / count as f32 * last as f32) as usize;
        equations.add(&[(k, 1.0)], samples[near].at.map(f64::from), PULL);
    }
    let solution = equations.solve().unwrap_or_default();
    for (off, solved) in span.off.iter_mut().zip(solution) {
        *off = solved.map(|v| v as f32);
    }
}
