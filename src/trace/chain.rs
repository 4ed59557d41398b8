//! Chains: a run of samples as lines and quadratic splines, by as few points as are near enough to them.
//!
//! The cheapest chain of spans within the tolerance is found by dynamic programme. Its spans end at corners of a polygon close to
//! the samples.

use crate::math::{self, Normal};

/// A place, px.
type Place = [f32; 2];

/// Tolerance of the polygon whose corners are the candidates for on-points, in units of that of the outline. A guess.
const POLYGON: f32 = 0.22 / 0.3;

/// The cheapest chain that ends at a candidate: its points, the candidate that its last span starts at, and that span.
#[derive(Clone, Copy)]
struct Best {
    cost: usize,
    from: usize,
    span: Span,
}

/// Appends the points of a run, its last one left out, each with whether it is on the path. Spans may end at the samples `ends`,
/// too.
pub(super) fn chain(
    run: &[Sample],
    ends: impl Iterator<Item = usize>,
    tolerance: f32,
    points: &mut Vec<(Place, bool)>,
) {
    let candidates = candidates(run, ends, tolerance);
    let unreached = Best {
        cost: usize::MAX,
        from: 0,
        span: Span::default(),
    };
    let mut best = vec![unreached; candidates.len()];
    best[0].cost = 0;
    for a in 0..candidates.len() - 1 {
        if best[a].cost < usize::MAX {
            extend(run, &candidates, a, &mut best);
        }
    }
    // Backwards from the end.
    let mut spans = Vec::new();
    let mut at = candidates.len() - 1;
    while at > 0 {
        spans.push((best[at].from, best[at].span));
        at = best[at].from;
    }
    for (from, span) in spans.into_iter().rev() {
        points.push((run[candidates[from]].at, true));
        points.extend(span.off[..span.count].iter().map(|&at| (at, false)));
    }
}

/// Tries all spans that start at candidate `a`.
fn extend(run: &[Sample], candidates: &[usize], a: usize, best: &mut [Best]) {
    // A longer span needs as many off-points as a shorter one, or more.
    let mut least = 0;
    let mut failed = 0;
    for b in a + 1..candidates.len() {
        let samples = thinned(&run[candidates[a]..=candidates[b]]);
        let most = MOST.min(samples.len().saturating_sub(2));
        let found = (least..=most)
            .take_while(|count| best[a].cost + 1 + count < best[b].cost)
            .find_map(|count| {
                let (span, worst) = fit(&samples, count);
                (worst <= 1.0).then_some(span)
            });
        let is_cheaper = best[a].cost + 1 + least < best[b].cost;
        match found {
            Some(span) => {
                least = span.count.saturating_sub(1);
                best[b] = Best {
                    cost: best[a].cost + 1 + span.count,
                    from: a,
                    span,
                };
                failed = 0;
            }
            // The next candidate can always be reached.
            None if b == a + 1 && best[b].cost == usize::MAX => {
                best[b] = Best {
                    cost: best[a].cost + 1,
                    from: a,
                    span: Span::default(),
                };
            }
            None if is_cheaper => failed += 1,
            None => {}
        }
        if failed == 3 {
            return;
        }
    }
}

/// At most some forty of the samples, with both ends.
fn thinned(run: &[Sample]) -> Vec<Sample> {
    let stride = run.len().div_ceil(40);
    let last = run.len() - 1;
    let inner = (0..last).step_by(stride).map(|i| run[i]);
    inner.chain([run[last]]).collect()
}

/// The samples at which spans may end: `ends`, corners of a polygon near to the run, and one in the middle of long gaps.
fn candidates(run: &[Sample], ends: impl Iterator<Item = usize>, tolerance: f32) -> Vec<usize> {
    let mut found = vec![];
    for factor in [1.0, 2.0, 4.0] {
        found = polygon(run, factor * POLYGON * tolerance);
        if found.len() <= 40 {
            break;
        }
    }
    let gaps = found.windows(2).filter(|w| w[1] - w[0] > 14);
    let middles: Vec<usize> = gaps.map(|w| (w[0] + w[1]) / 2).collect();
    found.extend(middles.into_iter().chain(ends));
    found.sort_unstable();
    found.dedup();
    found
}

/// The indices of the corners of a polygon that is within `tolerance` of the run, after Ramer, Douglas and Peucker.
fn polygon(run: &[Sample], tolerance: f32) -> Vec<usize> {
    let last = run.len() - 1;
    let mut kept = vec![0, last];
    let mut stack = vec![(0, last)];
    while let Some((a, b)) = stack.pop() {
        let ends = [run[a].at, run[b].at];
        let away2 = |i: usize| math::nearest_on_segment(run[i].at, ends).1;
        let far = (a + 1..b)
            .map(|i| (away2(i), i))
            .max_by(|p, q| p.0.total_cmp(&q.0));
        if let Some((_, i)) = far.filter(|far| far.0 > tolerance * tolerance) {
            kept.push(i);
            stack.extend([(a, i), (i, b)]);
        }
    }
    kept.sort_unstable();
    kept
}

/// A sample that a span has to be near to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) at: Place,
    /// The direction to one side, out of a shape. A line has none, and the second tolerance.
    pub(super) outward: Place,
    /// Farthest that the span may be from it to the other side, inside, and to that side, px.
    pub(super) tolerance: [f32; 2],
    /// Its weight among others.
    pub(super) weight: f32,
}

/// Most off-points of a span.
const MOST: usize = 8;

/// The off-points of a span.
#[derive(Debug, Clone, Copy, Default)]
struct Span {
    count: usize,
    off: [Place; MOST],
}

/// The span with `count` off-points that is nearest to the samples, and how far it is from them in units of their
/// tolerances. It goes from the first to the last sample.
fn fit(samples: &[Sample], count: usize) -> (Span, f32) {
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

/// Distance of a place of a span from a sample, in units of its tolerance.
fn violation(sample: &Sample, at: Place) -> f32 {
    let [x, y] = [at[0] - sample.at[0], at[1] - sample.at[1]];
    let is_outside = x * sample.outward[0] + y * sample.outward[1] >= 0.0;
    let tolerance = sample.tolerance[usize::from(is_outside)];
    (x * x + y * y).sqrt() / tolerance
}

fn on_line(p: Place, ends: [Place; 2]) -> Place {
    math::nearest_on_segment(p, ends).0
}

/// The lengths from the first sample to each, scaled to end at `end`.
fn lengths(samples: &[Sample], end: f32) -> Vec<f32> {
    let mut sum = 0.0;
    let mut lengths = vec![0.0];
    for pair in samples.windows(2) {
        sum += math::distance(pair[0].at, pair[1].at);
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
