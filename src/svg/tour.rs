//! Little travel: the order in which a pen draws the strokes of a layer with short ways between them.
//!
//! Two strokes keep their order if the picture depends on it. An open path may be drawn from either end, and a closed one from
//! any of its points. The tour begins greedily with the nearest end among the strokes that may be drawn; then parts of it
//! are reversed (2-opt: Croes, "A method for solving traveling-salesman problems", Operations Research 6, 1958) and up to three
//! neighbours move elsewhere (or-opt), as long as that shortens it.
//!
//! Antialiased edges of one colour that lie over each other may come out one 8-bit level different, because
//! renderers round after every stroke; and resvg, which bends curves within 1/4 px, does so in another way from their
//! other end.

use std::collections::BTreeSet;
use std::ops::Range;

use super::layer::Written;
use crate::math::Point;
use crate::scene::{Mark, Path, PathPoint, Precedence, UNITS_PER_PX, units};

/// Pairs of places that a pass looks at, at most: all pairs of a tour of 2,000 strokes. A guess.
const PAIRS: usize = 2_000_000;

/// Passes at most. Most tours settle in fewer.
const PASSES: usize = 12;

/// Most strokes that move elsewhere together. Without these moves, tours of 1,000 to 1,440 strokes are 12 % longer.
const BLOCK: usize = 3;

/// A change has to save this much, px, so that rounding never makes two changes undo each other for ever.
const LEAST: f64 = 1e-6;

/// The strokes in an order of little travel, for a pen that comes `from` a point. The picture does not change.
pub(super) fn shortened(strokes: &[Written], from: Option<Spot>) -> Vec<Written> {
    let precedence = Precedence::of(strokes.iter().map(|stroke| &stroke.mark));
    let mut tour = Tour::nearest_first(strokes, &precedence, from);
    tour.improve(strokes);
    let visits = tour.visits.iter();
    visits
        .map(|visit| visit.drawn(&strokes[visit.stroke]))
        .collect()
}

/// Where a pen is when it has drawn these strokes.
pub(super) fn end(strokes: &[Written]) -> Option<Spot> {
    strokes.last().map(|stroke| ends_of(stroke)[1])
}

/// Travel between strokes in this order, px.
pub(super) fn between(strokes: &[Written]) -> f64 {
    let ends: Vec<_> = strokes.iter().map(ends_of).collect();
    ends.windows(2).map(|w| dist(w[0][1], w[1][0])).sum()
}

/// A point of the page, in units.
pub(super) type Spot = [i64; 2];

/// Distance of two points, px.
fn dist(a: Spot, b: Spot) -> f64 {
    dist2(a, b).sqrt() / UNITS_PER_PX as f64
}

/// Squared distance of two points, in units.
fn dist2([ax, ay]: Spot, [bx, by]: Spot) -> f64 {
    let (dx, dy) = ((bx - ax) as f64, (by - ay) as f64);
    dx * dx + dy * dy
}

/// Where a pen is set down and lifted to draw the first path of a mark, which all others follow.
fn ends_of(mark: &Written) -> [Spot; 2] {
    mark.paths()
        .first()
        .map_or([[0; 2]; 2], |path| ends(path, 0))
}

/// Where a pen is set down and lifted to draw the path; a closed one from its point `start`, or, if that is off the path, from
/// between it and the previous one.
fn ends(path: &Path, start: usize) -> [Spot; 2] {
    let points = path.points();
    let (Some(first), Some(last)) = (points.get(start), points.last()) else {
        return [[0; 2]; 2];
    };
    if !path.is_closed() {
        return [first, last].map(|p| spot(p.at));
    }
    let previous = &points[(start + points.len() - 1) % points.len()];
    // Between two off-points the path begins at the implied point halfway.
    let other = if first.is_on() { first } else { previous };
    [spot(first.at.midpoint(other.at)); 2]
}

fn spot(p: Point) -> Spot {
    [units(p.x), units(p.y)]
}

/// A way to draw a stroke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Visit {
    /// Where the pen is set down and lifted.
    ends: [Spot; 2],
    /// The index of the stroke.
    stroke: usize,
    /// The point of a closed path that it begins at.
    start: usize,
    /// True if an open path is drawn from its last point.
    is_reversed: bool,
}

