//! Measurements of strokefit, and the experiments of the article that it started from; see `strokefit-rig --help`.
//!
//! It uses strokefit as any other program does, and is no part of what users install. A module imports only from
//! modules above its own:
//!
//! ```text
//! report  records, tables, plots, pages
//! lab     the article's experiments
//! bench   measurements of whole fits
//! cli     the command line
//! ```

#![warn(clippy::disallowed_methods)]

pub mod bench;
pub mod cli;
pub mod lab;
pub mod report;
