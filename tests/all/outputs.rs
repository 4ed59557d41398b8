//! Outputs that cannot be written are errors of one line, and what was there before stays.

use std::fs::File;
use std::process::Stdio;

use crate::support::{Place, STROKEFIT, Words, assert_says, stderr};

const SVG: &str =
    r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="30" viewBox="0 0 40 30"/>"##;

fn with_inputs() -> Place {
    let place = Place::of_picture(40, 30);
    place.file("in.svg", SVG);
    place
}

/// Runs the program, which must fail, with standard output going to `stdout`; returns its standard error.
#[track_caller]
fn failed(place: &Place, args: &str, stdout: impl Into<Stdio>) -> String {
    let mut command = place.command(STROKEFIT);
    command
        .args(args.words())
        .stdout(stdout)
        .stderr(Stdio::piped());
    let output = command.output().unwrap();
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{args}: {said}");
    said
}

#[test]
fn a_full_disk_is_an_error_of_every_command() {
    let place = with_inputs();
    for args in [
        "-q fit in.png --strokes 9 --preset draft -o /dev/full",
        "-q fit in.png --strokes 9 --preset draft -o out.svg --report /dev/full",
        "render in.svg -o /dev/full",
        "check in.svg in.png --renderer resvg --report /dev/full",
    ] {
        let said = failed(&place, args, Stdio::null());
        assert_says(&said, &["/dev/full", "space"]);
    }
}

#[test]
fn a_full_standard_output_is_an_error() {
    let place = with_inputs();
    for args in [
        "-q fit in.png -o - --strokes 9 --preset draft",
        "render in.svg -o -",
    ] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let said = failed(&place, args, full);
        assert_says(&said, &["standard output cannot be written"]);
    }
}

/// The file system has room for the old file and no more: limits on the size of files stand in for it.
#[test]
fn what_cannot_be_written_does_not_replace_what_is_there() {
    let place = with_inputs();
    place.file("out.svg", "old");
    // SIGXFSZ ignored, a write beyond the limit (in blocks of 512 or 1024 bytes) is an error.
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$0\" -q fit in.png -o out.svg --strokes 99 --preset draft";
    let mut command = place.command("sh");
    let output = command.args(["-c", script, STROKEFIT]).output().unwrap();
    let line = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{line}");
    assert_says(&line, &["out.svg: cannot be written"]);
    assert_eq!(place.text("out.svg"), "old");
    assert_eq!(place.names(), ["in.png", "in.svg", "out.svg"]);
}
