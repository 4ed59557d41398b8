//! The cheapest description of a contour: a dynamic programme over samples of it.
//!
//! A description is a ring of segments. Its length, in nats, is half of the squares of the samples' distances from it, in units of their
//! deviations, and a price for each number. Segments are fitted without their ends; neighbours meet in a corner, where their end tangents
//! cross, or smoothly, which takes a number away.

use std::collections::BTreeMap;

use crate::math::{self, Normal, Point, Vec2};

use super::super::contour::Place;
use super::curve::Ring;
use super::segment::{Knot, Segment, angle_between, weights};

/// A place of a contour, and its standard deviation, px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) at: Point,
    /// Infinite at a gap.
    pub(super) sigma: f64,
    /// The gap that stands between the samples beside it.
    pub(super) gap: Option<usize>,
    /// Half the width of a line there, px, as exact as the place, if it is described, too.
    pub(super) half: Option<f64>,
}

impl Sample {
    /// The square of a curve's distance in units of its deviation, where the curve's nearest place is off by this.
    pub(super) fn square(&self, off: f64) -> f64 {
        let away = off / self.sigma;
        (away * away).min(CAP)
    }

    fn weight(&self) -> f64 {
        1.0 / (self.sigma * self.sigma)
    }
}

/// A contour with its hidden stretches.
pub(super) struct Contour<'a> {
    pub(super) samples: Vec<Sample>,
    /// The places of each gap.
    pub(super) gaps: Vec<Vec<Point>>,
    /// True where an outline would be hidden.
    pub(super) is_hidden: &'a dyn Fn(Point) -> bool,
}

/// Price of a number, nats.
pub(in crate::trace) const PRICE: f64 = 5.0;
/// Numbers of a line, an arc and a cubic besides the joint before it, of which a smooth one has one less.
const NUMBERS: [f64; 3] = [2.0, 3.0, 6.0];
/// A joint leaves the sample beside it out, which would be free otherwise, nats.
const JOINT: f64 = 1.0;
/// Largest square of a sample's distance in units of its deviation: a single one that is wrong does not decide.
pub(super) const CAP: f64 = 25.0;
/// A segment that costs more than so many numbers, and a nat a sample, is hopeless.
const HOPELESS: f64 = 8.0;
/// After so many hopeless ends in a row no farther end of a start is tried: same descriptions, seven times faster.
const BREAK: usize = 6;
/// Most candidates for joints; more are thinned by a larger tolerance.
const MOST: usize = 400;

/// An end of a segment: the place and the direction in which the segment goes there.
#[derive(Debug, Clone, Copy, Default)]
struct End {
    at: Point,
    way: Vec2,
}

/// A segment that is fitted to samples.
#[derive(Debug, Clone, Copy)]
struct Fitted {
    ends: [End; 2],
    /// Relative to its own ends.
    shape: Segment,
    chi2: f64,
    /// The centre of an arc.
    center: Point,
}

/// Half the width of a line along a segment: at both of its ends, and χ² of the samples'.
#[derive(Debug, Clone, Copy)]
struct Halves {
    ends: [f64; 2],
    chi2: f64,
}

impl Halves {
    /// The widths along the samples between two, which are linear in the way along these; `None` if samples have none.
    fn along(samples: &[Sample]) -> Option<Self> {
        let mut equations = Normal::<1>::of(2);
        let (mut far, mut last) = (0.0, samples.first()?.at);
        let mut found: Vec<(f64, f64, &Sample)> = Vec::new();
        for sample in samples.iter().filter(|sample| sample.gap.is_none()) {
            far += (sample.at - last).hypot();
            last = sample.at;
            found.extend(sample.half.map(|half| (far, half, sample)));
        }
        if found.is_empty() {
            return None;
        }
        for (at, half, sample) in &found {
            let share = at / far.max(1e-9);
            let terms = [(0, 1.0 - share), (1, share)];
            equations.add(&terms, [*half], sample.weight());
        }
        // A few samples at one place tell one width.
        equations.add(&[(0, 1.0), (1, -1.0)], [0.0], 1e-3);
        let solution = equations.solve()?;
        let ends = [solution[0][0], solution[1][0]];
        let squares = found.iter().map(|(at, half, sample)| {
            let share = at / far.max(1e-9);
            sample.square(ends[0] + share * (ends[1] - ends[0]) - half)
        });
        Some(Self {
            ends,
            chi2: squares.sum(),
        })
    }
}

/// The ring around a closed contour.
pub(super) fn ring(contour: &Contour<'_>) -> Option<Ring> {
    let samples = &contour.samples;
    if samples.iter().all(|sample| sample.gap.is_some()) {
        // What is hidden all around may lie anywhere there.
        let places = contour.gaps.first()?;
        let corners = simplified(places, true);
        return (corners.len() > 2).then(|| Ring::Knots(corners.into_iter().map(corner).collect()));
    }
    if samples.len() < 5 {
        return None;
    }
    let candidates = candidates(samples);
    // 1. From the sharpest turn around to it, and again from a joint in the middle, which is a better start than a guess.
    let first = sharpest(samples, &candidates);
    let mut fits = Fits::new();
    let mut best = around(contour, &candidates, first, &mut fits)?;
    if let Some(middle) = best
        .starts
        .get(best.starts.len() / 2)
        .filter(|_| best.starts.len() > 1)
    {
        let again = around(contour, &candidates, *middle, &mut fits);
        best = again
            .filter(|again| again.length < best.length)
            .unwrap_or(best);
    }
    Some(Ring::Knots(best.knots))
}

