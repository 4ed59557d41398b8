//! Outputs that cannot be written are errors of one line, and what was there before stays.
#![cfg(target_os = "linux")]
#![allow(missing_docs, clippy::unwrap_used)]

use std::fs::{self, File};
use std::process::{Command, Stdio};

use tempfile::TempDir;

const SVG: &str =
    r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="30" viewBox="0 0 40 30"/>"##;

fn place() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let picture =
        image::RgbImage::from_fn(40, 30, |x, y| image::Rgb([x as u8 * 6, y as u8 * 8, 90]));
    picture.save(folder.path().join("in.png")).unwrap();
    fs::write(folder.path().join("in.svg"), SVG).unwrap();
    folder
}

/// Runs the program with standard output going to `stdout`; gives its status and standard error.
fn run(folder: &TempDir, args: &[&str], stdout: impl Into<Stdio>) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_strokefit"))
        .args(args)
        .current_dir(folder.path())
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
    let folder = place();
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
        let (code, line) = run(&folder, args, Stdio::null());
        assert_eq!(code, Some(1), "{args:?}: {line}");
        assert!(
            line.contains("/dev/full") && line.contains("space"),
            "{args:?}: {line}"
        );
    }
}

#[test]
fn a_full_standard_output_is_an_error() {
    let folder = place();
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
        let (code, line) = run(&folder, args, full());
        assert_eq!(code, Some(1), "{args:?}: {line}");
        assert!(line.contains("standard output cannot be written"), "{line}");
    }
}

/// The file system has room for the old file and no more: limits on the size of files stand in for it.
#[test]
fn what_cannot_be_written_does_not_replace_what_is_there() {
    let folder = place();
    fs::write(folder.path().join("out.svg"), "old").unwrap();
    // SIGXFSZ ignored, a write beyond the limit (in blocks of 512 or 1024 bytes) is an error.
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$0\" -q fit in.png -o out.svg --strokes 99 --preset draft";
    let output = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_strokefit")])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let line = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{line}");
    assert!(line.contains("out.svg: cannot be written"), "{line}");
    assert_eq!(
        fs::read_to_string(folder.path().join("out.svg")).unwrap(),
        "old"
    );
    let names = fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(names, 3, "only in.png, in.svg and out.svg");
}
