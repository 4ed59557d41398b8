//! Help and hints.

use crate::support::output::stderr;
use crate::support::place::Place;

#[test]
fn help_shows_examples_first() {
    let place = Place::new();
    for words in [&["--help"][..], &["lab", "--help"]] {
        let help = String::from_utf8(place.done(words).stdout).unwrap();
        let (examples, usage) = (help.find("Examples:"), help.find("Usage: strokefit-rig"));
        assert!(examples.is_some() && examples < usage, "{help}");
    }
}

#[test]
fn what_is_wrong_is_said_in_a_line_with_a_hint() {
    let place = Place::new();
    for (words, hint) in [
        (&["paretto"][..], "'pareto'"),
        (&["scaling", "-o", "out", "--shrot"], "'--short'"),
        (
            &["scaling"],
            "strokefit-rig scaling --help lists the options",
        ),
    ] {
        let output = place.run(words);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        let lines: Vec<&str> = said.lines().collect();
        assert!(
            lines.len() == 2 && lines[0].starts_with("error: "),
            "{said}"
        );
        assert!(
            lines[1].starts_with("hint: ") && lines[1].contains(hint),
            "{said}"
        );
    }
}