/// The polygon around a contour, about a pixel off.
pub(super) fn polygon_of(contour: &[Place]) -> Option<Ring> {
    let places: Vec<Point> = contour.iter().rev().map(|p| math::point(*p)).collect();
    let corners = simplified(&places, true);
    (corners.len() > 2).then(|| Ring::Knots(corners.into_iter().map(corner).collect()))
}

/// The vertices of the middle of a line along samples, in their order.
pub(super) fn line(samples: &[Sample], is_closed: bool) -> Option<Vec<Knot>> {
    // At a corner both segments go on until they meet.
    let always = |_| true;
    let gaps = samples
        .iter()
        .filter(|sample| sample.gap.is_some())
        .map(|sample| vec![sample.at]);
    let gaps: Vec<Vec<Point>> = gaps.collect();
    let contour = |samples: Vec<Sample>| Contour {
        samples,
        gaps: gaps.clone(),
        is_hidden: &always,
    };
    if is_closed {
        return match ring(&contour(samples.to_vec()))? {
            Ring::Knots(knots) => Some(knots),
            _ => None,
        };
    }
    // Between the end and the start of an open line is nothing, which takes the place of a gap.
    let nothing = Sample {
        at: samples.first()?.at.midpoint(samples.last()?.at),
        sigma: f64::INFINITY,
        gap: Some(NOTHING),
        half: None,
    };
    let samples = [nothing]
        .into_iter()
        .chain(samples.iter().copied())
        .collect();
    let contour = contour(samples);
    let candidates = candidates(&contour.samples);
    let mut knots = around(&contour, &candidates, 0, &mut Fits::new())?.knots;
    // The end comes first there.
    knots.rotate_left(1);
    Some(knots)
}

/// The gap between the end and the start of an open line.
const NOTHING: usize = usize::MAX;

/// A vertex with a line behind it.
pub(super) fn corner(at: Point) -> Knot {
    Knot {
        at,
        segment: Segment::Line,
        is_smooth: false,
        radius: 0.0,
    }
}

/// A description that begins at a sample.
struct Description {
    length: f64,
    knots: Vec<Knot>,
    /// The samples at which segments start.
    starts: Vec<usize>,
}

/// A segment between two candidates, and the cheapest way to it.
struct Span {
    /// Indices of its candidates.
    from: usize,
    to: usize,
    fitted: Fitted,
    halves: Option<Halves>,
    own: f64,
    /// How far it may go on beneath what hides it, at its start and at its end, px.
    reach: [f64; 2],
    /// The cost of the cheapest chain that ends with it, the span before it in that, and the first one.
    best: f64,
    before: Option<usize>,
    first: usize,
}

/// The fits of segments that were tried, by the samples at which they start and end.
type Fits = BTreeMap<[usize; 2], Vec<Option<Fitted>>>;

