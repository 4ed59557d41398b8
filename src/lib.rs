//! strokefit turns a raster picture into an editable SVG made of strokes.

pub mod coverage;
mod error;
pub mod fit;
pub mod image;
pub mod lab;
pub mod loss;
pub mod math;
pub mod metrics;
pub mod optim;
pub mod render;
pub mod report;
pub mod rng;
pub mod scene;
pub mod sdf;
pub mod seed;
pub mod svg;
pub mod verify;

pub use error::{Error, ErrorKind, Result};
