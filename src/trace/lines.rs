//! Lines: a skeleton's graph, cleaned of what thinning distorts, as few long runs.
//!
//! Where two lines cross, thinning leaves two branching points with a short edge between them, and at corners it leaves
//! short spurs. Both go. Then, at each node, the two edges that continue each other most straightly become one line,
//! and so on, so that lines run through crossings and end where nothing continues them.

use super::skeleton::{Edge, Graph, Spot};
use crate::math::{self, distance, median};

// All of these are guesses.
/// A hook is thinner than this share of its line's radius, and not longer than so many of its radii.
const HOOK: [f32; 2] = [0.75, 3.0];
/// Nodes closer than this are one, in units of their radii together.
const CROSSING: f32 = 0.75;
/// A spur reaches beyond the disc around its node by less than this, px and in units of that disc's radius.
const SPUR: [f32; 2] = [1.2, 0.35];
/// Lines go on at a node if the cosine of their turn is above this.
const SHARPEST_TURN: f32 = -0.86;
/// A line is smooth at a node if the cosine of its turn there is above this.
const SMOOTH_TURN: f32 = 0.82;

/// Longest edge that two lines share, px, and in radii of its ends.
const SHARED: [f32; 2] = [4.0, 8.0];
/// Least cosine of the turn of a line that goes on through an edge that it shares.
const STRAIGHT: f32 = 0.8;

/// A run of a skeleton from end to end.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) spots: Vec<Spot>,
    pub(super) closed: bool,
}

impl Line {
    /// Drops the hooks that thinning leaves at slanted ends, where the line is much thinner than elsewhere.
    fn trim(&mut self) {
        let Some(usual) = median(self.spots.iter().map(|spot| spot.radius)) else {
            return;
        };
        let hook = |spots: &mut dyn Iterator<Item = &Spot>| {
            let is_thin = |spot: &&Spot| spot.radius < HOOK[0] * usual;
            let thin = spots.take_while(is_thin).count();
            // A longer thin part is a taper, no hook.
            if thin as f32 <= HOOK[1] * usual {
                thin
            } else {
                0
            }
        };
        // The radii of lines this thin tell nothing: they are whole pixels.
        if self.closed || usual < 1.5 {
            return;
        }
        let last = self.spots.len() - hook(&mut self.spots.iter().rev());
        self.spots.truncate(last);
        let first = hook(&mut self.spots.iter());
        self.spots.drain(..first);
    }

    /// The area that a stroke along the line covers, px².
    pub(super) fn area(&self) -> f32 {
        let steps = self.spots.windows(2);
        let sides: f32 = steps
            .map(|w| (w[0].radius + w[1].radius) * distance(w[0].at, w[1].at))
            .sum();
        let cap = |spot: Option<&Spot>| spot.map_or(0.0, |spot| spot.radius * spot.radius);
        let caps = cap(self.spots.first()) + cap(self.spots.last());
        sides + if self.closed { 0.0 } else { 1.57 * caps }
    }
}

/// The lines of a graph.
pub(super) fn lines(mut graph: Graph) -> Vec<Line> {
    graph.clean();
    let mut lines = chain(&graph);
    lines.iter_mut().for_each(|line| line.trim());
    lines
}

impl Graph {
    /// Takes away what thinning adds where lines end and cross.
    pub(super) fn clean(&mut self) {
        // Each makes more of the other: without a spur, a branching point is a place on an edge.
        while prune(self) || contract(self) {}
    }

    /// Makes one node of both ends of each edge that two lines share, as they cross at a small angle.
    pub(super) fn cross(&mut self) {
        while let Some(shared) = self.shared() {
            let reach = 0.5 * self.length(&self.edges[shared]);
            self.make_one(shared, reach);
        }
    }

    /// An edge that two lines share: two pairs of edges at its ends go on straight through it.
    fn shared(&self) -> Option<usize> {
        let runs: Vec<Vec<Spot>> = self.edges.iter().map(|edge| self.run(edge)).collect();
        let is_shared = |i: &usize| {
            let edge = &self.edges[*i];
            let Some([a, b]) = edge.nodes.filter(|[a, b]| a != b) else {
                return false;
            };
            let [from, to] = [a, b].map(|node| self.nodes[node]);
            let length = self.length(edge);
            if length > SHARED[0] + SHARED[1] * from.radius.max(to.radius) {
                return false;
            }
            let leaving = |node: usize| {
                let ends = ends_at(self, node).into_iter().filter(|end| end.0 != *i);
                let ways = ends.map(|end| direction(&runs, end, self.nodes[node]));
                ways.collect::<Vec<_>>()
            };
            let through = math::direction(from.at, to.at);
            let dot = |u: [f32; 2], v: [f32; 2]| u[0] * v[0] + u[1] * v[1];
            let ends = leaving(b);
            let mut pairs: Vec<(usize, usize, f32)> = Vec::new();
            for (k, u) in leaving(a).into_iter().enumerate() {
                for (m, v) in ends.iter().enumerate() {
                    let straight = (-dot(u, *v)).min(-dot(u, through)).min(dot(through, *v));
                    pairs.push((k, m, straight));
                }
            }
            pairs.retain(|pair| pair.2 > STRAIGHT);
            // Two of different edges.
            pairs.iter().enumerate().any(|(n, p)| {
                let mut others = pairs[n + 1..].iter();
                others.any(|q| p.0 != q.0 && p.1 != q.1)
            })
        };
        (0..self.edges.len()).find(is_shared)
    }

