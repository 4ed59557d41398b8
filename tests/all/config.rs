//! Options from a file, and options as a file.

use crate::support::{Place, assert_refused, stderr};

fn draw(place: &Place, options: &str) -> String {
    place.done(&format!("fit in.png -o out.svg {options}"));
    place.text("out.svg")
}

#[test]
fn a_printed_file_draws_the_same_bytes_as_the_flags() {
    let place = Place::of_picture(40, 30);
    for flags in [
        "--strokes 20 --opaque --precision 1 --seed 18446744073709551615",
        "--psnr 22.5 --preset draft --no-polish --background #102030",
        "--bytes 2500 --preset draft --coverage sigmoid>smoothstep --stages 2",
    ] {
        let printed = place.done(&format!("fit --print-config {flags}"));
        place.file("fit.toml", printed.stdout);
        let by_file = draw(&place, "--config fit.toml");
        assert!(draw(&place, flags) == by_file, "{flags}");
    }
}

#[test]
fn flags_override_the_file_wherever_they_stand() {
    let place = Place::of_picture(40, 30);
    place.file(
        "fit.toml",
        "strokes = 5\nopaque = true\nno-polish = true\nseed = 3\n",
    );
    let nine = "--strokes 9 --no-polish --seed 3";
    for (flags, with_file) in [
        (nine, "--config fit.toml --strokes 9 --no-opaque"),
        (nine, "--no-opaque --strokes=9 --config=fit.toml"),
        (
            "--strokes 5 --opaque --seed 3",
            "--config fit.toml --polish",
        ),
    ] {
        assert!(
            draw(&place, flags) == draw(&place, with_file),
            "{with_file}"
        );
    }
}

#[test]
fn a_file_may_name_the_outputs_and_come_by_pipe() {
    let place = Place::of_picture(40, 30);
    let text =
        b"output = '{stem}-drawn.svg'\nreport = '{stem}.json'\nstrokes = 8\npreset = 'draft'";
    let output = place.pipe("fit in.png --config -", text);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(place.names(), ["in-drawn.svg", "in.json", "in.png"]);
}

#[test]
fn files_that_say_nonsense_are_refused_with_the_line() {
    let with_file = "fit in.png -o out.svg --config fit.toml";
    let place = Place::of_picture(40, 30);
    for (text, words) in [
        (
            "# a comment\n\nstroks = 5",
            ["fit.toml:3", "stroks", "did you mean strokes?"],
        ),
        ("seed = 1\npsnr = -3", ["fit.toml:2", "-3", "decibels"]),
        ("preset = 'bst'", ["fit.toml:1", "bst", "best"]),
        ("opaque = 'yes'", ["fit.toml:1", "opaque", "true or false"]),
        (
            "[sheet]\nopaque = true",
            ["fit.toml:1", "sheet", "no option"],
        ),
    ] {
        place.file("fit.toml", text);
        assert_refused(&place, with_file, 2, &words);
    }
    for (text, words) in [
        ("strokes 5", ["fit.toml:1", "not TOML"]),
        ("", ["fit.toml", "empty"]),
    ] {
        place.file("fit.toml", text);
        assert_refused(&place, with_file, 1, &words);
    }
    let words = ["fti.toml", "no such file", "did you mean fit.toml?"];
    assert_refused(&place, "fit in.png -o out.svg --config fti.toml", 1, &words);
    let words = ["standard input", "both"];
    assert_refused(&place, "fit - -o out.svg --config -", 2, &words);
    let words = ["--strokes", "0"];
    assert_refused(&place, "fit --print-config --strokes 0", 2, &words);
}

#[test]
fn a_conflict_between_file_and_flag_is_a_refusal() {
    let place = Place::of_picture(40, 30);
    place.file(
        "fit.toml",
        "progressive = true\nstrokes = 5\npreset = 'draft'",
    );
    let args = "fit in.png -o out.svg --config fit.toml --no-polish";
    assert_refused(&place, args, 2, &["--progressive", "--no-polish"]);
    draw(&place, "--config fit.toml --no-polish --no-progressive");
}

#[test]
fn refining_takes_options_from_files_too() {
    let place = Place::of_picture(40, 30);
    draw(&place, "--strokes 5 --preset draft");
    place.file(
        "more.toml",
        "strokes = 15\npreset = 'draft'\nfreeze-base = true\n",
    );
    let refine = |name: &str, options: &str| {
        place.done(&format!("refine out.svg in.png -o {name} {options}"));
        place.text(name)
    };
    let flags = "--strokes 15 --preset draft --freeze-base";
    assert!(refine("a.svg", flags) == refine("b.svg", "--config more.toml"));
}
