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

mod page;
mod rules;
mod values;

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::dom::Dom;
use page::Page;
use rules::{RULES, Rule};

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
        self.rule == rules::EXTERNAL
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
    let dom = Dom::parse(text);
    let sheets = page::sheets(&dom);
    let page = Page::of(text, &dom, &sheets);
    let mut findings: Vec<Finding> = RULES
        .iter()
        .flat_map(|rule| findings(rule, &page))
        .collect();
    findings.sort_by_key(|finding| (finding.severity, finding.lines.first().copied()));
    findings
}

/// The findings of a rule: one for all places, or one for each text that is found.
fn findings(rule: &Rule, page: &Page<'_>) -> Vec<Finding> {
    let mut findings: Vec<Finding> = Vec::new();
    let mut known = BTreeMap::new();
    for (at, found) in rule.places(page) {
        let line = page.dom.line(at);
        let key = if rule.is_each() {
            found.clone()
        } else {
            String::new()
        };
        let index = *known.entry(key).or_insert(findings.len());
        match findings.get_mut(index) {
            Some(finding) if finding.lines.last() == Some(&line) => {}
            Some(finding) => finding.lines.push(line),
            None => findings.push(Finding {
                rule: rule.name.into(),
                severity: rule.severity,
                lines: vec![line],
                found,
                why: rule.why.into(),
                remedy: rule.remedy.into(),
            }),
        }
    }
    findings
}

#[cfg(test)]
mod tests;
