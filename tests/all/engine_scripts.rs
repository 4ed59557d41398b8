//! `check` and the programs that it asks where they hang, fail or lie: scripts that the tests write, alone on
//! the `PATH`.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::Output;

use crate::support::output::stderr;
use crate::support::place::{Place, STROKEFIT};
use crate::support::verdicts::{entry, record};
use serde_json::Value;
use strokefit::engines::ENGINES;
use strokefit::image::Image;
use strokefit::verify::{self, Size};

const SVG: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40\" height=\"20\" viewBox=\"0 0 40 20\">\n<rect width=\"40\" height=\"20\" fill=\"#336699\"/>\n</svg>\n";

/// A folder with a file `a.svg` and what it should look like, `a.png`, and an empty one for programs.
fn without_programs() -> Place {
    let place = Place::new();
    let picture = verify::render(SVG, Size::Scale(1.0), None).unwrap();
    fs::write(place.path("a.svg"), SVG).unwrap();
    fs::write(place.path("a.png"), picture.encode_png().unwrap()).unwrap();
    fs::create_dir(place.path("bin")).unwrap();
    place
}

impl Place {
    /// A program that tells its version and else does what `script` says; `$out` is the
    /// picture that it should leave.
    fn program(self, name: &str, script: &str) -> Self {
        let text = format!(
            "#!/bin/sh\nif [ \"$1\" = --version ]; then echo \"$0 version 9.8.7\"; exit; fi\n\
             PATH=/usr/bin:/bin\nout=$PWD/drawing.png\n{script}\n"
        );
        let path = self.path(&format!("bin/{name}"));
        fs::write(&path, text).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        self
    }

    /// A program that leaves a copy of this picture.
    fn copying(self, name: &str, picture: &str) -> Self {
        let script = format!("cp '{}' \"$out\"", self.path(picture).display());
        self.program(name, &script)
    }

    fn check(&self, args: &[&str]) -> Output {
        let mut command = self.command(STROKEFIT);
        command.args(["check", "a.svg"]).args(args);
        command.env("PATH", self.path("bin")).output().unwrap()
    }
}

fn not_drawn<'a>(record: &'a Value, name: &str) -> &'a Value {
    let entries = record["not_drawn"].as_array().unwrap();
    entries.iter().find(|e| e["renderer"] == name).unwrap()
}