impl Visit {
    /// All ways to draw a mark: an area begins with its first ring, a shape and the outline of a line where their elements say.
    fn all(stroke: usize, mark: &Written) -> Vec<Self> {
        let Some(path) = mark.paths().first() else {
            return Vec::new();
        };
        let beginning_at = |start: usize| Self {
            ends: ends(path, start),
            stroke,
            start,
            is_reversed: false,
        };
        let forward = beginning_at(0);
        let is_fixed = mark.shape().is_some() || mark.line().is_some();
        if is_fixed || path.points().len() == 1 {
            return vec![forward];
        }
        if !path.is_closed() {
            return vec![forward, forward.flipped()];
        }
        // An implied start would have to be written; a ring without on-points has no other.
        let all_off = !path.points().iter().any(PathPoint::is_on);
        let starts = (0..path.points().len()).filter(|&i| all_off || path.points()[i].is_on());
        starts.map(beginning_at).collect()
    }

    /// This stroke, drawn the other way.
    fn flipped(self) -> Self {
        let [from, to] = self.ends;
        Self {
            is_reversed: !self.is_reversed,
            ends: [to, from],
            ..self
        }
    }

    /// The stroke, drawn in this way.
    fn drawn(&self, stroke: &Written) -> Written {
        let mut drawn = stroke.clone();
        if stroke.line().is_some() {
            return drawn;
        }
        let path = match &mut drawn.mark {
            Mark::Stroke(stroke) => Some(&mut stroke.path),
            Mark::Area(area) => area.rings.first_mut(),
        };
        if let Some(path) = path.filter(|path| path.shape().is_none()) {
            if path.is_closed() {
                let mut points = path.points().to_vec();
                points.rotate_left(self.start);
                *path = Path::canonical(points, true);
            } else if self.is_reversed {
                *path = path.turned();
            }
        }
        drawn
    }
}

/// An order to draw strokes in.
struct Tour<'a> {
    visits: Vec<Visit>,
    /// The place of each stroke in `visits`.
    place: Vec<usize>,
    precedence: &'a Precedence,
    /// Where the pen comes from.
    from: Option<Spot>,
}

impl<'a> Tour<'a> {
    /// The greedy tour: it goes on to the nearest end of a stroke that may be drawn.
    fn nearest_first(strokes: &[Written], precedence: &'a Precedence, from: Option<Spot>) -> Self {
        let mut tour = Self {
            visits: Vec::with_capacity(strokes.len()),
            place: vec![0; strokes.len()],
            precedence,
            from,
        };
        let mut waiting = precedence.waiting();
        let mut free = waiting.free();
        // The ways to draw a stroke that may be drawn, from left to right.
        let mut ready: BTreeSet<Visit> = BTreeSet::new();
        loop {
            // A stroke joins the choice once all below it are drawn.
            ready.extend(free.iter().flat_map(|&i| Visit::all(i, &strokes[i])));
            let at = tour.lifted(tour.visits.len()).unwrap_or_default();
            let Some(next) = nearest(&ready, at) else {
                return tour;
            };
            // One way was chosen; the others of this stroke go.
            for way in Visit::all(next.stroke, &strokes[next.stroke]) {
                ready.remove(&way);
            }
            tour.place[next.stroke] = tour.visits.len();
            tour.visits.push(next);
            free = waiting.draw(next.stroke);
        }
    }

    /// Makes the tour of these strokes shorter until no change is left that does so.
    fn improve(&mut self, strokes: &[Written]) {
        let count = self.visits.len();
        // Long tours look less far ahead, so that a pass takes about the same time.
        let window = PAIRS / count.max(1) + 1;
        for _ in 0..PASSES {
            let mut changes = false;
            for first in 0..count {
                let stop = count.min(first + window);
                // The end of the longest part from `first` on whose order does not matter.
                let bound = |tour: &Self| {
                    let mut rest = first + 1..stop;
                    rest.find(|&i| tour.has_to_follow(i, first..i))
                        .unwrap_or(stop)
                };
                // No two strokes of a reversed part may have to keep their order: the part ends before the first that does.
                let mut end = bound(self);
                for last in first..stop {
                    // 2-opt: the part is drawn backwards.
                    if last < end && self.reversal_saves(first, last) > LEAST {
                        self.reverse(first..last + 1);
                        changes = true;
                    }
                    // Or-opt: the first or the last one to three of the part move to its other end.
                    let reach = BLOCK.min(last - first);
                    for middle in (1..=reach).flat_map(|n| [first + n, last + 1 - n]) {
                        // The saving is cheaper to compute than the precedence, and rules out most.
                        if self.swap_saves(first, middle, last) > LEAST
                            && (middle..=last).all(|i| !self.has_to_follow(i, first..middle))
                        {
                            self.visits[first..=last].rotate_left(middle - first);
                            self.take_places(first..last + 1);
                            // Other strokes lie behind `first` now.
                            end = bound(self);
                            changes = true;
                        }
                    }
                }
            }
            // No short-circuit: starts are chosen in every pass, and a new start may make other changes pay.
            if !(self.choose_starts(strokes) | changes) {
                break;
            }
        }
    }

