//! What a drawing was, to go back to or to go on from.

use serde::{Deserialize, Serialize};

use super::Drawing;
use crate::render::Params;
use crate::scene::Rgb;

/// What a drawing is made again from, to the bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::fit) struct State {
    halvings: usize,
    /// The colour of a flat ground.
    color: Option<Rgb>,
    strokes: Vec<Params>,
    stage_of: Vec<usize>,
    frozen: usize,
    searches: u64,
    lost: usize,
}

/// The strokes of a drawing and what is behind them.
pub(in crate::fit) struct Snapshot {
    background: Option<Rgb>,
    strokes: Vec<Params>,
    stage_of: Vec<usize>,
}

impl Drawing {
    /// What the drawing is.
    pub(in crate::fit) fn state(&self) -> State {
        State {
            halvings: self.ground().halvings(),
            color: self.ground().color(),
            strokes: self.strokes.clone(),
            stage_of: self.stage_of.clone(),
            frozen: self.frozen,
            searches: self.searches,
            lost: self.lost,
        }
    }

    /// Makes the drawing what it was.
    pub(in crate::fit) fn resume(&mut self, state: State) {
        if let (Some(color), Some(was)) = (self.grounds[0].color_mut(), state.color) {
            *color = was;
        }
        for ground in &mut self.grounds {
            ground.enter(state.halvings);
        }
        self.cut_anew();
        self.strokes = state.strokes;
        self.stage_of = state.stage_of;
        self.searches = state.searches;
        self.lost = state.lost;
        if state.frozen > 0 {
            let free = self.strokes.split_off(state.frozen.min(self.strokes.len()));
            self.freeze();
            self.strokes.extend(free);
        }
    }

    /// What [`restore`](Self::restore) brings back.
    pub(in crate::fit) fn snapshot(&self) -> Snapshot {
        Snapshot {
            background: self.background(),
            strokes: self.strokes.clone(),
            stage_of: self.stage_of.clone(),
        }
    }

    /// Goes back to a drawing of the same resolution, without frozen strokes then and now.
    pub(in crate::fit) fn restore(&mut self, snapshot: Snapshot) {
        self.change_background(|color| *color = snapshot.background.unwrap_or(*color));
        self.strokes = snapshot.strokes;
        self.stage_of = snapshot.stage_of;
    }
}