    /// The nodes at which several edges meet.
    pub(super) fn crossings(&self) -> impl Iterator<Item = Spot> + '_ {
        let degrees = self.degrees();
        let nodes = self.nodes.iter().zip(degrees);
        nodes
            .filter(|(_, degree)| *degree > 2)
            .map(|(node, _)| *node)
    }

    /// Makes one node of both ends of an edge, with a disc of this radius at least.
    fn make_one(&mut self, edge: usize, radius: f32) {
        let Some([kept, gone]) = self.edges.remove(edge).nodes else {
            return;
        };
        let (a, b) = (self.nodes[kept], self.nodes[gone]);
        let at = [0, 1].map(|k| 0.5 * (a.at[k] + b.at[k]));
        self.nodes[kept] = Spot {
            at,
            radius: a.radius.max(b.radius).max(radius),
        };
        for edge in &mut self.edges {
            for node in edge.nodes.iter_mut().flatten() {
                if *node == gone {
                    *node = kept;
                }
            }
        }
    }

    fn degrees(&self) -> Vec<usize> {
        let mut degrees = vec![0; self.nodes.len()];
        for node in self.edges.iter().filter_map(|edge| edge.nodes).flatten() {
            degrees[node] += 1;
        }
        degrees
    }

    /// The places along an edge, its nodes included.
    fn run(&self, edge: &Edge) -> Vec<Spot> {
        let Some([a, b]) = edge.nodes else {
            return edge.spots.clone();
        };
        let middle = edge.spots.iter().copied();
        let ends = [self.nodes[a], self.nodes[b]];
        std::iter::once(ends[0])
            .chain(middle)
            .chain([ends[1]])
            .collect()
    }

    fn length(&self, edge: &Edge) -> f32 {
        let run = self.run(edge);
        run.windows(2).map(|w| distance(w[0].at, w[1].at)).sum()
    }
}

/// Removes the least of the spurs. Returns whether there was one.
fn prune(graph: &mut Graph) -> bool {
    let [px, radii] = SPUR;
    let degrees = graph.degrees();
    let spur = |edge: &Edge| {
        let [a, b] = edge.nodes?;
        let (end, node) = match (degrees[a], degrees[b]) {
            (1, 3..) => (a, b),
            (3.., 1) => (b, a),
            _ => return None,
        };
        let (end, node) = (graph.nodes[end], graph.nodes[node]);
        let reach = distance(end.at, node.at).max(graph.length(edge) * 0.8);
        let beyond = reach + end.radius - node.radius;
        (beyond < px + radii * node.radius).then_some(beyond)
    };
    let spurs = graph.edges.iter().map(spur).enumerate();
    let spurs = spurs.filter_map(|(i, beyond)| Some((i, beyond?)));
    let Some((least, _)) = spurs.min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return false;
    };
    graph.edges.remove(least);
    true
}

/// Makes one node of two branching points that belong to one crossing. Returns whether there were such.
fn contract(graph: &mut Graph) -> bool {
    let degrees = graph.degrees();
    let is_short = |edge: &Edge| {
        edge.nodes.is_some_and(|[a, b]| {
            let reach = CROSSING * (graph.nodes[a].radius + graph.nodes[b].radius);
            let is_inner = degrees[a] > 2 && degrees[b] > 2;
            is_inner && graph.length(edge) < reach.max(2.0)
        })
    };
    let Some(short) = graph.edges.iter().position(is_short) else {
        return false;
    };
    graph.make_one(short, 0.0);
    true
}

/// One end of an edge.
type End = (usize, bool);

