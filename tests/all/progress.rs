//! Progress on a terminal, and nowhere else. The terminal is that of `script`, of util-linux.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use crate::support::{Place, STROKEFIT, Words, assert_says, committed};

/// Text that a terminal 120 columns wide gets to see of `strokefit ARGS`.
fn on_a_terminal(place: &Place, args: &str) -> String {
    let line = format!("stty cols 120; '{STROKEFIT}' {args}");
    let output = place
        .command("script")
        .args(["-qec", &line, "/dev/null"])
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
    let fit = format!("fit '{input}' -o a.svg --strokes 400");
    let seen = on_a_terminal(&place, &fit);
    let parts = [
        "stage ",
        " of ",
        "polish",
        " strokes, ",
        " dB, ",
        "moves/s",
        " to go: ",
    ];
    assert_says(&seen, &parts);
    assert_says(&seen, &["a.svg: "]);
    assert_eq!(on_a_terminal(&place, &format!("{fit} -q")), "");
}

#[test]
fn several_pictures_are_counted() {
    let place = Place::new();
    place.picture("a.png", 300, 200);
    place.picture("b.png", 300, 200);
    let fit = "fit a.png b.png -o {stem}.svg --strokes 200 --preset draft";
    let seen = on_a_terminal(&place, fit);
    assert_says(&seen, &["1 of 2 ", "2 of 2 ", "2 drawn, 0 failed"]);
}

#[test]
fn nothing_is_coloured_against_the_wish() {
    let help = on_a_terminal(&Place::new(), "fit --help");
    let is_coloured = help.contains('\u{1b}');
    assert!(help.contains("Usage:") && !is_coloured, "{help}");
}

/// Each part is told of when it ends, long before the fit does.
#[test]
fn a_pipe_hears_of_parts_while_it_happens() {
    let place = Place::new();
    let endless = "-v fit @samples/coffee-300.png -o a.svg --strokes 30000 --preset best";
    let mut command = place.command(STROKEFIT);
    command.args(endless.words()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut lines = lines.map(Result::unwrap);
    let line = lines.find(|line| line.starts_with("stage 1")).unwrap();
    assert!(child.try_wait().unwrap().is_none());
    child.kill().unwrap();
    child.wait().unwrap();
    assert_says(&line, &["strokes", "iterations", " s, ", " dB"]);
}

#[test]
fn polish_and_settling_are_mentioned() {
    let fit = "-v fit @samples/coffee-300.png -o a.svg --strokes 60";
    let said = Place::new().said(fit, 0);
    assert_says(&said, &["stage 1", "\npolish: ", "\nsettling: "]);
}
