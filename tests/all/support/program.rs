//! The program, run to its end.

use std::process::Output;

use super::output::stderr;
use super::place::{Place, STROKEFIT};

impl Place {
    pub(crate) fn run(&self, args: &[&str]) -> Output {
        self.command(STROKEFIT).args(args).output().unwrap()
    }

    /// Runs the program, which must succeed.
    #[track_caller]
    pub(crate) fn done(&self, args: &[&str]) -> Output {
        let output = self.run(args);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{args:?}: {said}");
        output
    }
}
