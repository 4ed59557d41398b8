//! Expectations of a refusal.

use super::output::stderr;
use super::place::Place;
use super::words::Words;

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
    for word in words {
        let says = said.contains(word);
        assert!(says, "{args:?} does not say {word:?}: {said}");
    }
    let printed = &output.stdout;
    assert!(printed.is_empty(), "{args:?} wrote on standard output");
    assert_eq!(place.names(), before, "{args:?} left a file");
}
