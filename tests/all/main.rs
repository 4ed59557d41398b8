//! The tests of the whole product in one program: one module for each thing that users or developers rely on.
//!
//! `cargo test --release --test all budgets` runs those of one module.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

/// Helpers of several modules.
mod support {
    pub(crate) mod areas;
    mod fits;
    pub(crate) mod paths;

    pub(crate) use fits::*;

    // Of the program.
    #[cfg(feature = "cli")]
    mod built;
    #[cfg(feature = "cli")]
    mod engine;
    #[cfg(feature = "cli")]
    mod output;
    #[cfg(feature = "cli")]
    mod picture;
    #[cfg(feature = "cli")]
    mod place;
    #[cfg(feature = "cli")]
    mod program;
    #[cfg(feature = "cli")]
    mod runs;
    #[cfg(feature = "cli")]
    mod signal;
    #[cfg(feature = "cli")]
    mod skip;
    #[cfg(feature = "cli")]
    mod words;

    #[cfg(feature = "cli")]
    pub(crate) use {
        engine::entry, engine::installed, engine::record, output::stderr, place::Place,
        place::STROKEFIT, runs::agreement, runs::assert_refused, runs::assert_says, signal::send,
        skip::skip, words::Words,
    };
}

// The library.
mod alpha;
mod concurrency;
mod damage;
mod dependencies;
mod details;
mod examples;
mod fit;
mod fitter;
mod fuzz;
mod gradients;
mod ground;
mod imports;
mod points;
mod render;
mod repeatability;
mod shapes;

// The program, and what the library has for it alone.
#[cfg(feature = "cli")]
mod animation;
#[cfg(feature = "cli")]
mod batch;
#[cfg(feature = "cli")]
mod budgets;
#[cfg(all(feature = "cli", unix))]
mod checkpoint;
#[cfg(feature = "cli")]
mod cli;
#[cfg(feature = "cli")]
mod config;
#[cfg(all(feature = "cli", unix))]
mod engine_scripts;
#[cfg(feature = "cli")]
mod engines;
#[cfg(feature = "cli")]
mod forms;
#[cfg(feature = "cli")]
mod help;
#[cfg(feature = "cli")]
mod hostile;
#[cfg(all(feature = "cli", target_os = "linux"))]
mod interrupt;
#[cfg(feature = "cli")]
mod machine;
#[cfg(all(feature = "cli", target_os = "linux"))]
mod outputs;
#[cfg(feature = "cli")]
mod plotter;
#[cfg(all(feature = "cli", target_os = "linux"))]
mod progress;
#[cfg(feature = "cli")]
mod refine;
#[cfg(all(feature = "cli", unix))]
mod rig;
#[cfg(feature = "cli")]
mod shape_files;
#[cfg(feature = "cli")]
mod view;
