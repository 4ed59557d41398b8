//! Outlines: a contour as a ring of few on- and off-points.
//!
//! A contour is cut at its corners. Between two of them the cheapest chain of spans within the tolerance is found by
//! dynamic programme; its spans end at corners of a polygon close to the contour. Hidden edges may lie farther out.

use super::super::contour::{Field, Place, resampled};
use super::corners::{Corner, corners};
use super::span::{MOST, Sample, Span, fit};
use crate::math;
use crate::scene::{Path, PathPoint, PointKind};

/// Distance of the samples of an outline, px. A guess.
const STEP: f32 = 0.5;
/// Farthest that the outline of an area may be from the samples, px. 0.18, 0.3, 0.5: +0.6, 0, −2.6 dB at 1.16, 1, 0.9 times the
/// bytes of 64 drawings at 256 px (`docs/areas.md`).
pub(super) const TOLERANCE: f32 = 0.3;
/// Tolerance of the polygon whose corners are the candidates for on-points, in units of that of the outline. A guess.
const POLYGON: f32 = 0.22 / 0.3;

/// The shape that an outline is around, and what hides it.
pub(super) struct Surroundings<'a, D> {
    /// The size of the picture, px.
    pub(super) page: [f32; 2],
    /// Share of each pixel that the shape covers.
    pub(super) field: &'a Field,
    /// Farthest that the outline may lie beyond a place in a direction, as it is hidden there, px.
    pub(super) depth: D,
}

/// The ring along a contour, at most `tolerance` px from it.
pub(super) fn ring<D: Fn(Place, Place) -> f32>(
    contour: &[Place],
    tolerance: f32,
    around: &Surroundings<'_, D>,
) -> Option<Path> {
    // 1. Samples at even steps, each with the direction out of the shape.
    let mut places = resampled(contour, STEP);
    let count = places.len();
    let outward = |i: usize| {
        let [a, b] = [places[(i + count - 2) % count], places[(i + 2) % count]];
        let length = math::distance(a, b).max(f32::MIN_POSITIVE);
        [-(b[1] - a[1]) / length, (b[0] - a[0]) / length]
    };
    let outward: Vec<Place> = (0..count).map(outward).collect();
    // 2. Each moves along it to where half of a pixel would be covered.
    for (place, out) in places.iter_mut().zip(&outward) {
        let shift = around.field.edge(*place, *out);
        *place = [0, 1].map(|k| place[k] + shift * out[k]);
    }
    // 3. Corners split the outline. Where it is hidden, it may lie anywhere below what hides it.
    let (turns, corners) = corners(&places, STEP);
    let depths = places.iter().zip(&outward);
    let depths: Vec<f32> = depths.map(|(&at, &out)| (around.depth)(at, out)).collect();
    let (samples, corners) = samples(&places, &outward, &depths, corners, tolerance);
    let outline = Outline {
        samples,
        hidden: depths.iter().map(|depth| *depth > HIDDEN).collect(),
        corners,
        tolerance,
    };
    // 4. Spans between corners. What leaves the page is cut off along its border.
    let is_outside = |p: &Place| (0..2).any(|k| p[k] < 0.0 || p[k] > around.page[k]);
    let outside: Vec<bool> = places.iter().map(is_outside).collect();
    let mut points = match outside.contains(&true) {
        true => outline.cut_off(&outside, around.page),
        false => outline.whole(&turns),
    };
    square(&mut points);
    let points: Vec<PathPoint> = points
        .into_iter()
        .map(|(at, is_on)| PathPoint {
            at: math::point(at),
            kind: PointKind::on_if(is_on),
        })
        .collect();
    (points.len() > 2).then(|| Path::of_points(points, true))
}

/// The samples around a shape.
struct Outline {
    samples: Vec<Sample>,
    hidden: Vec<bool>,
    /// The indices of corners.
    corners: Vec<usize>,
    tolerance: f32,
}

type Points = Vec<(Place, bool)>;

impl Outline {
    /// The points of an outline within the page.
    fn whole(&self, turns: &[f32]) -> Points {
        let count = self.samples.len();
        let mut cuts = self.corners.clone();
        if cuts.is_empty() {
            let sharpest = (0..count).min_by(|&a, &b| turns[a].total_cmp(&turns[b]));
            cuts.extend(sharpest);
        }
        let mut points = Vec::new();
        for (k, &from) in cuts.iter().enumerate() {
            let to = cuts[(k + 1) % cuts.len()];
            let length = if to > from {
                to - from
            } else {
                to + count - from
            };
            let run: Vec<usize> = (0..=length).map(|d| (from + d) % count).collect();
            self.append(&run, [None; 2], &mut points);
        }
        points
    }

