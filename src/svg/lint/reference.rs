//! References in a file: to its own ids, to other files, to addresses.

use std::collections::BTreeMap;

use super::element::{Element, short};
use super::{Findings, rules};

/// The ids of a file and the references to them.
#[derive(Default)]
pub(super) struct References {
    /// Lines of the elements with each id.
    ids: BTreeMap<String, Vec<usize>>,
    /// Referenced ids, with their lines.
    wanted: Vec<(String, usize)>,
}

impl References {
    /// Notes the id and the references of the element.
    pub(super) fn note(&mut self, element: &Element, line: usize, findings: &mut Findings) {
        if let Some(id) = element.get("id") {
            self.ids.entry(id.to_owned()).or_default().push(line);
            if !id.starts_with(|c: char| c.is_alphabetic()) {
                findings.add(&rules::ID_START, line, element.quote("id"));
            }
        }
        if element.get("inkscape:groupmode") == Some("layer") && element.get("id").is_none() {
            findings.add(&rules::LAYER_ID, line, "a layer without an id");
        }
        // People follow links; renderers do not.
        let hrefs = element
            .attributes()
            .filter(|(key, _)| element.name != "a" && is_href(key));
        let targets = hrefs.map(|(_, target)| target.to_owned());
        let values = element.attributes().flat_map(|(_, value)| urls(value));
        for target in targets.chain(values) {
            self.refer(target.trim(), line, findings);
        }
    }

    /// Notes the references of a style sheet.
    pub(super) fn note_css(&mut self, css: &str, line: usize, findings: &mut Findings) {
        for target in urls(css) {
            self.refer(&target, line, findings);
        }
        if css.contains("@import") {
            findings.add_each(&rules::EXTERNAL, line, "@import in a style sheet".into());
        }
    }

    fn refer(&mut self, target: &str, line: usize, findings: &mut Findings) {
        if let Some(id) = target.strip_prefix('#') {
            self.wanted.push((id.to_owned(), line));
        } else if !is_embedded(target) && !target.is_empty() {
            findings.add_each(&rules::EXTERNAL, line, format!("\"{}\"", short(target)));
        }
    }

    /// Checks the references, once all ids are known.
    pub(super) fn judge(&self, findings: &mut Findings) {
        for (id, lines) in self.ids.iter().filter(|(_, lines)| lines.len() > 1) {
            for &line in lines {
                findings.add_each(&rules::DUPLICATE_ID, line, format!("id=\"{}\"", short(id)));
            }
        }
        for (id, line) in self
            .wanted
            .iter()
            .filter(|(id, _)| !self.ids.contains_key(id))
        {
            findings.add_each(&rules::MISSING_ID, *line, format!("\"#{}\"", short(id)));
        }
    }
}

/// True if the target is in the file and is not itself an SVG, which could refer to something else.
fn is_embedded(target: &str) -> bool {
    let kind = target
        .strip_prefix("data:")
        .and_then(|data| data.split([',', ';']).next());
    kind.is_some_and(|kind| {
        !kind.contains(['+', '&']) && !kind.to_ascii_lowercase().ends_with("xml")
    })
}

fn is_href(key: &str) -> bool {
    key.rsplit(':').next() == Some("href")
}

/// The targets of every `url(…)`.
fn urls(value: &str) -> Vec<String> {
    let calls = value.split("url(").skip(1);
    let inner = calls
        .filter_map(|rest| rest.split_once(')'))
        .map(|(inner, _)| inner);
    let plain = inner.map(|inner| inner.replace("&quot;", "").replace("&apos;", ""));
    plain
        .map(|target| target.trim().trim_matches(['"', '\'']).to_owned())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drawing_in_a_drawing_is_not_taken_as_embedded() {
        assert!(is_embedded("data:image/png;base64,AA") && is_embedded("data:,"));
        for target in [
            "data:image/svg+xml,x",
            "data:image/SVG+XML;base64,x",
            "data:text/xml,x",
            "a.png",
        ] {
            assert!(!is_embedded(target), "{target}");
        }
    }

    #[test]
    fn urls_are_found_with_any_quotes() {
        let css = "fill:url(#a);mask: url('b.svg#m') ; x:url(&quot;c&quot;)";
        assert_eq!(urls(css), ["#a", "b.svg#m", "c"]);
        assert!(urls("url(").is_empty());
    }
}
