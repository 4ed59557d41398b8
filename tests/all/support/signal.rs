//! Signals to processes.

use std::process::{Child, Command};

pub(crate) fn send(child: &Child, signal: i32) {
    let kill = format!("kill -{signal} {}", child.id());
    let status = Command::new("sh").args(["-c", &kill]).status().unwrap();
    assert!(status.success(), "{kill}");
}
