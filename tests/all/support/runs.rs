//! Runs of the program: what they read, what they say, and what they leave.

use std::fs;
use std::io::Write;
use std::process::{Output, Stdio};

use serde_json::Value;
use strokefit::image::Image;
use strokefit::metrics::Agreement;

use super::output::stderr;
use super::place::{Place, STROKEFIT};
use super::words::Words;

impl Place {
    /// A folder with a picture `in.png`.
    pub(crate) fn of_picture(width: u32, height: u32) -> Self {
        let place = Self::new();
        place.picture("in.png", width, height);
        place
    }

    pub(crate) fn file(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    pub(crate) fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    /// Record that `--report` wrote.
    pub(crate) fn report(&self, name: &str) -> Value {
        serde_json::from_slice(&self.bytes(name)).unwrap()
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.path(".")).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// Runs the program, which must end with `status`; returns what it says on standard error.
    #[track_caller]
    pub(crate) fn said(&self, args: &(impl Words + ?Sized), status: i32) -> String {
        let output = self.run(args);
        let said = stderr(&output);
        assert_eq!(
            output.status.code(),
            Some(status),
            "{:?}: {said}",
            args.words()
        );
        said
    }

    /// Runs the program, which must succeed; returns its standard output.
    #[track_caller]
    pub(crate) fn printed(&self, args: &(impl Words + ?Sized)) -> String {
        String::from_utf8(self.done(args).stdout).unwrap()
    }

    /// Runs the program, fed by a pipe.
    pub(crate) fn pipe(&self, args: &(impl Words + ?Sized), stdin: &[u8]) -> Output {
        let mut child = self
            .command(STROKEFIT)
            .args(args.words())
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

/// Expects each of these words.
#[track_caller]
pub(crate) fn assert_says(said: &str, words: &[&str]) {
    for word in words {
        assert!(said.contains(word), "no {word:?} in {said}");
    }
}

/// A line of error and perhaps one of advice that hold all of `words`, the exit status, and no new file.
#[track_caller]
pub(crate) fn assert_refused(
    place: &Place,
    args: &(impl Words + ?Sized),
    status: i32,
    words: &[&str],
) {
    let args = args.words();
    let before = place.names();
    let output = place.run(&args);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(status), "{args:?}: {said}");
    let mut lines = said.lines();
    let error = lines.next().unwrap_or_default();
    assert!(error.starts_with("error: "), "{args:?}: {said}");
    assert!(lines.all(|l| l.starts_with("hint: ")), "{args:?}: {said}");
    assert!(said.lines().count() <= 2, "{args:?}: {said}");
    assert_says(&said, words);
    let printed = &output.stdout;
    assert!(printed.is_empty(), "{args:?} wrote on standard output");
    assert_eq!(place.names(), before, "{args:?} left a file");
}

/// Agreement of two renders, dB.
pub(crate) fn agreement(a: &Image, b: &Image) -> f64 {
    Agreement::between(a, b).unwrap().psnr_db
}
