//! Drawings for machines and print: cut-outs and hatching, which are drawings again, and files in PDF and DXF.
//!
//! ```text
//! visible   marks → the places where each colour is seen: areas that do not overlap
//! oklab     how different two colours look
//! hatch     areas → pen lines
//! pdf, dxf  sheet → bytes of a file
//! ```

mod dxf;
#[cfg(feature = "cli")]
mod hatch;
#[cfg(feature = "cli")]
mod oklab;
mod pdf;
#[cfg(feature = "cli")]
mod visible;

pub use dxf::dxf;
#[cfg(feature = "cli")]
pub use hatch::{Hatch, hatched};
pub use pdf::pdf;
#[cfg(feature = "cli")]
pub use visible::cut_out;

use crate::outline;
use crate::scene::{Scene, Stage};
use crate::svg::Length;

/// The scene with the outline of each stroke in its place.
pub fn outlined(scene: &Scene) -> Scene {
    let stage = |stage: &Stage| stage.marks.iter().map(outline::of_mark).collect();
    Scene {
        stages: scene.stages.iter().map(stage).collect(),
        background: scene.background,
        ground: scene.ground.clone(),
        ..*scene
    }
}

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
    fn mm(&self) -> f64 {
        self.px() * MM
    }

    /// Points of a px of the drawing.
    fn pt(&self) -> f64 {
        self.px() * PT
    }

    /// Px of 1/96 inch of a px of the drawing.
    pub fn px(&self) -> f64 {
        let shown = self.scene.page.map(|[width, _]| f64::from(width));
        let own = f64::from(self.scene.width);
        self.width.map(Length::px).or(shown).unwrap_or(own) / own
    }
}
