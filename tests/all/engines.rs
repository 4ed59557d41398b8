//! The file as other programs see it: Inkscape, librsvg, Chromium and CairoSVG, where installed.
//!
//! A test whose program is missing passes, and says on standard error that it was skipped.
//! `STROKEFIT_ENGINES=inkscape,rsvg` names programs that must be there: a test without them fails.

use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::Duration;

use crate::support::paths::of_letters;
use crate::support::{
    Place, STROKEFIT, Words, committed, drawn, entry, installed, of_strokes, on_white, record,
    sample, stderr, within,
};
use serde_json::Value;
use strokefit::engines::{DrawRequest, Engine};
use strokefit::image::Image;
use strokefit::math;
use strokefit::metrics;
use strokefit::scene::{
    self, Area, Axis, Cap, Mark, PathPoint, PointKind, Scene, Shade, ShadeStop, Stage, Stroke,
};
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
        ("chelsea-cat", "chelsea-cat"),
        ("coffee-quality-35", "coffee-300"),
        ("noto-hibiscus", "noto-hibiscus"),
    ] {
        let files = format!("@docs/pictures/{svg}.svg @samples/{picture}.png");
        let check = Place::new().done(&format!("check {files} --renderer {name} --report -"));
        let record = record(&check);
        let (resvg, other) = (entry(&record, "resvg"), entry(&record, name));
        let db = |field: &Value| field["psnr_db"].as_f64().unwrap();
        let least = db(&resvg["fidelity"]) - 0.7;
        assert!(db(&other["fidelity"]) >= least, "{svg}: {record}");
        // Programs differ along edges. The cup has the edges of 1,300 strokes on 300×200 px.
        assert!(db(&other["against_resvg"]) > 39.0, "{svg}: {record}");
        let version = other["version"].as_str().unwrap();
        assert!(version.starts_with(|c: char| c.is_ascii_digit()));
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
    let picture = sample(name);
    Fitted {
        name,
        text: drawn(&picture, &within(of_strokes(strokes))).svg(),
        target: picture.flattened([1.0; 3]),
        least_db,
    }
}

fn draws_fits_of_many_strokes_as_faithfully_as_resvg(name: &str) {
    let Some(engine) = InstalledEngine::named(name) else {
        return;
    };
    for Fitted {
        name,
        text,
        target,
        least_db,
    } in fits()
    {
        let drawn = engine.drawn(text, [target.width(), target.height()]);
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
        radii: Vec::new(),
        cap: Cap::Round,
        color: [0.1, 0.3, 0.8],
        opacity: 1.0,
    }
}

/// A path of points, each on it or off it.
fn bent(points: &[(f32, f32, bool)], closed: bool, width: f32, opacity: f32) -> Stroke {
    let point = |&(x, y, is_on): &(f32, f32, bool)| PathPoint {
        at: math::point([x, y]),
        kind: PointKind::on_if(is_on),
    };
    let points = points.iter().map(point).collect();
    Stroke {
        path: scene::Path::new(points, closed).unwrap(),
        opacity,
        ..capsule([0.0; 2], [0.0; 2], width)
    }
}

/// Closed paths of all kinds of pieces, as a stroke and as an area.
fn mixed(points: &[(f32, f32, char)]) -> [Mark; 2] {
    let path = of_letters(points, true);
    let stroke = Stroke {
        path: path.clone(),
        opacity: 0.6,
        ..capsule([0.0; 2], [0.0; 2], 4.0)
    };
    [
        stroke.into(),
        Area::plain(vec![path], [0.9, 0.2, 0.1], 0.7).into(),
    ]
}

/// A page of 64×48 px with these strokes.
fn page(strokes: Vec<Stroke>) -> Scene {
    Scene {
        stages: vec![Stage::from_iter(strokes)],
        ..Scene::empty(64, 48, Some(PAGE))
    }
}

const PAGE: [f32; 3] = [1.0, 0.9, 0.7];

