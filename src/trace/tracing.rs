//! What tracing looks for.

use crate::restore::Doubt;

/// What tracing looks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracing {
    /// How far the picture may be from what it means.
    pub doubt: Doubt,
    /// True if gradients may fill shapes.
    pub has_shades: bool,
    /// Most marks. A shape comes apart into elements of its own only where there is room.
    pub most: usize,
    /// True if areas may be placed where their edges are seen.
    pub may_place: bool,
    /// True for details that a drawing has lost: they are small, and many are pale.
    pub is_of_details: bool,
}

impl Tracing {
    /// Shapes of fewer pixels are not traced. 2, 3, 6: SSIMULACRA2 of a screenshot of a dashboard 70.5, 69.0, 64.5 in 20 kB each, as
    /// the dots of its letters are small. With 3, 1 for details, 25, 41 of 41 specks of 1 to 4 px are there.
    pub(super) fn least_pixels(self) -> usize {
        if self.is_of_details { 1 } else { 2 }
    }

    /// Farthest that a pixel may be from its colour. A guess.
    pub(super) fn near(self) -> f32 {
        if self.is_of_details { 0.06 } else { 0.12 }
    }
}
