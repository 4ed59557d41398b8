//! The file as other programs see it: Inkscape, librsvg, Chromium and CairoSVG, where installed.
//!
//! A test whose program is missing passes, and says on standard error that it was skipped.
//! `STROKEFIT_ENGINES=inkscape,rsvg` names programs that must be there: a test without them fails.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

use crate::support::{
    Place, STROKEFIT, committed, entry, installed, of_strokes, on_white, record, stderr,
};
use serde_json::Value;
use strokefit::engines::{DrawRequest, Engine};
use strokefit::fit::{Config, Fitter};
use strokefit::image::Image;
use strokefit::math;
use strokefit::metrics;
use strokefit::scene::{self, Area, Axis, Cap, PathPoint, Scene, Shade, ShadeStop, Stage, Stroke};
use strokefit::svg::{self, Form, WriteOptions};
use strokefit::verify::{self, Size};

const PATIENCE: Duration = Duration::from_secs(120);

/// For each of these functions a module with a test for each engine.
macro_rules! on_each_engine {
    ($($check:ident)*) => {
        $(on_each_engine!($check: inkscape rsvg chromium cairosvg);)*
    };
    ($check:ident: $($engine:ident)*) => {
        mod $check {$(
            #[test]
            fn $engine() {
                super::$check(stringify!($engine));
            }
        )*}
    };
}

on_each_engine!(
    draws_fits_as_faithfully_as_resvg
    draws_fits_of_many_strokes_as_faithfully_as_resvg
    draws_every_kind_of_stroke
    draws_every_form_of_file
    scales_to_the_size_asked_for
    leaves_nothing_in_the_home
    draws_what_inkscape_saved
);

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
            &committed(svg),
            &committed(picture),
            "--renderer",
            name,
            "--report",
            "-",
        ];
        let record = record(&Place::new().done(&args));
        let (resvg, other) = (entry(&record, "resvg"), entry(&record, name));
        let db = |entry: &Value| entry["fidelity"]["psnr_db"].as_f64().unwrap();
        assert!(db(other) >= db(resvg) - 0.7, "{svg}: {record}");
        // Programs differ along edges. The cup has the edges of 1,300 strokes on 300×200 px.
        assert!(
            other["against_resvg"]["psnr_db"].as_f64().unwrap() > 39.0,
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

/// A fit that is more faithful than programs agree with one another, and the picture as it lies on white.
struct Fitted {
    name: &'static str,
    text: String,
    target: Image,
    /// Least fidelity of resvg's render.
    least_db: f64,
}

/// Flat art, thin lines and a photograph.
fn fits() -> &'static [Fitted] {
    static FITS: OnceLock<Vec<Fitted>> = OnceLock::new();
    FITS.get_or_init(|| {
        let samples = [
            ("noto-telescope", 500, 48.0),
            ("noto-hibiscus", 500, 47.0),
            ("bicycle", 500, 39.0),
            ("rocket-320", 2300, 40.0),
        ];
        samples
            .map(|(name, strokes, least_db)| fitted(name, strokes, least_db))
            .into()
    })
}

fn fitted(name: &'static str, strokes: usize, least_db: f64) -> Fitted {
    let picture = Image::open(committed(&format!("samples/{name}.png"))).unwrap();
    let budget = of_strokes(strokes);
    let config = Config {
        budget,
        ..Config::default()
    };
    let fit = Fitter::new(config).fit(&picture).unwrap();
    Fitted {
        name,
        text: fit.svg(),
        target: picture.flattened([1.0; 3]),
        least_db,
    }
}

fn draws_fits_of_many_strokes_as_faithfully_as_resvg(name: &str) {
    let Some((engine, program)) = installed(name) else {
        return;
    };
    for Fitted {
        name,
        text,
        target,
        least_db,
        ..
    } in fits()
    {
        let request = DrawRequest {
            svg: text,
            width: target.width(),
            height: target.height(),
        };
        let drawn = engine.draw(&program, request, PATIENCE).unwrap().image;
        let resvg = verify::fidelity(text, target).unwrap().psnr_db;
        let db = metrics::psnr(target, &drawn).unwrap();
        assert!(resvg > *least_db, "{name}: {resvg:.2} dB");
        // Fits are settled for resvg alone: thin lines and thousands of faint layers lose most elsewhere.
        assert!(db >= resvg - 5.0, "{name}: {db:.2} dB, {resvg:.2} in resvg");
    }
}

