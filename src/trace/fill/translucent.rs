//! Translucent regions on a clear page.
//!
//! Such a region shows what lies behind it. So it goes on beneath what is opaque, and lies on another one only where
//! that shows through it all over. Where two of one colour each cross, a third colour is seen, which is no shape of its own:
//! both shapes go on there.

use std::collections::{BTreeMap, BTreeSet};

use super::super::areas::{LEVEL, Pixel, Pixels, away, is_opaque, through};
use super::colors::CANVAS;
use super::regions::{Region, Regions};

/// Colours that differ by less are one, levels. A guess.
const ALIKE: f32 = 3.0;

/// A region of gradients with more than this share of translucent pixels is so. A guess.
const FADED: f32 = 0.05;

/// Most shapes beside a region that are tried for what crosses there. A guess.
const MOST_TRIED: usize = 16;

/// The translucent regions of a picture, which is on a black and a white matte.
pub(super) struct Translucent {
    /// True for each of them.
    is: Vec<bool>,
    /// The shapes that cross in a region, from front to back.
    crossings: BTreeMap<u32, Vec<u32>>,
    /// The region that stands for the shape which each region is a piece of.
    shapes: Vec<u32>,
}

impl Translucent {
    /// No translucent regions among so many.
    pub(super) fn none(count: usize) -> Self {
        Self {
            is: vec![false; count],
            crossings: BTreeMap::new(),
            shapes: (0..count as u32).collect(),
        }
    }

    /// The translucent ones of the regions of a picture.
    pub(super) fn of(
        regions: &Regions,
        neighbours: &[BTreeMap<u32, u32>],
        pixels: &Pixels<'_>,
    ) -> Self {
        let list = &regions.list;
        let is = |region: &Region| {
            let is_translucent = match region.shades[..] {
                [] => !is_opaque(&region.color),
                _ => is_faded(regions, region, pixels),
            };
            region.label != CANVAS && is_translucent && is_clear(region, pixels)
        };
        let mut found = Self {
            is: list.iter().map(is).collect(),
            ..Self::none(list.len())
        };
        found.cross(list, neighbours);
        found.join_pieces(list, neighbours);
        found
    }

    /// Finds the regions in which shapes cross.
    fn cross(&mut self, list: &[Region], neighbours: &[BTreeMap<u32, u32>]) {
        let is_plain = |r: &u32| self.is[*r as usize] && list[*r as usize].shades.is_empty();
        let mut regions: Vec<u32> = (0..list.len() as u32).filter(is_plain).collect();
        // What crosses is clearer than the crossing.
        let clearness = |r: u32| through(&list[r as usize].color);
        regions.sort_by(|a, b| clearness(*b).total_cmp(&clearness(*a)).then(a.cmp(b)));
        let mut crossings = BTreeMap::new();
        for region in regions {
            let clearer = |r: &u32| is_plain(r) && clearness(*r) > clearness(region);
            let beside = neighbours[region as usize].keys().copied();
            let beside: Vec<u32> = beside.filter(clearer).take(MOST_TRIED).collect();
            if let Some(shapes) = crossing(list, region, &beside, &crossings) {
                crossings.insert(region, shapes);
            }
        }
        self.crossings = crossings;
    }

    /// Makes the pieces of one label around each crossing one shape.
    fn join_pieces(&mut self, list: &[Region], neighbours: &[BTreeMap<u32, u32>]) {
        for (&region, shapes) in &self.crossings {
            for &shape in shapes {
                let label = list[shape as usize].label;
                let is_piece =
                    |r: &u32| list[*r as usize].label == label && !self.crossings.contains_key(r);
                for piece in neighbours[region as usize].keys().copied().filter(is_piece) {
                    let [a, b] = [shape, piece].map(|r| self.shapes[r as usize]);
                    let joined = self.shapes.iter_mut().filter(|other| **other == a.max(b));
                    joined.for_each(|other| *other = a.min(b));
                }
            }
        }
    }

    /// True for a translucent region.
    pub(super) fn has(&self, region: u32) -> bool {
        self.is[region as usize]
    }

    /// True for a region that no other one stands for, and where no shapes cross.
    pub(super) fn is_shape(&self, region: u32) -> bool {
        self.shapes[region as usize] == region && !self.crossings.contains_key(&region)
    }

    /// The region that stands for the shape of a region: where two cross, the front one.
    pub(super) fn shape(&self, region: u32) -> u32 {
        let front = self
            .crossings
            .get(&region)
            .map_or(region, |shapes| shapes[0]);
        self.shapes[front as usize]
    }

    /// Pairs of shapes that cross: the one in front, and the one behind.
    pub(super) fn crossing(&self) -> impl Iterator<Item = [u32; 2]> {
        let pairs = self.crossings.values().flat_map(|shapes| shapes.windows(2));
        pairs.map(|pair| [pair[0], pair[1]].map(|r| self.shapes[r as usize]))
    }