/// The cheapest description with a joint at sample `first`.
fn around(
    contour: &Contour<'_>,
    candidates: &[usize],
    first: usize,
    fits: &mut Fits,
) -> Option<Description> {
    let samples = &contour.samples;
    let count = samples.len();
    // The contour opened there; its first sample is its last one, too.
    let open: Vec<Sample> = (0..=count).map(|i| samples[(first + i) % count]).collect();
    let mut places: Vec<usize> = candidates
        .iter()
        .map(|i| (i + count - first) % count)
        .collect();
    places.extend([0, count]);
    places.sort_unstable();
    places.dedup();
    // 1. All segments that may pay, by their start.
    let has_halves = open.iter().any(|sample| sample.half.is_some());
    let mut spans = Vec::new();
    for from in 0..places.len() - 1 {
        let mut failed = 0;
        for to in from + 1..places.len() {
            let (a, b) = (places[from], places[to]);
            let before = spans.len();
            let mut least = f64::INFINITY;
            let halves = match has_halves {
                true => Halves::along(&open[a..=b]),
                false => None,
            };
            // Their number at the joint.
            let of_halves = halves.map_or(0.0, |halves| 0.5 * halves.chi2 + PRICE);
            let fits = fits
                .entry([(first + a) % count, (first + b) % count])
                .or_default();
            for (kind, numbers) in NUMBERS.into_iter().enumerate() {
                // More numbers cannot pay.
                if numbers * PRICE + of_halves >= least {
                    break;
                }
                if fits.len() <= kind {
                    fits.push(match kind {
                        0 => straight(&open, a, b),
                        1 => arc(&open, a, b),
                        _ => cubic(&open, a, b),
                    });
                }
                let Some(fitted) = fits[kind] else { continue };
                let is_next = kind == 0 && to == from + 1;
                let chi2 = 0.5 * fitted.chi2 + of_halves;
                if chi2 > HOPELESS * PRICE + (b - a) as f64 && !is_next {
                    continue;
                }
                if !contour.spans_gaps(&open[a..=b], &fitted) {
                    continue;
                }
                let own = chi2 + numbers * PRICE + JOINT;
                least = least.min(own - JOINT);
                let (best, first) = if from == 0 {
                    (own, spans.len())
                } else {
                    (f64::INFINITY, 0)
                };
                let reach = [0, 1].map(|end| match open[[a, b][end]].gap {
                    Some(_) => contour.reach(&fitted, end),
                    None => 0.0,
                });
                spans.push(Span {
                    from,
                    to,
                    fitted,
                    halves,
                    own,
                    reach,
                    best,
                    before: None,
                    first,
                });
            }
            failed = if spans.len() > before { 0 } else { failed + 1 };
            if failed == BREAK {
                break;
            }
        }
    }
    // 2. The cheapest way to each, from left to right.
    let mut ending: Vec<Vec<usize>> = vec![Vec::new(); places.len()];
    spans
        .iter()
        .enumerate()
        .for_each(|(i, span)| ending[span.to].push(i));
    let length = |span: &Span| places[span.to] - places[span.from];
    let joined = |a: &Span, b: &Span| {
        let sample = &open[places[b.from]];
        match sample.gap {
            Some(NOTHING) => return apart([a.fitted.ends[1], b.fitted.ends[0]]),
            Some(gap) => return contour.bridge(a, b, gap),
            None => {}
        }
        let may_be_smooth = [a, b]
            .iter()
            .all(|s| s.fitted.shape != Segment::Line || length(s) >= 4);
        let mut joint = joint(
            [a.fitted.ends[1], b.fitted.ends[0]],
            [length(a), length(b)],
            sample.sigma,
            may_be_smooth,
        );
        if let (Some(a), Some(b)) = (a.halves, b.halves) {
            let step = (a.ends[1] - b.ends[0]) / (2.0 * sample.sigma);
            joint.cost += 0.5 * (step * step).min(1e6);
        }
        joint
    };
    for i in 0..spans.len() {
        if spans[i].from == 0 {
            continue;
        }
        for &k in &ending[spans[i].from] {
            let (before, span) = (&spans[k], &spans[i]);
            // A joint saves a number at most.
            if before.best - PRICE + span.own >= span.best {
                continue;
            }
            let cost = before.best + joined(before, span).cost + span.own;
            if cost < span.best {
                let first = before.first;
                let span = &mut spans[i];
                (span.best, span.before, span.first) = (cost, Some(k), first);
            }
        }
    }
    // 3. Round the corner: the last segment meets the first one of its chain.
    let closed = |&i: &usize| spans[i].best + joined(&spans[i], &spans[spans[i].first]).cost;
    let last = ending[places.len() - 1].iter().copied();
    let last = last.filter(|i| spans[*i].best.is_finite());
    let last = last.min_by(|a, b| closed(a).total_cmp(&closed(b)))?;
    let length = closed(&last);
    let mut chain = vec![last];
    while let Some(before) = spans[chain[chain.len() - 1]].before {
        chain.push(before);
    }
    chain.reverse();
    // 4. Vertices where segments meet; handles move with them. Between two segments that do not meet beneath what hides them lie lines.
    let joints = (0..chain.len()).map(|k| {
        let before = &spans[chain[(k + chain.len() - 1) % chain.len()]];
        joined(before, &spans[chain[k]])
    });
    let joints: Vec<Joint> = joints.collect();
    let mut knots = Vec::new();
    for (k, &span) in chain.iter().enumerate() {
        let Fitted {
            ends,
            shape,
            center,
            ..
        } = spans[span].fitted;
        let (joint, next) = (&joints[k], &joints[(k + 1) % joints.len()]);
        let (at, to) = (joint.ends[1], next.ends[0]);
        if joint.ends[0] != joint.ends[1] {
            knots.push(corner(joint.ends[0]));
        }
        knots.extend(joint.between.iter().copied().map(corner));
        // The mean of both segments; an end has one.
        let before = &spans[chain[(k + chain.len() - 1) % chain.len()]];
        let radius = match [before.halves, spans[span].halves] {
            [Some(a), Some(b)] if joint.ends[0] == joint.ends[1] => 0.5 * (a.ends[1] + b.ends[0]),
            [_, halves] => halves.map_or(0.0, |halves| halves.ends[0]),
        };
        if joint.ends[0] != joint.ends[1]
            && let (Some(halves), Some(end)) = (before.halves, knots.last_mut())
        {
            end.radius = halves.ends[1];
        }
        knots.push(Knot {
            at,
            radius,
            segment: match shape {
                Segment::Cubic([a, b]) => {
                    Segment::Cubic([a + (at - ends[0].at), b + (to - ends[1].at)])
                }
                // An arc goes on along its circle.
                Segment::Arc(bulge) => {
                    let turned = |from: Point, to: Point| angle_between(from - center, to - center);
                    let more = turned(at, ends[0].at) + turned(ends[1].at, to);
                    let angle = 4.0 * math::atan(bulge) + more;
                    match joint.ends[0] != joint.ends[1]
                        || next.ends[0] != next.ends[1]
                        || joint.is_beneath
                        || next.is_beneath
                    {
                        true => Segment::Arc(math::tan(0.25 * angle.clamp(-6.0, 6.0))),
                        false => shape,
                    }
                }
                Segment::Line | Segment::Along(_) => shape,
            },
            is_smooth: joint.is_smooth,
        });
    }
    Some(Description {
        length,
        knots,
        starts: chain
            .iter()
            .map(|&i| (first + places[spans[i].from]) % count)
            .collect(),
    })
}

/// Where two segments meet, and what it costs.
struct Joint {
    cost: f64,
    /// Where the first one ends and the second one starts; the same unless there is a gap between them.
    ends: [Point; 2],
    /// Vertices in the gap, besides.
    between: Vec<Point>,
    is_smooth: bool,
    is_beneath: bool,
}

/// No joint: the end and the start of an open line.
fn apart(ends: [End; 2]) -> Joint {
    Joint {
        cost: 0.0,
        ends: ends.map(|end| end.at),
        between: Vec::new(),
        is_smooth: false,
        is_beneath: false,
    }
}

