//! What is claimed of fits, and whether it holds.

use serde::{Deserialize, Serialize};

use super::peers::AgainstPeer;
use super::recipe::{AtEqualStrokes, AtEqualTime};
use super::{ParetoEntry, pictures};

/// A claim, and whether it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The picture.
    pub picture: String,
    /// What is claimed.
    pub claim: String,
    /// What was found.
    pub figure: String,
    /// Whether it holds.
    pub holds: Holds,
}

/// Whether a claim holds.
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

/// What follows from `entries`. That fits beat the article's own run by so much is a claim, and a failure
/// where it does not hold; all other comparisons are findings.
pub fn comparisons(entries: &[ParetoEntry]) -> Vec<Comparison> {
    let mut all = Vec::new();
    for picture in pictures(entries) {
        let here: Vec<&ParetoEntry> = entries.iter().filter(|e| e.picture == picture).collect();
        all.extend(
            AtEqualStrokes::all(&here)
                .iter()
                .map(AtEqualStrokes::comparison),
        );
        all.extend(AtEqualTime::all(&here).iter().map(AtEqualTime::comparison));
        all.extend(AgainstPeer::all(&here).iter().map(AgainstPeer::comparison));
    }
    all
}
