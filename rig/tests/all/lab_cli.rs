//! `strokefit-rig lab` as its users meet it.

use std::process::Output;

use crate::support::output::stderr;
use crate::support::place::Place;

fn complaint(output: &Output) -> String {
    let text = stderr(output);
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}

#[test]
fn an_experiment_fills_a_new_folder() {
    let place = Place::new();
    let output = place.done(&["lab", "field", "-o", "a/b"]);
    assert!(output.stdout.is_empty());
    for name in ["field.csv", "field-streams.png"] {
        assert!(place.path("a/b").join(name).exists(), "{name}");
    }
}

#[test]
fn the_same_seed_is_the_same_drawing_on_any_number_of_threads() {
    let place = Place::new();
    place.picture("a.png", 70, 40);
    let json = |threads: &str, seed: &str| {
        let few = ["--strokes", "50", "--iterations", "5", "--seed", seed];
        let args = [
            &["lab", "article", "a.png", "-o", "out", "--threads", threads],
            &few[..],
        ]
        .concat();
        place.done(&args);
        std::fs::read_to_string(place.path("out/article.json")).unwrap()
    };
    assert_eq!(json("1", "3"), json("4", "3"));
    assert_ne!(json("1", "3"), json("1", "4"));
}

#[test]
fn what_cannot_be_done_is_said_in_a_line() {
    let place = Place::new();
    std::fs::write(place.path("file"), "x").unwrap();
    place.picture("a.png", 4, 4);
    let cases: [(&[&str], i32, &str); 3] = [
        (&["field", "-o", "file/in"], 1, "file/in"),
        (&["article", "none.png", "-o", "out"], 1, "none.png"),
        (
            &["article", "a.png", "-o", "out", "--coverage", "gauss"],
            2,
            "gauss",
        ),
    ];
    for (args, status, named) in cases {
        let output = place.run(&[&["lab"], args].concat());
        assert_eq!(output.status.code(), Some(status), "{args:?} {output:?}");
        assert!(complaint(&output).contains(named), "{output:?}");
    }
}
