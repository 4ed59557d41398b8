//! Compound shapes: those of one colour with nothing between them become one, as an artist draws a word.

use std::collections::{BTreeMap, BTreeSet};

use kurbo::ParamCurve;

use super::super::areas::{LEVEL, Pixel, away, mix};
use super::super::edge::Ring;
use crate::scene::{Path, Shade};

/// A shape to be painted, with rings as they are described.
#[derive(Debug, Clone)]
pub(in crate::trace) struct Fill<R = Path> {
    /// The region that it shows.
    pub(in crate::trace) region: u32,
    pub(super) rings: Vec<R>,
    pub(in crate::trace) color: Pixel,
    /// Its gradients, back to front.
    pub(super) shades: Vec<Shade>,
    /// The pixels that show it.
    pub(in crate::trace) size: f32,
    /// Squared error that it removes, summed over all mattes.
    pub(in crate::trace) gain: f32,
    pub(in crate::trace) rank: usize,
    /// The regions that it covers.
    pub(super) covers: Vec<u32>,
    /// Deviation of the shares of pixels from what the rings cover, in the middle of edges, where these are placed.
    pub(in crate::trace) deviation: f64,
}

impl<R> Fill<R> {
    /// True if it is filled with gradients.
    pub(in crate::trace) fn has_shades(&self) -> bool {
        !self.shades.is_empty()
    }
}

/// Colours that differ by less are one, levels. A guess.
const ALIKE: f32 = 3.0;

/// Joins shapes, which are given from back to front, but for those that `stand_alone`.
pub(super) fn joined<R>(
    fills: Vec<Fill<R>>,
    neighbours: &[BTreeMap<u32, u32>],
    stand_alone: impl Fn(&Fill<R>) -> bool,
) -> Vec<Fill<R>> {
    let mut touching = touching(&fills, neighbours);
    let mut fills: Vec<Option<Fill<R>>> = fills.into_iter().map(Some).collect();
    for upper in 1..fills.len() {
        for lower in (0..upper).rev() {
            let (Some(a), Some(b)) = (&fills[lower], &fills[upper]) else {
                continue;
            };
            let is_alike = a.shades == b.shades && away(&a.color, &b.color) <= ALIKE * LEVEL;
            if !is_alike || stand_alone(a) || stand_alone(b) {
                continue;
            }
            // One of them moves to the other, past everything between that it does not touch.
            let between = |k: &usize| *k > lower && *k < upper;
            let is_free = |i: usize| !touching[i].iter().any(between);
            let (kept, gone) = match (is_free(upper), is_free(lower)) {
                (true, _) => (lower, upper),
                (false, true) => (upper, lower),
                (false, false) => continue,
            };
            if let Some(more) = fills[gone].take()
                && let Some(fill) = &mut fills[kept]
            {
                fill.join(more);
                rename(&mut touching, gone, kept);
            }
            if gone == upper {
                break;
            }
        }
    }
    fills.into_iter().flatten().collect()
}

/// Most rings of a shape some of which leave it, to be elements of their own, and of one that all of them leave. A QR code stays one
/// path. A guess.
const SPLIT_RINGS: [usize; 2] = [12, 24];

/// The paths of each element of a shape: one, besides, as far as there is `room`, circles, ellipses and round rectangles that are apart
/// from all other rings. A drawing
/// of one shape is one path by its artist, too, unless it is nothing but such.
pub(super) fn paths(rings: &[Ring], is_only: bool, room: &mut usize) -> Vec<Vec<Path>> {
    let bodies: Vec<Path> = rings.iter().map(|ring| ring.path(false)).collect();
    // A hole and the ring around it are one shape only together.
    let is_alone = |i: usize| {
        let mut others = bodies.iter().enumerate().filter(|&(k, _)| k != i);
        others.all(|(_, other)| are_apart(&bodies[i], other))
    };
    let is_element = |(i, ring): (usize, &Ring)| ring.is_shorter_alone() && is_alone(i);
    let elements: Vec<bool> = rings.iter().enumerate().map(is_element).collect();
    let is_all = elements.iter().all(|is| *is);
    let more = elements.iter().filter(|is| **is).count() - usize::from(is_all);
    let is_split =
        rings.len() <= SPLIT_RINGS[usize::from(is_all)] && (is_all || !is_only) && more <= *room;
    if is_split {
        *room -= more;
    }
    let mut rest = Vec::new();
    let mut paths = Vec::new();
    for ((ring, body), is_element) in rings.iter().zip(bodies).zip(elements) {
        match is_element && is_split || rings.len() == 1 {
            true => paths.push(vec![ring.path(true)]),
            false => rest.push(body),
        }
    }
    let rest = Some(rest).filter(|rest| !rest.is_empty());
    paths.into_iter().chain(rest).collect()
}

/// True if neither of two rings lies in the other one.
fn are_apart(a: &Path, b: &Path) -> bool {
    let lies_in = |inner: &Path, outer: &Path| {
        let start = inner.segments().next().map(|first| first.start());
        start.is_some_and(|p| kurbo::Shape::winding(&outer.bezier(), p) != 0)
    };
    !lies_in(a, b) && !lies_in(b, a)
}

impl<R> Fill<R> {
    fn join(&mut self, more: Self) {
        let all = self.size + more.size;
        let share = more.size / all.max(f32::MIN_POSITIVE);
        self.color = mix(&self.color, &more.color, share);
        self.size = all;
        self.gain += more.gain;
        self.rings.extend(more.rings);
        self.covers.extend(more.covers);
    }
}

/// For each shape those that cover a region of its own or one beside it.
fn touching<R>(fills: &[Fill<R>], neighbours: &[BTreeMap<u32, u32>]) -> Vec<BTreeSet<usize>> {
    let mut covering: Vec<Vec<usize>> = vec![Vec::new(); neighbours.len()];
    for (i, fill) in fills.iter().enumerate() {
        fill.covers
            .iter()
            .for_each(|&r| covering[r as usize].push(i));
    }
    let around = |(i, fill): (usize, &Fill<R>)| {
        let own = fill.covers.iter();
        let near = own.clone().flat_map(|&r| neighbours[r as usize].keys());
        let regions: BTreeSet<u32> = own.chain(near).copied().collect();
        let others = regions.iter().flat_map(|&r| &covering[r as usize]);
        others.copied().filter(|&k| k != i).collect()
    };
    fills.iter().enumerate().map(around).collect()
}

/// Gives what `gone` touches to `kept`.
fn rename(touching: &mut [BTreeSet<usize>], gone: usize, kept: usize) {
    let others = std::mem::take(&mut touching[gone]);
    for &other in &others {
        touching[other].remove(&gone);
        if other != kept {
            touching[other].insert(kept);
            touching[kept].insert(other);
        }
    }
}
