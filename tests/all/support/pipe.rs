//! The program, fed by a pipe.

use std::io::Write;
use std::process::{Output, Stdio};

use super::place::{Place, STROKEFIT};

impl Place {
    pub(crate) fn pipe(&self, args: &[&str], stdin: &[u8]) -> Output {
        let mut child = self
            .command(STROKEFIT)
            .args(args)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // The program may leave before it has read everything.
        let _ = child.stdin.take().unwrap().write_all(stdin);
        child.wait_with_output().unwrap()
    }
}