const ON: bool = true;
const OFF: bool = false;

/// Paths that bend, turn back, close and cross themselves.
fn bent_kinds() -> Vec<(&'static str, Vec<Stroke>)> {
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
    let arcs = [
        (8.0, 20.0, 'o'),
        (20.0, 4.0, 'a'),
        (32.0, 20.0, 'o'),
        (44.0, 23.0, 'a'),
        (56.0, 20.0, 'o'),
        (40.0, 44.0, 'a'),
    ];
    let cubics = [
        (8.0, 24.0, 'o'),
        (8.0, 0.0, 'c'),
        (40.0, 8.0, 'c'),
        (32.0, 24.0, 'o'),
        (24.0, 40.0, 'c'),
        (60.0, 60.0, 'c'),
        (56.0, 12.0, 'o'),
        (50.0, 40.0, '~'),
    ];
    let of_marks = |marks: [Mark; 2]| Scene {
        stages: vec![Stage::from_iter(marks)],
        ..page(Vec::new())
    };
    let faint = |strokes: Vec<Stroke>| strokes.into_iter().map(|s| Stroke { opacity: 0.2, ..s });
    let bent = bent_kinds().into_iter();
    let bent = bent.map(|(kind, strokes)| (kind, page(strokes)));
    let mut kinds = vec![
        ("large dots", page(grid(4.6).collect())),
        ("smallest dots", page(grid(1.02).collect())),
        ("thinnest strokes", page(fan(1.02).collect())),
        (
            "faint thin strokes",
            page(faint(fan(1.02).collect()).collect()),
        ),
        (
            "partly off the page",
            page(vec![
                capsule([-30.0, 10.0], [10.0, 10.0], 9.0),
                capsule([60.0, -9.0], [90.0, 30.0], 5.0),
                capsule([20.0, 48.0], [44.0, 48.0], 3.0),
                capsule([-1000.0, 30.0], [1000.0, 33.0], 2.0),
            ]),
        ),
        (
            "covered",
            page(
                fan(2.0)
                    .chain([capsule([0.0, 24.0], [64.0, 24.0], 90.0)])
                    .collect(),
            ),
        ),
        (
            "shorter than wide",
            page(vec![capsule([30.0, 20.0], [30.4, 20.2], 25.0)]),
        ),
        (
            "many faint layers",
            page(vec![
                Stroke {
                    opacity: 0.15,
                    ..capsule([20.0, 20.0], [44.0, 28.0], 20.0)
                };
                8
            ]),
        ),
    ];
    kinds.extend(bent);
    kinds.push(("arcs", of_marks(mixed(&arcs))));
    kinds.push(("cubic curves", of_marks(mixed(&cubics))));
    kinds.push(("bands", page(bands())));
    kinds.push(("varying widths", page(varying())));
    kinds
}

/// Lines whose width varies: a tip and a hairpin, a corner, and a closed one, which is translucent.
fn varying() -> Vec<Stroke> {
    let hairpin = [
        (5.0, 10.0, ON),
        (30.0, 2.0, OFF),
        (34.0, 20.0, ON),
        (36.0, 27.0, OFF),
        (38.0, 20.0, ON),
    ];
    let corner = [(8.0, 40.0, ON), (18.0, 22.0, ON), (30.0, 42.0, ON)];
    let closed = [(44.0, 10.0, ON), (60.0, 14.0, ON), (50.0, 40.0, ON)];
    let lines = [
        (bent(&hairpin, false, 1.0, 1.0), vec![0.0, 3.0, 5.0]),
        (bent(&corner, false, 1.0, 1.0), vec![2.0, 4.0, 1.0]),
        (bent(&closed, true, 1.0, 0.6), vec![1.0, 3.0, 2.0]),
    ];
    let varying = |(line, radii): (Stroke, Vec<f64>)| {
        Stroke::varying(line.path, radii, line.color, line.opacity).unwrap()
    };
    lines.map(varying).into()
}

