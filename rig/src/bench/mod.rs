//! Benchmarks of whole fits: cost against error, what is found again, growth.
//!
//! | benchmark | question |
//! | --- | --- |
//! | [`pareto`] | how much error is left for how much time, memory, bytes and strokes; who else is there? |
//! | [`inverse`] | how much of a drawing is found again in its picture, in how many numbers, and how much of its damage is drawn? |
//! | [`compare`] | what does a change of the program do to drawings of all kinds? |
//! | [`scaling`] | how do time and memory grow with strokes, pixels and threads? |
//!
//! Each returns plain records of [`report`](crate::report), which turns them into tables, plots and pages.
//! `strokefit-rig` runs them. [`programs`] runs whoever makes drawings, each in a process of its own, and [`drawings`] makes
//! pictures of known ones.

pub mod compare;
mod damages;
pub mod drawings;
mod elements;
pub(crate) mod files;
pub mod gallery;
pub mod inverse;
pub mod measure;
pub mod pareto;
pub mod programs;
pub mod scaling;
