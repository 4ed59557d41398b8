//! A tour of all strokes, made shorter step by step: parts of it are reversed (2-opt), and up to three neighbours move
//! elsewhere (or-opt), as long as that is shorter and no stroke comes before one that it has to follow.

use std::collections::VecDeque;
use std::ops::RangeInclusive;

use super::nearby::Nearby;
use super::{Spot, Visit, dist};
use crate::scene::{Precedence, Written, WrittenPath};

/// Strokes near each end that a step may make a neighbour. With 5, tours of 1,000 random lines are 1 % longer; with 16 they
/// are as long.
const NEIGHBOURS: usize = 8;

/// Most strokes that move elsewhere together.
const BLOCK: usize = 3;

/// Times that the starts of closed paths are chosen again.
const ROUNDS: usize = 3;

/// A step has to save this much, px, so that rounding never makes two steps undo each other for ever.
const LEAST: f64 = 1e-6;

/// Most visits that all steps may touch, which takes about half a second.
const EFFORT: usize = 200_000_000;

/// An order to draw strokes in.
pub(super) struct Tour<'a> {
    visits: Vec<Visit>,
    /// The place of each stroke in `visits`.
    place: Vec<usize>,
    precedence: &'a Precedence,
    /// Where the pen comes from.
    from: Option<Spot>,
    /// Rest of [`EFFORT`].
    effort: usize,
}

/// A change of the tour.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// Draws what is from one place to another in the opposite order.
    Reverse(usize, usize),
    /// Moves the visits from `first` to `last` between those before and at `gap`.
    Move {
        first: usize,
        last: usize,
        gap: usize,
        is_reversed: bool,
    },
}

impl<'a> Tour<'a> {
    pub(super) fn new(visits: Vec<Visit>, precedence: &'a Precedence, from: Option<Spot>) -> Self {
        let mut tour = Self {
            place: vec![0; visits.len()],
            visits,
            precedence,
            from,
            effort: EFFORT,
        };
        tour.settle(0..=tour.visits.len().saturating_sub(1));
        tour
    }

    pub(super) fn visits(&self) -> &[Visit] {
        &self.visits
    }

    /// Makes the tour of these strokes shorter.
    pub(super) fn improve(&mut self, strokes: &[Written]) {
        for _ in 0..ROUNDS {
            self.descend();
            if !self.choose_starts(strokes) {
                break;
            }
        }
    }

    /// Takes steps until none is left that makes the tour shorter.
    fn descend(&mut self) {
        let near = self.neighbours();
        let mut queue: VecDeque<usize> = self.visits.iter().map(|visit| visit.stroke).collect();
        let mut is_queued = vec![true; self.visits.len()];
        while let Some(stroke) = queue.pop_front() {
            is_queued[stroke] = false;
            while let Some(step) = self.find(stroke, &near[stroke]) {
                for changed in self.around(step) {
                    if !std::mem::replace(&mut is_queued[changed], true) {
                        queue.push_back(changed);
                    }
                }
                self.take(step);
            }
            if self.effort == 0 {
                return;
            }
        }
    }

    /// For each stroke, those with an end near one of its ends.
    fn neighbours(&self) -> Vec<Vec<usize>> {
        let spots: Vec<Spot> = self.visits.iter().flat_map(|visit| visit.ends).collect();
        let mut nearby = Nearby::over(&spots);
        for visit in &self.visits {
            let [from, to] = visit.ends;
            nearby.put(from, visit.stroke);
            if to != from {
                nearby.put(to, visit.stroke);
            }
        }
        let of_stroke = |stroke: usize| {
            let visit = self.visits[self.place[stroke]];
            let ends = visit.ends.into_iter();
            let near = ends.flat_map(|end| nearby.nearest(end, NEIGHBOURS, |&k| k != stroke));
            let mut near: Vec<usize> = near.map(|(_, other)| other).collect();
            near.sort_unstable();
            near.dedup();
            near
        };
        (0..self.visits.len()).map(of_stroke).collect()
    }

    /// A step that puts the stroke beside one of those `near` and makes the tour shorter.
    fn find(&mut self, stroke: usize, near: &[usize]) -> Option<Step> {
        let at = self.place[stroke];
        for &other in near {
            let beside = self.place[other];
            for step in reversals(at, beside).chain(moves(at, beside, self.visits.len())) {
                if self.saved(step) > LEAST && self.is_allowed(step) {
                    return Some(step);
                }
            }
        }
        None
    }

    /// Where the pen is lifted before place `i`.
    fn lifted(&self, i: usize) -> Option<Spot> {
        match i.checked_sub(1) {
            Some(before) => self.visits.get(before).map(|visit| visit.ends[1]),
            None => self.from,
        }
    }

    /// Where the pen is set down at place `i`.
    fn set_down(&self, i: usize) -> Option<Spot> {
        self.visits.get(i).map(|visit| visit.ends[0])
    }

