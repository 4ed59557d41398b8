//! Layers of the file.

use crate::scene::{Mark, Path, Shape, quantum, units};

/// A rounded mark, by the integers of its element.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Written {
    pub(super) mark: Mark,
    /// The numbers of its layer and of its gradient in it, from 1; 0 if it has no place in a file yet.
    pub(super) place: [usize; 2],
    /// The rings of a stroke whose width varies.
    outline: Vec<Path>,
}

impl From<Mark> for Written {
    fn from(mark: Mark) -> Self {
        Self {
            mark,
            place: [0; 2],
            outline: Vec::new(),
        }
    }
}

impl Written {
    /// A mark that is rounded to so many decimals.
    pub(super) fn rounded(mark: Mark, precision: u8) -> Self {
        let stroke = mark.as_stroke();
        let outline = stroke.map_or_else(Vec::new, |stroke| stroke.written_outline(precision));
        Self {
            outline,
            ..Self::from(mark)
        }
    }

    /// The centre line of a stroke, or the rings of an area or of a stroke whose width varies; at least one.
    pub(super) fn paths(&self) -> &[Path] {
        match &self.outline[..] {
            [] => self.mark.paths(),
            rings => rings,
        }
    }

    /// The line and the radii of a stroke whose width varies.
    pub(super) fn line(&self) -> Option<(&Path, &[f64])> {
        let stroke = self.mark.as_stroke().filter(|stroke| stroke.is_varying())?;
        Some((&stroke.path, &stroke.radii))
    }

    /// The shape of the only path, if it is one.
    pub(super) fn shape(&self) -> Option<Shape> {
        self.mark.shape().filter(|_| self.outline.is_empty())
    }

    /// Width of a stroke in units of 1/[`UNITS_PER_PX`](crate::scene::UNITS_PER_PX) px; 0 for what is filled.
    pub(super) fn width(&self) -> i64 {
        match self.is_filled() {
            true => 0,
            false => units(2.0 * self.mark.radius()),
        }
    }

    /// 8-bit red, green and blue.
    pub(super) fn color(&self) -> [u8; 3] {
        self.mark.color().map(quantum)
    }

    /// Opacity in 1/255, never 0.
    pub(super) fn opacity(&self) -> u8 {
        quantum(self.mark.opacity())
    }

    /// True if it is rings with a fill: an area, or a stroke whose width varies.
    pub(super) fn is_filled(&self) -> bool {
        self.mark.is_area() || self.mark.is_varying()
    }

    /// True if it is a stroke with round ends.
    pub(super) fn is_round(&self) -> bool {
        !self.is_filled() && !self.mark.is_butt()
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
