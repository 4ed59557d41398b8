//! Hints: advice on a line of its own, after the error message.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Error;

/// Least likeness (Jaro–Winkler) of a name that is suggested.
const ALIKE: f64 = 0.85;

/// Most names of a folder that are looked at.
const MAX_NAMES: usize = 10_000;

/// A line of advice that an error carries.
#[derive(Debug)]
pub(super) struct Hint(String);

impl fmt::Display for Hint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Hint {
    /// Error that carries `advice`.
    pub(super) fn on(error: impl Into<Error>, advice: impl Into<String>) -> Error {
        error.into().context(Self(advice.into()))
    }

    /// Error that carries the advice if there is any.
    pub(super) fn maybe_on(error: Error, advice: Option<String>) -> Error {
        match advice {
            Some(advice) => Self::on(error, advice),
            None => error,
        }
    }

    /// Fault in words, and the advice that goes with it.
    pub(super) fn split(error: &Error) -> (String, Option<&Self>) {
        let hint = error.downcast_ref();
        // The advice was put around the error.
        let wrong = error.chain().nth(usize::from(hint.is_some()));
        let wrong = wrong.map_or_else(|| error.to_string(), ToString::to_string);
        (wrong, hint)
    }
}

/// `error` about the file at `path`, with the name that may have been meant if there is no such file.
pub(super) fn or_neighbour(error: Error, path: &Path) -> Error {
    match neighbour(path) {
        Some(near) if !path.exists() => {
            Hint::on(error, format!("did you mean {}?", near.display()))
        }
        _ => error,
    }
}

/// Path in the same folder with the name most like that of `path`.
fn neighbour(path: &Path) -> Option<PathBuf> {
    let wanted = path.file_name()?.to_string_lossy().to_lowercase();
    let folder = path.parent()?;
    let listed = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let names = fs::read_dir(listed).ok()?.flatten().take(MAX_NAMES);
    let rated = names.map(|entry| {
        let name = entry.file_name();
        let alike = strsim::jaro_winkler(&wanted, &name.to_string_lossy().to_lowercase());
        (alike, folder.join(name))
    });
    let best = rated.max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(&a.1)))?;
    (best.0 >= ALIKE).then_some(best.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_most_alike_is_suggested_and_no_other() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["cat.png", "Cathedral.png", "notes.txt"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let near = |name: &str| neighbour(&folder.path().join(name));
        assert_eq!(near("cta.png"), Some(folder.path().join("cat.png")));
        assert_eq!(
            near("catedral.png"),
            Some(folder.path().join("Cathedral.png"))
        );
        assert_eq!(near("zebra.jpg"), None);
    }

    #[test]
    fn an_error_keeps_its_kind_and_words_beside_the_advice() {
        let inner = strokefit::Error::new(strokefit::ErrorKind::Config, "wrong");
        let error = Hint::on(inner, "do right");
        let (wrong, hint) = Hint::split(&error);
        assert_eq!(
            (wrong.as_str(), hint.unwrap().to_string().as_str()),
            ("wrong", "do right")
        );
        assert!(error.downcast_ref::<strokefit::Error>().is_some());
    }
}
