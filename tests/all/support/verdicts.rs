//! Verdicts of `check --report -` on each program.

use std::process::Output;

use serde_json::Value;

use super::output::stderr;

pub(crate) fn record(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {}", stderr(output)))
}

/// Record of a program that drew the file.
pub(crate) fn entry<'a>(record: &'a Value, name: &str) -> &'a Value {
    let entries = record["renderers"].as_array().unwrap();
    let found = entries.iter().find(|e| e["renderer"] == name);
    found.unwrap_or_else(|| panic!("{name} drew nothing: {record}"))
}