fn capsule(a: [f32; 2], b: [f32; 2], width: f32) -> Stroke {
    let [a, b] = [a, b].map(math::point);
    let path = if a == b {
        scene::Path::dot(a)
    } else {
        scene::Path::line(a, b)
    };
    Stroke {
        path,
        radius: f64::from(width) / 2.0,
        cap: Cap::Round,
        color: [0.1, 0.3, 0.8],
        opacity: 1.0,
    }
}

/// A path of points, each on it or off it.
fn bent(points: &[(f32, f32, bool)], closed: bool, width: f32, opacity: f32) -> Stroke {
    let point = |&(x, y, is_on): &(f32, f32, bool)| PathPoint {
        at: math::point([x, y]),
        is_on,
    };
    let points = points.iter().map(point).collect();
    Stroke {
        path: scene::Path::new(points, closed).unwrap(),
        opacity,
        ..capsule([0.0; 2], [0.0; 2], width)
    }
}

/// Paths that bend, turn back, close and cross themselves.
fn bent_kinds() -> Vec<(&'static str, Vec<Stroke>)> {
    const ON: bool = true;
    const OFF: bool = false;
    let corners = [
        (8.0, 8.0, ON),
        (50.0, 12.0, ON),
        (14.0, 20.0, ON),
        (54.0, 40.0, ON),
    ];
    let cusp = [(8.0, 30.0, ON), (56.0, 18.0, ON), (20.0, 27.5, ON)];
    let wave = [
        (6.0, 24.0, ON),
        (16.0, 2.0, OFF),
        (30.0, 44.0, OFF),
        (46.0, 4.0, OFF),
        (58.0, 30.0, ON),
    ];
    let knot = [
        (6.0, 40.0, ON),
        (60.0, 30.0, OFF),
        (40.0, 0.0, OFF),
        (18.0, 44.0, OFF),
        (58.0, 44.0, ON),
    ];
    let ring = [
        (8.0, 8.0, OFF),
        (56.0, 8.0, OFF),
        (56.0, 40.0, OFF),
        (8.0, 40.0, OFF),
    ];
    let drop = [(32.0, 4.0, ON), (58.0, 44.0, OFF), (6.0, 44.0, OFF)];
    let tight = [(20.0, 40.0, ON), (30.0, 6.0, OFF), (36.0, 40.0, ON)];
    vec![
        ("corners", vec![bent(&corners, false, 3.0, 1.0)]),
        ("translucent corners", vec![bent(&corners, false, 9.0, 0.4)]),
        ("cusps", vec![bent(&cusp, false, 6.0, 0.6)]),
        ("curves", vec![bent(&wave, false, 4.0, 1.0)]),
        ("thin curves", vec![bent(&wave, false, 1.02, 1.0)]),
        (
            "curves that cross themselves",
            vec![bent(&knot, false, 8.0, 0.4)],
        ),
        (
            "bends tighter than the width",
            vec![bent(&tight, false, 14.0, 0.6)],
        ),
        ("closed corners", vec![bent(&corners, true, 3.0, 0.6)]),
        (
            "loops",
            vec![bent(&ring, true, 5.0, 0.6), bent(&drop, true, 2.0, 1.0)],
        ),
    ]
}