    /// The points of an outline that the page cuts off. Beyond the page it goes by the page's corners.
    fn cut_off(&self, outside: &[bool], page: [f32; 2]) -> Points {
        let count = outside.len();
        let first = (0..count).find(|&i| outside[i] && !outside[(i + 1) % count]);
        let Some(first) = first else {
            let all: Vec<usize> = (0..count).collect();
            return self.page_corners(&all, page);
        };
        let order: Vec<usize> = (1..=count).map(|d| (first + d) % count).collect();
        let mut points = Vec::new();
        for run in order.chunk_by(|&a, &b| outside[a] == outside[b]) {
            if outside[run[0]] {
                points.extend(self.page_corners(run, page));
                continue;
            }
            // Cuts at the corners; the ends go on beyond the page.
            let last = run.len() - 1;
            let inner = (1..last).filter(|&k| self.corners.contains(&run[k]));
            let cuts: Vec<usize> = [0].into_iter().chain(inner).chain([last]).collect();
            let at = |k: usize| self.samples[run[k.min(last)]].at;
            let start = beyond(at(0), at(8), page);
            let end = beyond(at(last), at(last.saturating_sub(8)), page);
            for pair in cuts.windows(2) {
                let ends = [
                    (pair[0] == 0).then_some(start),
                    (pair[1] == last).then_some(end),
                ];
                self.append(&run[pair[0]..=pair[1]], ends, &mut points);
            }
            points.push((end, true));
        }
        points
    }

    /// Appends the points along a run of samples, its last one left out. Its ends may go on to other places.
    fn append(&self, run: &[usize], ends: [Option<Place>; 2], points: &mut Points) {
        let end = |sample: usize, at: Option<Place>| {
            at.map(|at| Sample {
                at,
                ..self.samples[sample]
            })
        };
        let (first, last) = (run[0], run[run.len() - 1]);
        let [start, end] = [end(first, ends[0]), end(last, ends[1])];
        let hidden = [start.map(|_| first), end.map(|_| last)];
        let along = hidden[0]
            .into_iter()
            .chain(run.iter().copied())
            .chain(hidden[1]);
        let hidden: Vec<bool> = along.map(|i| self.hidden[i]).collect();
        let inner = run.iter().map(|&i| self.samples[i]);
        let samples: Vec<Sample> = start.into_iter().chain(inner).chain(end).collect();
        chain(&samples, &hidden, self.tolerance, points);
    }

    /// The corners of the page that samples outside of it go around.
    fn page_corners(&self, run: &[usize], page: [f32; 2]) -> Points {
        let corner = |i: &usize| {
            let at = self.samples[*i].at;
            let side = |k: usize| match at[k] {
                v if v < 0.0 => Some(-BEYOND),
                v if v > page[k] => Some(page[k] + BEYOND),
                _ => None,
            };
            Some(([side(0)?, side(1)?], true))
        };
        let mut corners: Points = run.iter().filter_map(corner).collect();
        corners.dedup();
        corners
    }
}

/// Distance that outlines go beyond the page, px.
const BEYOND: f32 = 2.0;

/// The place beyond the page to which the way from `before` to `at` leads, which is close to the page's border.
fn beyond(at: Place, before: Place, page: [f32; 2]) -> Place {
    let length = math::distance(before, at).max(f32::MIN_POSITIVE);
    let way = [0, 1].map(|k| (at[k] - before[k]) / length);
    // The border that is nearest is the one that it crosses.
    let to = |k: usize| at[k].min(page[k] - at[k]);
    let axis = usize::from(to(1) < to(0));
    let far = (BEYOND / way[axis].abs().max(0.3)).min(3.0 * BEYOND);
    let mut place = [0, 1].map(|k| at[k] + far * way[k]);
    place[axis] = if at[axis] < 0.5 * page[axis] {
        place[axis].min(-0.5 * BEYOND)
    } else {
        place[axis].max(page[axis] + 0.5 * BEYOND)
    };
    place
}

/// Depth from which on an edge is hidden, px. A guess.
const HIDDEN: f32 = 0.05;
/// Farthest that a hidden edge may be inside, px. A guess.
const INSIDE: f32 = 0.35;

/// Length of an edge, px, before it is hidden, along which it may lie outside as far. A guess.
const ENDING: f32 = 1.5;

