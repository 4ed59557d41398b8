//! The program, run to its end.

use std::process::Output;

use super::output::stderr;
use super::place::{Place, STROKEFIT};
use super::words::Words;

impl Place {
    pub(crate) fn run(&self, args: &(impl Words + ?Sized)) -> Output {
        self.command(STROKEFIT).args(args.words()).output().unwrap()
    }

    /// Runs the program, which must succeed.
    #[track_caller]
    pub(crate) fn done(&self, args: &(impl Words + ?Sized)) -> Output {
        let output = self.run(args);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{:?}: {said}", args.words());
        output
    }
}
