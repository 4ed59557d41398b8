//! What a drawing was, to go back to or to go on from.

use serde::{Deserialize, Serialize};

use super::{Counters, Drawing};
use crate::render::Params;
use crate::scene::Rgb;

/// What a drawing is made again from, to the bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::fit) struct Memento {
    halvings: usize,
    /// The background's colour, unless a document lies there.
    color: Option<Rgb>,
    strokes: Vec<Params>,
    stage_of: Vec<usize>,
    frozen: usize,
    counters: Counters,
}

impl Drawing {
    /// What the drawing is.
    pub(in crate::fit) fn memento(&self) -> Memento {
        Memento {
            halvings: self.surface().halvings(),
            color: self.surface().color(),
            strokes: self.strokes.clone(),
            stage_of: self.stage_of.clone(),
            frozen: self.frozen,
            counters: self.counters,
        }
    }

    /// Makes the drawing what it was, its counters too.
    pub(in crate::fit) fn restore(&mut self, memento: Memento) {
        if let (Some(color), Some(was)) = (self.surfaces[0].color_mut(), memento.color) {
            *color = was;
        }
        self.halve(memento.halvings);
        self.strokes = memento.strokes;
        self.stage_of = memento.stage_of;
        self.counters = memento.counters;
        if memento.frozen > 0 {
            // The frozen ones are rendered before the free ones are back.
            let free = self
                .strokes
                .split_off(memento.frozen.min(self.strokes.len()));
            self.freeze();
            self.strokes.extend(free);
        }
    }

    /// Goes back to what the drawing was. What was counted since then stays counted, so that no search is repeated.
    pub(in crate::fit) fn revert(&mut self, memento: Memento) {
        let counters = self.counters;
        self.restore(Memento {
            counters,
            ..memento
        });
    }
}
