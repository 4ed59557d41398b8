//! Greedy agglomeration: it repeatedly merges the two groups of strokes whose common colour and width add the least
//! squared error, up to a number of merges or a squared error.
//!
//! With the weights `u` and `v`, a mean of two values `a` and `b` adds `u·v / (u + v) · (a − b)²` (Ward, "Hierarchical
//! grouping to optimize an objective function", Journal of the American Statistical Association 58, 1963). All costs are
//! in one queue. A cost is out of date once one of its groups has grown; the grown group has a new one in the queue then.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f32::consts::TAU;

use super::width_grid::WidthGrid;
use crate::math;
use crate::render::StrokeRef;
use crate::scene::Rgb;

/// Squared contrast at the edge of a typical stroke, summed over the channels: the cost of 1 px of wrong radius for each px of edge.
/// Half, twice: +0.02, −0.04 dB and −0.7, −0.4 % of the bytes.
pub(super) const CONTRAST: f32 = 0.02;

/// Strokes that share a colour and a width.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// Indices of its strokes; the one that it began with comes first.
    pub(super) members: Vec<usize>,
    pub(super) color: Rgb,
    /// Growth of the squared error with the squared distance from the colour.
    pub(super) color_weight: f32,
    pub(super) radius: f32,
    /// Growth of the squared error with the squared distance from the radius, in units of [`Rule::contrast`].
    pub(super) radius_weight: f32,
}

/// Limits of merging.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rule<'a> {
    /// Most merges.
    pub(super) merges: usize,
    /// Most squared error that all merges may add, estimated in advance.
    pub(super) allowance: f32,
    /// Factor on the cost of radii.
    pub(super) contrast: f32,
    /// True if only groups of one colour are merged.
    pub(super) keeps_colors: bool,
    /// Number of groups to either side, in the order that they are given in, that a group may be merged with.
    pub(super) reach: usize,
    /// The radii that groups may have.
    pub(super) grid: WidthGrid<'a>,
}

impl Group {
    /// The squared error that one colour and one width for both would add.
    fn cost(&self, other: &Self, contrast: f32) -> f32 {
        // Ward's cost of a common mean, for colour and radius separately: uv / (u + v) · (a − b)².
        let both = |a: f32, b: f32| a * b / (a + b).max(f32::MIN_POSITIVE);
        let channels = self.color.iter().zip(other.color);
        let away2: f32 = channels.map(|(a, b)| (a - b) * (a - b)).sum();
        let wider2 = math::powi(self.radius - other.radius, 2);
        both(self.color_weight, other.color_weight) * away2
            + contrast * both(self.radius_weight, other.radius_weight) * wider2
    }

    /// Merges `other` into this group, which gets the weighted means of both.
    pub(super) fn join(&mut self, other: Self, grid: WidthGrid<'_>) {
        let mean =
            |a: f32, b: f32, [u, v]: [f32; 2]| (a * u + b * v) / (u + v).max(f32::MIN_POSITIVE);
        let weights = [self.color_weight, other.color_weight];
        // A mean of equal values may differ from them in the last bit.
        if self.color != other.color && weights != [0.0; 2] {
            self.color = [0, 1, 2].map(|c| mean(self.color[c], other.color[c], weights));
        }
        if self.radius != other.radius {
            let weights = [self.radius_weight, other.radius_weight];
            self.radius = grid.nearest(mean(self.radius, other.radius, weights));
        }
        self.color_weight += other.color_weight;
        self.radius_weight += other.radius_weight;
        self.members.extend(other.members);
    }
}

/// Merges `groups` by `rule`. `join` gets the first strokes of both groups of each merge, and may refuse it.
pub(super) fn merge(
    groups: Vec<Group>,
    rule: Rule<'_>,
    mut join: impl FnMut(usize, usize) -> bool,
) -> Vec<Group> {
    let mut queue = Queue {
        groups: groups.into_iter().map(Some).collect(),
        pairs: BinaryHeap::new(),
        rule,
    };
    for i in 0..queue.groups.len() {
        queue.offer(
            i,
            i + 1..(i + 1).saturating_add(rule.reach).min(queue.groups.len()),
        );
    }
    let (mut merges, mut left) = (0, rule.allowance);
    while merges < rule.merges
        && let Some((cost, i, k)) = queue.cheapest()
        && cost <= left
    {
        let [first, second] = [i, k].map(|i| queue.first_stroke(i));
        if !join(first, second) {
            continue;
        }
        left -= cost;
        merges += 1;
        // The lower index stays. Pairs with the old groups remain in the queue, and their sizes show that they are out of date.
        if let (Some(other), Some(group)) = (queue.groups[k].take(), queue.groups[i].as_mut()) {
            group.join(other, rule.grid);
        }
        queue.offer(i, queue.near(i));
    }
    queue.groups.into_iter().flatten().collect()
}

