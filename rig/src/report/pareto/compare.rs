//! Claims about fits, and whether they hold.

use serde::{Deserialize, Serialize};

/// A claim, and whether it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The picture.
    pub picture: String,
    /// Claim in words.
    pub claim: String,
    /// Figure that was found.
    pub figure: String,
    /// Verdict on the claim.
    pub holds: Holds,
}

/// Verdict on a claim: whether it holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Holds {
    /// It does.
    Holds,
    /// It does not, which is a finding.
    Not,
    /// It does not, which is a failure.
    Refuted,
}

impl Holds {
    /// The words that a line ends in.
    pub fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Not => "does not hold",
            Self::Refuted => "FAIL",
        }
    }
}

impl Comparison {
    /// The line of standard output, ending in the verdict.
    pub fn line(&self) -> String {
        let Self {
            picture,
            claim,
            figure,
            holds,
        } = self;
        format!("{picture}, {claim}: {figure}: {}", holds.word())
    }
}
