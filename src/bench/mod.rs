//! Measurements: what a drawing costs and gains, whether fits hold on hard cases, and how they grow.
//!
//! | benchmark | question |
//! | --- | --- |
//! | [`pareto`] | how much error is left for how much time, memory, bytes and strokes; who else is there? |
//! | [`stability`] | do hard cases end in valid drawings, and `f32` near `f64`? |
//! | [`scaling`] | how do time and memory grow with strokes, pixels and threads? |
//!
//! Each makes plain records of [`report`](crate::report), which makes tables, plots and pages of them.
//! `strokefit bench` runs them. [`child`] measures a case in a process of its own.

pub mod child;
pub mod measure;
pub mod pareto;
pub mod scaling;
pub mod stability;
