//! Compound shapes: those of one colour with nothing between them become one, as an artist draws a word.

use std::collections::{BTreeMap, BTreeSet};

use super::super::areas::{LEVEL, Pixel, away, mix};
use crate::scene::{Path, Shade};

/// A shape to be painted.
#[derive(Debug, Clone)]
pub(in crate::trace) struct Fill {
    /// The region that it shows.
    pub(in crate::trace) region: u32,
    pub(super) rings: Vec<Path>,
    pub(super) color: Pixel,
    /// Its gradients, back to front.
    pub(super) shades: Vec<Shade>,
    /// The pixels that show it.
    pub(super) size: f32,
    /// Squared error that it removes, summed over all mattes.
    pub(in crate::trace) gain: f32,
    pub(super) rank: usize,
    /// The regions that it covers.
    pub(super) covers: Vec<u32>,
}

/// Colours that differ by less are one, levels. A guess.
const ALIKE: f32 = 3.0;

/// Joins shapes, which are given from back to front, but for those that `stand_alone`.
pub(super) fn joined(
    fills: Vec<Fill>,
    neighbours: &[BTreeMap<u32, u32>],
    stand_alone: impl Fn(&Fill) -> bool,
) -> Vec<Fill> {
    let mut touching = touching(&fills, neighbours);
    let mut fills: Vec<Option<Fill>> = fills.into_iter().map(Some).collect();
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

impl Fill {
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
fn touching(fills: &[Fill], neighbours: &[BTreeMap<u32, u32>]) -> Vec<BTreeSet<usize>> {
    let mut covering: Vec<Vec<usize>> = vec![Vec::new(); neighbours.len()];
    for (i, fill) in fills.iter().enumerate() {
        fill.covers
            .iter()
            .for_each(|&r| covering[r as usize].push(i));
    }
    let around = |(i, fill): (usize, &Fill)| {
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
