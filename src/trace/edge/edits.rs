//! Edits of a ring, each judged by what it changes of its description's length: half of χ² of the pixels near it, and a price for each
//! number.

use std::collections::BTreeSet;

use super::coverage::{Band, Coverage, Page};
use super::curve::Ring;
use super::describe::PRICE;
use super::refine::{Target, all, chi2, refined};
use super::segment::{Knot, NEARLY, Segment, arc_middle, directions, distance2, weights};
use crate::math::{self, Point, Vec2};

/// Iterations in which an edit settles.
const ITERATIONS: usize = 8;
/// An edit that lengthens the list of numbers has to shorten the description by this, nats. A guess.
const LEAST: f64 = 0.5;
/// Vertices before and behind an edit that settle with it.
const NEAR: usize = 2;

/// An edit: the knots after it, and the vertices that it changed.
pub(super) struct Edit {
    pub(super) knots: Vec<Knot>,
    pub(super) changed: Vec<usize>,
}

/// Improves a ring until no edit does. `target` is what it is to cover of a part of the page.
pub(super) fn improve(ring: &mut Ring, target: &dyn Fn(Band) -> Target, page: Page) {
    for is_adding in [true, false, true, false] {
        // Segments that are to be tried; each edit lets its neighbours be tried again.
        let mut fresh: Vec<bool> = vec![true; ring.segments()];
        let mut costs = if is_adding {
            costs(ring, &all(ring), target, page)
        } else {
            Vec::new()
        };
        let mut is_changed = false;
        for _ in 0..8 * ring.segments() + 8 {
            let Ring::Knots(knots) = &*ring else { return };
            // 1. Of segments that may be drawn better the one that is farthest off; else the last one.
            let left = (0..knots.len()).filter(|&i| fresh[i]);
            let next = match is_adding {
                true => left
                    .filter(|&i| costs[i] > 1.2 * PRICE)
                    .max_by(|&a, &b| costs[a].total_cmp(&costs[b])),
                false => left.max(),
            };
            let Some(i) = next else { break };
            // 2. The edit of it that shortens the description most.
            let mut edits = if is_adding {
                longer(knots, i)
            } else {
                shorter(knots, i)
            };
            if is_adding {
                // An edit can spare no more than what is off near it.
                let near = [i + knots.len() - 1, i, i + 1].map(|k| costs[k % knots.len()]);
                let most: f64 = near.iter().sum();
                let freedom =
                    |knots: &[Knot]| knots.iter().map(Knot::freedom).sum::<usize>() as f64;
                let before = freedom(knots);
                edits.retain(|edit| PRICE * (freedom(&edit.knots) - before) < most);
            }
            let least = if is_adding { LEAST } else { 0.0 };
            let Some((edited, changed)) = best(ring, i, edits, target, page, least) else {
                fresh[i] = false;
                continue;
            };
            is_changed = true;
            let (before, count) = (fresh.len(), edited.segments());
            if count > before {
                fresh.insert(i, true);
                costs.insert(i.min(costs.len()), 0.0);
            } else if count < before {
                fresh.remove(i);
            }
            let moved = near(&changed, count);
            moved.iter().for_each(|&k| fresh[k] = true);
            *ring = edited;
            if is_adding {
                costs.resize(count, 0.0);
                let settled = self::costs(ring, &moved, target, page);
                moved
                    .into_iter()
                    .zip(settled)
                    .for_each(|(k, cost)| costs[k] = cost);
            }
        }
        if !is_changed && !is_adding {
            return;
        }
    }
}

/// Some segments of a ring of so many, and those beside them that settle with them.
fn near(segments: &[usize], count: usize) -> Vec<usize> {
    let around = |k: &usize| {
        let k = *k;
        (0..2 * NEAR + 1).map(move |d| (k + count * NEAR + d - NEAR) % count)
    };
    let near: BTreeSet<usize> = segments.iter().flat_map(around).collect();
    near.into_iter().collect()
}

/// Half of χ² of the pixels that each of some segments touches.
fn costs(ring: &Ring, segments: &[usize], target: &dyn Fn(Band) -> Target, page: Page) -> Vec<f64> {
    let target = target(Band::of(ring, segments, &[], page));
    let shares = Coverage::of(ring, &target.band).shares();
    let owns = ring.owns();
    let mut alone = Coverage::none(&target.band);
    let cost = |&i: &usize| {
        alone.forget();
        alone.add(ring, i, &owns);
        target.half_chi2(&alone.touched(), &shares)
    };
    segments.iter().map(cost).collect()
}