    /// True if the visit at place `i` has to follow one of those at `places`.
    fn has_to_follow(&self, i: usize, places: Range<usize>) -> bool {
        let mut below = self.precedence.below(self.visits[i].stroke).iter();
        below.any(|&other| places.contains(&self.place[other]))
    }

    /// Where the pen is lifted before place `i`.
    fn lifted(&self, i: usize) -> Option<Spot> {
        let before = i.checked_sub(1).map(|before| self.visits[before].ends[1]);
        before.or(self.from)
    }

    /// Where the pen is set down at place `i`.
    fn set_down(&self, i: usize) -> Option<Spot> {
        self.visits.get(i).map(|visit| visit.ends[0])
    }

    /// Travel from the visit before place `i` to the visit at place `k`, px.
    fn way(&self, i: usize, k: usize) -> f64 {
        way(self.lifted(i), self.set_down(k))
    }

    /// Travel that the reversal of the part from `first` to `last` saves, px.
    fn reversal_saves(&self, first: usize, last: usize) -> f64 {
        // Only the ways at both ends of the part change; those inside it are the same backwards.
        let old = self.way(first, first) + self.way(last + 1, last + 1);
        old - way(self.lifted(first), self.lifted(last + 1))
            - way(self.set_down(first), self.set_down(last + 1))
    }

    /// Travel saved if the part from `first` on and the part from `middle` to `last` change places, px.
    fn swap_saves(&self, first: usize, middle: usize, last: usize) -> f64 {
        let after = last + 1;
        // Three ways change: into the first part, between the two, and out of the second.
        let old = self.way(first, first) + self.way(middle, middle) + self.way(after, after);
        old - self.way(first, middle) - self.way(after, first) - self.way(middle, after)
    }

    fn reverse(&mut self, part: Range<usize>) {
        let visits = &mut self.visits[part.clone()];
        visits.reverse();
        visits.iter_mut().for_each(|visit| *visit = visit.flipped());
        self.take_places(part);
    }

    fn take_places(&mut self, part: Range<usize>) {
        for i in part {
            self.place[self.visits[i].stroke] = i;
        }
    }

    /// Lets each closed path begin where that is nearest to what comes before and after. Returns whether any changes.
    fn choose_starts(&mut self, strokes: &[Written]) -> bool {
        let mut changes = false;
        for i in 0..self.visits.len() {
            let now = self.visits[i];
            let mark = &strokes[now.stroke];
            if !mark.paths().first().is_some_and(Path::is_closed) {
                continue;
            }
            let neighbours = [self.lifted(i), self.set_down(i + 1)];
            let way = |visit: &Visit| {
                // A closed path is lifted where it was set down, so one point decides both ways.
                let spots = neighbours.iter().flatten();
                spots.map(|&spot| dist(spot, visit.ends[0])).sum::<f64>()
            };
            let ways = Visit::all(now.stroke, mark).into_iter();
            let best = ways.min_by(|a, b| way(a).total_cmp(&way(b)));
            if let Some(best) = best.filter(|best| way(best) + LEAST < way(&now)) {
                self.visits[i] = best;
                changes = true;
            }
        }
        changes
    }
}

/// Travel from one point to another, px; none from where the pen is not.
fn way(a: Option<Spot>, b: Option<Spot>) -> f64 {
    a.zip(b).map_or(0.0, |(a, b)| dist(a, b))
}

