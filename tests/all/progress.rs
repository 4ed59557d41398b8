//! Progress on a terminal, and nowhere else. The terminal is that of `script`, of util-linux.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use crate::support::place::{Place, STROKEFIT};
use crate::support::repository::committed;

/// Text that a terminal 120 columns wide gets to see of `strokefit ARGS`.
fn on_a_terminal(place: &Place, args: &str) -> String {
    let output = place
        .command("script")
        .args([
            "-qec",
            &format!("stty cols 120; '{STROKEFIT}' {args}"),
            "/dev/null",
        ])
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let seen = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{seen}");
    seen
}

#[test]
fn a_terminal_sees_stage_strokes_fidelity_rate_and_time_left() {
    let place = Place::new();
    let input = committed("samples/coffee-300.png");
    let seen = on_a_terminal(&place, &format!("fit '{input}' -o a.svg --strokes 400"));
    for words in [
        "stage ",
        " of ",
        "polish",
        " strokes, ",
        " dB, ",
        "moves/s",
        " to go: ",
        "a.svg: ",
    ] {
        assert!(seen.contains(words), "no {words:?} in {seen}");
    }
    let quiet = on_a_terminal(&place, &format!("fit '{input}' -o a.svg --strokes 400 -q"));
    assert_eq!(quiet, "");
}

#[test]
fn several_pictures_are_counted() {
    let place = Place::new();
    place.picture("a.png", 300, 200);
    place.picture("b.png", 300, 200);
    let seen = on_a_terminal(
        &place,
        "fit a.png b.png -o {stem}.svg --strokes 200 --preset draft",
    );
    assert!(
        seen.contains("1 of 2 ") && seen.contains("2 of 2 "),
        "{seen}"
    );
    assert!(seen.contains("2 drawn, 0 failed"), "{seen}");
}

#[test]
fn nothing_is_coloured_against_the_wish() {
    let place = Place::new();
    let help = on_a_terminal(&place, "fit --help");
    assert!(
        help.contains("Usage:") && !help.contains('\u{1b}'),
        "{help}"
    );
}

/// Each part is told of when it ends, long before the fit does.
#[test]
fn a_pipe_hears_of_parts_while_it_happens() {
    let place = Place::new();
    let input = committed("samples/coffee-300.png");
    let endless = [
        "-v",
        "fit",
        &input,
        "-o",
        "a.svg",
        "--strokes",
        "30000",
        "--preset",
        "best",
    ];
    let mut child = place
        .command(STROKEFIT)
        .args(endless)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let line = lines
        .find(|line| line.as_ref().unwrap().starts_with("stage 1"))
        .unwrap()
        .unwrap();
    assert!(child.try_wait().unwrap().is_none());
    child.kill().unwrap();
    child.wait().unwrap();
    for word in ["strokes", "iterations", " s, ", " dB"] {
        assert!(line.contains(word), "{line}");
    }
}

#[test]
fn polish_and_settling_are_mentioned() {
    let place = Place::new();
    let input = committed("samples/coffee-300.png");
    let args = ["-v", "fit", &input, "-o", "a.svg", "--strokes", "60"];
    let output = place.command(STROKEFIT).args(args).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    for part in ["stage 1", "polish: ", "settling: "] {
        assert!(
            said.lines().any(|line| line.starts_with(part)),
            "no {part:?} in {said}"
        );
    }
}