/// The lines along edges that continue each other.
pub(super) fn chain(graph: &Graph) -> Vec<Line> {
    // For each end of an edge, the end that it goes on at, and the cosine of the turn between.
    let runs: Vec<Vec<Spot>> = graph.edges.iter().map(|edge| graph.run(edge)).collect();
    let mut next: Vec<[Option<(End, f32)>; 2]> = vec![[None; 2]; runs.len()];
    for (node, spot) in graph.nodes.iter().enumerate() {
        let ends = ends_at(graph, node);
        for (a, b, turn) in pairs(&runs, &ends, *spot) {
            next[a.0][usize::from(a.1)] = Some((b, turn));
            next[b.0][usize::from(b.1)] = Some((a, turn));
        }
    }
    // Each edge is in one line. A ring without nodes is one by itself.
    let mut seen = vec![false; runs.len()];
    let mut lines = Vec::new();
    for first in 0..runs.len() {
        if seen[first] {
            continue;
        }
        if graph.edges[first].nodes.is_none() {
            seen[first] = true;
            lines.push(Line {
                spots: runs[first].clone(),
                closed: true,
            });
            continue;
        }
        let start = start_of(&next, first);
        lines.push(walk(&runs, &next, start, &mut seen));
    }
    lines
}

fn ends_at(graph: &Graph, node: usize) -> Vec<End> {
    let edges = graph.edges.iter().enumerate();
    let ends = edges.flat_map(|(i, edge)| {
        let [a, b] = edge
            .nodes
            .map_or([false; 2], |nodes| nodes.map(|n| n == node));
        [a.then_some((i, false)), b.then_some((i, true))]
    });
    ends.flatten().collect()
}

/// The direction in which an edge leaves a node, beyond what thinning has distorted.
fn direction(runs: &[Vec<Spot>], (i, is_end): End, node: Spot) -> [f32; 2] {
    let run = &runs[i];
    let reach = 2.2 * node.radius + 2.0;
    let is_far = |spot: &&Spot| distance(spot.at, node.at) > reach;
    let far = if is_end {
        run.iter().rev().find(is_far).or(run.first())
    } else {
        run.iter().find(is_far).or(run.last())
    };
    let to = far.map_or(node.at, |spot| spot.at);
    let away = distance(to, node.at).max(f32::MIN_POSITIVE);
    [0, 1].map(|k| (to[k] - node.at[k]) / away)
}

/// The pairs of ends at a node that continue each other, with the cosines of their turns, the straightest first.
fn pairs(runs: &[Vec<Spot>], ends: &[End], node: Spot) -> Vec<(End, End, f32)> {
    let leaving: Vec<[f32; 2]> = ends.iter().map(|end| direction(runs, *end, node)).collect();
    let mut pairs = Vec::new();
    for (i, a) in leaving.iter().enumerate() {
        for (k, b) in leaving.iter().enumerate().skip(i + 1) {
            pairs.push((ends[i], ends[k], -(a[0] * b[0] + a[1] * b[1])));
        }
    }
    // Two edges that meet alone are one line, however sharp the corner.
    pairs.retain(|pair| ends.len() == 2 || pair.2 > SHARPEST_TURN);
    pairs.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut taken: Vec<End> = Vec::new();
    pairs.retain(|(a, b, _)| {
        let is_free = !taken.contains(a) && !taken.contains(b);
        if is_free {
            taken.extend([*a, *b]);
        }
        is_free
    });
    pairs
}

/// The end that the line through edge `first` starts at. A ring starts at `first`.
fn start_of(next: &[[Option<(End, f32)>; 2]], first: usize) -> End {
    let mut at = (first, false);
    while let Some(((edge, is_end), _)) = next[at.0][usize::from(at.1)] {
        at = (edge, !is_end);
        if edge == first {
            return (first, false);
        }
    }
    at
}

/// The line from `start` on, which goes along edges until nothing continues it.
fn walk(
    runs: &[Vec<Spot>],
    next: &[[Option<(End, f32)>; 2]],
    start: End,
    seen: &mut [bool],
) -> Line {
    let mut spots: Vec<Spot> = Vec::new();
    let mut at = start;
    loop {
        seen[at.0] = true;
        let mut run = runs[at.0].clone();
        if at.1 {
            run.reverse();
        }
        // Two runs share the node between them.
        append(&mut spots, run);
        let leaving = (at.0, !at.1);
        let Some((entering, turn)) = next[leaving.0][usize::from(leaving.1)] else {
            return Line {
                spots,
                closed: false,
            };
        };
        // A skeleton bends at a crossing although the line that it stands for does not.
        if turn > SMOOTH_TURN {
            smooth_over(&mut spots);
        }
        if seen[entering.0] {
            return Line {
                spots,
                closed: true,
            };
        }
        at = entering;
    }
}

/// Appends a run that starts where the line ends.
fn append(spots: &mut Vec<Spot>, run: Vec<Spot>) {
    let Some(&node) = spots.last() else {
        *spots = run;
        return;
    };
    let is_near = |spot: &&Spot| distance(spot.at, node.at) < 0.9 * node.radius;
    let rest = run.iter().skip(1).skip_while(is_near).count();
    let from = run.len() - rest.max(1);
    spots.extend_from_slice(&run[from..]);
}