/// The best of some edits about segment `i`, if it shortens the description by more than `least`, and what it changed.
fn best(
    ring: &Ring,
    i: usize,
    edits: Vec<Edit>,
    target: &dyn Fn(Band) -> Target,
    page: Page,
    least: f64,
) -> Option<(Ring, Vec<usize>)> {
    if edits.is_empty() {
        return None;
    }
    let count = ring.segments();
    let around: Vec<usize> = (0..2 * NEAR + 5)
        .map(|d| (i + count * (NEAR + 2) + d - NEAR - 2) % count)
        .collect();
    let target = target(Band::of(ring, &around, &[], page));
    let before = 0.5 * chi2(ring, &around, &target) + PRICE * ring.freedom();
    let mut best = None;
    let mut length = before - least;
    for edit in edits {
        let ring = Ring::Knots(edit.knots);
        let count = ring.segments();
        let free = near(&edit.changed, count);
        let price = PRICE * ring.freedom();
        let (ring, chi2) = refined(&ring, &free, &target, ITERATIONS, 2.0 * (length - price));
        let now = 0.5 * chi2 + price;
        if now.is_finite() && now < length {
            length = now;
            best = Some((ring, edit.changed));
        }
    }
    best
}

/// Edits of segment `i` that add numbers.
pub(super) fn longer(knots: &[Knot], i: usize) -> Vec<Edit> {
    let count = knots.len();
    let next = (i + 1) % count;
    let mut edits = Vec::new();
    let with = |segment: Segment| {
        let mut knots = knots.to_vec();
        knots[i].segment = segment;
        Edit {
            knots,
            changed: vec![i, next],
        }
    };
    // 1. Another kind of segment.
    let [from, to] = [knots[i].at, knots[next].at];
    match knots[i].segment {
        Segment::Along(_) => edits.push(with(Segment::Line)),
        Segment::Line => {
            edits.push(with(Segment::Arc(1e-3)));
            edits.push(with(Segment::Cubic(handles(&knots[i], to))));
        }
        // What was fitted beside something hidden may be far off.
        Segment::Arc(_) => {
            edits.push(with(Segment::Cubic(handles(&knots[i], to))));
            edits.push(with(Segment::Line));
        }
        Segment::Cubic(_) => edits.push(with(Segment::Line)),
    }
    // 2. Two segments.
    let mut split = |middle: Point, halves: [Segment; 2]| {
        let mut knots = knots.to_vec();
        knots[i].segment = halves[0];
        knots.insert(
            i + 1,
            Knot {
                at: middle,
                segment: halves[1],
                is_smooth: true,
                radius: 0.5 * (knots[i].radius + knots[(i + 1) % count].radius),
            },
        );
        edits.push(Edit {
            knots,
            changed: vec![i, i + 1],
        });
    };
    match knots[i].segment {
        Segment::Line | Segment::Along(_) => split(from.midpoint(to), [Segment::Arc(1e-3); 2]),
        Segment::Arc(bulge) => {
            let half = math::tan(0.5 * math::atan(bulge));
            split(arc_middle(from, to, bulge), [Segment::Arc(half); 2]);
        }
        Segment::Cubic([c, d]) => {
            let m = c.midpoint(d);
            let [p, q] = [from.midpoint(c), d.midpoint(to)];
            let [r, s] = [p.midpoint(m), m.midpoint(q)];
            split(
                r.midpoint(s),
                [Segment::Cubic([p, r]), Segment::Cubic([s, q])],
            );
            let middle = r.midpoint(s);
            let of = |from: Point, to: Point, on: Point| Segment::Arc(bulge_of(from, to, on));
            let at = |t: f64| cubic_at([from, c, d, to], t);
            split(
                middle,
                [of(from, middle, at(0.25)), of(middle, to, at(0.75))],
            );
        }
    }
    // 3. Other joints at both ends.
    for k in [i, next] {
        if knots[k].is_smooth {
            let mut knots = knots.to_vec();
            knots[k].is_smooth = false;
            edits.push(Edit {
                knots,
                changed: vec![k],
            });
        } else {
            edits.extend(
                [0.7, 1.5]
                    .into_iter()
                    .filter_map(|depth| fillet(knots, k, depth)),
            );
        }
    }
    edits
}

/// Segment `i` of a line as its two halves, so that its width may bend in the middle.
pub(super) fn halved(knots: &[Knot], i: usize) -> Option<Edit> {
    let next = (i + 1) % knots.len();
    let [from, to] = [knots[i].at, knots[next].at];
    // Other kinds of segments come apart by [`longer`].
    let is_straight = matches!(knots[i].segment, Segment::Line | Segment::Along(_));
    is_straight.then(|| {
        let mut halves = knots.to_vec();
        halves[i].segment = Segment::Line;
        let middle = Knot {
            at: from.midpoint(to),
            segment: Segment::Line,
            is_smooth: true,
            radius: 0.5 * (knots[i].radius + knots[next].radius),
        };
        halves.insert(i + 1, middle);
        Edit {
            knots: halves,
            changed: vec![i, i + 1],
        }
    })
}

