//! Overlaps: which of two shapes beside each other lies on top.
//!
//! A shape that is convex but for what another one has bitten off goes on beneath that one, if the other is whole. So a disc
//! lies on a disc of its size, and a card on a card.

use std::collections::{BTreeMap, BTreeSet};

use super::hull::Hull;
use super::regions::Regions;
use super::translucent::Translucent;

/// Pixels of a hull that are not its shape's, in units of the root of its area: the hull of the pixels of a disc has 1.1 more
/// than they. A guess.
const RAGGED: f64 = 1.5;

/// Largest share of a hull that is bitten off. A guess.
const MOST: f64 = 0.6;

/// Fewest pixels of a bite, in the same units. A guess.
const BITE: f64 = 3.0;

/// Regions as convex shapes.
pub(super) struct Overlaps<'a> {
    regions: &'a Regions,
    enclosed: &'a [Vec<u32>],
    neighbours: &'a [BTreeMap<u32, u32>],
    hulls: BTreeMap<u32, Hull>,
}

impl<'a> Overlaps<'a> {
    /// The shapes of some regions, each beside its `neighbours`.
    pub(super) fn of(
        regions: &'a Regions,
        enclosed: &'a [Vec<u32>],
        neighbours: &'a [BTreeMap<u32, u32>],
        translucent: &Translucent,
        shapes: &[u32],
    ) -> Self {
        let members = |r: u32| &regions.list[r as usize].members;
        let hull = |&shape: &u32| match translucent.has(shape) {
            true => {
                let pieces = translucent.pieces(shape);
                let all: BTreeSet<u32> = pieces.flat_map(members).copied().collect();
                Hull::of(&Vec::from_iter(all), regions.width)
            }
            false => Hull::of(members(shape), regions.width),
        };
        Self {
            regions,
            enclosed,
            neighbours,
            hulls: shapes.iter().map(|r| (*r, hull(r))).collect(),
        }
    }

    /// The area of the hull of a shape.
    pub(super) fn hull_area(&self, shape: u32) -> f64 {
        self.hulls.get(&shape).map_or(0.0, Hull::area)
    }

    /// Moves shapes, which are given from back to front, so that each lies below those that have bitten something off it.
    /// Those that `may` be moved may also lie on top.
    pub(super) fn settle(&self, shapes: &mut [u32], may: impl Fn(u32) -> bool) {
        let movable: Vec<u32> = shapes.iter().copied().filter(|&r| may(r)).collect();
        for shape in movable {
            for biter in self.biters(shape, &may) {
                let [on_top, below] =
                    [biter, shape].map(|own| shapes.iter().position(|&r| r == own));
                if let (Some(on_top), Some(below)) = (on_top, below)
                    && on_top < below
                {
                    self.swap(&mut shapes[on_top..=below]);
                }
            }
        }
    }

    /// Moves the first one of some shapes above the last one, or that below the first one, if this changes nothing else.
    fn swap(&self, shapes: &mut [u32]) {
        let [first, between @ .., last] = &*shapes else {
            return;
        };
        let is_apart = |own: &u32| {
            let is_met = |r| self.neighbours[r as usize].contains_key(own);
            !between
                .iter()
                .any(|&r| is_met(r) || self.encloses(*own, r) || self.encloses(r, *own))
        };
        if is_apart(last) {
            shapes.rotate_right(1);
        } else if is_apart(first) {
            shapes.rotate_left(1);
        }
    }

    /// The shapes beside one that have bitten off what it lacks of its hull.
    fn biters(&self, shape: u32, may: &impl Fn(u32) -> bool) -> Vec<u32> {
        let (Some(hull), Some([missing, slack])) = (self.hulls.get(&shape), self.missing(shape))
        else {
            return Vec::new();
        };
        if missing <= slack || missing > MOST * hull.area() {
            return Vec::new();
        }
        let beside = self.neighbours[shape as usize].keys().copied();
        let whole = beside.filter(|&r| {
            let is_apart = !self.encloses(r, shape) && !self.encloses(shape, r);
            may(r) && is_apart && self.is_whole(r)
        });
        // The shape that each region is a part of.
        let owners = whole.flat_map(|r| self.within(r).map(move |inner| (inner, r)));
        let owners: BTreeMap<u32, u32> = owners.collect();
        let most: f64 = owners.keys().map(|&r| self.size(r)).sum();
        if most < missing - slack {
            return Vec::new();
        }
        let mut bites: BTreeMap<u32, f64> = BTreeMap::new();
        for [x, y] in hull.pixels() {
            let region = self.regions.of[y as usize * self.regions.width + x as usize];
            if let Some(&owner) = owners.get(&region) {
                *bites.entry(owner).or_default() += 1.0;
            }
        }
        if missing - bites.values().sum::<f64>() > slack {
            return Vec::new();
        }
        let least = BITE * hull.area().sqrt();
        bites.retain(|_, bite| *bite >= least);
        bites.into_keys().collect()
    }

    /// True for a shape that is convex.
    fn is_whole(&self, shape: u32) -> bool {
        let missing = self.missing(shape);
        missing.is_some_and(|[missing, slack]| missing <= slack)
    }

    /// The pixels of a shape's hull that are not its own, and how many those of a convex shape may be.
    fn missing(&self, shape: u32) -> Option<[f64; 2]> {
        let area = self.hulls.get(&shape)?.area();
        let own: f64 = self.within(shape).map(|r| self.size(r)).sum();
        Some([area - own, RAGGED * area.sqrt()])
    }

    /// A region and those that it encloses.
    fn within(&self, region: u32) -> impl Iterator<Item = u32> {
        let inner = self.enclosed[region as usize].iter().copied();
        std::iter::once(region).chain(inner)
    }

    fn encloses(&self, outer: u32, inner: u32) -> bool {
        self.enclosed[outer as usize].contains(&inner)
    }

    fn size(&self, region: u32) -> f64 {
        self.regions.list[region as usize].members.len() as f64
    }
}