/// Forgets the places around the node at the end of a line that passes it smoothly: there thinning has distorted them.
fn smooth_over(spots: &mut Vec<Spot>) {
    let Some(node) = spots.last().copied() else {
        return;
    };
    let away = spots
        .iter()
        .rposition(|spot| distance(spot.at, node.at) >= 0.9 * node.radius);
    if let Some(away) = away {
        spots.truncate(away + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::super::shape::shapes;
    use super::*;
    use crate::math::nearest_on_segment;

    /// The lines of the pixels within `reach` of the given segments, in a picture of 80×80 px.
    fn of(segments: &[[[f32; 2]; 2]], reach: f32) -> Vec<Line> {
        let is_near = |i: usize| {
            let p = [(i % 80) as f32 + 0.5, (i / 80) as f32 + 0.5];
            let dist2 = |&ends: &[[f32; 2]; 2]| nearest_on_segment(p, ends).1;
            segments.iter().any(|ends| dist2(ends) < reach * reach)
        };
        let keys: Vec<Option<u8>> = (0..6400).map(|i| is_near(i).then_some(0)).collect();
        let found = shapes(&keys, 80, 4);
        found
            .iter()
            .flat_map(|(_, shape)| lines(Graph::of(shape)))
            .collect()
    }

    fn ends(line: &Line) -> [[f32; 2]; 2] {
        let mut ends = [line.spots[0].at, line.spots[line.spots.len() - 1].at];
        ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
        ends
    }

    fn assert_near(found: [[f32; 2]; 2], wanted: [[f32; 2]; 2], within: f32) {
        for (a, b) in found.into_iter().zip(wanted) {
            assert!(distance(a, b) < within, "{found:?} for {wanted:?}");
        }
    }

    #[test]
    fn a_bar_is_one_line_of_its_radius() {
        for reach in [1.0, 2.5, 6.0] {
            let ends_of_bar = [[15.0, 20.0], [60.0, 50.0]];
            let found = of(&[ends_of_bar], reach);
            assert_eq!(found.len(), 1, "{reach}");
            assert_near(ends(&found[0]), ends_of_bar, 3.0);
            let middle = found[0].spots[found[0].spots.len() / 2];
            assert!(
                (middle.radius - reach).abs() < 0.8,
                "{} of {reach}",
                middle.radius
            );
        }
    }

    #[test]
    fn a_dot_is_a_line_of_no_length() {
        let found = of(&[[[40.0, 40.0], [40.1, 40.0]]], 7.0);
        assert_eq!(found.len(), 1);
        assert_near(ends(&found[0]), [[40.0, 40.0]; 2], 1.5);
    }

    #[test]
    fn lines_run_through_a_crossing() {
        let (a, b) = ([[10.0, 15.0], [70.0, 60.0]], [[12.0, 58.0], [66.0, 12.0]]);
        let mut found = of(&[a, b], 4.0);
        assert_eq!(found.len(), 2);
        found.sort_by(|p, q| ends(p)[0][1].total_cmp(&ends(q)[0][1]));
        assert_near(ends(&found[0]), a, 2.5);
        assert_near(ends(&found[1]), b, 2.5);
    }

    #[test]
    fn a_line_ends_at_the_one_that_it_meets() {
        let found = of(
            &[[[10.0, 20.0], [70.0, 20.0]], [[40.0, 20.0], [40.0, 65.0]]],
            4.0,
        );
        let mut lengths: Vec<f32> = found.iter().map(|l| l.spots.len() as f32).collect();
        lengths.sort_by(f32::total_cmp);
        assert_eq!(found.len(), 2);
        assert!(lengths[0] > 30.0 && lengths[1] > 45.0, "{lengths:?}");
    }

    #[test]
    fn a_corner_joins_two_sides() {
        let found = of(
            &[[[15.0, 60.0], [15.0, 15.0]], [[15.0, 15.0], [60.0, 15.0]]],
            4.0,
        );
        assert_eq!(found.len(), 1);
        assert!(!found[0].closed);
        assert_near(ends(&found[0]), [[15.0, 60.0], [60.0, 15.0]], 2.0);
    }

    #[test]
    fn a_frame_is_closed() {
        let corners = [[15.0, 15.0], [60.0, 18.0], [55.0, 60.0], [12.0, 50.0]];
        let sides = [0, 1, 2, 3].map(|i| [corners[i], corners[(i + 1) % 4]]);
        let found = of(&sides, 3.0);
        assert_eq!(found.len(), 1);
        assert!(found[0].closed);
    }
}
