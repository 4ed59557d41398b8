//! Programs that draw SVG, for tests that need one, and verdicts of `check --report -` on them.

use std::path::PathBuf;
use std::process::Output;

use serde_json::Value;
use strokefit::engines::{ENGINES, Engine};

use super::output::stderr;
use super::skip::skip;

/// The engine and its program; `None`, with the test reported as skipped, where it is not installed.
///
/// # Panics
///
/// If `STROKEFIT_ENGINES`, a list of names with commas, names an engine that is not installed.
pub(crate) fn installed(name: &str) -> Option<(&'static Engine, PathBuf)> {
    let engine = ENGINES.iter().find(|engine| engine.name == name).unwrap();
    if let Some(program) = engine.locate() {
        return Some((engine, program));
    }
    let required = std::env::var("STROKEFIT_ENGINES").unwrap_or_default();
    assert!(
        !required.split(',').any(|word| word == name),
        "{name} is required but not installed"
    );
    skip(&format!("{name} is not installed: {}", engine.install));
    None
}

pub(crate) fn record(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {}", stderr(output)))
}

/// Record of a program that drew the file.
pub(crate) fn entry<'a>(record: &'a Value, name: &str) -> &'a Value {
    let entries = record["renderers"].as_array().unwrap();
    let found = entries.iter().find(|e| e["renderer"] == name);
    found.unwrap_or_else(|| panic!("{name} drew nothing: {record}"))
}