/// The cheaper joint between the end of a segment of so many samples and the start of the next one.
fn joint([a, b]: [End; 2], lengths: [usize; 2], sigma: f64, may_be_smooth: bool) -> Joint {
    let gap = b.at - a.at;
    let (cross, dot) = (a.way.cross(b.way), a.way.dot(b.way));
    let angle = 2.0 * math::atan(cross / (1.0 + dot).max(1e-9));
    let middle = a.at.midpoint(b.at);
    // Smooth: the ends are at one place, and their directions alike, as far as their samples tell.
    let told = |length: usize| 4.0 * sigma / length as f64;
    let square = |v: f64| v * v;
    let spread2 = square(told(lengths[0])) + square(told(lengths[1])) + square(0.02);
    let apart = gap.hypot2() / square(2.0 * sigma);
    let squares = apart + square(angle) / spread2;
    let smooth = if may_be_smooth && angle.abs() < 0.5 {
        0.5 * squares.min(1e6) - PRICE
    } else {
        f64::INFINITY
    };
    // A corner: the tangents cross, within about a pixel, which the pixels have rounded.
    let (corner, at) = if cross.abs() > 0.05 {
        let along = [gap.cross(b.way) / cross, gap.cross(a.way) / cross];
        let far = along[0].abs().max(along[1].abs());
        let most = 1.0 + 0.1 / math::sin(0.5 * angle).abs().max(0.2);
        let over = ((far - most) / 0.25).max(0.0);
        (0.5 * over * over, a.at + along[0] * a.way)
    } else {
        (0.5 * apart, middle)
    };
    let is_smooth = smooth <= corner;
    Joint {
        cost: smooth.min(corner),
        ends: [if is_smooth { middle } else { at }; 2],
        between: Vec::new(),
        is_smooth,
        is_beneath: false,
    }
}

/// Farthest that a segment goes on beneath what hides it, px. A guess.
const FARTHEST: f64 = 256.0;
/// Distance of the places at which it is tried whether an outline would be hidden, px.
const STEP: f64 = 0.5;
/// Length of an outline before it is hidden that may be seen, px: pixels along what hides it are mixtures.
const ENDING: f64 = 2.5;

impl Contour<'_> {
    /// True if a line is hidden but for its ends.
    fn is_line_hidden(&self, from: Point, to: Point) -> bool {
        let way = to - from;
        let length = way.hypot();
        let count = (length / STEP) as usize;
        let places = (0..=count).map(|i| i as f64 * STEP);
        let mut inner = places.filter(|t| *t > ENDING && *t < length - ENDING);
        inner.all(|t| (self.is_hidden)(from + t / length * way))
    }

    /// The place a segment comes to beyond its start or end.
    fn beyond(fitted: &Fitted, end: usize, far: f64) -> Point {
        let End { at, way } = fitted.ends[end];
        let sign = if end == 0 { -1.0 } else { 1.0 };
        match fitted.shape {
            Segment::Arc(bulge) => {
                let out = at - fitted.center;
                let (sin, cos) = math::sin_cos(sign * far / out.hypot() * bulge.signum());
                fitted.center + Vec2::new(cos * out.x - sin * out.y, sin * out.x + cos * out.y)
            }
            _ => at + sign * far * way,
        }
    }

    /// How far a segment stays hidden beyond its start or end, px.
    fn reach(&self, fitted: &Fitted, end: usize) -> f64 {
        let most = match fitted.shape {
            Segment::Arc(bulge) => {
                let radius = (fitted.ends[end].at - fitted.center).hypot();
                radius * (6.0 - 4.0 * math::atan(bulge).abs()).max(0.0)
            }
            _ => FARTHEST,
        };
        let most = most.min(FARTHEST);
        let mut far = 0.0;
        while far + STEP <= most {
            let p = Self::beyond(fitted, end, far + STEP);
            if far + STEP > ENDING && !(self.is_hidden)(p) {
                break;
            }
            far += STEP;
        }
        far
    }

    /// True if a segment is hidden in all gaps along it.
    fn spans_gaps(&self, inner: &[Sample], fitted: &Fitted) -> bool {
        let gaps = (1..inner.len().saturating_sub(1)).filter(|&i| inner[i].gap.is_some());
        let mut gaps = gaps.map(|i| [inner[i - 1].at, inner[i + 1].at]);
        gaps.all(|[from, to]| match fitted.shape {
            Segment::Line | Segment::Along(_) => self.is_line_hidden(from, to),
            Segment::Arc(bulge) => {
                let [u, v] = [from - fitted.center, to - fitted.center];
                let mut angle = angle_between(u, v);
                if angle * bulge < 0.0 {
                    angle += std::f64::consts::TAU.copysign(bulge);
                }
                let count = (angle.abs() * u.hypot() / STEP) as usize;
                let place = |i: usize| {
                    let (sin, cos) = math::sin_cos(angle * i as f64 / count as f64);
                    fitted.center + Vec2::new(cos * u.x - sin * u.y, sin * u.x + cos * u.y)
                };
                let margin = (ENDING / STEP) as usize;
                (margin..count.saturating_sub(margin)).all(|i| (self.is_hidden)(place(i)))
            }
            // A cubic says nothing about what it does beyond its samples.
            Segment::Cubic(_) => false,
        })
    }

    /// The cheapest way through a gap between two segments.
    fn bridge(&self, a: &Span, b: &Span, gap: usize) -> Joint {
        let beneath = |ends: [Point; 2], between: Vec<Point>, numbers: usize| Joint {
            cost: PRICE * numbers as f64,
            ends,
            between,
            is_smooth: false,
            is_beneath: true,
        };
        // 1. Both go on until they meet.
        if let Some(at) = meeting(a, b) {
            return beneath([at; 2], Vec::new(), 0);
        }
        // 2. A line between places a little farther on.
        for far in [2.0, 0.0, 4.0, 8.0, 16.0] {
            let [from, to] = [
                Self::beyond(&a.fitted, 1, a.reach[1].min(far)),
                Self::beyond(&b.fitted, 0, b.reach[0].min(far)),
            ];
            if self.is_line_hidden(from, to) {
                return beneath([from, to], Vec::new(), 2);
            }
        }
        // 3. Along what hides it.
        let places = &self.gaps[gap];
        let between = simplified(places, false);
        let [from, to] = [a.fitted.ends[1].at, b.fitted.ends[0].at];
        let numbers = 2 + 2 * between.len();
        beneath([from, to], between, numbers)
    }
}