/// Edits at the start of segment `i` that take numbers away.
pub(super) fn shorter(knots: &[Knot], i: usize) -> Vec<Edit> {
    let count = knots.len();
    let before = (i + count - 1) % count;
    let mut edits = Vec::new();
    let three = [knots[before], knots[i], knots[(i + 1) % count]];
    let angle = Ring::Knots(knots.to_vec()).angle(i);
    // 1. Without the vertex.
    if count > 3 && angle.abs() < 0.5 {
        let places = places(&three);
        let chord = three[2].at - three[0].at;
        let middle = places[places.len() / 2];
        let mut kinds = vec![
            Segment::Line,
            Segment::Arc(bulge_of(three[0].at, three[2].at, middle)),
        ];
        kinds.extend(cubic_along(&places).map(Segment::Cubic));
        // What is far off before it settles is far off afterwards, too.
        let is_near = |segment: &Segment| off(segment, [three[0].at, three[2].at], &places) < FAR;
        for segment in kinds
            .into_iter()
            .filter(|segment| chord.hypot() > 0.3 && is_near(segment))
        {
            let mut knots = knots.to_vec();
            knots[before].segment = segment;
            knots.remove(i);
            let at = if before > i { before - 1 } else { before };
            edits.push(Edit {
                changed: vec![at, (at + 1) % (count - 1)],
                knots,
            });
        }
    }
    // 2. A smooth joint.
    if !knots[i].is_smooth && angle.abs() < 0.5 {
        let mut knots = knots.to_vec();
        knots[i].is_smooth = true;
        edits.push(Edit {
            knots,
            changed: vec![i],
        });
    }
    // 3. A simpler kind of segment.
    let to = three[2].at;
    let mut with = |segment: Segment| {
        let mut knots = knots.to_vec();
        knots[i].segment = segment;
        edits.push(Edit {
            knots,
            changed: vec![i, (i + 1) % count],
        });
    };
    match knots[i].segment {
        Segment::Line => {
            let changed = vec![i, (i + 1) % count];
            edits.extend(along(knots, i).map(|knots| Edit { knots, changed }));
        }
        Segment::Along(_) => {}
        Segment::Arc(bulge) if bulge.abs() < 0.1 => with(Segment::Line),
        Segment::Arc(_) => {}
        Segment::Cubic([c, d]) => {
            let middle = cubic_at([knots[i].at, c, d, to], 0.5);
            with(Segment::Arc(bulge_of(knots[i].at, to, middle)));
            with(Segment::Line);
        }
    }
    edits
}

/// The line behind vertex `i` along the nearer axis, at the middle of its ends, if it is nearly so.
fn along(knots: &[Knot], i: usize) -> Option<Vec<Knot>> {
    let next = (i + 1) % knots.len();
    let [from, to] = [knots[i].at, knots[next].at];
    let way = to - from;
    let axis = usize::from(way.y.abs() > way.x.abs());
    let middle = from.midpoint(to);
    let mut knots = knots.to_vec();
    for k in [i, next] {
        let at = &mut knots[k].at;
        match axis {
            0 => at.y = middle.y,
            _ => at.x = middle.x,
        }
    }
    knots[i].segment = Segment::Along(axis);
    ((knots[i].at - from).hypot() < NEARLY).then_some(knots)
}

/// Largest distance of a new segment from what it replaces, root of the mean of squares, px, at which it is tried: edits that were made
/// began nearer. A guess.
const FAR: f64 = 0.15;

/// The distance of a segment between two points from places, which are at even steps along it, root of the mean of squares, px.
fn off(segment: &Segment, [from, to]: [Point; 2], places: &[Point]) -> f64 {
    let ring = Ring::Knots(vec![
        Knot {
            at: from,
            segment: *segment,
            is_smooth: false,
            radius: 0.0,
        },
        Knot {
            at: to,
            segment: Segment::Line,
            is_smooth: false,
            radius: 0.0,
        },
    ]);
    let curve: Vec<Point> = ring
        .polyline_of(0, &ring.owns())
        .iter()
        .map(|vertex| vertex.at)
        .collect();
    let sum: f64 = places.iter().map(|p| distance2(&curve, *p)).sum();
    (sum / places.len() as f64).sqrt()
}

/// The control points of the cubic that is like a segment.
fn handles(knot: &Knot, to: Point) -> [Point; 2] {
    let chord = to - knot.at;
    match knot.segment {
        Segment::Cubic(controls) => controls,
        Segment::Line | Segment::Along(_) => [knot.at + chord / 3.0, to - chord / 3.0],
        Segment::Arc(bulge) => {
            // The handles of an arc of the angle a and the radius r are 4/3·tan(a/4)·r long, and its chord 2r·sin(a/2).
            let [u, v] = directions(knot, to);
            let square = bulge * bulge;
            let length = (1.0 + square) * (1.0 + square)
                / (3.0 * (1.0 - square).abs().max(0.5) + 3.0 * square);
            let length = length.min(1.0);
            [knot.at + length * u, to - length * v]
        }
    }
}

