//! Rendering of strokes, forward and backward.

pub mod reference;