/// Lines with square ends and mitred corners, one of them closed, one bent, one translucent.
fn bands() -> Vec<Stroke> {
    let line = [(5.0, 6.5, ON), (25.0, 6.5, ON)];
    let corner = [(8.0, 40.0, ON), (18.0, 18.0, ON), (30.0, 42.0, ON)];
    let closed = [(36.0, 8.0, ON), (58.0, 8.0, ON), (50.0, 24.0, ON)];
    let wave = [
        (36.0, 40.0, ON),
        (40.0, 31.0, OFF),
        (50.0, 30.0, OFF),
        (60.0, 38.0, ON),
    ];
    let bands = [
        bent(&line, false, 5.0, 1.0),
        bent(&corner, false, 4.0, 1.0),
        bent(&closed, true, 3.0, 0.5),
        bent(&wave, false, 6.0, 1.0),
    ];
    let band = |stroke| Stroke {
        cap: Cap::Butt,
        color: [0.1, 0.3, 0.5],
        ..stroke
    };
    bands.map(band).into()
}

/// A program that is installed.
struct InstalledEngine(&'static Engine, PathBuf);

impl InstalledEngine {
    /// `None`, with the test reported as skipped, where it is not installed.
    fn named(name: &str) -> Option<Self> {
        installed(name).map(|(engine, program)| Self(engine, program))
    }

    fn drawn(&self, svg: &str, [width, height]: [usize; 2]) -> Image {
        let request = DrawRequest { svg, width, height };
        self.0.draw(&self.1, request, PATIENCE).unwrap().image
    }

    /// Renders of `svg` at this size, by the program and by resvg; they differ by `least_db` at least.
    #[track_caller]
    fn draws_alike(&self, what: &str, svg: &str, size: [u32; 2], least_db: f64) -> [Image; 2] {
        let [width, height] = size;
        let drawn = self.drawn(svg, size.map(|side| side as usize));
        let resvg = verify::render(svg, Size::Exact { width, height }, Some([1.0; 3])).unwrap();
        let db = metrics::psnr(&resvg, &drawn).unwrap();
        assert!(
            db >= least_db,
            "{}, {what}: {db:.2} dB from resvg",
            self.0.name
        );
        [drawn, resvg]
    }
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
        let Some(engine) = InstalledEngine::named(name) else {
            continue;
        };
        for axis in [linear, radial] {
            let scene = Scene {
                ground: vec![Area::page(Shade::new(axis, &stops).unwrap(), [64, 48])],
                ..Scene::empty(64, 48, None)
            };
            let text = svg::write(&scene, &WriteOptions::default());
            engine.draws_alike(&format!("{axis:?}"), &text, [64, 48], 48.0);
        }
    }
}

fn draws_every_kind_of_stroke(name: &str) {
    let Some(engine) = InstalledEngine::named(name) else {
        return;
    };
    let background = Image::filled(64, 48, PAGE).unwrap();
    let ink = |image: &Image| metrics::l1(&background, image).unwrap();
    for (kind, scene) in kinds() {
        let text = svg::write(&scene, &WriteOptions::default());
        let [drawn, resvg] = engine.draws_alike(kind, &text, [64, 48], 36.0);
        let ratio = ink(&drawn) / ink(&resvg);
        let is_alike = (0.95..1.05).contains(&ratio);
        assert!(is_alike, "{kind}: {ratio:.3} × the ink of resvg");
    }
}

fn draws_every_form_of_file(name: &str) {
    let Some(engine) = InstalledEngine::named(name) else {
        return;
    };
    let layers = kinds().into_iter().filter(|(kind, _)| *kind != "covered");
    let scene = Scene {
        stages: layers.flat_map(|(_, scene)| scene.stages).collect(),
        ..Scene::empty(64, 48, Some(PAGE))
    };
    for form in Form::ALL {
        let options = WriteOptions {
            form,
            ..WriteOptions::default()
        };
        let text = svg::write(&scene, &options);
        engine.draws_alike(&format!("{form:?}"), &text, [64, 48], 36.0);
    }
}

