//! Pictures: planar `f32`, sRGB-encoded. The one door of the `image` crate.

/// A picture: three planes of sRGB-encoded colour 0..1, and alpha where the source had it.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Width in px, at least 1.
    width: usize,
    /// Height in px, at least 1.
    height: usize,
    /// Red, green and blue, each `width·height` values row by row. Not premultiplied.
    planes: [Vec<f32>; 3],
    /// `width·height` values 0..1, or `None` when every pixel is opaque.
    alpha: Option<Vec<f32>>,
}
