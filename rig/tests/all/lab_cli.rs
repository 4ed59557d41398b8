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
    let output = place.done(&["lab", "compose", "-o", "a/b"]);
    assert!(output.stdout.is_empty());
    for name in ["compose.csv", "compose-opaque.png", "compose-half.png"] {
        assert!(place.path("a/b").join(name).exists(), "{name}");
    }
}

#[test]
fn the_demo_goes_on_from_where_it_was_saved() {
    let place = Place::new();
    place.picture("a.png", 20, 10);
    place.picture("b.png", 10, 20);
    let few = ["--strokes", "9", "--iterations", "4", "--every", "2"];
    let first = [&["lab", "article", "a.png", "-o", "one"], &few[..]].concat();
    place.done(&first);

    let load = [
        "--load",
        "one/article.json",
        "--coverage",
        "tanh>smoothstep",
    ];
    let next = [&["lab", "article", "a.png", "-o", "two"], &few[..], &load].concat();
    place.done(&next);
    assert!(place.path("two/article-legend.gif").exists());

    let other = [&["lab", "article", "b.png", "-o", "three"], &few[..], &load].concat();
    let output = place.run(&other);
    assert_eq!(output.status.code(), Some(2));
    assert!(complaint(&output).contains("20×10"));
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
    let cases: [(&[&str], i32, &str); 4] = [
        (&["sdf", "-o", "file/in"], 1, "file/in"),
        (&["article", "none.png", "-o", "out"], 1, "none.png"),
        (
            &["article", "a.png", "-o", "out", "--coverage", "gauss"],
            2,
            "gauss",
        ),
        (
            &["article", "a.png", "-o", "out", "--load", "file"],
            2,
            "file",
        ),
    ];
    for (args, status, named) in cases {
        let output = place.run(&[&["lab"], args].concat());
        assert_eq!(output.status.code(), Some(status), "{args:?} {output:?}");
        assert!(complaint(&output).contains(named), "{output:?}");
    }
}
