//! `strokefit-rig compare`: two programs draw the same pictures, each only once.

use std::fs;
use std::path::PathBuf;
use std::process::Output;

use crate::bench::{bench, lines};
use crate::support::place::Place;

const BAR: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="64" height="64"><path d="M8 8h40v30h-40z" fill="#2060c0"/></svg>"##;

/// A program that writes the bar, moved by so many px, and its report, and adds a line to the file `drawn`.
fn program(place: &Place, name: &str, moved: f32) -> PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let path = place.path(name);
    let svg = BAR.replace("M8 8", &format!("M{} 8", 8.0 + moved));
    let script = format!(
        r#"#!/bin/sh
echo "$*" >> drawn
while [ "$1" != -o ]; do shift; done
echo '{svg}' > "$2"
echo '{{"cpu_s": 0.5}}' > "$4"
"#
    );
    fs::write(&path, script).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    path
}

fn compare(place: &Place, old: &str, new: &str) -> Output {
    let args = [
        "compare",
        old,
        new,
        "-o",
        "out",
        "--samples",
        "tiny=art",
        "--kind",
        "tiny",
    ];
    bench(place, &args)
}

#[test]
fn a_drawing_that_is_worse_is_named_and_no_program_draws_twice() {
    let place = Place::new();
    fs::create_dir(place.path("art")).unwrap();
    fs::write(place.path("art/bar.svg"), BAR).unwrap();
    place.picture("art/noise.png", 64, 64);
    program(&place, "old", 0.0);
    program(&place, "new", 1.0);
    let output = compare(&place, "old", "new");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = lines(&output);
    let starts = |start: &str| said.iter().any(|line| line.starts_with(start));
    assert!(starts("| tiny | 2 | 0 | -"), "{said:#?}");
    assert!(starts("| CPU s | 0.50 | 0.50 | +0.0 % |"), "{said:#?}");
    assert!(
        starts("| bar | ") && starts("| ΔE00 at 1,024 px | 0.000 | "),
        "{said:#?}"
    );
    let drawn = || {
        fs::read_to_string(place.path("drawn"))
            .unwrap()
            .lines()
            .count()
    };
    assert_eq!(drawn(), 4);
    let again = compare(&place, "old", "old");
    assert_eq!(again.status.code(), Some(0), "{again:?}");
    assert!(
        lines(&again)
            .iter()
            .any(|line| line.starts_with("| tiny | 2 | 2 | +0.00 | "))
    );
    assert_eq!(drawn(), 4);
    let folder = fs::read_dir(place.path("out")).unwrap();
    let written = folder.filter_map(|entry| entry.unwrap().file_name().into_string().ok());
    let reports = written.filter(|name| name.starts_with("compare-") && name.ends_with(".json"));
    assert_eq!(reports.count(), 2);
}

#[test]
fn a_program_that_draws_nothing_is_a_failure_and_a_kind_that_is_none_is_refused() {
    let place = Place::new();
    fs::create_dir(place.path("art")).unwrap();
    fs::write(place.path("art/bar.svg"), BAR).unwrap();
    fs::write(place.path("text"), "no program").unwrap();
    let output = compare(&place, "text", "text");
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(lines(&output).iter().any(|line| line.ends_with(": FAIL")));
    let output = bench(
        &place,
        &["compare", "text", "text", "-o", "out", "--kind", "none"],
    );
    assert_eq!(output.status.code(), Some(1), "{output:?}");
}
