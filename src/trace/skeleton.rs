//! Skeletons: the pixels in the middle of a shape, as a graph of nodes and edges.
//!
//! Pixels are taken away from the outside to the inside, as long as the shape stays connected and the ends of its
//! lines stay. What is left is one pixel wide.

use std::collections::BTreeMap;

use super::shape::Shape;

/// Growth of the distance to the outside towards the middle of a shape from a place that is no end of a line, px per px. A guess.
const GROWTH: f32 = 0.75;

/// A place on the skeleton, px of the picture, and the radius of the largest disc around it within the shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    pub(super) at: [f32; 2],
    pub(super) radius: f32,
}

/// A run of the skeleton between two nodes.
#[derive(Debug, Clone)]
pub(super) struct Edge {
    /// The nodes at start and end; a ring has none.
    pub(super) nodes: Option<[usize; 2]>,
    /// From the start to the end, without the nodes.
    pub(super) spots: Vec<Spot>,
}

/// A skeleton: its ends and branching points are nodes.
#[derive(Debug, Default)]
pub(super) struct Graph {
    pub(super) nodes: Vec<Spot>,
    pub(super) edges: Vec<Edge>,
}

impl Graph {
    /// The skeleton of a shape.
    pub(super) fn of(shape: &Shape) -> Self {
        let distances: Vec<f32> = shape.distances2().into_iter().map(f32::sqrt).collect();
        let thin = Grid {
            width: shape.width,
            inside: shape.inside.clone(),
            distances: &distances,
        };
        let thin = thin.thinned();
        let spot = |i: usize| Spot {
            at: shape.place(i),
            // The nearest pixel outside is half a pixel beyond the outline.
            radius: (distances[i] - 0.5).max(0.5),
        };
        thin.graph(spot)
    }
}

/// The pixels of a frame whose border is empty.
struct Grid<'a> {
    width: usize,
    inside: Vec<bool>,
    /// Distance of each pixel to the outside, px.
    distances: &'a [f32],
}

