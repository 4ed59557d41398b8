//! The experiments of the article that this project starts from, and what they show beyond it.
//!
//! Each experiment writes tables and pictures to a [`ResultFolder`]; `strokefit-rig lab` runs them by name. They use the same
//! coverage functions, losses, Adam and renderers as the fit.
//!
//! | experiment | question |
//! | --- | --- |
//! | [`field`] | which way does the loss pull a circle, from everywhere? |
//! | [`convergence`] | does a circle find its target? do sixteen strokes find a star of four? |
//! | [`colors`] | do coloured strokes find coloured strokes? |
//! | [`article`] | how far do thousands of strokes get, all at once from a random start? |
//! | [`compare`] | which coverage function is best, in the render and in the file? |
//!
//! They share [`descent`] (a problem, an optimiser, its trajectory) and [`matching`] (a union of shapes against a target).
//!
//! Like the article, the small experiments sample pixels at integer coordinates.

pub mod article;
pub mod colors;
pub mod compare;
pub mod convergence;
pub mod descent;
pub mod field;
pub mod matching;
mod output;

pub use output::{ResultFolder, unread, unwritten};

use strokefit::coverage::Coverage;

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