/// Kinds of strokes that programs might treat apart, each a drawing of its own, 64×48 px.
fn kinds() -> Vec<(&'static str, Scene)> {
    let of = |strokes: Vec<Stroke>| Scene {
        stages: vec![Stage::from_iter(strokes)],
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
    let bent = bent_kinds()
        .into_iter()
        .map(|(kind, strokes)| (kind, of(strokes)));
    let mut kinds = vec![
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
    ];
    kinds.extend(bent);
    kinds.push(("bands", bands()));
    kinds
}

/// Lines with square ends and mitred corners, one of them closed, one bent, one translucent.
fn bands() -> Scene {
    let on = |x: f32, y: f32| PathPoint::on(math::point([x, y]));
    let off = |x: f32, y: f32| PathPoint::off(math::point([x, y]));
    let lines = [
        (vec![on(5.0, 6.5), on(25.0, 6.5)], false, 5.0, 1.0),
        (
            vec![on(8.0, 40.0), on(18.0, 18.0), on(30.0, 42.0)],
            false,
            4.0,
            1.0,
        ),
        (
            vec![on(36.0, 8.0), on(58.0, 8.0), on(50.0, 24.0)],
            true,
            3.0,
            0.5,
        ),
        (
            vec![
                on(36.0, 40.0),
                off(40.0, 31.0),
                off(50.0, 30.0),
                on(60.0, 38.0),
            ],
            false,
            6.0,
            1.0,
        ),
    ];
    let band = |(points, closed, width, opacity)| Stroke {
        path: scene::Path::new(points, closed).unwrap(),
        radius: 0.5 * width,
        cap: Cap::Butt,
        color: [0.1, 0.3, 0.5],
        opacity,
    };
    Scene {
        stages: vec![lines.map(band).into_iter().collect()],
        ..Scene::empty(64, 48, Some([1.0, 0.9, 0.7]))
    }
}

/// Renders of `svg` at this size, by the engine and by resvg.
fn drawn_by_both(
    engine: &Engine,
    program: &Path,
    svg: &str,
    [width, height]: [u32; 2],
) -> [Image; 2] {
    let request = DrawRequest {
        svg,
        width: width as usize,
        height: height as usize,
    };
    let drawn = engine.draw(program, request, PATIENCE).unwrap().image;
    let resvg = verify::render(svg, Size::Exact { width, height }, Some([1.0; 3])).unwrap();
    [drawn, resvg]
}

/// Gradients of both kinds, of colour and of opacity, are drawn alike.
#[test]
fn shades_are_drawn_alike() {
    let stop = |offset, color, opacity| ShadeStop {
        offset,
        color,
        opacity,
    };
    let stops = [
        stop(0.0, [0.9, 0.2, 0.2], 0.1),
        stop(0.4, [0.2, 0.8, 0.9], 0.9),
        stop(1.0, [1.0, 0.9, 0.1], 1.0),
    ];
    let linear = Axis::Linear {
        from: (4.0, 6.0).into(),
        to: (58.0, 40.0).into(),
    };
    let radial = Axis::Radial {
        center: (30.5, 20.5).into(),
        radius: 25.25,
    };
    for name in ["inkscape", "rsvg", "chromium", "cairosvg"] {
        let Some((engine, program)) = installed(name) else {
            continue;
        };
        for axis in [linear, radial] {
            let scene = Scene {
                ground: vec![Area::page(Shade::new(axis, &stops).unwrap(), [64, 48])],
                ..Scene::empty(64, 48, None)
            };
            let text = svg::write(&scene, &WriteOptions::default());
            let [drawn, resvg] = drawn_by_both(engine, &program, &text, [64, 48]);
            let db = metrics::psnr(&resvg, &drawn).unwrap();
            assert!(db >= 48.0, "{name}, {axis:?}: {db:.2} dB from resvg");
        }
    }
}

fn draws_every_kind_of_stroke(name: &str) {
    let Some((engine, program)) = installed(name) else {
        return;
    };
    for (kind, scene) in kinds() {
        let text = svg::write(&scene, &WriteOptions::default());
        let [drawn, resvg] = drawn_by_both(engine, &program, &text, [64, 48]);
        let db = metrics::psnr(&resvg, &drawn).unwrap();
        assert!(db >= 36.0, "{kind}: {db:.2} dB from resvg");
        let background = Image::filled(64, 48, [1.0, 0.9, 0.7]).unwrap();
        let ink = |image| metrics::l1(&background, image).unwrap();
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
    for form in Form::ALL {
        let options = WriteOptions {
            form,
            ..WriteOptions::default()
        };
        let text = svg::write(&scene, &options);
        let [drawn, resvg] = drawn_by_both(engine, &program, &text, [64, 48]);
        let db = metrics::psnr(&resvg, &drawn).unwrap();
        assert!(db >= 36.0, "{form:?}: {db:.2} dB from resvg");
    }
}

fn scales_to_the_size_asked_for(name: &str) {
    let Some((engine, program)) = installed(name) else {
        return;
    };
    // Without a background: the page is white.
    let scene = Scene {
        background: None,
        ..kinds().swap_remove(4).1
    };
    let text = svg::write(&scene, &WriteOptions::default());
    for [width, height] in [[32, 24], [64, 48], [640, 480]] {
        let [drawn, resvg] = drawn_by_both(engine, &program, &text, [width, height]);
        let db = metrics::psnr(&resvg, &drawn).unwrap();
        assert!(db >= 36.0, "{width}×{height}: {db:.2} dB from resvg");
    }
}

fn leaves_nothing_in_the_home(name: &str) {
    // A program that keeps the home leaves it as it is by not being told another; it may look into it.
    let Some((engine, _)) = installed(name) else {
        return;
    };
    let (home, temporary) = (Place::new(), Place::new());
    let file = committed("docs/pictures/noto-hibiscus.svg");
    let output = home
        .command(STROKEFIT)
        .args(["check", &file, "--renderer", engine.name])
        .env("HOME", home.path("."))
        .env("TMPDIR", temporary.path("."))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for folder in [&home, &temporary] {
        let left: Vec<_> = fs::read_dir(folder.path("."))
            .unwrap()
            .map(|e| e.unwrap().path())
            .collect();
        assert!(left.is_empty(), "{left:?}");
    }
}

/// The file as Inkscape saves it, plain or with its own elements.
fn saved_by_inkscape(place: &Place, file: &str, plain: bool) -> String {
    let (_, program) = installed("inkscape").unwrap();
    let saved = place.path("saved.svg");
    let mut command = place.command(program);
    command.arg(if plain {
        "--export-plain-svg"
    } else {
        "--export-type=svg"
    });
    command
        .arg(format!("--export-filename={}", saved.display()))
        .arg(file);
    command
        .env("HOME", place.path("."))
        .env("INKSCAPE_PROFILE_DIR", place.path("."))
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
    let plain = fs::read_to_string(committed("docs/pictures/chelsea-cat.svg")).unwrap();
    let options = WriteOptions {
        precision: 1,
        form: Form::Smallest,
        width: Some("120mm".parse().unwrap()),
        ..WriteOptions::default()
    };
    let smallest = svg::write(&svg::read(&plain).unwrap(), &options);
    assert!(smallest.contains("scale(0.1)"));
    for original in [plain, smallest] {
        survives_inkscape(&original, true);
        survives_inkscape(&original, false);
    }
}

#[track_caller]
fn survives_inkscape(original: &str, plain: bool) {
    let place = Place::new();
    let file = place.path("original.svg");
    fs::write(&file, original).unwrap();
    let saved = saved_by_inkscape(&place, file.to_str().unwrap(), plain);
    assert_ne!(saved, original);
    let render = |text: &str| on_white(text);
    let db = metrics::psnr(&render(original), &render(&saved)).unwrap();
    assert!(db >= 45.0, "plain {plain}: {db:.2} dB");
    let count = |text: &str, word| text.matches(word).count();
    for word in ["<path", "id=\"stage-"] {
        assert_eq!(count(&saved, word), count(original, word));
    }
    let layers = if plain {
        0
    } else {
        count(original, "groupmode")
    };
    assert_eq!(count(&saved, "inkscape:groupmode=\"layer\""), layers);
    let worst = svg::lint(&saved)
        .into_iter()
        .find(|f| f.severity < svg::Severity::Note);
    assert_eq!(worst, None);
}

#[test]
fn what_inkscape_saved_is_refined() {
    if installed("inkscape").is_none() {
        return;
    }
    let place = Place::new();
    let (file, picture) = (
        committed("docs/pictures/coffee-quality-20.svg"),
        committed("samples/coffee-300.png"),
    );
    for plain in [true, false] {
        let saved = saved_by_inkscape(&place, &file, plain);
        let refine = ["refine", "saved.svg", &picture, "-o", "better.svg"];
        let budget = ["--strokes", "300", "--preset", "draft"];
        place.done(&[&refine[..], &budget].concat());
        let better = place.text("better.svg");
        let target = Image::open(&picture).unwrap();
        let db = |text: &str| verify::fidelity(text, &target).unwrap().psnr_db;
        let (before, after) = (db(&saved), db(&better));
        assert!(
            after > before + 1.0,
            "plain {plain}: {before:.2} dB, then {after:.2} dB"
        );
        assert!(better.matches("<path").count() > saved.matches("<path").count());
        let check = ["check", "better.svg", &picture, "--renderer", "inkscape"];
        place.done(&check);
    }
}

fn draws_what_inkscape_saved(name: &str) {
    if installed(name).is_none() || installed("inkscape").is_none() {
        return;
    }
    let place = Place::new();
    let file = committed("docs/pictures/chelsea-cat.svg");
    for plain in [true, false] {
        saved_by_inkscape(&place, &file, plain);
        let picture = committed("samples/chelsea-cat.png");
        let args = ["check", "saved.svg", &picture, "--renderer", name];
        place.done(&args);
    }
}
