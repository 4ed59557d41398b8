//! The tests of the whole product in one program: one module for each thing that users or developers rely on.
//!
//! `cargo test --release --test all budgets` runs those of one module.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

/// Helpers of several modules.
mod support {
    pub(crate) mod areas;
    pub(crate) mod drafts;
    pub(crate) mod fits;
    pub(crate) mod paths;
    pub(crate) mod repository;

    // Of the program.
    #[cfg(feature = "cli")]
    pub(crate) mod built;
    #[cfg(feature = "cli")]
    pub(crate) mod engine;
    #[cfg(feature = "cli")]
    pub(crate) mod files;
    #[cfg(feature = "cli")]
    pub(crate) mod output;
    #[cfg(feature = "cli")]
    pub(crate) mod picture;
    #[cfg(feature = "cli")]
    pub(crate) mod pipe;
    #[cfg(feature = "cli")]
    pub(crate) mod place;
    #[cfg(feature = "cli")]
    pub(crate) mod program;
    #[cfg(feature = "cli")]
    pub(crate) mod refusal;
    #[cfg(feature = "cli")]
    pub(crate) mod report;
    #[cfg(feature = "cli")]
    pub(crate) mod signal;
    #[cfg(feature = "cli")]
    pub(crate) mod skip;
    #[cfg(feature = "cli")]
    pub(crate) mod verdicts;
    #[cfg(feature = "cli")]
    pub(crate) mod words;
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
mod imports;
mod library;
mod points;
mod render;
mod repeatability;
mod shade;
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
mod shadows;
#[cfg(feature = "cli")]
mod shape_files;
#[cfg(feature = "cli")]
mod view;
