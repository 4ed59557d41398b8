//! Copies of a drawing, to return to or to continue from.

use serde::{Deserialize, Serialize};

use super::{Counters, Drawing};
use crate::render::Strokes;
use crate::scene::Rgb;

/// A copy of a drawing's state, from which it is restored to the bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::fit) struct Memento {
    halvings: usize,
    /// The background's colour, unless the drawing is on top of a document.
    color: Option<Rgb>,
    strokes: Strokes,
    stage_of: Vec<usize>,
    frozen: usize,
    counters: Counters,
}

impl Drawing {
    /// A copy of the current state.
    pub(in crate::fit) fn memento(&self) -> Memento {
        Memento {
            halvings: self.surface().halvings(),
            color: self.surface().color(),
            strokes: self.all(),
            stage_of: self.stage_of.clone(),
            frozen: self.frozen.len(),
            counters: self.counters,
        }
    }

    /// Restores the drawing, its counters included.
    pub(in crate::fit) fn restore(&mut self, memento: Memento) {
        if let (Some(color), Some(was)) = (self.surfaces[0].color_mut(), memento.color) {
            *color = was;
        }
        // The target of the strokes has changed only if the resolution has, or if some of them were frozen.
        if memento.halvings != self.surface().halvings() || !self.is_thawed() {
            self.halve(memento.halvings);
        }
        // All strokes are free at first. Those that were frozen are frozen again, in the same order of renders.
        *self.free_mut() = memento.strokes;
        self.stage_of = memento.stage_of;
        self.counters = memento.counters;
        if memento.frozen > 0 {
            // Only the frozen strokes may be there when they are rendered.
            let free = self.free_mut().split_off(memento.frozen);
            self.freeze();
            *self.free_mut() = free;
        }
    }

    /// Restores the drawing, but keeps its counters, so that no search repeats the random draws of an earlier one.
    pub(in crate::fit) fn revert(&mut self, memento: Memento) {
        let counters = self.counters;
        self.restore(Memento {
            counters,
            ..memento
        });
    }
}
