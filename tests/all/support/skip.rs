//! Tests that cannot run here, because a program is missing or the system forbids something.

use std::fs::OpenOptions;
use std::io::{self, Write};

/// Says that the test that calls it, or a part of it, is skipped, and why.
///
/// The line goes to the process's standard error, which the test harness does not capture as it captures
/// `eprintln!`, and to the end of the file that `STROKEFIT_SKIPPED` names: `.ci/run` prints and counts
/// its lines.
pub(crate) fn skip(reason: &str) {
    let thread = std::thread::current();
    let line = format!("SKIPPED {}: {reason}\n", thread.name().unwrap_or("a test"));
    let _ = io::stderr().write_all(line.as_bytes());
    if let Some(list) = std::env::var_os("STROKEFIT_SKIPPED") {
        let mut list = OpenOptions::new()
            .create(true)
            .append(true)
            .open(list)
            .unwrap();
        list.write_all(line.as_bytes()).unwrap();
    }
}