/// Where two segments meet, each beyond its end within its reach.
fn meeting(a: &Span, b: &Span) -> Option<Point> {
    let ([p, q], reach) = (
        [a.fitted.ends[1], b.fitted.ends[0]],
        [a.reach[1], b.reach[0]],
    );
    let circle = |fitted: &Fitted| match fitted.shape {
        Segment::Arc(_) => Some((fitted.center, (fitted.ends[0].at - fitted.center).hypot())),
        _ => None,
    };
    let on_line = |End { at, way }: End, (center, radius): (Point, f64)| {
        let foot = at + (center - at).dot(way) * way;
        let half = (radius * radius - (foot - center).hypot2()).max(-1.0);
        let half = if half < 0.0 { f64::NAN } else { half.sqrt() };
        vec![foot + half * way, foot - half * way]
    };
    let found = match (circle(&a.fitted), circle(&b.fitted)) {
        (None, None) => {
            let cross = p.way.cross(q.way);
            let along = (q.at - p.at).cross(q.way) / cross;
            if cross.abs() < 0.03 {
                vec![]
            } else {
                vec![p.at + along * p.way]
            }
        }
        (Some(circle), None) => on_line(q, circle),
        (None, Some(circle)) => on_line(p, circle),
        (Some((c, r)), Some((d, s))) => {
            let way = d - c;
            let length = way.hypot();
            let along = (length * length + r * r - s * s) / (2.0 * length);
            let half2 = r * r - along * along;
            if length < 1e-6 || half2 < 0.0 {
                vec![]
            } else {
                let way = way / length;
                let across = half2.sqrt() * Vec2::new(-way.y, way.x);
                vec![c + along * way + across, c + along * way - across]
            }
        }
    };
    // How far beyond its end each comes to there.
    let far = |fitted: &Fitted, end: usize, at: Point| {
        let End { at: from, way } = fitted.ends[end];
        let sign = if end == 0 { -1.0 } else { 1.0 };
        match fitted.shape {
            Segment::Arc(bulge) => {
                let [u, v] = [from - fitted.center, at - fitted.center];
                let mut angle = sign * angle_between(u, v) * bulge.signum();
                // Pixels along what hides them are mixtures, so it may be a little back.
                if angle * u.hypot() < -1.0 {
                    angle += std::f64::consts::TAU;
                }
                angle * u.hypot()
            }
            _ => sign * (at - from).dot(way),
        }
    };
    let fits = found.into_iter().filter_map(|at| {
        let far = [far(&a.fitted, 1, at), far(&b.fitted, 0, at)];
        let is_within = (0..2).all(|k| far[k] >= -1.0 && far[k] <= reach[k]);
        is_within.then_some((far[0] + far[1], at))
    });
    fits.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, at)| at)
}

/// The corners of a polygon near places that may be anywhere about there.
fn simplified(places: &[Point], is_closed: bool) -> Vec<Point> {
    const TOLERANCE: f64 = 1.0;
    let samples: Vec<Sample> = places
        .iter()
        .map(|&at| Sample {
            at,
            sigma: TOLERANCE,
            gap: None,
            half: None,
        })
        .collect();
    if places.len() < 3 {
        return Vec::new();
    }
    match is_closed {
        true => polygon(&samples, 1.0)
            .into_iter()
            .map(|i| places[i])
            .collect(),
        false => {
            let mut kept = vec![0, places.len() - 1];
            let mut stack = vec![(0, places.len() - 1)];
            while let Some((a, b)) = stack.pop() {
                let line = kurbo::Line::new(places[a], places[b]);
                let away =
                    |i: usize| kurbo::ParamCurveNearest::nearest(&line, places[i], 0.0).distance_sq;
                let far = (a + 1..b).max_by(|i, k| away(*i).total_cmp(&away(*k)));
                if let Some(i) = far.filter(|i| away(*i) > TOLERANCE * TOLERANCE) {
                    kept.push(i);
                    stack.extend([(a, i), (i, b)]);
                }
            }
            kept.sort_unstable();
            kept.into_iter().map(|i| places[i]).collect()
        }
    }
}

/// The number of samples that are not gaps.
fn seen(samples: &[Sample]) -> usize {
    samples.iter().filter(|s| s.gap.is_none()).count()
}

/// The place at which a segment from sample `a` to `b` starts or ends: beside a gap that of the last one that is seen.
fn end_of(samples: &[Sample], [a, b]: [usize; 2], end: usize) -> Point {
    let (i, inner) = if end == 0 { (a, a + 1) } else { (b, b - 1) };
    if samples[i].gap.is_some() {
        samples[inner].at
    } else {
        samples[i].at
    }
}

