//! Reports of the benchmarks: plain records that serialise to JSON, and the tables, plots and pages made from them.
//!
//! The rules of [`strokefit::report`] hold: fields may be added, none is renamed.

pub mod cases;
pub mod compare;
mod damage;
pub mod pareto;
pub mod picture;
pub mod plot;
pub mod scaling;
pub mod stability;
pub(crate) mod statistics;
mod table;

pub use damage::Damage;
pub use table::{Column, Table};

use serde::{Deserialize, Serialize};

/// Who makes our own drawings.
pub const OWN: &str = "strokefit";

/// Verdict on a case: whether it holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CaseVerdict {
    /// It does.
    Pass,
    /// It does not, for a known reason that does not occur in ordinary drawings; the note names it.
    Exception,
    /// It does not.
    Fail,
}

impl CaseVerdict {
    /// The word that a line of the table ends in.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Exception => "exception",
            Self::Fail => "FAIL",
        }
    }
}
