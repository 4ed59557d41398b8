//! Help, hints, completions and manual pages.

use std::process::Stdio;

use crate::support::{Place, STROKEFIT, Words, assert_refused, assert_says, stderr};

#[test]
fn help_is_printed_with_examples_first_and_no_colour_in_a_pipe() {
    let place = Place::new();
    let commands = ["fit", "refine", "check", "render", "completions", "man"];
    for command in commands {
        let output = place.done(&[command, "--help"]);
        assert_eq!(stderr(&output), "");
        let help = String::from_utf8(output.stdout).unwrap();
        let (examples, usage) = (help.find("Examples:"), help.find("Usage:"));
        assert!(examples.is_some() && examples < usage, "{help}");
        assert_says(&help, &[&format!("  strokefit {command} ")]);
        assert!(!help.contains('\u{1b}'), "{help}");
        assert!(!place.printed(&[command, "-h"]).is_empty());
    }
    for args in ["--help", "--version"] {
        assert!(!place.printed(args).is_empty(), "{args}");
    }
    assert_eq!(place.run("").status.code(), Some(2));
}

/// Every example of the help of `fit` is understood, up to the files that it names.
#[test]
fn examples_of_the_help_are_understood() {
    let place = Place::new();
    let help = place.printed("fit --help");
    let examples = help.lines().map(str::trim);
    let examples = examples.filter(|line| line.starts_with("strokefit fit "));
    let mut tried = 0;
    for example in examples {
        let example = example.split("  ").next().unwrap().replace('\'', "");
        let words = example
            .split(" > ")
            .next()
            .unwrap()
            .replace("strokefit ", "");
        let has_config = words.contains("--config");
        let config = if has_config { "" } else { "--config gone.toml" };
        let said = place.said(&format!("{words} {config}"), 1);
        assert_says(&said, &["no such file"]);
        if !has_config {
            place.done(&format!("{words} --print-config"));
        }
        tried += 1;
    }
    assert!(tried >= 5, "{help}");
}

#[test]
fn typos_are_answered_with_what_was_meant() {
    let place = Place::new();
    place.picture("cat.png", 30, 20);
    for (args, status, words) in [
        (
            "fit cat.png -o out.svg --storkes 3",
            2,
            ["--storkes", "'--strokes'"],
        ),
        (
            "fit cat.png -o out.svg --preset drft",
            2,
            ["drft", "'draft'"],
        ),
        ("chck a b", 2, ["chck", "'check'"]),
        (
            "cat.png",
            2,
            ["hint: strokefit fit", "fit cat.png -o cat.svg"],
        ),
        (
            "cat.png -o c.svg",
            2,
            ["hint: strokefit fit", "fit cat.png -o c.svg"],
        ),
        (
            "fit cta.png -o out.svg",
            1,
            ["cta.png", "did you mean cat.png?"],
        ),
        (
            "render cat.pgn -o out.png",
            1,
            ["cat.pgn", "did you mean cat.png?"],
        ),
        ("fit cat.png", 2, ["no output is named", "add -o cat.svg"]),
    ] {
        assert_refused(&place, args, status, &["hint: ", words[0], words[1]]);
    }
    let words = ["zebra.jpg", "no such file"];
    assert_refused(&place, "fit zebra.jpg -o out.svg", 1, &words);
}

#[test]
fn completions_know_the_options() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = place.printed(&["completions", shell]);
        assert_says(&script, &["fit", "strokes", "preset", "config"]);
    }
}

/// The script that bash gets completes what it should, in a real bash.
#[test]
#[cfg(target_os = "linux")]
fn bash_completes_an_option() {
    let place = Place::new();
    place.file("strokefit.bash", place.printed("completions bash"));
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
    place.done("man -o man/man1 -q");
    for (page, words) in [
        ("strokefit.1", ["strokefit", "Exit status"]),
        ("strokefit-fit.1", ["strokes", "Examples"]),
        ("strokefit-check.1", ["renderer", "Examples"]),
    ] {
        let text = place.text(&format!("man/man1/{page}"));
        assert!(text.starts_with(".ie"), "{text}");
        assert_says(&text, &words);
    }
}

#[test]
#[cfg(unix)]
fn a_reader_that_goes_away_is_no_failure() {
    let place = Place::of_picture(30, 20);
    for args in [
        "fit --help",
        "completions bash",
        "fit in.png -o - -q --strokes 9",
    ] {
        let mut command = place.command(STROKEFIT);
        command.args(args.words());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(stderr(&output), "", "{args}");
        assert_eq!(output.status.code(), Some(0), "{args}");
    }
}