impl Grid<'_> {
    /// The neighbours of a pixel, around it, from the right one on.
    fn around(&self, i: usize) -> [usize; 8] {
        let w = self.width;
        [
            i + 1,
            i + w + 1,
            i + w,
            i + w - 1,
            i - 1,
            i - w - 1,
            i - w,
            i - w + 1,
        ]
    }

    fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        self.around(i).into_iter().filter(|&k| self.inside[k])
    }

    /// True if the shape without pixel `i` has as many parts and as many holes.
    fn is_simple(&self, i: usize) -> bool {
        let around = self.around(i).map(|k| self.inside[k]);
        let crossings = (0..8)
            .step_by(2)
            .filter(|&k| !around[k] && (around[k + 1] || around[(k + 2) % 8]));
        crossings.count() == 1
    }

    /// Takes away all pixels that are not needed, those nearest to the outside first. From one side at a time, as otherwise
    /// a line two pixels wide would be eaten from its end.
    fn thinned(mut self) -> Self {
        let layer = |i: usize| (2.0 * self.distances[i]) as usize;
        let mut layers: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for i in (0..self.inside.len()).filter(|&i| self.inside[i]) {
            layers.entry(layer(i)).or_default().push(i);
        }
        let mut open: Vec<usize> = Vec::new();
        for members in layers.into_values() {
            open.extend(members);
            while self.peel(&open) {
                open.retain(|&i| self.inside[i]);
            }
        }
        self
    }

    /// Takes away the pixels of `open` that are not needed, once from each side. Returns whether there were such.
    fn peel(&mut self, open: &[usize]) -> bool {
        let mut has_changed = false;
        for side in [0, 4, 2, 6] {
            let is_bare = |i: usize| self.inside[i] && !self.inside[self.around(i)[side]];
            let border: Vec<usize> = open.iter().copied().filter(|&i| is_bare(i)).collect();
            for i in border {
                if self.is_simple(i) && !self.is_end(i) {
                    self.inside[i] = false;
                    has_changed = true;
                }
            }
        }
        has_changed
    }

    /// True if `i` is the end of a line that does not only taper towards it.
    fn is_end(&self, i: usize) -> bool {
        if self.neighbours(i).count() > 1 {
            return false;
        }
        let around = self.around(i).into_iter().enumerate();
        !around.into_iter().any(|(turn, k)| {
            let step = if turn % 2 == 0 {
                1.0
            } else {
                std::f32::consts::SQRT_2
            };
            self.distances[k] - self.distances[i] > GROWTH * step
        })
    }

    /// The graph of a shape that is one pixel wide.
    fn graph(&self, spot: impl Fn(usize) -> Spot) -> Graph {
        let (node_of, nodes) = self.branches(&spot);
        let mut graph = Graph {
            nodes,
            edges: Vec::new(),
        };
        for run in self.runs(&node_of) {
            let is_ring = self.on_runs(&node_of, run[0]) == 2;
            let spots: Vec<Spot> = run.iter().map(|&i| spot(i)).collect();
            if is_ring {
                graph.edges.push(Edge { nodes: None, spots });
            } else {
                let ends = self.branches_beside(&node_of, &run);
                graph.add(spots, ends);
            }
        }
        graph
    }

    /// The node that each pixel belongs to, [`NONE`] for most, and the nodes. Branching pixels beside each other are one
    /// node: where lines cross, thinning leaves several.
    fn branches(&self, spot: impl Fn(usize) -> Spot) -> (Vec<usize>, Vec<Spot>) {
        let is_branch = |i: usize| self.inside[i] && self.neighbours(i).count() > 2;
        let (mut node_of, mut nodes) = (vec![NONE; self.inside.len()], Vec::new());
        let mut stack = Vec::new();
        for start in 0..self.inside.len() {
            if !is_branch(start) || node_of[start] != NONE {
                continue;
            }
            node_of[start] = nodes.len();
            stack.push(start);
            let mut members = Vec::new();
            while let Some(i) = stack.pop() {
                members.push(spot(i));
                for k in self.neighbours(i).filter(|&k| is_branch(k)) {
                    if node_of[k] == NONE {
                        node_of[k] = nodes.len();
                        stack.push(k);
                    }
                }
            }
            nodes.push(mean(&members));
        }
        (node_of, nodes)
    }

    /// Number of neighbours of a pixel that belong to no node.
    fn on_runs(&self, node_of: &[usize], i: usize) -> usize {
        self.neighbours(i).filter(|&k| node_of[k] == NONE).count()
    }

    /// The pixels between nodes, run by run. Runs with ends come first, so that none of them begins in its middle; what is
    /// left are rings.
    fn runs(&self, node_of: &[usize]) -> Vec<Vec<usize>> {
        let pixels = (0..self.inside.len()).filter(|&i| self.inside[i] && node_of[i] == NONE);
        let (ends, rings): (Vec<usize>, Vec<usize>) =
            pixels.partition(|&i| self.on_runs(node_of, i) < 2);
        let mut seen = vec![false; self.inside.len()];
        let mut runs = Vec::new();
        for start in ends.into_iter().chain(rings) {
            if std::mem::replace(&mut seen[start], true) {
                continue;
            }
            let (mut run, mut last) = (vec![start], start);
            let is_next = |seen: &[bool], k: usize| !seen[k] && node_of[k] == NONE;
            while let Some(next) = self.neighbours(last).find(|&k| is_next(&seen, k)) {
                seen[next] = true;
                run.push(next);
                last = next;
            }
            runs.push(run);
        }
        runs
    }

    /// The nodes beside both ends of a run, where it has any.
    fn branches_beside(&self, node_of: &[usize], run: &[usize]) -> [Option<usize>; 2] {
        let beside = |i: usize| {
            let nodes = self.neighbours(i).map(|k| node_of[k]);
            let mut nodes: Vec<usize> = nodes.filter(|&node| node != NONE).collect();
            nodes.dedup();
            nodes
        };
        let at_start = beside(run[0]);
        let first = at_start.first().copied();
        let last = match run {
            // A single pixel may lie between two nodes.
            [_] => at_start.iter().copied().find(|&node| Some(node) != first),
            _ => beside(run[run.len() - 1]).first().copied(),
        };
        [first, last]
    }
}

impl Graph {
    /// Adds the edge along `spots` between two nodes. An end of the skeleton becomes a node of its own.
    fn add(&mut self, mut spots: Vec<Spot>, [first, last]: [Option<usize>; 2]) {
        let mut node = |found: Option<usize>, spot: Option<Spot>| {
            found.unwrap_or_else(|| {
                self.nodes.extend(spot);
                self.nodes.len() - 1
            })
        };
        let nodes = [
            node(first, spots.first().copied()),
            node(last, spots.last().copied()),
        ];
        if first.is_none() {
            spots.remove(0);
        }
        if last.is_none() && !spots.is_empty() {
            spots.pop();
        }
        self.edges.push(Edge {
            nodes: Some(nodes),
            spots,
        });
    }
}

/// The node of a pixel that belongs to none.
const NONE: usize = usize::MAX;

fn mean(spots: &[Spot]) -> Spot {
    let share = 1.0 / spots.len() as f32;
    let mut mean = Spot {
        at: [0.0; 2],
        radius: 0.0,
    };
    for spot in spots {
        mean.at = [0, 1].map(|k| mean.at[k] + share * spot.at[k]);
        mean.radius = mean.radius.max(spot.radius);
    }
    mean
}
