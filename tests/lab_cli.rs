//! `strokefit lab` as its users meet it.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;
use std::process::{Command, Output};

fn lab(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_strokefit"))
        .arg("lab")
        .args(args)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn complaint(output: &Output) -> String {
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}

fn picture(folder: &Path, name: &str, width: u32, height: u32) {
    let level = |x: u32| (x * 37 % 256) as u8;
    let pixel = |x, y| image::Rgb([level(x), level(y), 90]);
    image::RgbImage::from_fn(width, height, pixel)
        .save(folder.join(name))
        .unwrap();
}

#[test]
fn an_experiment_fills_a_new_folder() {
    let folder = tempfile::tempdir().unwrap();
    let output = lab(folder.path(), &["compose", "-o", "a/b"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(output.stdout.is_empty());
    for name in ["compose.csv", "compose-opaque.png", "compose-half.png"] {
        assert!(folder.path().join("a/b").join(name).exists(), "{name}");
    }
}

#[test]
fn the_demo_goes_on_from_where_it_was_saved() {
    let folder = tempfile::tempdir().unwrap();
    picture(folder.path(), "a.png", 20, 10);
    picture(folder.path(), "b.png", 10, 20);
    let few = ["--strokes", "9", "--iterations", "4", "--every", "2"];
    let first = [&["article", "a.png", "-o", "one"], &few[..]].concat();
    assert_eq!(lab(folder.path(), &first).status.code(), Some(0));

    let load = [
        "--load",
        "one/article.json",
        "--coverage",
        "tanh>smoothstep",
    ];
    let next = [&["article", "a.png", "-o", "two"], &few[..], &load].concat();
    assert_eq!(lab(folder.path(), &next).status.code(), Some(0));
    assert!(folder.path().join("two/article-legend.gif").exists());

    let other = [&["article", "b.png", "-o", "three"], &few[..], &load].concat();
    let output = lab(folder.path(), &other);
    assert_eq!(output.status.code(), Some(2));
    assert!(complaint(&output).contains("20×10"));
}

#[test]
fn the_same_seed_is_the_same_drawing_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    picture(folder.path(), "a.png", 70, 40);
    let json = |threads: &str, seed: &str| {
        let few = ["--strokes", "50", "--iterations", "5", "--seed", seed];
        let args = [
            &["article", "a.png", "-o", "out", "--threads", threads],
            &few[..],
        ]
        .concat();
        assert_eq!(lab(folder.path(), &args).status.code(), Some(0));
        std::fs::read_to_string(folder.path().join("out/article.json")).unwrap()
    };
    assert_eq!(json("1", "3"), json("4", "3"));
    assert_ne!(json("1", "3"), json("1", "4"));
}

#[test]
fn what_cannot_be_done_is_said_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "x").unwrap();
    picture(folder.path(), "a.png", 4, 4);
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
        let output = lab(folder.path(), args);
        assert_eq!(output.status.code(), Some(status), "{args:?} {output:?}");
        assert!(complaint(&output).contains(named), "{output:?}");
    }
}
