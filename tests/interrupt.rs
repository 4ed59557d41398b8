//! Signals at any moment of a fit: the drawing so far is written, and the program ends as the signal
//! ends programs. On Linux alone, where a test can see which signals a process catches.
#![cfg(target_os = "linux")]
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// A fit that takes hours when it is left alone.
const ENDLESS: [&str; 4] = ["--preset", "best", "--strokes", "30000"];
/// What no moment of a fit may take, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn picture(folder: &TempDir, width: u32, height: u32) {
    let wave = |x: u32, y: u32, k: u32| ((x * k) ^ (y * (k + 2))) as u8;
    let picture = image::RgbImage::from_fn(width, height, |x, y| {
        image::Rgb([wave(x, y, 1), wave(x, y, 3), wave(x, y, 5)])
    });
    picture.save(folder.path().join("in.png")).unwrap();
}

fn fit(folder: &TempDir, through: &[&str], options: &[&str]) -> Child {
    let program = [env!("CARGO_BIN_EXE_strokefit")];
    let words: Vec<&str> = through.iter().chain(&program).copied().collect();
    Command::new(words[0])
        .args(&words[1..])
        .args(["fit", "in.png", "-o", "out.svg", "--report", "out.json"])
        .args(options)
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Waits until the process catches `signal`: until its fit is about to begin.
fn await_fit(child: &Child, signal: i32) {
    let start = Instant::now();
    while !catches(child.id(), signal) {
        assert!(start.elapsed() < PATIENCE, "the fit does not begin");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn catches(process: u32, signal: i32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("SigCgt:"));
    let bits = line.map_or(0, |bits| u64::from_str_radix(bits.trim(), 16).unwrap());
    bits >> (signal - 1) & 1 == 1
}

fn send(child: &Child, signal: i32) {
    let kill = format!("kill -{signal} {}", child.id());
    assert!(
        Command::new("sh")
            .args(["-c", &kill])
            .status()
            .unwrap()
            .success()
    );
}

/// The output of the process, which must end by itself.
fn end(mut child: Child) -> Output {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("the process does not end");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().unwrap()
}

fn strokes(svg: &Path) -> usize {
    let text = fs::read_to_string(svg).unwrap();
    strokefit::svg::read(&text).unwrap().len()
}

#[test]
fn every_signal_leaves_the_drawing_so_far() {
    for (signal, wait_ms) in [(2, 300), (15, 0), (1, 1000)] {
        let folder = tempfile::tempdir().unwrap();
        picture(&folder, 200, 150);
        let child = fit(&folder, &[], &ENDLESS);
        await_fit(&child, signal);
        std::thread::sleep(Duration::from_millis(wait_ms));
        send(&child, signal);
        let output = end(child);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.signal(), Some(signal), "{stderr}");
        assert!(stderr.contains("interrupted"), "{stderr}");
        let report = fs::read(folder.path().join("out.json")).unwrap();
        let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
        assert_eq!(report["stop"], "interrupted");
        let drawn = strokes(&folder.path().join("out.svg"));
        assert_eq!(report["strokes"], drawn, "signal {signal}");
        assert!(drawn > 0 || wait_ms == 0, "signal {signal}");
    }
}

/// Signals in the first half second of a short fit fall into seeding, descent, settling and verifying.
#[test]
fn at_every_moment_there_is_a_whole_file_or_none() {
    for wait_ms in (0..16).map(|i| i * i * 3) {
        let folder = tempfile::tempdir().unwrap();
        picture(&folder, 120, 90);
        let child = fit(&folder, &[], &["--preset", "draft", "--strokes", "300"]);
        std::thread::sleep(Duration::from_millis(wait_ms));
        let running = catches(child.id(), 15);
        send(&child, 15);
        let status = end(child).status;
        assert!(
            status.signal() == Some(15) || status.code() == Some(0),
            "{status}"
        );
        let names: Vec<_> = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name != "in.png")
            .collect();
        // A signal before the fit ends the program as any other; afterwards there is a drawing.
        if names.is_empty() {
            assert!(
                !running && status.signal() == Some(15),
                "after {wait_ms} ms"
            );
        } else {
            assert_eq!(names.len(), 2, "{names:?} after {wait_ms} ms");
            strokes(&folder.path().join("out.svg"));
        }
    }
}

#[test]
fn a_second_signal_ends_at_once_and_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    picture(&folder, 2400, 1600);
    fs::write(folder.path().join("out.svg"), "old").unwrap();
    let child = fit(&folder, &[], &ENDLESS);
    await_fit(&child, 15);
    send(&child, 2);
    send(&child, 15);
    assert_eq!(end(child).status.signal(), Some(15));
    let svg = fs::read_to_string(folder.path().join("out.svg")).unwrap();
    assert_eq!(svg, "old");
}

#[test]
fn a_signal_that_is_ignored_from_outside_stays_ignored() {
    let folder = tempfile::tempdir().unwrap();
    picture(&folder, 120, 90);
    let through = ["sh", "-c", "trap '' HUP; exec \"$0\" \"$@\""];
    let child = fit(
        &folder,
        &through,
        &["--preset", "draft", "--strokes", "300"],
    );
    await_fit(&child, 15);
    send(&child, 1);
    assert_eq!(end(child).status.code(), Some(0));
}
