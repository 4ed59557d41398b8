//! The file as other programs see it: Inkscape, librsvg, Chromium and CairoSVG, where installed.
//!
//! A test whose program is missing says so on standard error, even when the tests' output is
//! captured, and passes. `STROKEFIT_ENGINES=inkscape,rsvg` names programs that must be there: then
//! a missing one fails. The programs that hang, fail or lie are scripts that the tests write.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Duration;

use serde_json::Value;
use strokefit::engines::{ENGINES, Engine, Page};
use strokefit::image::Image;
use strokefit::metrics;
use strokefit::scene::{Scene, Shape, Stage, Stroke};
use strokefit::svg::{self, Form, WriteOptions};
use strokefit::verify::{self, Size};
use tempfile::TempDir;

const PATIENCE: Duration = Duration::from_secs(120);

/// The engine and its program; `None`, said loudly, where it is not installed.
fn installed(name: &str) -> Option<(&'static Engine, PathBuf)> {
    let engine = ENGINES.iter().find(|engine| engine.name == name).unwrap();
    if let Some(program) = engine.locate() {
        return Some((engine, program));
    }
    let required = std::env::var("STROKEFIT_ENGINES").unwrap_or_default();
    assert!(
        !required.split(',').any(|word| word == name),
        "{name} is required but not installed"
    );
    let test = std::thread::current().name().unwrap_or_default().to_owned();
    // Not by `eprintln!`, which is kept back for tests that pass.
    let _ = writeln!(
        io::stderr(),
        "SKIPPED {test}: {name} is not installed: {}",
        engine.install
    );
    None
}

fn path(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    path.to_str().unwrap().into()
}

fn strokefit(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_strokefit"));
    command.current_dir(folder);
    command
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {}", stderr(output)))
}

fn entry<'a>(record: &'a Value, name: &str) -> &'a Value {
    let entries = record["renderers"].as_array().unwrap();
    let found = entries.iter().find(|e| e["renderer"] == name);
    found.unwrap_or_else(|| panic!("{name} drew nothing: {record}"))
}

/// A module of tests for each engine.
macro_rules! for_each_engine {
    ($($module:ident)*) => {$(
        mod $module {
            const NAME: &str = stringify!($module);

            #[test]
            fn draws_fits_as_faithfully_as_resvg() {
                super::draws_fits_as_faithfully_as_resvg(NAME);
            }

            #[test]
            fn draws_every_kind_of_stroke() {
                super::draws_every_kind_of_stroke(NAME);
            }

            #[test]
            fn draws_every_form_of_file() {
                super::draws_every_form_of_file(NAME);
            }

            #[test]
            fn scales_to_the_size_asked_for() {
                super::scales_to_the_size_asked_for(NAME);
            }

            #[test]
            fn leaves_nothing_in_the_home() {
                super::leaves_nothing_in_the_home(NAME);
            }

            #[test]
            fn draws_what_inkscape_saved() {
                super::draws_what_inkscape_saved(NAME);
            }
        }
    )*};
}

for_each_engine!(inkscape rsvg chromium cairosvg);

fn draws_fits_as_faithfully_as_resvg(name: &str) {
    if installed(name).is_none() {
        return;
    }
    for (svg, picture) in [
        ("docs/pictures/chelsea-cat.svg", "samples/chelsea-cat.png"),
        (
            "docs/pictures/coffee-quality-35.svg",
            "samples/coffee-300.png",
        ),
        (
            "docs/pictures/noto-hibiscus.svg",
            "samples/noto-hibiscus.png",
        ),
    ] {
        let args = [
            "check",
            &path(svg),
            &path(picture),
            "--renderer",
            name,
            "--report",
            "-",
        ];
        let output = strokefit(Path::new(".")).args(args).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{svg}: {}", stderr(&output));
        let record = json(&output);
        let (resvg, other) = (entry(&record, "resvg"), entry(&record, name));
        let db = |entry: &Value| entry["fidelity"]["psnr_db"].as_f64().unwrap();
        assert!(db(other) >= db(resvg) - 0.6, "{svg}: {record}");
        assert!(
            other["against_resvg"]["psnr_db"].as_f64().unwrap() > 40.0,
            "{svg}: {record}"
        );
        assert!(
            other["version"]
                .as_str()
                .unwrap()
                .starts_with(|c: char| c.is_ascii_digit())
        );
    }
}

fn capsule(a: [f32; 2], b: [f32; 2], width: f32) -> Stroke {
    let shape = if a == b {
        Shape::dot(a.into())
    } else {
        Shape::capsule(a.into(), b.into())
    };
    Stroke {
        shape,
        radius: width / 2.0,
        color: [0.1, 0.3, 0.8],
        opacity: 1.0,
    }
}

