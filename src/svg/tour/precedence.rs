//! Precedence: the pairs of strokes that keep their order.

use crate::scene::{Written, overlaps};

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
        // Most drawings for a pen are of one colour.
        let is_plain = |s: &Written| s.opacity == u8::MAX && s.color == strokes[0].color;
        let pairs = if strokes.iter().all(is_plain) {
            Vec::new()
        } else {
            overlaps(strokes, depends_on_order)
        };
        for [first, later] in pairs {
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

/// True if the order of two strokes shows where they meet.
fn depends_on_order(a: &Written, b: &Written) -> bool {
    a.color != b.color || a.opacity < u8::MAX || b.opacity < u8::MAX
}
