//! Findings of `strokefit-rig stability`.

use serde::{Deserialize, Serialize};
use strokefit::report::SCHEMA;

use super::{CaseVerdict, Column, Table};

/// All checks of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StabilityReport {
    /// [`SCHEMA`].
    pub schema: u32,
    /// One per check, in order.
    pub entries: Vec<StabilityEntry>,
}

/// Finding of one check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StabilityEntry {
    /// Kind of the case.
    pub group: String,
    /// The case.
    pub name: String,
    /// Property that was checked.
    pub checked: String,
    /// Figure that was found.
    pub figure: String,
    /// Verdict on the case.
    pub verdict: CaseVerdict,
    /// Why an exception is one.
    pub note: String,
    /// CPU time, s.
    pub cpu_s: Option<f64>,
}

impl StabilityReport {
    /// The report of these checks.
    pub fn new(entries: Vec<StabilityEntry>) -> Self {
        Self {
            schema: SCHEMA,
            entries,
        }
    }

    /// Number of checks that failed.
    pub fn failures(&self) -> usize {
        let failed = |entry: &&StabilityEntry| entry.verdict == CaseVerdict::Fail;
        self.entries.iter().filter(failed).count()
    }

    /// The count of each verdict, the exceptions with their reasons, and all checks.
    pub fn markdown(&self) -> String {
        let of = |verdict| self.entries.iter().filter(move |e| e.verdict == verdict);
        let columns: [Column<StabilityEntry>; 3] = [
            ("case", |e| format!("`{}/{}`", e.group, e.name)),
            ("figure", |e| e.figure.clone()),
            ("why", |e| e.note.clone()),
        ];
        let exceptions = Table::of(&columns, of(CaseVerdict::Exception));
        format!(
            "# Hard cases\n\n{} cases: {} hold, {} are exceptions, {} failed.\n\n## Exceptions\n\n{}\n## All\n\n{}",
            self.entries.len(),
            of(CaseVerdict::Pass).count(),
            of(CaseVerdict::Exception).count(),
            self.failures(),
            exceptions.markdown(),
            self.table().markdown()
        )
    }

    /// One row per check.
    pub fn table(&self) -> Table {
        let columns: [Column<StabilityEntry>; 6] = [
            ("group", |e| e.group.clone()),
            ("case", |e| e.name.clone()),
            ("checked", |e| e.checked.clone()),
            ("figure", |e| e.figure.clone()),
            ("verdict", |e| e.verdict.word().to_owned()),
            ("note", |e| e.note.clone()),
        ];
        Table::of(&columns, &self.entries)
    }
}

impl StabilityEntry {
    /// The line of standard output, ending in the verdict.
    pub fn line(&self) -> String {
        let note = if self.note.is_empty() {
            String::new()
        } else {
            format!(" ({})", self.note)
        };
        format!(
            "{}/{}: {}{note}: {}",
            self.group,
            self.name,
            self.figure,
            self.verdict.word()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exceptions_are_told_with_their_reasons() {
        let entry = |name: &str, verdict, note: &str| StabilityEntry {
            group: "kinks".into(),
            name: name.into(),
            checked: String::new(),
            figure: "2 %".into(),
            verdict,
            note: note.into(),
            cpu_s: None,
        };
        let report = StabilityReport::new(vec![
            entry("a", CaseVerdict::Pass, ""),
            entry("b", CaseVerdict::Exception, "a jump"),
        ]);
        let text = report.markdown();
        assert!(
            text.contains("2 cases: 1 hold, 1 are exceptions, 0 failed."),
            "{text}"
        );
        assert!(text.contains("| `kinks/b` | 2 % | a jump |"), "{text}");
    }
}
