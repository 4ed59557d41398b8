//! Reports of the benchmarks: plain records that serialise to JSON, and the tables, plots and pages made from them.
//!
//! The rules of [`strokefit::report`] hold: fields may be added, none is renamed.

pub mod cases;
pub mod compare;
mod damage;
pub mod ink;
pub mod pareto;
pub mod picture;
pub mod plot;
pub mod scaling;
pub(crate) mod statistics;
mod table;

pub use damage::Damage;
pub use table::{Column, Table};

/// Who makes our own drawings.
pub const OWN: &str = "strokefit";
