//! Drawings for machines and print: cut-outs and hatching, which are drawings again, and files in PDF and DXF.
//!
//! ```text
//! bezier    paths that a sweep found
//! visible   marks → the places where each colour is seen
//! cutout    areas that do not overlap
//! hatch     areas → pen lines
//! sheet     a drawing on a page with a size
//! pdf, dxf  sheet → bytes of a file
//! ```

#[cfg(feature = "cli")]
mod bezier;
#[cfg(feature = "cli")]
mod cutout;
mod dxf;
#[cfg(feature = "cli")]
mod hatch;
mod pdf;
mod sheet;
#[cfg(feature = "cli")]
mod visible;

#[cfg(feature = "cli")]
pub use cutout::cut_out;
pub use dxf::dxf;
#[cfg(feature = "cli")]
pub use hatch::{Hatch, hatched};
pub use pdf::pdf;
pub use sheet::Sheet;

use crate::outline;
use crate::scene::{Scene, Stage};

/// The scene with the outline of each stroke in its place.
pub fn outlined(scene: &Scene) -> Scene {
    let stage = |stage: &Stage| stage.marks.iter().map(outline::of_mark).collect();
    Scene {
        stages: scene.stages.iter().map(stage).collect(),
        background: scene.background,
        shade: scene.shade.clone(),
        shadows: scene.shadows.clone(),
        ..*scene
    }
}