/// Kinds of strokes that programs might treat apart, each a drawing of its own, 64×48 px.
fn kinds() -> Vec<(&'static str, Scene)> {
    let of = |strokes: Vec<Stroke>| Scene {
        stages: vec![Stage { strokes }],
        ..Scene::empty(64, 48, Some([1.0, 0.9, 0.7]))
    };
    let fan = |width: f32| {
        let end = |i: usize| (i as f32 * 0.26).sin_cos();
        (0..12).map(move |i| {
            let (y, x) = end(i);
            capsule(
                [32.0 + 4.0 * x, 24.0 + 4.0 * y],
                [32.0 + 20.0 * x, 24.0 + 20.0 * y],
                width,
            )
        })
    };
    let grid = |width| {
        (0..12).map(move |i| {
            let at = [6.3 + 5.1 * (i % 6) as f32, 9.7 + 23.4 * (i / 6) as f32];
            capsule(at, at, width)
        })
    };
    let faint = |strokes: Vec<Stroke>| strokes.into_iter().map(|s| Stroke { opacity: 0.2, ..s });
    vec![
        ("large dots", of(grid(4.6).collect())),
        ("smallest dots", of(grid(1.02).collect())),
        ("thinnest strokes", of(fan(1.02).collect())),
        (
            "faint thin strokes",
            of(faint(fan(1.02).collect()).collect()),
        ),
        (
            "partly off the page",
            of(vec![
                capsule([-30.0, 10.0], [10.0, 10.0], 9.0),
                capsule([60.0, -9.0], [90.0, 30.0], 5.0),
                capsule([20.0, 48.0], [44.0, 48.0], 3.0),
                capsule([-1000.0, 30.0], [1000.0, 33.0], 2.0),
            ]),
        ),
        (
            "covered",
            of(fan(2.0)
                .chain([capsule([0.0, 24.0], [64.0, 24.0], 90.0)])
                .collect()),
        ),
        (
            "shorter than wide",
            of(vec![capsule([30.0, 20.0], [30.4, 20.2], 25.0)]),
        ),
        (
            "many faint layers",
            of(vec![
                Stroke {
                    opacity: 0.15,
                    ..capsule([20.0, 20.0], [44.0, 28.0], 20.0)
                };
                8
            ]),
        ),
    ]
}

fn draws_every_kind_of_stroke(name: &str) {
    let Some((engine, program)) = installed(name) else {
        return;
    };
    for (kind, scene) in kinds() {
        let text = svg::write(&scene, &WriteOptions::default());
        let page = Page {
            svg: &text,
            width: 64,
            height: 48,
        };
        let drawn = engine.draw(&program, page, PATIENCE).unwrap().image;
        let resvg = verify::render(&text, Size::Scale(1.0), Some([1.0; 3])).unwrap();
        let db = metrics::psnr(&resvg, &drawn).unwrap();
        assert!(db >= 36.0, "{kind}: {db:.2} dB from resvg");
        let ground = Image::filled(64, 48, [1.0, 0.9, 0.7]).unwrap();
        let ink = |image| metrics::l1(&ground, image).unwrap();
        let ratio = ink(&drawn) / ink(&resvg);
        assert!(
            (0.95..1.05).contains(&ratio),
            "{kind}: {ratio:.3} × the ink of resvg"
        );
    }
}

fn draws_every_form_of_file(name: &str) {
    let Some((engine, program)) = installed(name) else {
        return;
    };
    let layers = kinds().into_iter().filter(|(kind, _)| *kind != "covered");
    let stages = layers.flat_map(|(_, scene)| scene.stages).collect();
    let scene = Scene {
        stages,
        ..Scene::empty(64, 48, Some([1.0, 0.9, 0.7]))
    };
    for form in [Form::Elements, Form::Plain, Form::Smallest, Form::Outlines] {
        let options = WriteOptions {
            form,
            ..WriteOptions::default()
        };
        let text = svg::write(&scene, &options);
        let page = Page {
            svg: &text,
            width: 64,
            height: 48,
        };
        let drawn = engine.draw(&program, page, PATIENCE).unwrap().image;
        let resvg = verify::render(&text, Size::Scale(1.0), Some([1.0; 3])).unwrap();
        let db = metrics::psnr(&resvg, &drawn).unwrap();
        assert!(db >= 36.0, "{form:?}: {db:.2} dB from resvg");
    }
}