/// A cost, as its bits; the places of both groups; and how many strokes they had.
type Pair = (u32, usize, usize, [usize; 2]);

/// The groups, `None` for one that was merged into another, and the pairs that may be merged, the cheapest first.
struct Queue<'a> {
    groups: Vec<Option<Group>>,
    pairs: BinaryHeap<Reverse<Pair>>,
    rule: Rule<'a>,
}

impl Queue<'_> {
    /// The groups that group `i` may be merged with.
    fn near(&self, i: usize) -> Vec<usize> {
        let is_left = |k: &usize| self.groups[*k].is_some();
        // Merged groups don't count: a group's neighbours are the nearest that are left.
        let below = (0..i).rev().filter(is_left).take(self.rule.reach);
        let above = (i + 1..self.groups.len()).filter(is_left);
        below.chain(above.take(self.rule.reach)).collect()
    }

    /// Puts the pairs of group `i` and `others` into the queue.
    fn offer(&mut self, i: usize, others: impl IntoIterator<Item = usize>) {
        for other in others {
            let (i, k) = (i.min(other), i.max(other));
            if let (Some(a), Some(b)) = (&self.groups[i], &self.groups[k])
                && (a.color == b.color || !self.rule.keeps_colors)
            {
                // Costs are not negative, so that their bits sort like their values.
                let cost = a.cost(b, self.rule.contrast).to_bits();
                let sizes = [a.members.len(), b.members.len()];
                self.pairs.push(Reverse((cost, i, k, sizes)));
            }
        }
    }

    /// Takes the pair of least cost that is up to date.
    fn cheapest(&mut self) -> Option<(f32, usize, usize)> {
        let size = |group: &Option<Group>| group.as_ref().map_or(0, |group| group.members.len());
        while let Some(Reverse((cost, i, k, sizes))) = self.pairs.pop() {
            // Groups only grow, so a group of the same size is the same group.
            if [i, k].map(|i| size(&self.groups[i])) == sizes {
                return Some((f32::from_bits(cost), i, k));
            }
        }
        None
    }

    fn first_stroke(&self, i: usize) -> usize {
        let members = self.groups[i].as_ref().map(|group| &group.members);
        members
            .and_then(|members| members.first().copied())
            .unwrap_or(i)
    }
}

/// Length of a stroke's outline, px.
pub(super) fn outline(stroke: StrokeRef<'_>) -> f32 {
    2.0 * stroke.length() + TAU * stroke.radius()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULE: Rule<'_> = Rule {
        merges: usize::MAX,
        allowance: f32::INFINITY,
        contrast: 1.0,
        keeps_colors: false,
        reach: usize::MAX,
        grid: WidthGrid::Any,
    };

    /// The members of the groups that strokes of these radii and weights are merged to.
    fn merged(strokes: &[(f32, f32)], rule: Rule<'_>) -> Vec<Vec<usize>> {
        let strokes = strokes.iter().enumerate();
        let group = |(i, &(radius, radius_weight)): (usize, &(f32, f32))| Group {
            members: vec![i],
            color: [0.0; 3],
            color_weight: 0.0,
            radius,
            radius_weight,
        };
        let groups = merge(strokes.map(group).collect(), rule, |_, _| true);
        groups.into_iter().map(|group| group.members).collect()
    }

    #[test]
    fn the_cheapest_pairs_are_merged_until_the_allowance_is_used() {
        let strokes = [(1.0, 2.0), (5.0, 2.0), (1.1, 2.0), (5.4, 2.0)];
        let rule = |allowance| Rule { allowance, ..RULE };
        assert_eq!(merged(&strokes, rule(0.005)).len(), 4);
        assert_eq!(merged(&strokes, rule(0.02)).len(), 3);
        assert_eq!(merged(&strokes, rule(0.2)), [[0, 2], [1, 3]]);
    }

    #[test]
    fn only_groups_within_reach_are_merged() {
        let strokes = [(1.0, 1.0), (5.0, 1.0), (1.1, 1.0)];
        let one = |reach| {
            let rule = Rule {
                merges: 1,
                reach,
                ..RULE
            };
            merged(&strokes, rule)
        };
        assert_eq!(one(1), [vec![0], vec![1, 2]]);
        assert_eq!(one(2), [vec![0, 2], vec![1]]);
    }
}
