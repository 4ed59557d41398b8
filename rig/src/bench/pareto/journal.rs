//! Results as they come: a line of JSON per drawing, appended and never rewritten.

use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use super::{case, unread};
use crate::bench::files::stem;
use crate::lab::unwritten;
use crate::report::pareto::ParetoEntry;
use strokefit::{Error, ErrorKind, Result};

/// Measurements so far.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    pub(super) entries: Vec<ParetoEntry>,
}

impl Journal {
    /// The journal in the file at `path`, which need not be there yet. A last line that was cut short by
    /// the end of a run is dropped.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(e) => return Err(unread(path, e)),
        };
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        if whole.len() < text.len() {
            fs::write(path, whole).map_err(|e| unwritten(path, e))?;
        }
        let mut journal = Self {
            path: path.to_owned(),
            entries: Vec::new(),
        };
        for (i, line) in whole.lines().enumerate() {
            let entry = serde_json::from_str(line).map_err(|e| {
                let place = format!("{}, line {}", path.display(), i + 1);
                let message = format!(
                    "{place}: not a result of this benchmark ({e}): choose another folder with -o"
                );
                Error::new(ErrorKind::Io, message)
            })?;
            journal.take(entry);
        }
        Ok(journal)
    }

    /// The drawing with this id, unless it failed: a failed one is tried again.
    pub(super) fn find(&self, id: &str) -> Option<&ParetoEntry> {
        let known = self.entries.iter().find(|entry| entry.id() == id);
        known.filter(|entry| entry.failure.is_none())
    }

    /// Writes one more line.
    pub(super) fn append(&mut self, entry: ParetoEntry) -> Result<()> {
        let line = serde_json::to_string(&entry).map_err(|e| {
            Error::new(
                ErrorKind::Io,
                format!("a result cannot be written as JSON: {e}"),
            )
        })?;
        let file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&self.path);
        let written = file.and_then(|mut file| file.write_all(format!("{line}\n").as_bytes()));
        written.map_err(|e| unwritten(&self.path, e))?;
        self.take(entry);
        Ok(())
    }

    /// A later result replaces an earlier one with the same id.
    fn take(&mut self, entry: ParetoEntry) {
        match self
            .entries
            .iter_mut()
            .find(|known| known.id() == entry.id())
        {
            Some(known) => *known = entry,
            None => self.entries.push(entry),
        }
    }

    /// All results, without those of another picture of the same name as one of `pictures`.
    pub(super) fn current(&self, pictures: &[PathBuf]) -> Result<Vec<ParetoEntry>> {
        let mut digests = Vec::new();
        for path in pictures {
            digests.push((stem(path), case::digest(&case::open(path)?)));
        }
        let stale = |entry: &&ParetoEntry| {
            let mut same = digests.iter().filter(|(name, _)| *name == entry.picture);
            same.any(|(_, digest)| *digest != entry.digest)
        };
        Ok(self
            .entries
            .iter()
            .filter(|entry| !stale(entry))
            .cloned()
            .collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(label: &str, failure: Option<&str>) -> ParetoEntry {
        ParetoEntry {
            label: label.into(),
            failure: failure.map(str::to_owned),
            ..ParetoEntry::default()
        }
    }

    #[test]
    fn what_was_cut_short_is_measured_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        let mut journal = Journal::open(&path).unwrap();
        journal.append(entry("one", None)).unwrap();
        journal.append(entry("two", None)).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, &text[..text.len() - 9]).unwrap();
        let mut journal = Journal::open(&path).unwrap();
        assert!(journal.find(&entry("one", None).id()).is_some());
        assert!(journal.find(&entry("two", None).id()).is_none());
        journal.append(entry("two", None)).unwrap();
        assert_eq!(Journal::open(&path).unwrap().entries.len(), 2);
    }

    #[test]
    fn what_failed_is_tried_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        let mut journal = Journal::open(&path).unwrap();
        journal.append(entry("one", Some("killed"))).unwrap();
        assert!(journal.find(&entry("one", None).id()).is_none());
        journal.append(entry("one", None)).unwrap();
        let journal = Journal::open(&path).unwrap();
        assert_eq!(journal.entries, [entry("one", None)]);
    }

    #[test]
    fn what_is_no_journal_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        fs::write(&path, "something else\n").unwrap();
        let error = Journal::open(&path).unwrap_err().to_string();
        assert!(error.contains("line 1"), "{error}");
    }
}
