//! `strokefit-rig` as its users meet it: files, lines, exit statuses, and going on where it stopped.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::Output;

use crate::support::place::{Place, STROKEFIT};

pub(crate) fn bench(place: &Place, args: &[&str]) -> Output {
    // Peers that happen to be installed would only take time.
    bench_beside("", place, args)
}

/// With the programs in the folders `path`.
pub(crate) fn bench_beside(path: &str, place: &Place, args: &[&str]) -> Output {
    place
        .command(STROKEFIT)
        .args(args)
        .env("PATH", path)
        .output()
        .unwrap()
}

/// The whole path of a file of the samples.
pub(crate) fn sample(path: &str) -> String {
    format!("{}/../samples/{path}", env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn lines(output: &Output) -> Vec<String> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines().map(str::to_owned).collect()
}

/// The results of `pareto`, by their files' names.
fn results(place: &Place) -> BTreeMap<PathBuf, serde_json::Value> {
    let files = fs::read_dir(place.path("out/svg")).unwrap();
    let paths = files.map(|file| file.unwrap().path());
    let read = |path: &PathBuf| serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    paths
        .filter(|path| path.extension().unwrap() == "json")
        .map(|path| (path.clone(), read(&path)))
        .collect()
}

const FEW: [&str; 7] = [
    "pareto",
    "a.png",
    "-o",
    "out",
    "--short",
    "--settings",
    "--strokes 12 --preset draft",
];

#[test]
fn pareto_writes_its_report() {
    let place = Place::new();
    place.picture("a.png", 40, 30);
    let output = bench(&place, &FEW);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    for name in [
        "pareto.csv",
        "pareto.json",
        "pareto.md",
        "pareto.png",
        "a-time.svg",
        "a-bytes.svg",
        "a-seen.svg",
    ] {
        assert!(place.path("out").join(name).exists(), "{name}");
    }
    let results = results(&place);
    let of = |family: &str| results.values().filter(|r| r["family"] == family).count();
    assert_eq!([of("strokefit"), of("article")], [3, 2], "{results:?}");
    for (path, result) in &results {
        assert!(path.with_extension("svg").exists(), "{path:?}");
        assert!(result["cpu_s"].as_f64().is_some(), "{result}");
    }
    for line in lines(&output) {
        let verdict = line.rsplit(": ").next().unwrap();
        assert!(
            ["pass", "holds", "does not hold"].contains(&verdict),
            "{line}"
        );
    }
}

#[test]
fn a_run_goes_on_where_it_stopped() {
    let place = Place::new();
    place.picture("a.png", 40, 30);
    assert_eq!(bench(&place, &FEW).status.code(), Some(0));
    let whole = results(&place);
    // As if the process had been killed while it wrote a file, and before it wrote another.
    let mut fits = whole.iter().filter(|(_, r)| r["family"] == "strokefit");
    let [cut, lost] = [fits.next().unwrap().0, fits.next().unwrap().0];
    let recipe = whole
        .iter()
        .find(|(_, r)| r["family"] == "article")
        .unwrap();
    let written = fs::metadata(recipe.0).unwrap().modified().unwrap();
    fs::write(cut, "{\"picture\":").unwrap();
    fs::remove_file(lost).unwrap();
    let again = bench(&place, &FEW);
    assert_eq!(again.status.code(), Some(0), "{again:?}");
    let kept = fs::metadata(recipe.0).unwrap().modified().unwrap();
    assert_eq!(kept, written, "what was there is not measured again");
    let found = results(&place);
    assert!(whole.keys().all(|path| found.contains_key(path)));
}

#[test]
fn what_cannot_be_measured_is_said_in_a_line() {
    let place = Place::new();
    place.picture("a.png", 40, 30);
    fs::create_dir(place.path("b")).unwrap();
    place.picture("b/a.png", 40, 30);
    let cases: [(&[&str], i32, &str); 2] = [
        (&["pareto", "a.png", "b/a.png", "-o", "out"], 2, "called a"),
        (&["pareto", "missing.png", "-o", "out"], 1, "missing.png"),
    ];
    for (args, status, named) in cases {
        let output = bench(&place, args);
        assert_eq!(output.status.code(), Some(status), "{args:?} {output:?}");
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(text.lines().count() == 1 && text.contains(named), "{text}");
    }
}

#[test]
fn a_case_that_fails_is_told_and_the_rest_goes_on() {
    let place = Place::new();
    place.picture("a.png", 40, 30);
    let wrong = [&FEW[..], &["--settings", "--wrong 1"]].concat();
    let output = bench(&place, &wrong);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let mut failed = lines(&output);
    failed.retain(|line| line.ends_with(": FAIL"));
    assert!(
        failed.len() == 1 && failed[0].contains("--wrong"),
        "{failed:?}"
    );
    assert!(place.path("out/pareto.png").exists());
}

/// A program in the folder `programs`.
#[cfg(unix)]
fn program(place: &Place, name: &str, script: &str) {
    use std::os::unix::fs::PermissionsExt;
    let path = place.path("programs").join(name);
    fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
}

/// A program that draws a grey page to the file after the word `-o`, and one that says why it does not.
#[cfg(unix)]
#[test]
fn a_peer_that_fails_is_a_case_that_fails() {
    let place = Place::new();
    place.picture("a.png", 40, 30);
    fs::create_dir(place.path("programs")).unwrap();
    let page = r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="30"><rect width="40" height="30" fill="#808080"/></svg>"##;
    let draw = format!("while [ \"$1\" != -o ]; do shift; done; echo '{page}' > \"$2\"");
    program(&place, "primitive", &draw);
    program(&place, "vtracer", "echo 'no bits left' >&2; exit 3");
    let output = bench_beside(place.path("programs").to_str().unwrap(), &place, &FEW);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let of = |name: &str| -> Vec<String> {
        let start = format!("a, {name} ");
        let all = lines(&output).into_iter();
        all.filter(|line| line.starts_with(&start)).collect()
    };
    let (drawn, failed) = (of("primitive"), of("vtracer"));
    let passes = |line: &String| line.ends_with(": pass");
    assert!(!drawn.is_empty() && drawn.iter().all(passes), "{drawn:?}");
    let told =
        |line: &String| line.contains("no bits left (exit status: 3)") && line.ends_with(": FAIL");
    assert!(!failed.is_empty() && failed.iter().all(told), "{failed:?}");
    assert!(place.path("out/pareto.png").exists());
}

#[test]
fn drawings_are_found_again_stroke_by_stroke() {
    let place = Place::new();
    let icon = |name: &str| sample(&format!("icons/{name}.svg"));
    let (clock, zap) = (icon("clock"), icon("zap"));
    let output = bench(&place, &["inverse", &clock, &zap, "-o", "out", "--short"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let lines = lines(&output);
    let found = |start: &str| lines.iter().find(|line| line.starts_with(start)).unwrap();
    assert!(found("clock").contains(" 2 elements of 2,"), "{lines:?}");
    assert!(found("zap").contains(" 1 elements of 1,"), "{lines:?}");
    assert!(
        found("crossings").contains(" 3 elements of 3,"),
        "{lines:?}"
    );
    assert!(
        found("translucent").contains(" 2 elements of 2,"),
        "{lines:?}"
    );
    for name in [
        "inverse.csv",
        "inverse.json",
        "inverse.md",
        "inverse.png",
        "clock-96.svg",
    ] {
        assert!(place.path("out").join(name).exists(), "{name}");
    }
    // Who is not installed is said once, each in a line.
    let said = String::from_utf8(output.stderr).unwrap();
    for peer in ["pyautotrace", "potrace", "vtracer", "inkscape"] {
        let start = format!("{peer}: not measured");
        assert_eq!(said.matches(&start).count(), 1, "{said}");
    }
}

#[test]
fn filled_drawings_are_found_again_beside_their_artists() {
    let place = Place::new();
    fs::create_dir(place.path("art")).unwrap();
    let svg = |body: &str| {
        format!(r##"<svg xmlns="http://www.w3.org/2000/svg" width="32" height="32">{body}</svg>"##)
    };
    let bars =
        r##"<path fill="#d03020" d="M4 6h24v6H4z"/><path fill="#2060c0" d="M4 18h24v6H4z"/>"##;
    fs::write(place.path("art/flags__bars.svg"), svg(bars)).unwrap();
    fs::write(place.path("art/empty.svg"), svg("")).unwrap();
    fs::write(place.path("art/notes.txt"), "no drawing").unwrap();
    let args = [
        "inverse",
        "art",
        "-o",
        "out",
        "--short",
        "--sides",
        "48",
        "--damage",
        "clean,noise8",
    ];
    let output = bench(&place, &args);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let lines = lines(&output);
    let starts = |line: &String, start| line.starts_with(start) && line.ends_with(" px off: pass");
    let expected = [
        "flags__bars at 48 px: ",
        "flags__bars at 48 px, strokefit strokes: ",
        "flags__bars at 48 px, noise 8: ",
        "flags__bars at 48 px, noise 8, strokefit strokes: ",
    ];
    assert_eq!(lines.len(), expected.len(), "{lines:?}");
    for (line, start) in lines.iter().zip(expected) {
        assert!(starts(line, start), "{line}");
    }
    for name in [
        "shapes.csv",
        "shapes.json",
        "shapes.md",
        "shapes.png",
        "flags__bars-48.svg",
        "flags__bars-48-noise8-strokefit-strokes.svg",
    ] {
        assert!(place.path("out").join(name).exists(), "{name}");
    }
    assert!(
        !place.path("out/inverse.csv").exists(),
        "no drawing of strokes"
    );
    let table = fs::read_to_string(place.path("out/shapes.csv")).unwrap();
    let row = "flags__bars,flags,48,clean,strokefit,2,";
    assert!(table.lines().nth(1).unwrap().starts_with(row), "{table}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("not measured: empty: nothing is painted"),
        "{said}"
    );
}

/// One that draws a centre line without a width, one that fills areas, and one that fails.
#[cfg(unix)]
#[test]
fn peers_trace_the_pictures_of_known_drawings() {
    let place = Place::new();
    fs::create_dir(place.path("programs")).unwrap();
    let svg = |path: &str| {
        format!(r##"<svg xmlns="http://www.w3.org/2000/svg" width="96" height="96">{path}</svg>"##)
    };
    let stroke = svg(r##"<path style="stroke:#000000; fill:none;" d="M20 20L76 76"/>"##);
    let area = svg(r##"<path fill="#000000" d="M20 20L76 20L76 76z"/>"##);
    let version = "[ \"$1\" != --version ] || { echo pyautotrace 1; exit; }";
    let draw = format!("{version}; echo '{stroke}' > \"$2\"");
    program(&place, "pyautotrace", &draw);
    let draw = format!("while [ \"$1\" != --output ]; do shift; done; echo '{area}' > \"$2\"");
    program(&place, "potrace", &draw);
    program(&place, "vtracer", "echo 'no bits left' >&2; exit 3");
    let zap = sample("icons/zap.svg");
    let programs = place.path("programs");
    let args = ["inverse", &zap, "-o", "out", "--short"];
    let output = bench_beside(programs.to_str().unwrap(), &place, &args);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let lines = lines(&output);
    let line = |peer: &str| {
        let start = format!("zap at 96 px, {peer}: ");
        lines.iter().find(|line| line.starts_with(&start)).unwrap()
    };
    assert!(line("pyautotrace").contains("1 elements of 1, 2 points of "));
    assert!(line("pyautotrace").contains(", centre lines "));
    let areas = line("potrace");
    assert!(
        areas.ends_with(" px off: pass") && !areas.contains("centre lines"),
        "{areas}"
    );
    let failed = line("vtracer");
    assert!(failed.contains("no bits left (exit status: 3)") && failed.ends_with(": FAIL"));
    // It tells no widths, so it is told that of the drawing: 2 of 24.
    let told = fs::read_to_string(place.path("out/zap-96-pyautotrace.svg")).unwrap();
    assert!(told.contains(r#"stroke-width="8.00""#), "{told}");
    assert!(!place.path("out/zap-96-vtracer.svg").exists());
    let table = fs::read_to_string(place.path("out/inverse.csv")).unwrap();
    let cells = |row: &str| -> Vec<String> { row.split(',').map(str::to_owned).collect() };
    let head = cells(table.lines().next().unwrap());
    let row = table
        .lines()
        .find(|row| row.starts_with("zap,96,clean,potrace,1,1,1,1,"));
    let at = head.iter().position(|cell| cell == "mean_px").unwrap();
    assert_eq!(
        cells(row.unwrap())[at..at + 2],
        ["", ""],
        "areas have no centre lines"
    );
}

#[test]
fn scaling_writes_its_series() {
    let place = Place::new();
    let output = bench(&place, &["scaling", "-o", "out", "--short"]);
    // Growth is a matter of the machine: what is asked here is that it is told.
    assert!(
        output.status.code().is_some_and(|code| code < 2),
        "{output:?}"
    );
    let lines = lines(&output);
    assert_eq!(lines.len(), 3, "{lines:?}");
    assert!(
        lines
            .iter()
            .all(|l| l.ends_with(": pass") || l.ends_with(": FAIL")),
        "{lines:?}"
    );
    let table = fs::read_to_string(place.path("out/scaling.csv")).unwrap();
    assert!(table.lines().count() > 7, "{table}");
}

#[test]
fn lines_in_ink_are_found_again_in_their_pictures() {
    let place = Place::new();
    let glyph = r#"<svg xmlns="http://www.w3.org/2000/svg" width="109" height="109"><path d="M20 30C50 28 70 28 90 30" fill="none" stroke="red"/></svg>"#;
    fs::write(place.path("a.svg"), glyph).unwrap();
    let args = ["inverse", "--ink", "--kanji", "a.svg", "-o", "out"];
    let output = bench(&place, &args);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let lines = lines(&output);
    assert!(
        lines[0].starts_with("kanji-a, strokefit: 1 of 1 lines whole"),
        "{lines:?}"
    );
    for name in [
        "ink.csv",
        "ink.md",
        "ink.json",
        "ink.png",
        "kanji-a.svg",
        "kanji-a.png",
        "kanji-a.truth.json",
    ] {
        assert!(place.path("out").join(name).exists(), "{name}");
    }
    // Its picture and truth are a drawing, too.
    let again = bench(
        &place,
        &["inverse", "--ink", "out/kanji-a.png", "-o", "again"],
    );
    assert_eq!(again.status.code(), Some(0), "{again:?}");
    let [first, second] = ["out", "again"].map(|folder| {
        let json = fs::read_to_string(place.path(folder).join("ink.json")).unwrap();
        let report: serde_json::Value = serde_json::from_str(&json).unwrap();
        report["entries"][0]["found"].clone()
    });
    assert_eq!(first, second);
}

#[test]
fn a_picture_in_ink_without_its_lines_is_refused_by_name() {
    let place = Place::new();
    place.picture("a.png", 40, 30);
    let args = ["inverse", "--ink", "a.png", "-o", "out"];
    for (json, status, said) in [
        (None, 1, "a.json: cannot be read"),
        (Some("[]"), 2, "a.json: no lines"),
        (Some("[[]]"), 2, "line 0 is empty"),
        (Some("[[[1, 2]]]"), 2, "a.json: invalid length 2"),
        (Some("[[[1, 2, -1]]]"), 2, "line 0 has [1.0, 2.0, -1.0]"),
    ] {
        if let Some(json) = json {
            fs::write(place.path("a.json"), json).unwrap();
        }
        let output = bench(&place, &args);
        assert_eq!(output.status.code(), Some(status), "{output:?}");
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(text.lines().count() == 1 && text.contains(said), "{text}");
    }
}
