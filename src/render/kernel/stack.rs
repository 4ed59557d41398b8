//! Memory that pass 1 fills for pass 2, which takes it back from the end.

use super::super::grid::BlockSet;

/// A stack whose items are written in place. When it shrinks, it keeps its memory and the items there.
#[derive(Debug)]
pub(super) struct Stack<T> {
    items: Vec<T>,
    len: usize,
    /// Content of new memory.
    empty: T,
}

impl<T: Copy> Stack<T> {
    pub(super) fn new(empty: T) -> Self {
        Self {
            items: Vec::new(),
            len: 0,
            empty,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds one item for each of `blocks`; returns them to be written.
    #[inline(always)]
    pub(super) fn push(&mut self, blocks: BlockSet) -> &mut [T] {
        let start = self.len;
        self.len += blocks.count_ones() as usize;
        // Memory doubles, so that growth costs a constant per item. Old items stay: the caller overwrites them.
        if self.items.len() < self.len {
            self.items.resize(2 * self.len, self.empty);
        }
        &mut self.items[start..self.len]
    }

    /// Takes back the items that were added for `blocks`, which were the last.
    #[inline(always)]
    pub(super) fn pop(&mut self, blocks: BlockSet) -> &mut [T] {
        let end = self.len;
        self.len -= blocks.count_ones() as usize;
        &mut self.items[self.len..end]
    }
}
