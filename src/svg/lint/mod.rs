//! Finds constructs in an SVG that some programs draw differently, or not at all.
//!
//! The lint works on any SVG, reads only its text, and draws nothing. It sees attributes, `style="…"`, and style sheets
//! whose rules are for classes. It evaluates no others, and reports a file that has a `<style>`.
//!
//! ```
//! use strokefit::svg::lint;
//!
//! let findings = lint(r##"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9" viewBox="0 0 9 9">
//! <path d="M1 1h8" stroke="#000000" stroke-width="0.4"/>
//! </svg>"##);
//! assert_eq!(findings[0].rule, "thin-stroke");
//! assert_eq!(findings[0].lines, [2]);
//! ```

mod element;
mod number;
mod path;
mod reference;
mod rules;
mod stroke;
mod walk;

use std::fmt;

use serde::{Deserialize, Serialize};

use rules::Rule;

/// File size at which readers built on libxml2 stop, bytes.
const LIBXML2_BYTES: usize = 10_000_000;

/// Number of lines that a finding's text names; the record has all of them.
const SHOWN_LINES: usize = 3;

/// Severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Some program draws nothing or something else.
    Error,
    /// Some programs draw it differently.
    Warning,
    /// Drawn alike, but not in strokefit's dialect, or harder to edit.
    Note,
}

/// A finding, with all places where it occurs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Finding {
    /// Name of the rule, such as `thin-stroke`.
    pub rule: String,
    /// Its severity.
    pub severity: Severity,
    /// Every line that has it, from 1, ascending.
    pub lines: Vec<usize>,
    /// The text found there, at the first place if there are several.
    pub found: String,
    /// The consequence.
    pub why: String,
    /// The remedy.
    pub remedy: String,
}

impl Finding {
    /// True if the file refers to something outside itself.
    pub fn is_external(&self) -> bool {
        self.rule == rules::EXTERNAL.name
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        let shown: Vec<_> = self
            .lines
            .iter()
            .take(SHOWN_LINES)
            .map(usize::to_string)
            .collect();
        let word = if self.lines.len() == 1 {
            "line"
        } else {
            "lines"
        };
        write!(f, "{severity}: {word} {}", shown.join(", "))?;
        if self.lines.len() > SHOWN_LINES {
            write!(f, " and {} more", self.lines.len() - SHOWN_LINES)?;
        }
        let Self {
            rule,
            found,
            why,
            remedy,
            ..
        } = self;
        write!(f, ": {rule}: {found}: {why}: {remedy}")
    }
}

/// Finds constructs in SVG text that programs draw differently, the worst first.
pub fn lint(text: &str) -> Vec<Finding> {
    let mut findings = Findings::default();
    if text.len() > LIBXML2_BYTES {
        findings.add(&rules::LARGE_FILE, 1, format!("{} bytes", text.len()));
    }
    walk::walk(text, &mut findings);
    findings.sorted()
}

/// The findings so far: one entry for each rule, or for each rule and element.
#[derive(Default)]
struct Findings(Vec<Finding>);

impl Findings {
    /// Notes that `found` on `line` breaks `rule`.
    fn add(&mut self, rule: &Rule, line: usize, found: impl Into<String>) {
        let at = self.0.iter().position(|f| f.rule == rule.name);
        self.insert(at, rule, line, found.into());
    }

    /// Notes as [`Self::add`] does, but with an entry for each different `found`.
    fn add_each(&mut self, rule: &Rule, line: usize, found: String) {
        let at = self
            .0
            .iter()
            .position(|f| f.rule == rule.name && f.found == found);
        self.insert(at, rule, line, found);
    }

    fn insert(&mut self, at: Option<usize>, rule: &Rule, line: usize, found: String) {
        match at {
            Some(at) if self.0[at].lines.last() == Some(&line) => {}
            Some(at) => self.0[at].lines.push(line),
            None => self.0.push(Finding {
                rule: rule.name.into(),
                severity: rule.severity,
                lines: vec![line],
                found,
                why: rule.why.into(),
                remedy: rule.remedy.into(),
            }),
        }
    }

    /// By severity, then by place.
    fn sorted(mut self) -> Vec<Finding> {
        self.0
            .sort_by_key(|f| (f.severity, f.lines.first().copied()));
        self.0
    }
}

#[cfg(test)]
mod tests;
