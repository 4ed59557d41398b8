//! The stack: which regions lie on top of which, and how far those below go on beneath them.
//!
//! A shape with a larger convex hull lies below. It takes in the regions that it encloses, and those that lie on it
//! and hardly touch anything farther below; its outline runs around all of them, so that paths go straight on beneath
//! what lies on top. What shows the canvas is no shape: it stays a hole. Translucent shapes lie below all others, beside each
//! other or on one that shows through.

use std::collections::{BTreeMap, BTreeSet};

use super::colors::CANVAS;
use super::overlaps::Overlaps;
use super::regions::Regions;
use super::translucent::{Translucent, on_top};

/// A shape of the stack.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    /// The region that it shows.
    pub(super) region: u32,
    /// The regions that it covers, its own among them.
    pub(super) covers: Vec<u32>,
    /// Its place in the stack, from back to front.
    pub(super) rank: usize,
}

/// The stack of some regions.
pub(super) struct Stack {
    /// From back to front.
    pub(super) layers: Vec<Layer>,
    /// The rank of each region; `None` if it shows what is behind all.
    pub(super) ranks: Vec<Option<usize>>,
    /// For each region the shape next below its own, if there is one: without its own, that would be seen.
    pub(super) below: Vec<Option<u32>>,
}

type Neighbours = [BTreeMap<u32, u32>];

impl Stack {
    /// The stack of regions. Those that are not `drawn` show what is behind.
    pub(super) fn of(
        regions: &Regions,
        neighbours: &Neighbours,
        drawn: &[bool],
        translucent: &Translucent,
    ) -> Self {
        // 1. The regions that are shapes: a hole shows what is behind.
        let enclosed = enclosed(regions, neighbours);
        let holes = holes(regions, &enclosed, drawn);
        let shows = |r: u32| drawn[r as usize] && !holes[r as usize] && translucent.is_shape(r);
        let count = regions.list.len() as u32;
        let shapes: Vec<u32> = (0..count).filter(|&r| shows(r)).collect();
        // 2. Their order, from back to front.
        let overlaps = Overlaps::of(regions, &enclosed, neighbours, translucent, &shapes);
        let order = order(&overlaps, translucent, shapes);
        let places: BTreeMap<u32, usize> =
            order.iter().zip(0..).map(|(&r, rank)| (r, rank)).collect();
        let ranks: Vec<Option<usize>> = (0..count)
            .map(|r| places.get(&translucent.shape(r)).copied())
            .collect();
        // 3. A shape goes on beneath all that lies on it, so it covers the regions that it may lie under.
        let ground = Ground {
            regions,
            neighbours,
            translucent,
            ranks: &ranks,
        };
        let layers = order.iter().enumerate();
        let layers = layers.map(|(rank, &region)| {
            let inner = &enclosed[region as usize];
            Layer {
                region,
                covers: ground.covered(region, rank, inner),
                rank,
            }
        });
        let layers: Vec<Layer> = layers.collect();
        Self {
            below: below(&layers, regions.list.len()),
            layers,
            ranks,
        }
    }
}

/// Shapes from back to front: translucent ones before others, large ones before small ones, and those that overlap as is seen.
fn order(overlaps: &Overlaps<'_>, translucent: &Translucent, mut shapes: Vec<u32>) -> Vec<u32> {
    shapes.sort_by(|a, b| {
        let is_front = |r: &u32| !translucent.has(*r);
        let [a_size, b_size] = [a, b].map(|r| overlaps.hull_area(*r));
        let by_size = b_size.total_cmp(&a_size).then(a.cmp(b));
        is_front(a).cmp(&is_front(b)).then(by_size)
    });
    for pair in translucent.crossing() {
        let places = pair.map(|shape| shapes.iter().position(|&r| r == shape));
        if let [Some(front), Some(back)] = places
            && front < back
        {
            shapes[front..=back].rotate_left(1);
        }
    }
    overlaps.settle(&mut shapes, |shape| !translucent.has(shape));
    shapes
}

/// The regions that each region encloses: no way leads from them to the picture's border past it.
fn enclosed(regions: &Regions, neighbours: &Neighbours) -> Vec<Vec<u32>> {
    let (width, height) = (regions.width, regions.height);
    let rows = (0..width).flat_map(|x| [x, (height - 1) * width + x]);
    let columns = (0..height).flat_map(|y| [y * width, y * width + width - 1]);
    let border: BTreeSet<u32> = rows.chain(columns).map(|i| regions.of[i]).collect();
    let count = regions.list.len();
    let inner = |by: usize| {
        // What encloses something is beside at least one thing that is enclosed.
        if neighbours[by].len() < 2 && border.contains(&(by as u32)) && count > 1 {
            let only = neighbours[by].keys().next().copied();
            if only.is_none_or(|only| border.contains(&only)) {
                return Vec::new();
            }
        }
        let mut seen = vec![false; count];
        seen[by] = true;
        let mut stack: Vec<u32> = border.iter().copied().filter(|&r| r != by as u32).collect();
        stack.iter().for_each(|&r| seen[r as usize] = true);
        while let Some(region) = stack.pop() {
            for &next in neighbours[region as usize].keys() {
                if !seen[next as usize] {
                    seen[next as usize] = true;
                    stack.push(next);
                }
            }
        }
        (0..count as u32).filter(|&r| !seen[r as usize]).collect()
    };
    (0..count).map(inner).collect()
}