/// The line along the samples between two.
fn straight(samples: &[Sample], a: usize, b: usize) -> Option<Fitted> {
    // The ends are left out, where there are others: corners have rounded them.
    let inner = if b - a < 3 {
        &samples[a..=b]
    } else {
        &samples[a + 1..b]
    };
    let inner = if seen(inner) < 2 {
        &samples[a..=b]
    } else {
        inner
    };
    if seen(inner) < 2 {
        return None;
    }
    let all: f64 = inner.iter().map(Sample::weight).sum();
    let middle = inner
        .iter()
        .map(|s| s.weight() * s.at.to_vec2())
        .sum::<Vec2>()
        / all;
    let [mut xx, mut xy, mut yy] = [0.0; 3];
    for sample in inner {
        let (w, d) = (sample.weight(), sample.at.to_vec2() - middle);
        (xx, xy, yy) = (xx + w * d.x * d.x, xy + w * d.x * d.y, yy + w * d.y * d.y);
    }
    // The direction of the largest spread: half the angle of (xx − yy, 2·xy).
    let (x, y) = (xx - yy, 2.0 * xy);
    let length = math::hypot(x, y);
    let cosine = (0.5 * (1.0 + x / length.max(f64::MIN_POSITIVE)))
        .max(0.0)
        .sqrt();
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt().copysign(y);
    let mut way = Vec2::new(cosine, sine);
    if way.dot(samples[b].at - samples[a].at) < 0.0 {
        way = -way;
    }
    let chi2 = inner
        .iter()
        .map(|s| s.square(way.cross(s.at.to_vec2() - middle)));
    let end = |end: usize| End {
        at: (middle + way.dot(end_of(samples, [a, b], end).to_vec2() - middle) * way).to_point(),
        way,
    };
    Some(Fitted {
        ends: [end(0), end(1)],
        shape: Segment::Line,
        chi2: chi2.sum(),
        center: Point::ORIGIN,
    })
}

/// A circle near some samples: centre and radius, by least squares of distances.
pub(super) fn nearest_circle(samples: &[Sample]) -> Option<(Point, f64)> {
    // 1. Algebraic: x² + y² = p·x + q·y + r is linear in p, q, r.
    let origin = samples.first()?.at;
    let mut equations = Normal::<1>::of(3);
    for sample in samples {
        let d = sample.at - origin;
        let weight = sample.weight();
        equations.add(&[(0, d.x), (1, d.y), (2, 1.0)], [d.hypot2()], weight);
    }
    let solution = equations.solve()?;
    let mut center = Vec2::new(0.5 * solution[0][0], 0.5 * solution[1][0]);
    let mut radius = (solution[2][0] + center.hypot2()).max(0.0).sqrt();
    // What is far off now stays so.
    if 0.5 * chi2_of(samples, origin + center, radius)
        > 8.0 * (HOPELESS * PRICE + samples.len() as f64)
    {
        return None;
    }
    // 2. Geometric: Gauss–Newton on the distances.
    for _ in 0..3 {
        let mut equations = Normal::<1>::of(3);
        for sample in samples {
            let d = sample.at - origin - center;
            let length = d.hypot().max(1e-12);
            let terms = [(0, d.x / length), (1, d.y / length), (2, 1.0)];
            equations.add(&terms, [length - radius], sample.weight());
        }
        let Some(step) = equations.solve() else { break };
        center += Vec2::new(step[0][0], step[1][0]);
        radius += step[2][0];
    }
    let is_circle = radius.is_finite() && (0.2..3000.0).contains(&radius);
    is_circle.then(|| (origin + center, radius))
}

/// The squares of the samples' distances from a circle, in units of their deviations.
fn chi2_of(samples: &[Sample], center: Point, radius: f64) -> f64 {
    let square = |s: &Sample| s.square((s.at - center).hypot() - radius);
    samples.iter().map(square).sum()
}

/// Most samples that a fit of a curve looks at: more change its numbers by less than their deviations.
const ENOUGH: usize = 40;

/// At most [`ENOUGH`] of some samples that are seen, and their distance in those.
fn thinned(samples: &[Sample]) -> (Vec<Sample>, usize) {
    let seen = samples.iter().filter(|sample| sample.gap.is_none());
    let stride = seen.clone().count().div_ceil(ENOUGH).max(1);
    let few = seen.skip((stride - 1) / 2).step_by(stride).copied();
    (few.collect(), stride)
}

/// The arc along the samples between two.
fn arc(samples: &[Sample], a: usize, b: usize) -> Option<Fitted> {
    let (inner, _) = thinned(&samples[a + 1..b]);
    if inner.len() < 4 {
        return None;
    }
    let (center, radius) = nearest_circle(&inner)?;
    // The angle from sample to sample, so that more than half a turn has its sign.
    let along = [end_of(samples, [a, b], 0)]
        .into_iter()
        .chain(inner.iter().map(|s| s.at));
    let along: Vec<Point> = along.chain([end_of(samples, [a, b], 1)]).collect();
    let steps = along.windows(2);
    let steps = steps.map(|w| angle_between(w[0] - center, w[1] - center));
    let angle: f64 = steps.sum();
    if !(0.03..5.8).contains(&angle.abs()) {
        return None;
    }
    let end = |end: usize| {
        let out = end_of(samples, [a, b], end) - center;
        let out = out / out.hypot().max(1e-12);
        End {
            at: center + radius * out,
            way: Vec2::new(-out.y, out.x) * angle.signum(),
        }
    };
    Some(Fitted {
        ends: [end(0), end(1)],
        shape: Segment::Arc(math::tan(0.25 * angle)),
        chi2: chi2_of(&samples[a + 1..b], center, radius),
        center,
    })
}

/// Rounds of fitting control points and finding the nearest places. A guess.
const ROUNDS: usize = 4;