fn scales_to_the_size_asked_for(name: &str) {
    let Some((engine, program)) = installed(name) else {
        return;
    };
    // Without a ground: the page is white.
    let scene = Scene {
        background: None,
        ..kinds().swap_remove(4).1
    };
    let text = svg::write(&scene, &WriteOptions::default());
    for (width, height) in [(32, 24), (64, 48), (640, 480)] {
        let page = Page {
            svg: &text,
            width,
            height,
        };
        let drawn = engine.draw(&program, page, PATIENCE).unwrap().image;
        let size = Size::Exact {
            width: width as u32,
            height: height as u32,
        };
        let resvg = verify::render(&text, size, Some([1.0; 3])).unwrap();
        let db = metrics::psnr(&resvg, &drawn).unwrap();
        assert!(db >= 36.0, "{width}×{height}: {db:.2} dB from resvg");
    }
}

fn leaves_nothing_in_the_home(name: &str) {
    // What keeps the home leaves it as it is by not being told another; it may look into it.
    let Some((engine, _)) = installed(name) else {
        return;
    };
    let (home, temporary) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let file = path("docs/pictures/noto-hibiscus.svg");
    let output = strokefit(home.path())
        .args(["check", &file, "--renderer", engine.name])
        .env("HOME", home.path())
        .env("TMPDIR", temporary.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for folder in [&home, &temporary] {
        let left: Vec<_> = fs::read_dir(folder.path())
            .unwrap()
            .map(|e| e.unwrap().path())
            .collect();
        assert!(left.is_empty(), "{left:?}");
    }
}

/// The file as Inkscape saves it, plain or with its own elements.
fn saved_by_inkscape(folder: &Path, file: &str, plain: bool) -> String {
    let (_, program) = installed("inkscape").unwrap();
    let saved = folder.join("saved.svg");
    let mut command = Command::new(program);
    command.arg(if plain {
        "--export-plain-svg"
    } else {
        "--export-type=svg"
    });
    command
        .arg(format!("--export-filename={}", saved.display()))
        .arg(file);
    command
        .env("HOME", folder)
        .env("INKSCAPE_PROFILE_DIR", folder)
        .env_remove("DISPLAY");
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    fs::read_to_string(saved).unwrap()
}

#[test]
fn a_round_trip_through_inkscape_keeps_the_drawing_and_its_layers() {
    if installed("inkscape").is_none() {
        return;
    }
    let file = path("docs/pictures/chelsea-cat.svg");
    let original = fs::read_to_string(&file).unwrap();
    let render = |text: &str| verify::render(text, Size::Scale(1.0), Some([1.0; 3])).unwrap();
    for plain in [true, false] {
        let folder = tempfile::tempdir().unwrap();
        let saved = saved_by_inkscape(folder.path(), &file, plain);
        assert_ne!(saved, original);
        let db = metrics::psnr(&render(&original), &render(&saved)).unwrap();
        assert!(db >= 45.0, "plain {plain}: {db:.2} dB");
        let count = |text: &str, word| text.matches(word).count();
        assert_eq!(count(&saved, "<path"), count(&original, "<path"));
        assert_eq!(
            count(&saved, "id=\"stage-"),
            count(&original, "id=\"stage-")
        );
        let layers = if plain {
            0
        } else {
            count(&original, "groupmode")
        };
        assert_eq!(count(&saved, "inkscape:groupmode=\"layer\""), layers);
        let worst = svg::lint(&saved)
            .into_iter()
            .find(|f| f.severity < svg::Severity::Note);
        assert_eq!(worst, None);
    }
}

#[test]
fn what_inkscape_saved_is_refined() {
    if installed("inkscape").is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (file, picture) = (
        path("docs/pictures/coffee-quality-20.svg"),
        path("samples/coffee-300.png"),
    );
    for plain in [true, false] {
        let saved = saved_by_inkscape(folder.path(), &file, plain);
        let refine = ["refine", "saved.svg", &picture, "-o", "better.svg"];
        let budget = ["--strokes", "300", "--preset", "draft"];
        let output = strokefit(folder.path())
            .args([&refine[..], &budget].concat())
            .output()
            .unwrap();
        assert_eq!(
            output.status.code(),
            Some(0),
            "plain {plain}: {}",
            stderr(&output)
        );
        let better = fs::read_to_string(folder.path().join("better.svg")).unwrap();
        let target = Image::open(&picture).unwrap();
        let db = |text: &str| verify::fidelity(text, &target).unwrap().psnr_db;
        let (before, after) = (db(&saved), db(&better));
        assert!(
            after > before + 1.0,
            "plain {plain}: {before:.2} dB, then {after:.2} dB"
        );
        assert!(better.matches("<path").count() > saved.matches("<path").count());
        let check = ["check", "better.svg", &picture, "--renderer", "inkscape"];
        let output = strokefit(folder.path()).args(check).output().unwrap();
        assert_eq!(
            output.status.code(),
            Some(0),
            "plain {plain}: {}",
            stderr(&output)
        );
    }
}

fn draws_what_inkscape_saved(name: &str) {
    if installed(name).is_none() || installed("inkscape").is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = path("docs/pictures/chelsea-cat.svg");
    for plain in [true, false] {
        saved_by_inkscape(folder.path(), &file, plain);
        let picture = path("samples/chelsea-cat.png");
        let args = ["check", "saved.svg", &picture, "--renderer", name];
        let output = strokefit(folder.path()).args(args).output().unwrap();
        assert_eq!(
            output.status.code(),
            Some(0),
            "plain {plain}: {}",
            stderr(&output)
        );
    }
}

#[cfg(unix)]
mod programs {
    //! Programs that are scripts of the tests' own, alone on the `PATH`.

    use super::*;
    use std::os::unix::fs::PermissionsExt;

    const SVG: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40\" height=\"20\" viewBox=\"0 0 40 20\">\n<rect width=\"40\" height=\"20\" fill=\"#336699\"/>\n</svg>\n";

    /// A folder with a file `a.svg`, what it should look like, `a.png`, and programs in `bin`.
    struct Place(TempDir);

    impl Place {
        fn new() -> Self {
            let place = Self(tempfile::tempdir().unwrap());
            let picture = verify::render(SVG, Size::Scale(1.0), None).unwrap();
            fs::write(place.path("a.svg"), SVG).unwrap();
            fs::write(place.path("a.png"), picture.encode_png().unwrap()).unwrap();
            fs::create_dir(place.path("bin")).unwrap();
            place
        }

        fn path(&self, name: &str) -> PathBuf {
            self.0.path().join(name)
        }

        /// A program that tells its version and else does what `script` says; `$out` is the
        /// picture that it should leave.
        fn program(self, name: &str, script: &str) -> Self {
            let text = format!(
                "#!/bin/sh\nif [ \"$1\" = --version ]; then echo \"$0 version 9.8.7\"; exit; fi\n\
                 PATH=/usr/bin:/bin\nout=$PWD/drawing.png\n{script}\n"
            );
            let path = self.path("bin").join(name);
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
            let mut command = strokefit(self.0.path());
            command
                .args(["check", "a.svg"])
                .args(args)
                .env("PATH", self.path("bin"));
            command.output().unwrap()
        }
    }

    fn not_drawn<'a>(record: &'a Value, name: &str) -> &'a Value {
        let entries = record["not_drawn"].as_array().unwrap();
        entries.iter().find(|e| e["renderer"] == name).unwrap()
    }

    #[test]
    fn missing_programs_are_named_with_how_to_get_them_and_are_no_failure() {
        let place = Place::new();
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
        let record = json(&place.check(&["a.png", "--report", "-"]));
        assert_eq!(record["renderers"].as_array().unwrap().len(), 1);
        assert_eq!(not_drawn(&record, "chromium")["installed"], false);
    }

    #[test]
    fn a_missing_program_that_was_asked_for_is_a_failure() {
        let place = Place::new();
        let output = place.check(&["a.png", "--renderer", "resvg,inkscape", "-q"]);
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
        let place = Place::new()
            .program("inkscape", "sleep 600")
            .copying("rsvg-convert", "a.png");
        let output = place.check(&["a.png", "--timeout", "1", "--report", "-"]);
        assert_eq!(output.status.code(), Some(1));
        assert!(
            stderr(&output).contains("inkscape: "),
            "{}",
            stderr(&output)
        );
        let record = json(&output);
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
            let place = Place::new().program("cairosvg", script);
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
        let place = Place::new();
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
        let place = Place::new();
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
            let record = json(&output);
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
        let place = Place::new().copying("rsvg-convert", "a.png");
        let record = json(&place.check(&["--report", "-"]));
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
        let place = Place::new().copying("rsvg-convert", "a.png");
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
            stderr(&output).contains("a.png: is no folder"),
            "{}",
            stderr(&output)
        );
    }

    #[test]
    fn a_file_that_refers_to_others_is_given_to_no_program() {
        let place = Place::new().program("inkscape", "touch \"$0.asked\"");
        let body = "<image width=\"9\" height=\"9\" href=\"http://127.0.0.1:9/a.png\"/>\n</svg>";
        fs::write(place.path("a.svg"), SVG.replace("</svg>", body)).unwrap();
        let output = place.check(&["a.png", "--report", "-"]);
        assert_eq!(output.status.code(), Some(1));
        assert!(
            stderr(&output).contains("inkscape: not asked, since line 3"),
            "{}",
            stderr(&output)
        );
        assert!(!place.path("bin/inkscape.asked").exists());
        assert_eq!(json(&output)["lint"][0]["rule"], "external-reference");
    }

    #[test]
    fn findings_are_in_the_table_and_in_the_report() {
        let place = Place::new();
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
        let record: Value =
            serde_json::from_slice(&fs::read(place.path("r.json")).unwrap()).unwrap();
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
}
