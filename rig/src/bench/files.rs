//! Files that a benchmark reads and writes.

use std::path::{Path, PathBuf};
use std::{fs, io};

use anyhow::{Context, Result};

/// The files that are named, and those in the folders that are, in order; true for those in folders. Of a folder, files that end
/// in one of `endings` count.
pub(crate) fn named(paths: &[PathBuf], endings: &[&str]) -> Result<Vec<(PathBuf, bool)>> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push((path.clone(), false));
            continue;
        }
        let listed = fs::read_dir(path).and_then(Iterator::collect::<io::Result<Vec<_>>>);
        let listed = listed.with_context(|| format!("{}: cannot be read", path.display()))?;
        let listed = listed.into_iter().map(|entry| entry.path());
        let is_one = |path: &PathBuf| endings.iter().any(|ending| has_ending(path, ending));
        let mut listed: Vec<_> = listed.filter(is_one).collect();
        listed.sort();
        files.extend(listed.into_iter().map(|path| (path, true)));
    }
    Ok(files)
}

/// True for a name that ends so, after a dot.
pub(crate) fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(ending))
}

/// A file's name without its ending.
pub(crate) fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// FNV-1a of all parts, in hexadecimal digits.
pub(crate) fn digest(parts: &[&[u8]]) -> String {
    let bytes = parts.iter().copied().flatten();
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    format!("{hash:016x}")
}

/// A few of the files or drawings, at most so many, from all over the list.
pub(crate) fn few<T>(all: Vec<T>, most: usize) -> Vec<T> {
    let step = all.len().div_ceil(most).max(1);
    all.into_iter().step_by(step).collect()
}

#[cfg(test)]
mod tests {
    use super::few;

    #[test]
    fn a_few_are_from_all_over_the_list() {
        assert_eq!(few(vec![0, 1], 6), [0, 1]);
        assert_eq!(few((0..12).collect(), 6), [0, 2, 4, 6, 8, 10]);
        assert!(few(Vec::<usize>::new(), 6).is_empty());
    }
}