/// The cubic along the samples between two, with free ends.
fn cubic(samples: &[Sample], a: usize, b: usize) -> Option<Fitted> {
    // A cubic says nothing about what it does in a gap.
    let is_gap = |i: usize| samples[i].gap.is_some();
    if (a + 1..b).any(is_gap) {
        return None;
    }
    let [a, b] = [a + usize::from(is_gap(a)), b - usize::from(is_gap(b))];
    if b < a + 8 {
        return None;
    }
    let (inner, stride) = thinned(&samples[a + 1..b]);
    let ends = [samples[a], samples[b]];
    let run: Vec<Sample> = [ends[0]]
        .into_iter()
        .chain(inner)
        .chain([ends[1]])
        .collect();
    // 1. Shares of the chord length.
    let mut shares = vec![0.0];
    let mut length = 0.0;
    for pair in run.windows(2) {
        length += (pair[1].at - pair[0].at).hypot();
        shares.push(length);
    }
    shares.iter_mut().for_each(|share| *share /= length);
    let inner = 1..run.len() - 1;
    let (mut points, mut chi2) = ([Vec2::ZERO; 4], 0.0);
    for round in 0..ROUNDS {
        // 2. The control points, in least squares.
        let mut equations = Normal::<2>::of(4);
        for i in inner.clone() {
            let [p, q, r, s] = weights(shares[i]);
            let terms = [(0, p), (1, q), (2, r), (3, s)];
            let at = run[i].at;
            equations.add(&terms, [at.x, at.y], run[i].weight());
        }
        (0..4).for_each(|k| equations.add(&[(k, 1.0)], [run[0].at.x, run[0].at.y], 1e-7));
        let solution = equations.solve()?;
        points = std::array::from_fn(|k| Vec2::new(solution[k][0], solution[k][1]));
        // 3. The place nearest to each sample, by a step of Newton's method.
        chi2 = 0.0;
        for i in inner.clone() {
            let (off, step) = beside(&points, shares[i], run[i].at);
            chi2 += run[i].square(off);
            if round < ROUNDS - 1 {
                shares[i] = (shares[i] + step.clamp(-0.1, 0.1)).clamp(0.0, 1.0);
            }
        }
        // What is far off now stays so.
        if round == 1 && 0.5 * stride as f64 * chi2 > 8.0 * (HOPELESS * PRICE + (b - a) as f64) {
            return None;
        }
    }
    // 4. All samples, whose places are between those of the few.
    if stride > 1 {
        let first = 1 + (stride - 1) / 2;
        let place = |i: usize| {
            let at = ((i as f64 - first as f64) / stride as f64 + 1.0).max(0.0);
            let k = (at as usize).min(shares.len() - 2);
            shares[k] + (at - k as f64).min(1.0) * (shares[k + 1] - shares[k])
        };
        chi2 = (a + 1..b)
            .map(|i| {
                let (mut t, mut off) = (place(i - a), 0.0);
                for _ in 0..2 {
                    let (away, step) = beside(&points, t, samples[i].at);
                    off = away;
                    t = (t + step).clamp(0.0, 1.0);
                }
                samples[i].square(off)
            })
            .sum();
    }
    // 5. Handles that say nothing, or too much, are not a curve.
    let handles = [points[1] - points[0], points[3] - points[2]];
    let is_sane = handles
        .iter()
        .all(|h| (0.02 * length..2.0 * length).contains(&h.hypot()));
    let ends = [0, 3].map(|k| points[k].to_point());
    let is_near = [(ends[0], run[0].at), (ends[1], run[run.len() - 1].at)];
    let is_near = is_near.iter().all(|(p, q)| (*p - *q).hypot() <= 1.0);
    (is_sane && is_near).then(|| Fitted {
        ends: [0, 1].map(|k| End {
            at: ends[k],
            way: handles[k] / handles[k].hypot(),
        }),
        shape: Segment::Cubic([points[1].to_point(), points[2].to_point()]),
        chi2,
        center: Point::ORIGIN,
    })
}

/// How far a cubic at share `t` is beside a place, and the step of `t` to the place on it that is nearest, by Newton's method.
fn beside(points: &[Vec2; 4], t: f64, place: Point) -> (f64, f64) {
    let at: Vec2 = weights(t).iter().zip(points).map(|(w, p)| *w * *p).sum();
    let u = 1.0 - t;
    let slope = 3.0
        * (u * u * (points[1] - points[0])
            + 2.0 * u * t * (points[2] - points[1])
            + t * t * (points[3] - points[2]));
    let away = at - place.to_vec2();
    let speed = slope.hypot().max(1e-12);
    (
        away.cross(slope) / speed,
        -away.dot(slope) / (speed * speed),
    )
}

/// The samples at which segments may meet: corners of a polygon that is within two deviations, and both neighbours of sharp ones.
fn candidates(samples: &[Sample]) -> Vec<usize> {
    let count = samples.len();
    for factor in [2.0, 4.0, 8.0, 16.0] {
        let corners = polygon(samples, factor);
        let mut found = corners.clone();
        for (k, &i) in corners.iter().enumerate() {
            let [a, b] = [k + corners.len() - 1, k + 1].map(|k| corners[k % corners.len()]);
            let [u, v] = [samples[i].at - samples[a].at, samples[b].at - samples[i].at];
            if angle_between(u, v).abs() > 0.35 {
                found.extend([(i + count - 1) % count, (i + 1) % count]);
            }
        }
        // Beside a gap a segment needs samples that tell its direction.
        let is_gap = |i: usize| samples[i % count].gap.is_some();
        found.retain(|&i| !(0..5).any(|d| is_gap(i + count + d - 2)));
        found.extend((0..count).filter(|&i| is_gap(i)));
        found.sort_unstable();
        found.dedup();
        if found.len() <= MOST || factor > 8.0 {
            return found;
        }
    }
    Vec::new()
}

