//! Signals at any moment of a fit: the drawing so far is written, and the program ends as the signal
//! ends programs. On Linux alone, where a test can see which signals a process catches.

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Output, Stdio};
use std::time::{Duration, Instant};

use crate::support::{Place, STROKEFIT, Words, send, skip, stderr};

/// A fit that takes hours when it is left alone.
const ENDLESS: &str = "--preset best --strokes 30000";
/// Most time for any moment of a fit, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn picture(place: &Place, width: u32, height: u32) {
    let wave = |x: u32, y: u32, k: u32| ((x * k) ^ (y * (k + 2))) as u8;
    let picture = image::RgbImage::from_fn(width, height, |x, y| {
        image::Rgb([wave(x, y, 1), wave(x, y, 3), wave(x, y, 5)])
    });
    picture.save(place.path("in.png")).unwrap();
}

/// A fit that a program begins, `env` if no other.
fn fit(place: &Place, through: &[&str], options: &str) -> Child {
    let args = format!("fit in.png -o out.svg --report out.json {options}");
    let mut command = place.command("env");
    command.args(through).arg(STROKEFIT).args(args.words());
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// Waits until the process catches `signal`: until its fit is about to begin.
fn await_fit(child: &Child, signal: i32) {
    await_that("the fit does not begin", || catches(child.id(), signal));
}

fn await_that(otherwise: &str, is_so: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < PATIENCE, "{otherwise}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn catches(process: u32, signal: i32) -> bool {
    is_in(process, "SigCgt:", signal)
}

/// True if `signal` is in a set of signals that Linux tells of a process.
fn is_in(process: u32, set: &str, signal: i32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix(set));
    let bits = line.map_or(0, |bits| u64::from_str_radix(bits.trim(), 16).unwrap());
    bits >> (signal - 1) & 1 == 1
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

fn strokes(place: &Place) -> usize {
    let scene = strokefit::svg::read(&place.text("out.svg"));
    scene.unwrap().len()
}

#[test]
fn every_signal_leaves_the_drawing_so_far() {
    for (signal, wait_ms) in [(2, 300), (15, 0), (1, 1000)] {
        if is_in(std::process::id(), "SigIgn:", signal) {
            // As shells start what runs in the background of a script.
            skip(&format!("signal {signal} is ignored from outside"));
            continue;
        }
        let place = Place::new();
        picture(&place, 200, 150);
        let child = fit(&place, &[], ENDLESS);
        await_fit(&child, signal);
        std::thread::sleep(Duration::from_millis(wait_ms));
        send(&child, signal);
        let output = end(child);
        let said = stderr(&output);
        assert_eq!(output.status.signal(), Some(signal), "{said}");
        assert!(said.contains("interrupted"), "{said}");
        let report = place.report("out.json");
        assert_eq!(report["stop"], "interrupted");
        let drawn = strokes(&place);
        assert_eq!(report["strokes"], drawn, "signal {signal}");
        assert!(drawn > 0 || wait_ms == 0, "signal {signal}");
    }
}

/// Signals in the first half second of a short fit fall into seeding, descent, settling and verifying.
#[test]
fn at_every_moment_there_is_a_whole_file_or_none() {
    for wait_ms in (0..16).map(|i| i * i * 3) {
        let place = Place::new();
        picture(&place, 120, 90);
        let child = fit(&place, &[], "--preset draft --strokes 300");
        std::thread::sleep(Duration::from_millis(wait_ms));
        let running = catches(child.id(), 15);
        send(&child, 15);
        let status = end(child).status;
        assert!(
            status.signal() == Some(15) || status.code() == Some(0),
            "{status}"
        );
        let mut names = place.names();
        names.retain(|name| name != "in.png");
        // A signal before the fit ends the program as any other; afterwards there is a drawing.
        if names.is_empty() {
            let is_ended = status.signal() == Some(15);
            assert!(!running && is_ended, "after {wait_ms} ms");
        } else {
            assert_eq!(names.len(), 2, "{names:?} after {wait_ms} ms");
            strokes(&place);
        }
    }
}

#[test]
fn a_second_signal_ends_at_once_and_leaves_the_old_file() {
    let place = Place::new();
    picture(&place, 2400, 1600);
    place.file("out.svg", "old");
    let child = fit(&place, &[], ENDLESS);
    await_fit(&child, 15);
    // Not a hangup, which is ignored where tests run under `nohup`.
    send(&child, 15);
    // Of two that wait together, either may come first.
    let has_arrived = || !is_in(child.id(), "ShdPnd:", 15);
    await_that("the signal does not arrive", has_arrived);
    send(&child, 15);
    assert_eq!(end(child).status.signal(), Some(15));
    assert_eq!(place.text("out.svg"), "old");
}

#[test]
fn a_signal_that_is_ignored_from_outside_stays_ignored() {
    let place = Place::new();
    picture(&place, 120, 90);
    let through = ["sh", "-c", "trap '' HUP; exec \"$0\" \"$@\""];
    let child = fit(&place, &through, "--preset draft --strokes 300");
    await_fit(&child, 15);
    send(&child, 1);
    assert_eq!(end(child).status.code(), Some(0));
}
