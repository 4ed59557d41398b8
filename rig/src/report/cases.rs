//! Cases of a run: each a picture, who drew it, and what was made of it.

use serde::{Deserialize, Serialize};
use strokefit::report::SCHEMA;

/// Who makes our own drawings.
pub const OWN: &str = "strokefit";

/// All cases of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cases<Entry> {
    /// [`SCHEMA`].
    pub schema: u32,
    /// One per picture, and who drew that, in order.
    pub entries: Vec<Entry>,
}

/// A record of one case.
pub trait Case {
    /// Why nothing was made.
    fn failure(&self) -> Option<&str>;
}

impl<Entry: Case> Cases<Entry> {
    /// The report of these cases.
    pub fn new(entries: Vec<Entry>) -> Self {
        Self {
            schema: SCHEMA,
            entries,
        }
    }

    /// Number of drawings that could not be made.
    pub fn failures(&self) -> usize {
        self.entries.len() - self.made().len()
    }

    /// The cases of which something was made.
    pub(super) fn made(&self) -> Vec<&Entry> {
        let entries = self.entries.iter();
        entries.filter(|entry| entry.failure().is_none()).collect()
    }
}

/// The line of standard output of a case: whose `picture` of `what`, what was made of it, and the verdict.
pub(super) fn line(
    entry: &impl Case,
    (what, picture, by): (&str, &str, &str),
    made: impl FnOnce() -> String,
) -> String {
    let by = other(by).map(|by| format!(", {by}")).unwrap_or_default();
    match entry.failure() {
        Some(why) => format!("{what} at {picture}{by}: {why}: FAIL"),
        None => format!("{what} at {picture}{by}: {}: pass", made()),
    }
}

/// The end of a file's name that tells who made it: nothing of our own.
pub(super) fn suffix(by: &str) -> String {
    let by = other(by).map(|by| format!("-{}", by.replace(' ', "-")));
    by.unwrap_or_default()
}

/// The name of another program, or of another way to draw.
fn other(by: &str) -> Option<&str> {
    Some(by).filter(|by| *by != OWN)
}
