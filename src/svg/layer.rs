//! Layers of the file.

use crate::scene::Written;

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
