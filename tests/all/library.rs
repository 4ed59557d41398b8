//! Needs of a binding, with the library alone: `cargo test --no-default-features --test all library::`.

use std::fmt::Debug;
use std::str::FromStr;
use std::time::Duration;

use crate::support::{of_strokes, within};
use serde_json::Value;
use strokefit::fit::{Background, Base, Colors, Config, Fitter, Preset};
use strokefit::image::{Image, Rows};
use strokefit::report::{self, FitReport, Judged, Run, Usage};
use strokefit::svg::{Form, Group, Length, WriteOptions};
use strokefit::{Error, ErrorKind};

const SIDE: usize = 32;

/// A dark disc on a light page, as rows of RGBA with a gap of 5 bytes between them.
fn disc() -> Image {
    let stride = 4 * SIDE + 5;
    let mut samples = vec![0_u8; stride * SIDE];
    for y in 0..SIDE {
        for x in 0..SIDE {
            let inside = x.abs_diff(15).pow(2) + y.abs_diff(15).pow(2) < 64;
            let level = if inside { 30 } else { 240 };
            samples[y * stride + 4 * x..][..4].copy_from_slice(&[level, level, level, 255]);
        }
    }
    let rows = Rows {
        stride,
        ..Rows::packed(SIDE, SIDE, 4, &samples)
    };
    Image::from_rows(rows).unwrap()
}

fn config() -> Config {
    Config {
        preset: "draft".parse().unwrap(),
        background: "#f0f0f0".parse().unwrap(),
        colors: "#f0f0f0,#1e1e1e".parse().unwrap(),
        seed: 7,
        ..within(of_strokes(5))
    }
}

fn drawn(config: &Config, base: Option<Base>) -> Judged {
    let fitter = Fitter::new(config.clone());
    let fitter = match base {
        Some(base) => fitter.on(base),
        None => fitter,
    };
    Judged::new(fitter.fit(&disc()).unwrap()).unwrap()
}

/// The report of a run with these options in 1.5 s.
fn reported(judged: &Judged, config: &Config, base: Option<&str>) -> Value {
    let run = Run {
        input: "disc",
        base,
        config,
        wall: Duration::from_millis(1500),
        usage: Usage::default(),
    };
    let text = report::json(&FitReport::of(judged, &run)).unwrap();
    assert!(text.ends_with("}\n"));
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_fit_reports_as_the_command_line_does() {
    let config = config();
    let judged = drawn(&config, None);
    let report = reported(&judged, &config, None);
    assert_eq!(report["schema"], report::SCHEMA);
    assert_eq!(report["input"]["path"], "disc");
    assert_eq!(report["input"]["width"], SIDE);
    assert_eq!(report["strokes"], judged.fit.scene.len());
    assert_eq!(report["svg_bytes"], judged.svg.len());
    assert_eq!(report["wall_s"], 1.5);
    assert_eq!(report["seed"], 7);
    assert!(report["fidelity"]["psnr_db"].as_f64().unwrap() > 20.0);
    assert!(judged.verdict.agrees());
    // What is not known or does not apply is null.
    for field in ["cpu_s", "peak_rss_bytes", "alpha", "base"] {
        assert_eq!(report.get(field), Some(&Value::Null), "{field}");
    }
}

#[test]
fn a_base_is_reported_with_its_strokes() {
    let config = config();
    let first = drawn(&config, None);
    let base = Base::read(first.svg, &disc(), false).unwrap();
    let strokes = base.scene.len();
    let report = reported(&drawn(&config, Some(base)), &config, Some("first.svg"));
    assert_eq!(report["base"]["path"], "first.svg");
    assert_eq!(report["base"]["strokes"], strokes);
}

#[test]
fn words_become_a_configuration() {
    let config = config();
    assert_eq!(config.preset, Preset::Draft);
    assert_eq!(config.background, Background::Color([240.0 / 255.0; 3]));
    assert_eq!(config.colors, Colors::Palette(vec![[240; 3], [30; 3]]));
    let file = WriteOptions {
        form: "smallest".parse().unwrap(),
        group: "color".parse().unwrap(),
        width: Some("120mm".parse().unwrap()),
        ..WriteOptions::default()
    };
    assert_eq!((file.form, file.group), (Form::Smallest, Group::Color));
    assert_eq!(file.width.map(|width| width.to_string()).unwrap(), "120mm");
}

#[test]
fn a_word_that_is_none_is_refused_with_those_that_are() {
    fn refusal<T: FromStr<Err = Error> + Debug>(word: &str) -> Error {
        word.parse::<T>().unwrap_err()
    }
    for (error, words) in [
        (
            refusal::<Preset>("bset"),
            ["'bset'", "draft, balanced or best"],
        ),
        (
            refusal::<Background>("mauve"),
            ["'mauve'", "auto, none or a colour"],
        ),
        (refusal::<Colors>("#ff"), ["'#ff'", "#rrggbb"]),
        (refusal::<Form>("tiny"), ["'tiny'", "smallest"]),
        (refusal::<Group>("hue"), ["'hue'", "stage, color or object"]),
        (refusal::<Length>("12"), ["'12'", "mm, cm, in, pt or px"]),
    ] {
        assert_eq!(error.kind(), ErrorKind::Config);
        let message = error.to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}