#[test]
fn missing_programs_are_named_with_how_to_get_them_and_are_no_failure() {
    let place = without_programs();
    let output = place.check(&["a.png"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for engine in &ENGINES {
        let line = format!("{}: not installed: {}", engine.name, engine.install);
        assert!(
            stderr(&output).lines().any(|l| l == line),
            "{}",
            stderr(&output)
        );
    }
    assert!(place.check(&["a.png", "-q"]).stderr.is_empty());
    let record = record(&place.check(&["a.png", "--report", "-"]));
    assert_eq!(record["renderers"].as_array().unwrap().len(), 1);
    assert_eq!(not_drawn(&record, "chromium")["installed"], false);
}

#[test]
fn a_missing_program_that_was_asked_for_is_a_failure() {
    let place = without_programs();
    let output = place.check(&["a.png", "--renderer", "resvg,inkscape"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).starts_with("inkscape: not installed"),
        "{}",
        stderr(&output)
    );
    assert!(String::from_utf8_lossy(&output.stdout).contains("resvg"));
    let output = place.check(&["a.png", "--renderer", "paint"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("chromium"), "{}", stderr(&output));
}

#[test]
fn a_program_that_hangs_is_ended_and_the_others_go_on() {
    let place = without_programs()
        .program("inkscape", "sleep 600")
        .copying("rsvg-convert", "a.png");
    let output = place.check(&["a.png", "--timeout", "1", "--report", "-"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("inkscape: "),
        "{}",
        stderr(&output)
    );
    let record = record(&output);
    let inkscape = not_drawn(&record, "inkscape");
    assert_eq!(inkscape["installed"], true);
    assert!(
        inkscape["reason"]
            .as_str()
            .unwrap()
            .contains("ended after 1 s"),
        "{record}"
    );
    let rsvg = entry(&record, "rsvg");
    assert_eq!(
        (&rsvg["passed"], &rsvg["version"]),
        (&Value::Bool(true), &"9.8.7".into())
    );
}

#[test]
fn a_program_that_fails_is_quoted() {
    for (script, words) in [
        (
            "echo first >&2; echo 'out of paint' >&2; exit 3",
            ["exit status: 3", "out of paint"],
        ),
        (
            "echo no picture > \"$out\"",
            ["its picture", "not a picture"],
        ),
        ("kill -9 $$", ["left no picture", "signal: 9"]),
    ] {
        let place = without_programs().program("cairosvg", script);
        let output = place.check(&["a.png"]);
        assert_eq!(output.status.code(), Some(1));
        for word in words {
            let said = stderr(&output);
            let line = said.lines().find(|l| l.starts_with("cairosvg: ")).unwrap();
            assert!(line.contains(word), "{line}");
        }
    }
}

#[test]
fn a_picture_of_another_size_is_refused() {
    let place = without_programs();
    let wide = Image::filled(80, 40, [0.2; 3])
        .unwrap()
        .encode_png()
        .unwrap();
    fs::write(place.path("wide.png"), wide).unwrap();
    let place = place.copying("inkscape", "wide.png");
    let output = place.check(&["a.png"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("80×40 px instead of 40×20"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_program_that_draws_something_else_fails_the_check() {
    let place = without_programs();
    let mut pixels = verify::render(SVG, Size::Scale(1.0), None)
        .unwrap()
        .into_planes();
    pixels[1][3 * 40 + 7..][..9].fill(1.0);
    let spot = Image::new(40, 20, pixels).unwrap();
    fs::write(place.path("spot.png"), spot.encode_png().unwrap()).unwrap();
    let place = place.copying("rsvg-convert", "spot.png");
    for args in [&["a.png", "--report", "-"][..], &["--report", "-"]] {
        let output = place.check(args);
        assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
        assert!(
            stderr(&output).contains("rsvg: draws the file"),
            "{}",
            stderr(&output)
        );
        let record = record(&output);
        let rsvg = entry(&record, "rsvg");
        assert_eq!(rsvg["passed"], false);
        let other = &rsvg["against_resvg"];
        assert_eq!(
            (&other["max_abs"], &other["x"], &other["y"]),
            (&153.into(), &7.into(), &3.into())
        );
    }
}

#[test]
fn without_a_picture_programs_are_compared_with_resvg() {
    let place = without_programs().copying("rsvg-convert", "a.png");
    let record = record(&place.check(&["--report", "-"]));
    assert!(record["input"].is_null());
    assert!(entry(&record, "resvg")["fidelity"].is_null());
    let rsvg = entry(&record, "rsvg");
    assert_eq!(
        (&rsvg["against_resvg"]["psnr_db"], &rsvg["passed"]),
        (&Value::Null, &true.into())
    );
    assert_eq!(place.check(&[]).status.code(), Some(0));
}

#[test]
fn pictures_are_kept_beside_what_they_are_compared_with() {
    let place = without_programs().copying("rsvg-convert", "a.png");
    assert_eq!(
        place
            .check(&["a.png", "--pictures", "new/folder"])
            .status
            .code(),
        Some(0)
    );
    let size = |name: &str| {
        let image = Image::open(place.path("new/folder").join(name)).unwrap();
        (image.width(), image.height())
    };
    for name in ["resvg", "rsvg"] {
        assert_eq!(size(&format!("{name}.png")), (40, 20));
        assert_eq!(size(&format!("{name}-compared.png")), (4 * 40 + 3 * 8, 20));
    }
    let output = place.check(&["a.png", "--pictures", "a.png"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("a.png: pictures cannot be written to this folder"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_file_that_refers_to_others_is_given_to_no_program() {
    let place = without_programs().program("inkscape", "touch \"$0.asked\"");
    let body = "<image width=\"9\" height=\"9\" href=\"http://127.0.0.1:9/a.png\"/>\n</svg>";
    fs::write(place.path("a.svg"), SVG.replace("</svg>", body)).unwrap();
    let output = place.check(&["a.png", "--report", "-"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("inkscape: not run, because line 3"),
        "{}",
        stderr(&output)
    );
    assert!(!place.path("bin/inkscape.asked").exists());
    assert_eq!(record(&output)["lint"][0]["rule"], "external-reference");
}

#[test]
fn findings_are_in_the_table_and_in_the_report() {
    let place = without_programs();
    let body = "<path d=\"M1 1h9\" stroke=\"#000\" stroke-width=\"0.5\"/>\n</svg>";
    fs::write(place.path("a.svg"), SVG.replace("</svg>", body)).unwrap();
    let output = place.check(&["--report", "r.json"]);
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(
        table
            .lines()
            .any(|l| l.starts_with("warning: line 3: thin-stroke: ")),
        "{table}"
    );
    let record = place.report("r.json");
    let finding = &record["lint"][0];
    assert_eq!(
        (&finding["rule"], &finding["severity"]),
        (&"thin-stroke".into(), &"warning".into())
    );
    assert_eq!(finding["lines"], serde_json::json!([3]));
    for key in ["found", "why", "remedy"] {
        assert!(!finding[key].as_str().unwrap().is_empty(), "{finding}");
    }
}
