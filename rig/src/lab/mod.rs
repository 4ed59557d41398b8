//! The experiments of the article that this project starts from, and what they show beyond it.
//!
//! Each experiment is a file with a function `run`, which writes tables, pictures and animations to a
//! [`ResultFolder`]; `strokefit-rig lab` runs them by name. They use the same coverage functions, losses,
//! Adam and renderers as the fit.
//!
//! | experiment | question |
//! | --- | --- |
//! | [`sdf`] | what do distances, coverage functions and combinations look like? |
//! | [`field`] | which way does the loss pull a circle, from everywhere? |
//! | [`circle`] | does a circle find its target? |
//! | [`star`] | do sixteen strokes find a star of four? |
//! | [`compose`] | how do coloured strokes make a picture? |
//! | [`colors`] | do coloured strokes find coloured strokes? |
//! | [`article`] | how far do thousands of strokes get, all at once from a random start? |
//! | [`compare`] | which coverage function is best, in the render and in the file? |
//!
//! They share [`shapes`], [`optimizers`], [`descent`] (a problem, an optimiser, its trajectory), [`matching`] (a union of
//! shapes against a target) and [`table`].
//!
//! Like the article, the small experiments sample pixels at integer coordinates.

pub mod article;
pub mod circle;
pub mod colors;
pub mod compare;
pub mod compose;
pub mod descent;
pub mod field;
pub mod matching;
pub mod optimizers;
mod output;
pub mod sdf;
pub mod shapes;
pub mod star;
pub mod table;

pub use output::{Notice, ResultFolder, unwritten};

use crate::report::plot::{Panel, Sheet};
use strokefit::Result;
use strokefit::coverage::Coverage;
use strokefit::image::Image;

/// Side of the small experiments' pictures, px.
pub const SIZE: usize = 64;

/// The coverage functions that the article compares, with a legend for each.
pub const COVERAGES: [Coverage; 5] = [
    Coverage::Smoothstep,
    Coverage::Atan { k: 1.0 },
    Coverage::Atan { k: 4.0 },
    Coverage::Tanh,
    Coverage::Sigmoid,
];

/// Sheet of a small problem after `step` steps, a panel for each function.
fn sheet_of_step(title: &str, step: usize, panels: Vec<Panel>) -> Result<Image> {
    let sheet = Sheet {
        title: format!("{title}, step {step}"),
        columns: 3,
        zoom: 4,
        panels,
    };
    sheet.draw()
}
