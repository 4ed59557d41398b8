//! Programs that draw SVG, for tests that need one.

use std::path::PathBuf;

use strokefit::engines::{ENGINES, Engine};

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
