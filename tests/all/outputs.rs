//! Outputs that cannot be written are errors of one line, and what was there before stays.

use std::fs::{self, File};
use std::process::Stdio;

use crate::support::place::{Place, STROKEFIT};

const SVG: &str =
    r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="30" viewBox="0 0 40 30"/>"##;

fn with_inputs() -> Place {
    let place = Place::new();
    place.picture("in.png", 40, 30);
    place.file("in.svg", SVG);
    place
}

/// Runs the program with standard output going to `stdout`; gives its status and standard error.
fn run(place: &Place, args: &[&str], stdout: impl Into<Stdio>) -> (Option<i32>, String) {
    let output = place
        .command(STROKEFIT)
        .args(args)
        .stdout(stdout)
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    (
        output.status.code(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

fn full() -> File {
    File::options().write(true).open("/dev/full").unwrap()
}

#[test]
fn a_full_disk_is_an_error_of_every_command() {
    let place = with_inputs();
    let fit = ["-q", "fit", "in.png", "--strokes", "9", "--preset", "draft"];
    let commands: [&[&str]; 4] = [
        &[&fit[..], &["-o", "/dev/full"]].concat(),
        &[&fit[..], &["-o", "out.svg", "--report", "/dev/full"]].concat(),
        &["render", "in.svg", "-o", "/dev/full"],
        &[
            "check",
            "in.svg",
            "in.png",
            "--renderer",
            "resvg",
            "--report",
            "/dev/full",
        ],
    ];
    for args in commands {
        let (code, line) = run(&place, args, Stdio::null());
        assert_eq!(code, Some(1), "{args:?}: {line}");
        assert!(
            line.contains("/dev/full") && line.contains("space"),
            "{args:?}: {line}"
        );
    }
}

#[test]
fn a_full_standard_output_is_an_error() {
    let place = with_inputs();
    let fit: &[&str] = &[
        "-q",
        "fit",
        "in.png",
        "-o",
        "-",
        "--strokes",
        "9",
        "--preset",
        "draft",
    ];
    for args in [fit, &["render", "in.svg", "-o", "-"]] {
        let (code, line) = run(&place, args, full());
        assert_eq!(code, Some(1), "{args:?}: {line}");
        assert!(line.contains("standard output cannot be written"), "{line}");
    }
}

/// The file system has room for the old file and no more: limits on the size of files stand in for it.
#[test]
fn what_cannot_be_written_does_not_replace_what_is_there() {
    let place = with_inputs();
    place.file("out.svg", "old");
    // SIGXFSZ ignored, a write beyond the limit (in blocks of 512 or 1024 bytes) is an error.
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$0\" -q fit in.png -o out.svg --strokes 99 --preset draft";
    let output = place
        .command("sh")
        .args(["-c", script, STROKEFIT])
        .output()
        .unwrap();
    let line = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{line}");
    assert!(line.contains("out.svg: cannot be written"), "{line}");
    assert_eq!(fs::read_to_string(place.path("out.svg")).unwrap(), "old");
    assert_eq!(place.names(), ["in.png", "in.svg", "out.svg"]);
}