/// The samples of a contour with what is allowed of each, and the indices of its corners.
fn samples(
    places: &[Place],
    outward: &[Place],
    depths: &[f32],
    corners: Vec<Corner>,
    tolerance: f32,
) -> (Vec<Sample>, Vec<usize>) {
    let count = places.len();
    // Where an edge begins to be hidden, the contour turns along what hides it.
    let reach = (ENDING / STEP).ceil() as usize;
    let is_ending = |i: usize| {
        let near = (0..=2 * reach).map(|d| depths[(i + count * 2 + d - reach) % count]);
        depths[i] <= HIDDEN && near.fold(0.0, f32::max) > HIDDEN
    };
    let sample = |i: usize| {
        let (at, out, depth) = (places[i], outward[i], depths[i]);
        if is_ending(i) {
            return Sample {
                at,
                outward: out,
                tolerance: [INSIDE, ENDING],
                weight: 0.1,
            };
        }
        if depth <= HIDDEN {
            return Sample {
                at,
                outward: out,
                tolerance: [tolerance; 2],
                weight: 1.0,
            };
        }
        let shift = (0.5 * depth).min(1.0);
        Sample {
            at: [0, 1].map(|k| at[k] + shift * out[k]),
            outward: out,
            tolerance: [INSIDE, depth.max(tolerance)],
            weight: 0.05,
        }
    };
    let mut samples: Vec<Sample> = (0..count).map(sample).collect();
    let seen: Vec<Corner> = corners
        .into_iter()
        .filter(|corner| depths[corner.index] <= HIDDEN && !is_ending(corner.index))
        .collect();
    let cuts: Vec<usize> = seen.iter().map(|corner| corner.index).collect();
    for corner in &seen {
        samples[corner.index].at = corner.at;
        // Pixels have rounded what is beside it.
        for d in [1, 2] {
            for i in [corner.index + count - d, corner.index + d].map(|i| i % count) {
                if !cuts.contains(&i) {
                    samples[i].weight *= 0.1;
                    samples[i].tolerance = samples[i].tolerance.map(|t| t.max(0.9));
                }
            }
        }
    }
    (samples, cuts)
}

/// The cheapest chain that ends at a candidate: its points, the candidate that its last span starts at, and that span.
#[derive(Clone, Copy)]
struct Best {
    cost: usize,
    from: usize,
    span: Span,
}

/// Appends the points of a run, its last one left out.
fn chain(run: &[Sample], hidden: &[bool], tolerance: f32, points: &mut Vec<(Place, bool)>) {
    let candidates = candidates(run, hidden, tolerance);
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
        // Nothing from here can be cheaper, which is most pairs of a long run.
        if best[a].cost + 1 + least >= best[b].cost {
            continue;
        }
        let samples = thinned(&run[candidates[a]..=candidates[b]]);
        let most = MOST.min(samples.len().saturating_sub(2));
        let found = (least..=most)
            .take_while(|count| best[a].cost + 1 + count < best[b].cost)
            .find_map(|count| {
                let (span, worst) = fit(&samples, count);
                (worst <= 1.0).then_some(span)
            });
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
            None => failed += 1,
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

/// The samples at which spans may end: corners of a polygon near to the run, places where it becomes hidden, and one
/// in the middle of long gaps.
fn candidates(run: &[Sample], hidden: &[bool], tolerance: f32) -> Vec<usize> {
    let mut found = vec![];
    for factor in [1.0, 2.0, 4.0] {
        found = polygon(run, factor * POLYGON * tolerance);
        if found.len() <= 40 {
            break;
        }
    }
    let gaps = found.windows(2).filter(|w| w[1] - w[0] > 14);
    let middles: Vec<usize> = gaps.map(|w| (w[0] + w[1]) / 2).collect();
    let changes = hidden.windows(2).enumerate();
    let changes = changes.filter(|(_, w)| w[0] != w[1]).map(|(i, _)| i);
    found.extend(middles.into_iter().chain(changes));
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

/// Makes lines that are nearly level or upright exactly so.
fn square(points: &mut [(Place, bool)]) {
    const SLANT: f32 = 0.3;
    let count = points.len();
    for i in 0..count {
        let k = (i + 1) % count;
        let ((a, true), (b, true)) = (points[i], points[k]) else {
            continue;
        };
        for axis in [0, 1] {
            let across = (a[axis] - b[axis]).abs();
            let along = (a[1 - axis] - b[1 - axis]).abs();
            if across < SLANT && along > 4.0 * across + 1.0 {
                let middle = 0.5 * (a[axis] + b[axis]);
                points[i].0[axis] = middle;
                points[k].0[axis] = middle;
            }
        }
    }
}