    /// By how much the step makes the tour shorter, px.
    fn saved(&self, step: Step) -> f64 {
        let way = |a: Option<Spot>, b: Option<Spot>| a.zip(b).map_or(0.0, |(a, b)| dist(a, b));
        match step {
            Step::Reverse(first, last) => {
                let (before, after) = (self.lifted(first), self.set_down(last + 1));
                let (from, to) = (self.set_down(first), self.lifted(last + 1));
                way(before, from) + way(to, after) - way(before, to) - way(from, after)
            }
            Step::Move {
                first,
                last,
                gap,
                is_reversed,
            } => {
                let (before, after) = (self.lifted(first), self.set_down(last + 1));
                let (from, to) = (self.set_down(first), self.lifted(last + 1));
                let (left, right) = (self.lifted(gap), self.set_down(gap));
                let [head, tail] = if is_reversed { [to, from] } else { [from, to] };
                let removed = way(before, from) + way(to, after) - way(before, after);
                removed + way(left, right) - way(left, head) - way(tail, right)
            }
        }
    }

    /// True if no stroke comes before one that it has to follow.
    fn is_allowed(&mut self, step: Step) -> bool {
        match step {
            Step::Reverse(first, last) => self.may_reverse(first..=last),
            Step::Move {
                first,
                last,
                gap,
                is_reversed,
            } => {
                let others = if gap > last {
                    last + 1..=gap - 1
                } else {
                    gap..=first - 1
                };
                let has_to_stay = |i: usize| {
                    let stroke = self.visits[i].stroke;
                    let bound = match gap > last {
                        true => self.precedence.above(stroke),
                        false => self.precedence.below(stroke),
                    };
                    bound
                        .iter()
                        .any(|&other| others.contains(&self.place[other]))
                };
                !(first..=last).any(has_to_stay) && (!is_reversed || self.may_reverse(first..=last))
            }
        }
    }

    /// True if the order of the visits in this range does not matter.
    fn may_reverse(&mut self, mut range: RangeInclusive<usize>) -> bool {
        let all = range.clone();
        let bound = range.position(|i| {
            let above = self.precedence.above(self.visits[i].stroke);
            above.iter().any(|&other| all.contains(&self.place[other]))
        });
        let looked_at = bound.unwrap_or(all.end() - all.start()) + 1;
        self.effort = self.effort.saturating_sub(looked_at);
        bound.is_none()
    }

    /// The strokes that get other neighbours by the step.
    fn around(&self, step: Step) -> Vec<usize> {
        let ends = match step {
            Step::Reverse(first, last) => [first, last, first, last],
            Step::Move {
                first, last, gap, ..
            } => [first, last, gap, gap],
        };
        let places = ends.iter().flat_map(|&i| [i.saturating_sub(1), i, i + 1]);
        let visits = places.filter_map(|i| self.visits.get(i));
        visits.map(|visit| visit.stroke).collect()
    }

    fn take(&mut self, step: Step) {
        let changed = match step {
            Step::Reverse(first, last) => {
                self.reverse(first..=last);
                first..=last
            }
            Step::Move {
                first,
                last,
                gap,
                is_reversed,
            } => {
                if is_reversed {
                    self.reverse(first..=last);
                }
                let count = last + 1 - first;
                if gap > last {
                    self.visits[first..gap].rotate_left(count);
                    first..=gap - 1
                } else {
                    self.visits[gap..=last].rotate_right(count);
                    gap..=last
                }
            }
        };
        self.settle(changed);
    }

    fn reverse(&mut self, range: RangeInclusive<usize>) {
        let part = &mut self.visits[range];
        part.reverse();
        part.iter_mut().for_each(|visit| *visit = visit.flipped());
    }

    /// Takes down the places of the visits in this range.
    fn settle(&mut self, range: RangeInclusive<usize>) {
        self.effort = self.effort.saturating_sub(range.end() + 1 - range.start());
        for i in range {
            if let Some(visit) = self.visits.get(i) {
                self.place[visit.stroke] = i;
            }
        }
    }

    /// Lets each closed path begin where that is nearest to what comes before and after. Returns whether any changes.
    fn choose_starts(&mut self, strokes: &[Written]) -> bool {
        let mut changes = false;
        for i in 0..self.visits.len() {
            let now = self.visits[i];
            let mark = &strokes[now.stroke];
            if !mark.paths.first().is_some_and(WrittenPath::is_closed) {
                continue;
            }
            let neighbours = [self.lifted(i), self.set_down(i + 1)];
            let way = |visit: &Visit| {
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

/// The reversals that make the visits at the two places neighbours.
fn reversals(a: usize, b: usize) -> impl Iterator<Item = Step> {
    let (first, last) = (a.min(b), a.max(b));
    [(first + 1, last), (first, last - 1)]
        .into_iter()
        .map(|(first, last)| Step::Reverse(first, last))
}

/// The moves of the visit at place `at`, alone or with neighbours, to one side of that at `beside`, in a tour of `count`.
fn moves(at: usize, beside: usize, count: usize) -> impl Iterator<Item = Step> {
    let blocks = (0..BLOCK).flat_map(move |more| {
        let forward = (at + more < count).then_some((at, at + more));
        let back = at.checked_sub(more).filter(|_| more > 0);
        [forward, back.map(|first| (first, at))]
            .into_iter()
            .flatten()
    });
    blocks
        .filter(move |(first, last)| !(first..=last).contains(&&beside))
        .flat_map(move |(first, last)| {
            let gaps = [beside, beside + 1].into_iter();
            let gaps = gaps.filter(move |&gap| gap < first || gap > last + 1);
            gaps.flat_map(move |gap| {
                [false, true].map(|is_reversed| Step::Move {
                    first,
                    last,
                    gap,
                    is_reversed,
                })
            })
        })
}