/// The visit that begins nearest to a point.
fn nearest(ready: &BTreeSet<Visit>, at: Spot) -> Option<Visit> {
    // Visits are sorted by x. The search goes right and left from here, and stops where x alone is farther than the best.
    let pivot = Visit {
        ends: [at, [i64::MIN; 2]],
        stroke: 0,
        start: 0,
        is_reversed: false,
    };
    let mut best: Option<(f64, Visit)> = None;
    let mut look = |visits: &mut dyn Iterator<Item = &Visit>| {
        for &visit in visits {
            let [begin, _] = visit.ends;
            // All that follow are farther along the x axis alone.
            if best.is_some_and(|(least2, _)| dist2(at, [begin[0], at[1]]) > least2) {
                break;
            }
            let away2 = dist2(at, begin);
            if best.is_none_or(|(least2, _)| away2 < least2) {
                best = Some((away2, visit));
            }
        }
    };
    look(&mut ready.range(pivot..));
    look(&mut ready.range(..pivot).rev());
    best.map(|(_, visit)| visit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng;
    use crate::scene::{Cap, Stroke, color};

    fn path(points: &[[i64; 2]], closed: bool) -> Path {
        let on = |p: &[i64; 2]| PathPoint::on(Point::new(p[0] as f64, p[1] as f64));
        Path::canonical(points.iter().map(on).collect(), closed)
    }

    fn stroke_of(path: Path, level: u8, radius: f64, opacity: f32) -> Written {
        let stroke = Stroke {
            path,
            radius,
            radii: Vec::new(),
            cap: Cap::Round,
            color: color([level; 3]),
            opacity,
        };
        Mark::from(stroke).into()
    }

    fn stroke(path: Path, level: u8) -> Written {
        stroke_of(path, level, 1.0, 1.0)
    }

    /// Lines of 5 px at random places of a square, of so many colours.
    fn lines(count: usize, side: i64, colors: u64) -> Vec<Written> {
        let draw = |i: usize, k: u64| i64::from(rng::bits(5, 0, i as u64, k) as u32 >> 8);
        let line = |i: usize| {
            let at = [draw(i, 0) % side, draw(i, 1) % side];
            let to = [at[0] + draw(i, 2) % 11 - 5, at[1] + draw(i, 3) % 11 - 5];
            stroke(
                path(&[at, to], false),
                (rng::bits(5, 1, i as u64, 0) % colors) as u8,
            )
        };
        (0..count).map(line).collect()
    }

    #[test]
    fn the_pen_goes_on_at_the_nearest_end() {
        let strokes = [
            stroke(path(&[[10, 0], [0, 0]], false), 0),
            stroke(path(&[[40, 0], [50, 0]], false), 0),
            stroke(path(&[[39, 0], [11, 0]], false), 0),
        ];
        let drawn = shortened(&strokes, Some([0, 0]));
        assert_eq!(between(&drawn), 2.0);
        let starts: Vec<_> = drawn
            .iter()
            .map(|s| ends_of(s)[0][0] / UNITS_PER_PX)
            .collect();
        assert_eq!(starts, [0, 11, 40]);
    }

    #[test]
    fn a_closed_path_begins_where_the_pen_comes_from() {
        let square = path(&[[50, 50], [50, 20], [20, 20], [20, 50]], true);
        let line = path(&[[0, 20], [19, 20]], false);
        let drawn = shortened(&[stroke(square, 0), stroke(line, 0)], None);
        assert_eq!(between(&drawn), 1.0);
        let closed = drawn
            .iter()
            .flat_map(Written::paths)
            .find(|path| path.is_closed());
        assert_eq!(closed.map(|path| path.points().len()), Some(4));
    }

    #[test]
    fn a_tour_of_many_lines_is_near_the_shortest() {
        let strokes = lines(1000, 1000, 1);
        let before = between(&strokes);
        let after = between(&shortened(&strokes, None));
        // The shortest tour of n points in a square of side a has about 0.7124·√n·a.
        assert!(after < 0.044 * before, "{after} of {before}");
    }

    #[test]
    fn strokes_that_meet_keep_their_order_unless_they_are_alike() {
        // Widths tell strokes apart.
        let strokes: Vec<Written> = lines(420, 100, 3)
            .into_iter()
            .enumerate()
            .map(|(i, line)| {
                let opacity = if i % 7 == 0 { 100.0 / 255.0 } else { 1.0 };
                let radius = 1.0 + 1e-6 * i as f64;
                stroke_of(line.paths()[0].clone(), line.color()[0], radius, opacity)
            })
            .collect();
        let drawn = shortened(&strokes, None);
        assert!(between(&drawn) < 0.7 * between(&strokes));
        let place = |stroke: &Written| drawn.iter().position(|s| s.width() == stroke.width());
        let mut pairs = 0;
        for (i, below) in strokes.iter().enumerate() {
            for above in &strokes[i + 1..] {
                if below.mark.meets(&above.mark) && below.color() != above.color() {
                    assert!(place(below) < place(above), "{below:?} {above:?}");
                    pairs += 1;
                }
            }
        }
        assert!(pairs > 500, "{pairs}");
    }
}
