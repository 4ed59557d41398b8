//! A side of an outline: curves through samples of it.

use std::collections::BTreeMap;

use kurbo::{CubicBez, ParamCurve, ParamCurveDeriv, QuadBez};

use super::length;
use crate::math::{Point, Vec2};
use crate::scene::PathPoint;

/// Farthest that a curve is from the samples, px: rasterisers have steps of 1/16 px at best.
const TOLERANCE: f64 = 0.04;
/// Largest second difference of a curve's points, px: resvg draws chords in the place of curves, fewer of them than would be exact. Two
/// drawings have 35.1 and 36.2 dB with any, 36.7 and 38.1 with 2 px, 37.5 and 39.1 with 1 px and 37.7 and 39.4 with 0.5 px, which take
/// 1.13, 1.25 and 1.4 times the bytes.
const BEND: f64 = 1.0;
/// Rounds of finding the parameters of the samples on a curve anew.
const ROUNDS: usize = 3;

/// The points of a side, as far as it is known.
#[derive(Debug, Default)]
pub(super) struct Side {
    pub(super) points: Vec<PathPoint>,
    /// Places on it that are still to be joined by curves.
    run: Vec<Sample>,
}

/// A place on a side.
#[derive(Debug, Clone, Copy)]
struct Sample {
    at: Point,
    /// The directions in which the side arrives and leaves; about the same.
    ways: [Vec2; 2],
}

impl Side {
    /// Adds a place that the side runs through smoothly.
    pub(super) fn sample(&mut self, at: Point, way: Vec2) {
        self.run.push(Sample { at, ways: [way; 2] });
    }

    /// Says in which direction the side leaves the last place, if it turns a little there.
    pub(super) fn turn(&mut self, way: Vec2) {
        if let Some(last) = self.run.last_mut() {
            last.ways[1] = way;
        }
    }

    /// Adds a place that a line leads to.
    pub(super) fn corner(&mut self, at: Point) {
        self.end();
        self.push(PathPoint::on(at));
    }

    /// Adds a point. Places on the side that coincide are one, and what leads back to where it came from goes.
    pub(super) fn push(&mut self, point: PathPoint) {
        let on = |p: &PathPoint| p.is_on().then_some(p.at);
        let count = self.points.len();
        let before = |k: usize| count.checked_sub(k).and_then(|i| on(&self.points[i]));
        if on(&point).is_some() && before(1) == on(&point) {
            return;
        }
        if on(&point).is_some() && before(1).is_some() && before(2) == on(&point) {
            self.points.pop();
            return;
        }
        self.points.push(point);
    }

    /// Joins the samples by curves.
    pub(super) fn end(&mut self) {
        let run = std::mem::take(&mut self.run);
        let Some(first) = run.first() else {
            return;
        };
        self.push(PathPoint::on(first.at));
        for (to, curve) in Samples::of(&run).curves() {
            curve.into_iter().for_each(|point| self.push(point));
            self.push(PathPoint::on(run[to].at));
        }
    }
}

/// Samples of a smooth side.
struct Samples<'a> {
    run: &'a [Sample],
    /// The samples, and a place between each two of them.
    places: Vec<Point>,
    /// The length up to each place.
    lengths: Vec<f64>,
}

/// The sample that a curve ends at, and its control points.
type Curve = (usize, Vec<PathPoint>);

/// The kinds of curves, by how many control points they have.
const KINDS: [usize; 3] = [0, 1, 2];