/// The bulge of the arc between two points near a third one.
fn bulge_of(from: Point, to: Point, on: Point) -> f64 {
    let chord = to - from;
    // The sagitta over half the chord, positive on the side to which (y, −x) points.
    2.0 * (on - from.midpoint(to)).dot(Vec2::new(chord.y, -chord.x)) / chord.hypot2().max(1e-12)
}

fn cubic_at(points: [Point; 4], t: f64) -> Point {
    let sum: Vec2 = weights(t)
        .iter()
        .zip(points)
        .map(|(w, p)| *w * p.to_vec2())
        .sum();
    sum.to_point()
}

/// Places along the two segments of three vertices.
fn places(three: &[Knot; 3]) -> Vec<Point> {
    let ring = Ring::Knots(three.to_vec());
    let owns = ring.owns();
    let both = (0..2).flat_map(|i| ring.polyline_of(i, &owns));
    let places: Vec<Point> = both.map(|vertex| vertex.at).collect();
    // At even steps.
    let mut out = vec![places[0]];
    let all: f64 = places.windows(2).map(|w| (w[1] - w[0]).hypot()).sum();
    const COUNT: usize = 24;
    let (mut done, step) = (0.0, all / COUNT as f64);
    for pair in places.windows(2) {
        let length = (pair[1] - pair[0]).hypot();
        while out.len() < COUNT && step * out.len() as f64 <= done + length {
            let share = (step * out.len() as f64 - done) / length.max(1e-12);
            out.push(pair[0] + share * (pair[1] - pair[0]));
        }
        done += length;
    }
    out.push(three[2].at);
    out
}

/// The control points of the cubic nearest to places, which are at even steps.
fn cubic_along(places: &[Point]) -> Option<[Point; 2]> {
    let (from, to) = (*places.first()?, *places.last()?);
    let last = places.len() - 1;
    let mut shares: Vec<f64> = (0..=last).map(|k| k as f64 / last as f64).collect();
    let mut controls = [from, to];
    for _ in 0..ROUNDS {
        let mut equations = math::Normal::<2>::of(2);
        for (&t, place) in shares.iter().zip(places) {
            let u = 1.0 - t;
            let rest = place.to_vec2() - u * u * u * from.to_vec2() - t * t * t * to.to_vec2();
            equations.add(
                &[(0, 3.0 * u * u * t), (1, 3.0 * u * t * t)],
                [rest.x, rest.y],
                1.0,
            );
        }
        let solution = equations.solve()?;
        controls = [0, 1].map(|k| Point::new(solution[k][0], solution[k][1]));
        // The place nearest to each, by a step of Newton's method.
        let curve = kurbo::CubicBez::new(from, controls[0], controls[1], to);
        for (t, place) in shares.iter_mut().zip(places) {
            let slope =
                kurbo::ParamCurve::eval(&kurbo::ParamCurveDeriv::deriv(&curve), *t).to_vec2();
            let away = kurbo::ParamCurve::eval(&curve, *t) - *place;
            let step = -away.dot(slope) / slope.hypot2().max(1e-12);
            *t = (*t + step.clamp(-0.1, 0.1)).clamp(0.0, 1.0);
        }
    }
    Some(controls)
}

/// Rounds of fitting control points and finding the nearest places. A guess.
const ROUNDS: usize = 6;

/// The corner at vertex `i` between two lines as an arc that begins this far before it.
fn fillet(knots: &[Knot], i: usize, depth: f64) -> Option<Edit> {
    let count = knots.len();
    let [before, next] = [(i + count - 1) % count, (i + 1) % count];
    let are_lines = [before, i]
        .iter()
        .all(|&k| matches!(knots[k].segment, Segment::Line | Segment::Along(_)));
    let [u, v] = [before, next].map(|k| knots[k].at - knots[i].at);
    if !are_lines || u.hypot().min(v.hypot()) < 2.2 * depth {
        return None;
    }
    let [from, to] = [u, v].map(|way| knots[i].at + depth / way.hypot() * way);
    let turn = Ring::Knots(knots.to_vec()).angle(i);
    let mut knots = knots.to_vec();
    let radius = knots[i].radius;
    knots[i] = Knot {
        at: from,
        segment: Segment::Arc(math::tan(0.25 * turn)),
        is_smooth: true,
        radius,
    };
    knots.insert(
        i + 1,
        Knot {
            at: to,
            segment: Segment::Line,
            is_smooth: true,
            radius,
        },
    );
    Some(Edit {
        knots,
        changed: vec![i, i + 1],
    })
}
