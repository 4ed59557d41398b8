//! A drawing on a page with a size.

use crate::scene::Scene;
use crate::svg::Length;

/// Millimetres and points of a px of 1/96 inch.
const MM: f64 = 25.4 / 96.0;
const PT: f64 = 72.0 / 96.0;

/// A drawing on a page with a size.
#[derive(Debug, Clone, Copy)]
pub struct Sheet<'a> {
    /// The drawing.
    pub scene: &'a Scene,
    /// Width of the page; its height follows. `None`: 1/96 inch per pixel of the picture.
    pub width: Option<Length>,
}

impl Sheet<'_> {
    /// Millimetres of a px of the drawing.
    pub(super) fn mm(&self) -> f64 {
        self.px() * MM
    }

    /// Points of a px of the drawing.
    pub(super) fn pt(&self) -> f64 {
        self.px() * PT
    }

    /// Px of 1/96 inch of a px of the drawing.
    pub fn px(&self) -> f64 {
        let shown = self.scene.page.map(|[width, _]| f64::from(width));
        let own = f64::from(self.scene.width);
        self.width.map(Length::px).or(shown).unwrap_or(own) / own
    }
}