impl<'a> Samples<'a> {
    fn of(run: &'a [Sample]) -> Self {
        // The middle of the cubic curve with these directions, whose handles are a third of the chord.
        let between = |a: Sample, b: Sample| {
            a.at.midpoint(b.at) + 0.125 * length(b.at - a.at) * (a.ways[1] - b.ways[0])
        };
        let pairs = run.windows(2);
        let inner = pairs.flat_map(|pair| [between(pair[0], pair[1]), pair[1].at]);
        let first = run.first().map(|first| first.at);
        let places: Vec<Point> = first.into_iter().chain(inner).collect();
        let mut lengths = vec![0.0];
        for pair in places.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + length(pair[1] - pair[0]));
        }
        Self {
            run,
            places,
            lengths,
        }
    }

    /// The curves along all samples that take fewest numbers.
    fn curves(&self) -> Vec<Curve> {
        let end = self.run.len() - 1;
        // From each sample that curves lead to: the numbers up to the end, and the first curve. A dynamic programme, backwards.
        let mut best: BTreeMap<usize, (usize, Curve)> = BTreeMap::new();
        let mut open = vec![0];
        let mut steps: BTreeMap<usize, Vec<Curve>> = BTreeMap::new();
        while let Some(from) = open.pop().filter(|_| end > 0) {
            if from < end && !steps.contains_key(&from) {
                let curves = KINDS.iter().filter_map(|&kind| self.farthest(from, kind));
                let curves: Vec<Curve> = curves.collect();
                open.extend(curves.iter().map(|(to, _)| *to));
                steps.insert(from, curves);
            }
        }
        for (from, curves) in steps.into_iter().rev() {
            let priced = curves.into_iter().map(|(to, curve)| {
                let rest = best.get(&to).map_or(0, |(numbers, _)| *numbers);
                (rest + 2 + 2 * curve.len(), (to, curve))
            });
            // On equal terms the curve with fewest control points, which comes first.
            if let Some(found) = priced.min_by_key(|(numbers, _)| *numbers) {
                best.insert(from, found);
            }
        }
        let mut curves = Vec::new();
        let mut from = 0;
        while let Some((_, curve)) = best.remove(&from) {
            from = curve.0;
            curves.push(curve);
        }
        curves
    }

    /// The farthest sample that a curve of this kind leads to, by bisection.
    fn farthest(&self, from: usize, kind: usize) -> Option<Curve> {
        let end = self.run.len() - 1;
        let curve = |to: usize| self.curve([from, to], kind).map(|curve| (to, curve));
        if let Some(found) = curve(end) {
            return Some(found);
        }
        let mut best = curve(from + 1)?;
        let (mut low, mut high) = (from + 1, end);
        while high - low > 1 {
            let middle = low.midpoint(high);
            match curve(middle) {
                Some(found) => (best, low) = (found, middle),
                None => high = middle,
            }
        }
        Some(best)
    }

    /// The control points of the curve of this kind between two samples, if it is near to those in between.
    fn curve(&self, [from, to]: [usize; 2], kind: usize) -> Option<Vec<PathPoint>> {
        let inner = 2 * from..=2 * to;
        let (places, lengths) = (&self.places[inner.clone()], &self.lengths[inner]);
        let whole = lengths[lengths.len() - 1] - lengths[0];
        let mut shares: Vec<f64> = lengths.iter().map(|l| (l - lengths[0]) / whole).collect();
        let [a, b] = [self.run[from], self.run[to]];
        let ([leaving, arriving], [a, b]) = ([a.ways[1], b.ways[0]], [a.at, b.at]);
        match kind {
            0 => {
                let line = kurbo::Line::new(a, b);
                is_near(&line, places, &mut shares).then(Vec::new)
            }
            1 => {
                let control = meeting([a, b], [leaving, arriving])?;
                let curve = QuadBez::new(a, control, b);
                let is_flat = from + 1 == to || bend([a, control, b]) <= BEND;
                (is_flat && is_near(&curve, places, &mut shares))
                    .then(|| vec![PathPoint::off(control)])
            }
            _ => {
                for _ in 0..ROUNDS {
                    let curve = cubic([a, b], [leaving, arriving], places, &shares)?;
                    let bends = [[a, curve.p1, curve.p2], [curve.p1, curve.p2, b]].map(bend);
                    let is_flat = from + 1 == to || bends[0].max(bends[1]) <= BEND;
                    if !is_flat {
                        return None;
                    }
                    if is_near(&curve, places, &mut shares) {
                        return Some([curve.p1, curve.p2].map(PathPoint::cubic).to_vec());
                    }
                }
                None
            }
        }
    }
}

/// Where a curve that leaves one end in a direction, and arrives so at the other one, has its control point.
fn meeting([a, b]: [Point; 2], [leaving, arriving]: [Vec2; 2]) -> Option<Point> {
    let turn = leaving.cross(arriving);
    let [first, second] = [(b - a).cross(arriving) / turn, leaving.cross(b - a) / turn];
    let is_between = first > 0.0 && second > 0.0 && first.is_finite() && second.is_finite();
    is_between.then(|| a + first * leaving)
}

/// The cubic curve with these ends and directions that is nearest to places at these parameters, by least squares over the lengths of
/// its handles (Schneider, "An algorithm for automatically fitting digitized curves", 1990).
fn cubic(
    [a, b]: [Point; 2],
    [leaving, arriving]: [Vec2; 2],
    places: &[Point],
    shares: &[f64],
) -> Option<CubicBez> {
    let [mut xx, mut xy, mut yy, mut x, mut y] = [0.0; 5];
    for (place, &t) in places.iter().zip(shares) {
        let s = 1.0 - t;
        let [first, second] = [3.0 * s * s * t * leaving, -3.0 * s * t * t * arriving];
        let ends = s * s * (s + 3.0 * t) * a.to_vec2() + t * t * (t + 3.0 * s) * b.to_vec2();
        let rest = place.to_vec2() - ends;
        xx += first.dot(first);
        xy += first.dot(second);
        yy += second.dot(second);
        x += first.dot(rest);
        y += second.dot(rest);
    }
    let whole = xx * yy - xy * xy;
    let handles = [(x * yy - y * xy) / whole, (y * xx - x * xy) / whole];
    // A handle that points back, or beyond the other end, makes a loop.
    let most = 3.0 * length(b - a);
    let are_fit = handles.iter().all(|h| (0.0..=most).contains(h));
    are_fit.then(|| CubicBez::new(a, a + handles[0] * leaving, b - handles[1] * arriving, b))
}

/// The length of the second difference of three points, px.
fn bend([a, b, c]: [Point; 3]) -> f64 {
    length(a.to_vec2() - 2.0 * b.to_vec2() + c.to_vec2())
}

/// True if a curve is near to places; their parameters become those of the places on it that are nearest, about.
fn is_near<C: ParamCurve + ParamCurveDeriv>(
    curve: &C,
    places: &[Point],
    shares: &mut [f64],
) -> bool {
    let deriv = curve.deriv();
    let mut most = 0.0_f64;
    for (place, t) in places.iter().zip(shares) {
        // Newton's step along the curve.
        for _ in 0..2 {
            let (at, velocity) = (curve.eval(*t), deriv.eval(*t).to_vec2());
            let step = (*place - at).dot(velocity) / velocity.hypot2();
            *t = if step.is_finite() {
                (*t + step).clamp(0.0, 1.0)
            } else {
                *t
            };
        }
        most = most.max((*place - curve.eval(*t)).hypot2());
    }
    most <= TOLERANCE * TOLERANCE
}
