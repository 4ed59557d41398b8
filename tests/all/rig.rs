//! `strokefit bench` and `strokefit lab` hand over to the program `strokefit-rig`.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::Output;

use crate::support::{Place, STROKEFIT, stderr};

/// Runs a copy of the program, which nothing lies beside but what is in this place, with `path` to look for others.
fn run(place: &Place, path: &str, args: &[&str]) -> Output {
    let own = place.path("strokefit");
    fs::copy(STROKEFIT, &own).unwrap();
    place
        .command(own)
        .args(args)
        .env("PATH", place.path(path))
        .output()
        .unwrap()
}

/// A program that says its arguments, and ends with status 7.
fn rig(place: &Place, name: &str) {
    let path = place.path(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, "#!/bin/sh\nprintf '<%s>' \"$@\"\nexit 7\n").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn all_arguments_and_the_status_are_those_of_the_other_program() {
    for (name, path) in [
        ("strokefit-rig", "none"),
        ("programs/strokefit-rig", "programs"),
    ] {
        let place = Place::new();
        rig(&place, name);
        for (args, passed) in [
            (
                &["bench", "pareto", "a b.png", "-q", "--short"][..],
                "<pareto><a b.png><-q><--short>",
            ),
            (&["lab", "circle", "-o", "out"], "<lab><circle><-o><out>"),
            (&["-q", "bench", "scaling"], "<--quiet><scaling>"),
            (&["bench", "--help"], "<--help>"),
        ] {
            let output = run(&place, path, args);
            assert_eq!(
                output.status.code(),
                Some(7),
                "{args:?}: {}",
                stderr(&output)
            );
            assert_eq!(String::from_utf8_lossy(&output.stdout), passed, "{args:?}");
        }
    }
}

#[test]
fn where_it_is_not_installed_the_command_is_named() {
    let place = Place::new();
    let output = run(&place, "none", &["bench", "pareto", "a b.png", "-o", "out"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    let command = "cargo run --release -p rig -- pareto 'a b.png' -o out";
    assert!(
        said.lines().count() == 2 && said.trim().ends_with(command),
        "{said}"
    );
}