fn scales_to_the_size_asked_for(name: &str) {
    let Some(engine) = InstalledEngine::named(name) else {
        return;
    };
    // Without a background: the page is white.
    let scene = Scene {
        background: None,
        ..kinds().swap_remove(4).1
    };
    let text = svg::write(&scene, &WriteOptions::default());
    for size in [[32, 24], [64, 48], [640, 480]] {
        engine.draws_alike(&format!("{size:?}"), &text, size, 36.0);
    }
}

fn leaves_nothing_in_the_home(name: &str) {
    // A program that keeps the home leaves it as it is by not being told another; it may look into it.
    let Some((engine, _)) = installed(name) else {
        return;
    };
    let (home, temporary) = (Place::new(), Place::new());
    let args = format!(
        "check @docs/pictures/noto-hibiscus.svg --renderer {}",
        engine.name
    );
    let output = home
        .command(STROKEFIT)
        .args(args.words())
        .env("HOME", home.path("."))
        .env("TMPDIR", temporary.path("."))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!([home.names(), temporary.names()], [[""; 0]; 2]);
}

/// The file as Inkscape saves it to `saved.svg`, plain or with its own elements.
fn saved_by_inkscape(place: &Place, file: &str, plain: bool) -> String {
    let (_, program) = installed("inkscape").unwrap();
    let kind = ["--export-type=svg", "--export-plain-svg"][usize::from(plain)];
    let args = format!("{kind} --export-filename=saved.svg {file}");
    let output = place
        .command(program)
        .args(args.words())
        .env("HOME", place.path("."))
        .env("INKSCAPE_PROFILE_DIR", place.path("."))
        .env_remove("DISPLAY")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    place.text("saved.svg")
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
    place.file("original.svg", original);
    let saved = saved_by_inkscape(&place, "original.svg", plain);
    assert_ne!(saved, original);
    let db = metrics::psnr(&on_white(original), &on_white(&saved)).unwrap();
    assert!(db >= 45.0, "plain {plain}: {db:.2} dB");
    let count = |text: &str, word| text.matches(word).count();
    for word in ["<path", "id=\"stage-"] {
        assert_eq!(count(&saved, word), count(original, word));
    }
    let layers = count(original, "groupmode") * usize::from(!plain);
    assert_eq!(count(&saved, "inkscape:groupmode=\"layer\""), layers);
    let mut findings = svg::lint(&saved).into_iter();
    let worst = findings.find(|f| f.severity < svg::Severity::Note);
    assert_eq!(worst, None);
}

#[test]
fn what_inkscape_saved_is_refined() {
    if installed("inkscape").is_none() {
        return;
    }
    let place = Place::new();
    let target = sample("coffee-300");
    let db = |text: &str| verify::fidelity(text, &target).unwrap().psnr_db;
    for plain in [true, false] {
        let saved = saved_by_inkscape(&place, "@docs/pictures/coffee-quality-20.svg", plain);
        let files = "saved.svg @samples/coffee-300.png -o better.svg";
        place.done(&format!("refine {files} --strokes 300 --preset draft"));
        let better = place.text("better.svg");
        let (before, after) = (db(&saved), db(&better));
        assert!(
            after > before + 1.0,
            "plain {plain}: {before:.2} dB, then {after:.2}"
        );
        assert!(better.matches("<path").count() > saved.matches("<path").count());
        place.done("check better.svg @samples/coffee-300.png --renderer inkscape");
    }
}

fn draws_what_inkscape_saved(name: &str) {
    if installed(name).is_none() || installed("inkscape").is_none() {
        return;
    }
    let place = Place::new();
    for plain in [true, false] {
        saved_by_inkscape(&place, "@docs/pictures/chelsea-cat.svg", plain);
        let check = format!("check saved.svg @samples/chelsea-cat.png --renderer {name}");
        place.done(&check);
    }
}
