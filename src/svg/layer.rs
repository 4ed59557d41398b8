//! Layers of the file.

use crate::scene::{Mark, Path, Shape, quantum, units};

/// A rounded mark, by the integers of its element.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Written {
    pub(super) mark: Mark,
    /// The numbers of its layer and of its gradient in it, from 1; 0 if it has no place in a file yet.
    pub(super) place: [usize; 2],
}

impl From<Mark> for Written {
    fn from(mark: Mark) -> Self {
        let place = [0; 2];
        Self { mark, place }
    }
}

impl Written {
    /// The centre line of a stroke, or the rings of an area; at least one.
    pub(super) fn paths(&self) -> &[Path] {
        self.mark.paths()
    }

    /// The shape of the only path, if it is one.
    pub(super) fn shape(&self) -> Option<Shape> {
        self.mark.shape()
    }

    /// Width of a stroke in units of 1/[`UNITS_PER_PX`](crate::scene::UNITS_PER_PX) px; 0 for an area.
    pub(super) fn width(&self) -> i64 {
        units(2.0 * self.mark.radius())
    }

    /// 8-bit red, green and blue.
    pub(super) fn color(&self) -> [u8; 3] {
        self.mark.color().map(quantum)
    }

    /// Opacity in 1/255, never 0.
    pub(super) fn opacity(&self) -> u8 {
        quantum(self.mark.opacity())
    }

    pub(super) fn is_area(&self) -> bool {
        self.mark.is_area()
    }

    /// True if it is a stroke with round ends.
    pub(super) fn is_round(&self) -> bool {
        !self.is_area() && !self.mark.is_butt()
    }
}

/// Strokes of a layer, and what they have in common.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    pub(super) strokes: Vec<Written>,
    pub(super) kind: LayerKind,
}

/// Reason for marks to share a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LayerKind {
    /// They were added together.
    Stage,
    /// This colour, which so many layers below have as well.
    Color([u8; 3], usize),
    /// They are a thing whose lowest mark has this colour; without one, they belong to nothing.
    Object(Option<[u8; 3]>),
}
