//! Programs on the `PATH`.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// The first program of this name that can be run.
pub fn program(name: &str) -> Option<PathBuf> {
    let file = format!("{name}{}", env::consts::EXE_SUFFIX);
    let path = env::var_os("PATH")?;
    let mut places = env::split_paths(&path).map(|folder| folder.join(&file));
    places.find(|place| is_program(place))
}

#[cfg(unix)]
fn is_program(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    const ANYONE_RUNS: u32 = 0o111;
    fs::metadata(path).is_ok_and(|m| m.is_file() && m.permissions().mode() & ANYONE_RUNS != 0)
}

#[cfg(not(unix))]
fn is_program(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|m| m.is_file())
}
