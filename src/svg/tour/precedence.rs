//! Precedence: the pairs of strokes that keep their order.

use crate::scene::{Swept, Written};

/// The pairs of strokes whose order the picture depends on.
#[derive(Debug, Clone)]
pub(super) struct Precedence {
    /// For each stroke, those that have to come later.
    above: Vec<Vec<usize>>,
    /// For each stroke, those that have to come earlier.
    below: Vec<Vec<usize>>,
}

impl Precedence {
    pub(super) fn of(strokes: &[Written]) -> Self {
        let mut above = vec![Vec::new(); strokes.len()];
        let mut below = vec![Vec::new(); strokes.len()];
        for [first, later] in pairs(strokes) {
            above[first].push(later);
            below[later].push(first);
        }
        Self { above, below }
    }

    /// The strokes that have to come after this one.
    pub(super) fn above(&self, stroke: usize) -> &[usize] {
        &self.above[stroke]
    }

    /// The strokes that have to come before this one.
    pub(super) fn below(&self, stroke: usize) -> &[usize] {
        &self.below[stroke]
    }

    /// For each stroke, how many have to come before it.
    pub(super) fn counts(&self) -> Vec<usize> {
        self.below.iter().map(Vec::len).collect()
    }
}

/// The pairs, found by a sweep from left to right.
fn pairs(strokes: &[Written]) -> Vec<[usize; 2]> {
    // Most drawings for a pen are of one colour.
    let is_plain = |s: &Written| s.opacity == u8::MAX && s.color == strokes[0].color;
    if strokes.iter().all(is_plain) {
        return Vec::new();
    }
    let swept: Vec<Swept> = strokes.iter().map(Swept::new).collect();
    let mut from_left: Vec<usize> = (0..strokes.len()).collect();
    from_left.sort_by_key(|&i| swept[i].span());
    let (mut open, mut pairs): (Vec<usize>, Vec<_>) = (Vec::new(), Vec::new());
    for i in from_left {
        open.retain(|&k| swept[k].span()[1] >= swept[i].span()[0]);
        let partners = open
            .iter()
            .filter(|&&k| depends_on_order(&strokes[i], &strokes[k]) && swept[i].meets(&swept[k]));
        pairs.extend(partners.map(|&k| [i.min(k), i.max(k)]));
        open.push(i);
    }
    pairs
}

/// Whether the order of two strokes shows where they meet.
fn depends_on_order(a: &Written, b: &Written) -> bool {
    a.color != b.color || a.opacity < u8::MAX || b.opacity < u8::MAX
}