/// The corners of a closed polygon within `factor` deviations of the samples, after Ramer, Douglas and Peucker.
fn polygon(samples: &[Sample], factor: f64) -> Vec<usize> {
    let count = samples.len();
    let farthest_from = |p: Point| {
        let away = |i: &usize| (samples[*i].at - p).hypot2();
        (0..count)
            .max_by(|a, b| away(a).total_cmp(&away(b)))
            .unwrap_or(0)
    };
    let middle = samples.iter().map(|s| s.at.to_vec2()).sum::<Vec2>() / count as f64;
    let a = farthest_from(middle.to_point());
    let b = farthest_from(samples[a].at);
    let around = |from: usize, to: usize| if to > from { to } else { to + count };
    let mut corners = vec![a, b];
    let mut stack = vec![(a, around(a, b)), (b, around(b, a))];
    while let Some((from, to)) = stack.pop() {
        let [p, q] = [from, to].map(|i| samples[i % count].at);
        let way = (q - p) / (q - p).hypot().max(1e-12);
        let halves = [from, to].map(|i| samples[i % count].half);
        let away = |i: usize| {
            let sample = &samples[i % count];
            let beside = way.cross(sample.at - p).abs();
            let wider = match (halves, sample.half) {
                ([Some(a), Some(b)], Some(half)) => {
                    let share = (i - from) as f64 / (to - from) as f64;
                    (a + share * (b - a) - half).abs()
                }
                _ => 0.0,
            };
            beside.max(wider) / sample.sigma
        };
        let far = (from + 1..to).max_by(|a, b| away(*a).total_cmp(&away(*b)));
        if let Some(i) = far.filter(|i| away(*i) > factor) {
            corners.push(i % count);
            stack.extend([(from, i), (i, to)]);
        }
    }
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// The candidate at which the contour turns most, over three samples to each side.
fn sharpest(samples: &[Sample], candidates: &[usize]) -> usize {
    let count = samples.len();
    let reach = if count > 12 { 3 } else { 1 };
    let cosine = |i: usize| {
        let [a, b] = [(i + count - reach) % count, (i + reach) % count].map(|k| samples[k].at);
        let [u, v] = [samples[i].at - a, b - samples[i].at];
        u.dot(v) / (u.hypot() * v.hypot()).max(1e-12)
    };
    let found = candidates.iter().copied();
    let found = found.min_by(|&a, &b| cosine(a).total_cmp(&cosine(b)));
    found.unwrap_or(0)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::rng;

    /// Samples about a px apart along a ring, each moved by noise of this deviation.
    pub(in super::super) fn sampled(ring: &Ring, sigma: f64) -> Vec<Sample> {
        let owns = ring.owns();
        let vertices = (0..ring.segments()).flat_map(|i| ring.polyline_of(i, &owns));
        let places: Vec<Point> = vertices.map(|vertex| vertex.at).collect();
        let next = places.iter().cycle().skip(1);
        let mut samples: Vec<Sample> = Vec::new();
        let mut left = 0.0;
        for (a, b) in places.iter().zip(next) {
            let way = *b - *a;
            let length = way.hypot();
            while left < length {
                let k = samples.len() as u64;
                let noise = [0, 1].map(|axis| sigma * f64::from(rng::normal(0, axis, 0, k)));
                let at = *a + left / length * way + Vec2::new(noise[0], noise[1]);
                samples.push(Sample {
                    at,
                    sigma,
                    gap: None,
                    half: None,
                });
                left += 1.0;
            }
            left -= length;
        }
        samples
    }

    fn seen_ring(truth: &Ring, sigma: f64) -> Ring {
        let contour = Contour {
            samples: sampled(truth, sigma),
            gaps: Vec::new(),
            is_hidden: &|_| false,
        };
        ring(&contour).unwrap()
    }

    pub(in super::super) fn knot(x: f64, y: f64, segment: Segment, is_smooth: bool) -> Knot {
        Knot {
            at: Point::new(x, y),
            segment,
            is_smooth,
            radius: 0.0,
        }
    }

    #[test]
    fn a_tab_is_three_lines_and_an_arc() {
        let truth = Ring::Knots(vec![
            knot(6.2, 45.1, Segment::Line, false),
            knot(6.2, 22.4, Segment::Arc(1.0), true),
            knot(44.6, 22.4, Segment::Line, true),
            knot(44.6, 45.1, Segment::Line, false),
        ]);
        let found = seen_ring(&truth, 0.03);
        let Ring::Knots(knots) = &found else {
            panic!("{found:?}")
        };
        let arcs = knots
            .iter()
            .filter(|k| matches!(k.segment, Segment::Arc(_)));
        assert_eq!((knots.len(), arcs.count()), (4, 1), "{found:?}");
        let smooth = knots.iter().filter(|knot| knot.is_smooth).count();
        assert_eq!(smooth, 2, "{found:?}");
    }

    #[test]
    fn stairs_are_lines() {
        let corners = [
            [0.0, 0.0],
            [40.0, 0.0],
            [40.0, 20.0],
            [20.0, 20.0],
            [20.0, 40.0],
            [0.0, 40.0],
        ];
        let stairs = corners.map(|[x, y]| knot(x, y, Segment::Line, false));
        let found = seen_ring(&Ring::Knots(stairs.to_vec()), 0.02);
        let Ring::Knots(knots) = &found else {
            panic!("{found:?}")
        };
        assert_eq!(knots.len(), 6, "{found:?}");
        assert!(knots.iter().all(|knot| knot.segment == Segment::Line));
    }
}
