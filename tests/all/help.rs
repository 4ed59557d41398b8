//! Help, hints, completions and manual pages.

use std::process::Stdio;

use crate::support::output::stderr;
use crate::support::place::{Place, STROKEFIT};
use crate::support::refusal::assert_refused;

fn stdout(place: &Place, args: &[&str]) -> String {
    String::from_utf8(place.done(args).stdout).unwrap()
}

#[test]
fn help_shows_examples_first_and_no_colour_in_a_pipe() {
    let place = Place::new();
    let commands = ["fit", "refine", "check", "render", "completions", "man"];
    for command in commands {
        let help = stdout(&place, &[command, "--help"]);
        let (examples, usage) = (
            help.find("Examples:").unwrap(),
            help.find("Usage:").unwrap(),
        );
        assert!(examples < usage, "{help}");
        assert!(help.contains(&format!("  strokefit {command} ")), "{help}");
        assert!(!help.contains('\u{1b}'), "{help}");
    }
}

/// Every example of the help of `fit` is understood, up to the files that it names.
#[test]
fn examples_of_the_help_are_understood() {
    let place = Place::new();
    let help = stdout(&place, &["fit", "--help"]);
    let examples = help
        .lines()
        .filter_map(|line| line.trim().strip_prefix("strokefit fit "));
    let mut tried = 0;
    for example in examples {
        let example = example.split("  ").next().unwrap().replace('\'', "");
        let words: Vec<_> = example.split(" > ").next().unwrap().split(' ').collect();
        let args = [&["fit", "--config", "gone.toml"], words.as_slice()].concat();
        let config = words.contains(&"--config");
        let args = if config {
            [&["fit"], words.as_slice()].concat()
        } else {
            args
        };
        let output = place.run(&args);
        assert_eq!(
            output.status.code(),
            Some(1),
            "{example}: {}",
            stderr(&output)
        );
        assert!(
            stderr(&output).contains("no such file"),
            "{example}: {}",
            stderr(&output)
        );
        let args = [&["fit"], words.as_slice(), &["--print-config"]].concat();
        if !config {
            stdout(&place, &args);
        }
        tried += 1;
    }
    assert!(tried >= 5, "{help}");
}

#[test]
fn typos_are_answered_with_what_was_meant() {
    let place = Place::new();
    place.picture("cat.png", 30, 20);
    let fit = ["fit", "cat.png", "-o", "out.svg"];
    assert_refused(
        &place,
        &[&fit[..], &["--storkes", "3"]].concat(),
        2,
        &["--storkes", "hint: ", "'--strokes'"],
    );
    assert_refused(
        &place,
        &[&fit[..], &["--preset", "drft"]].concat(),
        2,
        &["drft", "hint: ", "'draft'"],
    );
    assert_refused(
        &place,
        &["chck", "a", "b"],
        2,
        &["chck", "hint: ", "'check'"],
    );
    assert_refused(
        &place,
        &["cat.png"],
        2,
        &["hint: strokefit fit cat.png -o cat.svg"],
    );
    assert_refused(
        &place,
        &["fit", "cta.png", "-o", "out.svg"],
        1,
        &["cta.png", "hint: did you mean cat.png?"],
    );
    assert_refused(
        &place,
        &["render", "cat.pgn", "-o", "out.png"],
        1,
        &["cat.pgn", "hint: did you mean cat.png?"],
    );
    assert_refused(
        &place,
        &["fit", "zebra.jpg", "-o", "out.svg"],
        1,
        &["zebra.jpg", "no such file"],
    );
    assert_refused(
        &place,
        &["fit", "cat.png"],
        2,
        &["--output", "hint: add -o cat.svg"],
    );
}

#[test]
fn completions_know_the_options() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = stdout(&place, &["completions", shell]);
        for word in ["fit", "strokes", "preset", "config"] {
            assert!(script.contains(word), "{shell} does not know {word}");
        }
    }
}

/// The script that bash gets completes what it should, in a real bash.
#[test]
#[cfg(target_os = "linux")]
fn bash_completes_an_option() {
    let place = Place::new();
    place.file("strokefit.bash", stdout(&place, &["completions", "bash"]));
    let ask = "source strokefit.bash; COMP_WORDS=(strokefit fit --stro); COMP_CWORD=2; \
               _strokefit strokefit --stro fit; echo ${COMPREPLY[@]}";
    let bash = place.command("bash").args(["-c", ask]).output().unwrap();
    assert_eq!(
        String::from_utf8_lossy(&bash.stdout).trim(),
        "--strokes",
        "{}",
        stderr(&bash)
    );
}

#[test]
fn manual_pages_are_written_for_every_command() {
    let place = Place::new();
    place.done(&["man", "-o", "man/man1", "-q"]);
    for (page, words) in [
        ("strokefit.1", ["strokefit", "Exit status"]),
        ("strokefit-fit.1", ["strokes", "Examples"]),
        ("strokefit-check.1", ["renderer", "Examples"]),
    ] {
        let text = std::fs::read_to_string(place.path("man/man1").join(page)).unwrap();
        assert!(
            text.starts_with(".ie") && words.iter().all(|word| text.contains(word)),
            "{text}"
        );
    }
}

#[test]
#[cfg(unix)]
fn a_reader_that_goes_away_is_no_failure() {
    let place = Place::new();
    place.picture("in.png", 30, 20);
    for args in [
        &["fit", "--help"][..],
        &["completions", "bash"],
        &["fit", "in.png", "-o", "-", "-q", "--strokes", "9"],
    ] {
        let mut child = place
            .command(STROKEFIT)
            .args(args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(
            output.status.code(),
            Some(0),
            "{args:?}: {}",
            stderr(&output)
        );
        assert_eq!(stderr(&output), "", "{args:?}");
    }
}
