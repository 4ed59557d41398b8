//! Several pictures at once: names, tables, failures, events.

use std::fs;

use serde_json::{Value, json};

use crate::support::{Place, STROKEFIT, assert_refused, assert_says, stderr};

const QUICK: &str = "--strokes 12 --preset draft";

#[test]
fn each_picture_has_its_files_and_its_row() {
    let place = Place::new();
    place.picture("a.png", 20, 30);
    place.picture("b c.png", 30, 20);
    fs::create_dir(place.path("out")).unwrap();
    // A name with a space is no words of a line.
    let mut args = vec!["fit", "a.png", "b c.png"];
    let words = format!("-o out/{{stem}}.svg --report {{stem}}.json {QUICK}");
    args.extend(words.split(' '));
    let table = place.said(&args, 0);
    assert_eq!(
        place.names(),
        ["a.json", "a.png", "b c.json", "b c.png", "out"]
    );
    let lines: Vec<_> = table.lines().collect();
    assert_eq!(lines.len(), 4, "{table}");
    for name in ["a", "b c"] {
        let record = place.report(&format!("{name}.json"));
        assert_eq!(record["input"]["path"], format!("{name}.png"));
        let bytes = place.bytes(&format!("out/{name}.svg")).len();
        assert_eq!(record["svg_bytes"], bytes);
        let mut rows = lines.iter();
        let row = rows
            .find(|line| line.starts_with(&format!("{name}.png")))
            .unwrap();
        assert!(row.contains(&format!(" {bytes} ")), "{table}");
    }
    assert_eq!(lines[3], "2 drawn, 0 failed");
}

#[test]
fn a_picture_alone_and_among_others_gives_the_same_bytes() {
    let place = Place::new();
    place.picture("a.png", 20, 30);
    place.picture("b.png", 30, 20);
    for words in ["a.png b.png -o {stem}.svg", "b.png -o alone.svg"] {
        place.done(&format!("fit {words} {QUICK}"));
    }
    assert!(place.bytes("b.svg") == place.bytes("alone.svg"));
}

#[test]
fn a_failure_does_not_stop_the_others_and_the_status_is_the_worst() {
    let place = Place::new();
    place.file("bad.png", "no picture");
    place.picture("good.png", 20, 30);
    let words = "bad.png gone.png good.png -o {stem}.svg";
    let said = place.said(&format!("fit {words} {QUICK}"), 1);
    assert_eq!(place.names(), ["bad.png", "good.png", "good.svg"]);
    assert_says(
        &said,
        &[
            "error: bad.png: not a picture",
            "error: gone.png: no such file",
            "1 drawn, 2 failed",
        ],
    );
    place.picture("other.png", 20, 31);
    let fit = |pictures: &str| format!("fit {pictures} -o {{stem}}.svg --psnr 99 {QUICK}");
    place.said(&fit("good.png bad.png"), 1);
    let said = place.said(&fit("good.png other.png"), 3);
    assert_says(&said, &["good.svg: target not reached"]);
}

#[test]
fn outputs_that_would_collide_are_refused_before_the_work() {
    let place = Place::new();
    place.picture("a.png", 20, 30);
    place.picture("b.png", 20, 30);
    fs::create_dir(place.path("in")).unwrap();
    place.picture("in/a.png", 20, 30);
    for (args, words) in [
        ("a.png b.png -o out.svg", ["out.svg", "{stem}"]),
        ("a.png b.png -o -", ["standard output", "{stem}"]),
        ("a.png in/a.png -o {stem}.svg", ["a.svg", "different names"]),
        (
            "a.png b.png -o {stem}.svg --report r.json",
            ["r.json", "{stem}"],
        ),
        (
            "a.png -o {stem}.svg --report ./a.svg",
            ["a.svg", "same place"],
        ),
        ("a.png -o - --events -", ["standard output", "same place"]),
        (
            "in/a.png b.png -o {stem}.svg -o {stem}.png",
            ["overwritten", "b.png"],
        ),
        (
            "a.png b.png -o {stem}.svg --events b.png",
            ["overwritten", "b.png"],
        ),
        ("- -o {stem}.svg", ["standard input", "{stem}"]),
    ] {
        assert_refused(&place, &format!("fit {args}"), 2, &words);
    }
    let words = ["a.png/a.svg", "is a file"];
    assert_refused(&place, "fit a.png b.png -o a.png/{stem}.svg", 1, &words);
}

#[test]
fn events_tell_of_each_stage_and_end_with_the_report() {
    let place = Place::new();
    place.picture("a.png", 40, 30);
    place.file("bad.png", "no picture");
    let words = "a.png bad.png -o {stem}.svg --events - --report {stem}.json -q";
    let text = place.run(&format!("fit {words} {QUICK}")).stdout;
    let text = String::from_utf8(text).unwrap();
    let events = text.lines().map(|line| serde_json::from_str(line).unwrap());
    let events: Vec<Value> = events.collect();
    let named = |name: &str| -> Vec<&Value> {
        let events = events.iter();
        events.filter(|event| event["event"] == name).collect()
    };
    let start = json!({"event": "start", "path": "a.png", "width": 40, "height": 30});
    assert_eq!(events[0], start);

    let (record, stages) = (place.report("a.json"), named("stage"));
    let expected = record["stages"].as_array().unwrap();
    assert_eq!(stages.len(), expected.len(), "{text}");
    for (event, stage) in stages.iter().zip(expected) {
        assert_eq!(event["stage"], stage["index"]);
        assert_eq!(event["iterations"], stage["iterations"]);
    }
    assert_eq!(named("polish").len(), 1, "{text}");
    assert_eq!(named("polish")[0]["done"], 1.0);
    let mut done = named("done")[0].clone();
    done.as_object_mut().unwrap().remove("event");
    assert_eq!(done, record);
    assert_eq!(named("failed")[0]["path"], "bad.png");
    assert_eq!(events.len(), stages.len() + 4, "{text}");
}

#[test]
#[cfg(target_os = "linux")]
fn names_that_are_not_unicode_work() {
    use std::os::unix::ffi::OsStrExt;
    let place = Place::new();
    place.picture("a.png", 20, 30);
    let odd = std::ffi::OsStr::from_bytes(b"x\xff.png");
    fs::copy(place.path("a.png"), place.path("a.png").with_file_name(odd)).unwrap();
    let output = place
        .command(STROKEFIT)
        .arg("fit")
        .arg(odd)
        .args(["-o", "{stem}.svg"])
        .args(QUICK.split(' '))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let drawn = std::ffi::OsStr::from_bytes(b"x\xff.svg");
    assert!(place.path("a.png").with_file_name(drawn).exists());
}