/// True for each region that shows the canvas through all that encloses it: at most one shape that is not open there
/// already. Within several shapes, a place like the canvas is a shape on top of them.
fn holes(regions: &Regions, enclosed: &[Vec<u32>], drawn: &[bool]) -> Vec<bool> {
    let count = regions.list.len();
    let is_canvas = |r: usize| regions.list[r].label == CANVAS;
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (by, inner) in enclosed.iter().enumerate() {
        inner.iter().for_each(|&r| around[r as usize].push(by));
    }
    // From the outside to the inside.
    let mut order: Vec<usize> = (0..count).filter(|&r| is_canvas(r)).collect();
    order.sort_by_key(|&r| (around[r].len(), r));
    let mut holes = vec![false; count];
    for r in order {
        let outer: Vec<usize> = around[r].iter().copied().filter(|&by| holes[by]).collect();
        let is_open = |by: usize| outer.iter().any(|&hole| around[hole].contains(&by));
        let closed = around[r]
            .iter()
            .filter(|&&by| drawn[by] && !is_canvas(by) && !is_open(by));
        holes[r] = closed.count() < 2;
    }
    holes
}

/// Regions and their places in the stack.
struct Ground<'a> {
    regions: &'a Regions,
    neighbours: &'a Neighbours,
    translucent: &'a Translucent,
    ranks: &'a [Option<usize>],
}

/// A shape goes on beneath another one that has at most this share of its border with shapes farther below. A guess.
const EXPOSED: f32 = 0.08;

impl Ground<'_> {
    /// The regions that the shape of `region` covers.
    fn covered(&self, region: u32, rank: usize, enclosed: &[u32]) -> Vec<u32> {
        let Self {
            neighbours, ranks, ..
        } = *self;
        let is_above = |r: u32| ranks[r as usize].is_some_and(|other| other > rank);
        let is_below = |r: u32| ranks[r as usize].is_none_or(|other| other < rank);
        // What is seen through others lies on none but those that enclose it.
        let is_hiding = |r: u32| is_above(r) && !self.translucent.has(r);
        let is_inside = |&r: &u32| is_hiding(r) || (is_above(r) && self.lies_on(r, region));
        let mut inside: BTreeSet<u32> = enclosed.iter().copied().filter(is_inside).collect();
        inside.insert(region);
        if self.translucent.has(region) {
            inside.extend(self.translucent.pieces(region));
        }
        for _ in 0..4 {
            let beside = inside.iter().flat_map(|&r| neighbours[r as usize].keys());
            let beside: BTreeSet<u32> = beside.copied().filter(|&r| is_hiding(r)).collect();
            let more: Vec<u32> = beside
                .difference(&inside)
                .copied()
                .filter(|&r| {
                    let touched = &neighbours[r as usize];
                    let all: u32 = touched.values().sum();
                    let below = touched.iter().filter(|(q, _)| is_below(**q));
                    let below: u32 = below.map(|(_, count)| count).sum();
                    below as f32 <= EXPOSED * all as f32
                })
                .collect();
            if more.is_empty() {
                break;
            }
            inside.extend(more);
        }
        connected_to(region, &inside, neighbours)
    }

    /// True if what is seen in a region may be something on top of the shape of another one.
    fn lies_on(&self, region: u32, other: u32) -> bool {
        let [seen, back] = [region, other].map(|r| &self.regions.list[r as usize]);
        let is_plain = seen.shades.is_empty() && back.shades.is_empty();
        is_plain && self.translucent.has(other) && on_top(&seen.color, &back.color).is_some()
    }
}

/// The regions of `inside` that are connected with `region` there.
fn connected_to(region: u32, inside: &BTreeSet<u32>, neighbours: &Neighbours) -> Vec<u32> {
    let mut found = BTreeSet::from([region]);
    let mut stack = vec![region];
    while let Some(r) = stack.pop() {
        for &next in neighbours[r as usize].keys() {
            if inside.contains(&next) && found.insert(next) {
                stack.push(next);
            }
        }
    }
    found.into_iter().collect()
}

/// For each region the shape next below its own, if there is one.
fn below(layers: &[Layer], count: usize) -> Vec<Option<u32>> {
    let mut below = vec![None; count];
    for layer in layers {
        let others = layer.covers.iter().filter(|&&r| r != layer.region);
        others.for_each(|&r| below[r as usize] = Some(layer.region));
    }
    below
}
