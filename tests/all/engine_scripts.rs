//! `check` and the programs that it asks where they hang, fail or lie: scripts that the tests write, alone on
//! the `PATH`.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::Output;

use serde_json::{Value, json};

use crate::support::{Place, STROKEFIT, Words, assert_says, entry, record, rendered, stderr};
use strokefit::engines::ENGINES;
use strokefit::image::Image;

const SVG: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40\" height=\"20\" viewBox=\"0 0 40 20\">\n<rect width=\"40\" height=\"20\" fill=\"#336699\"/>\n</svg>\n";

/// A folder with a file `a.svg` and what it should look like, `a.png`, and an empty one for programs.
fn without_programs() -> Place {
    with_svg(SVG)
}

/// The same, with these elements at the end of the file.
fn with_elements(elements: &str) -> Place {
    with_svg(&SVG.replace("</svg>", &format!("{elements}\n</svg>")))
}

fn with_svg(svg: &str) -> Place {
    let place = Place::new();
    place.file("a.svg", svg);
    place.file("a.png", rendered(SVG).encode_png().unwrap());
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

    fn check(&self, args: &str) -> Output {
        let mut command = self.command(STROKEFIT);
        command.args(["check", "a.svg"]).args(args.words());
        command.env("PATH", self.path("bin")).output().unwrap()
    }

    /// The output of a check that ends with `status` and says these words on standard error.
    #[track_caller]
    fn checked(&self, args: &str, status: i32, words: &[&str]) -> Output {
        let output = self.check(args);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(status), "{said}");
        assert_says(&said, words);
        output
    }
}

fn not_drawn<'a>(record: &'a Value, name: &str) -> &'a Value {
    let entries = record["not_drawn"].as_array().unwrap();
    entries.iter().find(|e| e["renderer"] == name).unwrap()
}

#[test]
fn missing_programs_are_named_with_how_to_get_them_and_are_no_failure() {
    let place = without_programs();
    let said = stderr(&place.checked("a.png", 0, &[]));
    for engine in &ENGINES {
        let line = format!("{}: not installed: {}", engine.name, engine.install);
        assert!(said.lines().any(|l| l == line), "{said}");
    }
    assert!(place.check("a.png -q").stderr.is_empty());
    let record = record(&place.check("a.png --report -"));
    assert_eq!(record["renderers"].as_array().unwrap().len(), 1);
    assert_eq!(not_drawn(&record, "chromium")["installed"], false);
}

#[test]
fn a_missing_program_that_was_asked_for_is_a_failure() {
    let place = without_programs();
    let output = place.checked("a.png --renderer resvg,inkscape", 1, &[]);
    assert!(stderr(&output).starts_with("inkscape: not installed"));
    assert!(String::from_utf8_lossy(&output.stdout).contains("resvg"));
    place.checked("a.png --renderer paint", 2, &["chromium"]);
}

#[test]
fn a_program_that_hangs_is_ended_and_the_others_go_on() {
    let place = without_programs()
        .program("inkscape", "sleep 600")
        .copying("rsvg-convert", "a.png");
    let output = place.checked("a.png --timeout 1 --report -", 1, &["inkscape: "]);
    let record = record(&output);
    let inkscape = not_drawn(&record, "inkscape");
    assert_eq!(inkscape["installed"], true);
    assert_says(inkscape["reason"].as_str().unwrap(), &["ended after 1 s"]);
    let rsvg = entry(&record, "rsvg");
    assert_eq!(rsvg["passed"], true);
    assert_eq!(rsvg["version"], "9.8.7");
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
        let said = stderr(&place.checked("a.png", 1, &[]));
        let line = said.lines().find(|l| l.starts_with("cairosvg: ")).unwrap();
        assert_says(line, &words);
    }
}

#[test]
fn a_picture_of_another_size_is_refused() {
    let place = without_programs();
    let wide = Image::filled(80, 40, [0.2; 3]).unwrap();
    place.file("wide.png", wide.encode_png().unwrap());
    let place = place.copying("inkscape", "wide.png");
    place.checked("a.png", 1, &["80×40 px instead of 40×20"]);
}

#[test]
fn a_program_that_draws_something_else_fails_the_check() {
    let place = without_programs();
    let mut pixels = rendered(SVG).into_planes();
    pixels[1][3 * 40 + 7..][..9].fill(1.0);
    let spot = Image::new(40, 20, pixels).unwrap();
    place.file("spot.png", spot.encode_png().unwrap());
    let place = place.copying("rsvg-convert", "spot.png");
    for args in ["a.png --report -", "--report -"] {
        let record = record(&place.checked(args, 4, &["rsvg: draws the file"]));
        let rsvg = entry(&record, "rsvg");
        assert_eq!(rsvg["passed"], false);
        let other = &rsvg["against_resvg"];
        assert_eq!(
            json!([other["max_abs"], other["x"], other["y"]]),
            json!([153, 7, 3])
        );
    }
}

#[test]
fn without_a_picture_programs_are_compared_with_resvg() {
    let place = without_programs().copying("rsvg-convert", "a.png");
    let record = record(&place.check("--report -"));
    assert!(record["input"].is_null());
    assert!(entry(&record, "resvg")["fidelity"].is_null());
    let rsvg = entry(&record, "rsvg");
    assert!(rsvg["against_resvg"]["psnr_db"].is_null());
    assert_eq!(rsvg["passed"], true);
    place.checked("", 0, &[]);
}

#[test]
fn pictures_are_kept_beside_what_they_are_compared_with() {
    let place = without_programs().copying("rsvg-convert", "a.png");
    place.checked("a.png --pictures new/folder", 0, &[]);
    let size = |name: &str| {
        let image = Image::open(place.path("new/folder").join(name)).unwrap();
        (image.width(), image.height())
    };
    for name in ["resvg", "rsvg"] {
        assert_eq!(size(&format!("{name}.png")), (40, 20));
        assert_eq!(size(&format!("{name}-compared.png")), (4 * 40 + 3 * 8, 20));
    }
    let words = ["a.png: pictures cannot be written to this folder"];
    place.checked("a.png --pictures a.png", 1, &words);
}

#[test]
fn a_file_that_refers_to_others_is_given_to_no_program() {
    let image = r#"<image width="9" height="9" href="http://127.0.0.1:9/a.png"/>"#;
    let place = with_elements(image).program("inkscape", "touch \"$0.asked\"");
    let words = ["inkscape: not run, because line 3"];
    let output = place.checked("a.png --report -", 1, &words);
    assert!(!place.path("bin/inkscape.asked").exists());
    assert_eq!(record(&output)["lint"][0]["rule"], "external-reference");
}

#[test]
fn findings_are_in_the_table_and_in_the_report() {
    let line = r##"<path d="M1 1h9" stroke="#000" stroke-width="0.5"/>"##;
    let place = with_elements(line);
    let table = String::from_utf8(place.check("--report r.json").stdout).unwrap();
    assert_says(&table, &["\nwarning: line 3: thin-stroke: "]);
    let finding = &place.report("r.json")["lint"][0];
    assert_eq!(finding["rule"], "thin-stroke");
    assert_eq!(finding["severity"], "warning");
    assert_eq!(finding["lines"], json!([3]));
    for key in ["found", "why", "remedy"] {
        assert!(!finding[key].as_str().unwrap().is_empty(), "{finding}");
    }
}