    /// The regions that make up a shape, those where it crosses others among them.
    pub(super) fn pieces(&self, shape: u32) -> impl Iterator<Item = u32> {
        let own = move |r: u32| self.shapes[r as usize] == shape;
        let whole = (0..self.shapes.len() as u32)
            .filter(move |r| own(*r) && !self.crossings.contains_key(r));
        let crossed = self.crossings.iter();
        let crossed = crossed.filter(move |(_, shapes)| shapes.iter().any(|&r| own(r)));
        whole.chain(crossed.map(|(region, _)| *region))
    }
}

/// True if much of what is inside a region of gradients is translucent.
fn is_faded(regions: &Regions, region: &Region, pixels: &Pixels<'_>) -> bool {
    let inner = region.members.iter().map(|&i| i as usize);
    let inner: Vec<usize> = inner.filter(|&i| regions.share[i] == 0.0).collect();
    let faded = inner.iter().filter(|&&i| !is_opaque(&pixels.target.at(i)));
    faded.count() as f32 > FADED * inner.len() as f32
}

/// True if nothing is drawn yet behind most of a region.
fn is_clear(region: &Region, pixels: &Pixels<'_>) -> bool {
    let clear = region
        .members
        .iter()
        .filter(|&&i| pixels.is_clear(i as usize));
    2 * clear.count() > region.members.len()
}

/// The shapes that are seen in a region on top of each other, from front to back, by the regions `beside` it.
fn crossing(
    list: &[Region],
    region: u32,
    beside: &[u32],
    crossings: &BTreeMap<u32, Vec<u32>>,
) -> Option<Vec<u32>> {
    let color = |r: u32| &list[r as usize].color;
    let shapes = |r: u32| crossings.get(&r).cloned().unwrap_or_else(|| vec![r]);
    // One shape, and what is seen beside: a shape, or several that cross there.
    let ones: BTreeSet<u32> = beside.iter().flat_map(|&r| shapes(r)).collect();
    let pairs = ones
        .iter()
        .flat_map(|&one| beside.iter().map(move |&other| (one, other)));
    let orders = pairs.flat_map(|(one, other)| [[one, other], [other, one]]);
    let errors = orders.map(|pair| {
        let [front, back] = pair.map(color);
        (pair, away(&over(front, back), color(region)))
    });
    let near = errors.filter(|(_, error)| *error <= ALIKE * LEVEL);
    let stacks = near.map(|(pair, error)| (pair.map(shapes).concat(), error));
    // Nothing crosses itself.
    let labels = |stack: &[u32]| -> BTreeSet<u16> {
        stack.iter().map(|&r| list[r as usize].label).collect()
    };
    let sound = stacks.filter(|(stack, _)| labels(stack).len() == stack.len());
    let nearest = sound.min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map(|(stack, _)| stack)
}

/// The colours of two things on top of each other, on a black and a white matte.
fn over(front: &Pixel, back: &Pixel) -> Pixel {
    let through = through(front);
    std::array::from_fn(|k| front[k % 3] + through * back[k])
}

/// The colour on a clear page of what is seen as `seen` on top of `back`, if it is a colour.
pub(super) fn on_top(seen: &Pixel, back: &Pixel) -> Option<Pixel> {
    if is_opaque(seen) {
        return Some(*seen);
    }
    let through = through(seen) / through(back).max(LEVEL);
    if through > 1.0 {
        return None;
    }
    let own: [f32; 3] = std::array::from_fn(|k| seen[k] - through * back[k]);
    let range = -ALIKE * LEVEL..=1.0 - through + ALIKE * LEVEL;
    let is_color = own.iter().all(|v| range.contains(v));
    is_color.then(|| std::array::from_fn(|k| own[k % 3] + if k < 3 { 0.0 } else { through }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(color: [f32; 3], opacity: f32) -> Pixel {
        std::array::from_fn(|k| color[k % 3] * opacity + if k < 3 { 0.0 } else { 1.0 - opacity })
    }

    #[test]
    fn a_colour_is_found_again_on_what_it_lies_on() {
        let (front, back) = (pixel([1.0, 0.25, 0.0], 0.5), pixel([0.0, 0.5, 1.0], 0.25));
        let seen = over(&front, &back);
        assert!((through(&seen) - 0.5 * 0.75).abs() < 1e-6);
        let found = on_top(&seen, &back).unwrap();
        assert!(away(&found, &front) < 1e-6, "{found:?}");
        // Nothing lies on what is less clear than it.
        assert_eq!(on_top(&back, &front), None);
        let opaque = pixel([0.2; 3], 1.0);
        assert_eq!(on_top(&opaque, &back), Some(opaque));
    }
}
