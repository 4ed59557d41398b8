//! Needs of a binding, with the library alone: `cargo test --no-default-features --test all library::`.

use std::time::Duration;

use crate::support::of_strokes;
use serde_json::Value;
use strokefit::ErrorKind;
use strokefit::fit::{Background, Base, Colors, Config, Fitter, Preset};
use strokefit::image::{Image, Rows};
use strokefit::report::{self, FitReport, Judged, Run, Usage};
use strokefit::svg::{Form, Group, Length, WriteOptions};

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
    let budget = of_strokes(5);
    Config {
        budget,
        preset: "draft".parse().unwrap(),
        background: "#f0f0f0".parse().unwrap(),
        colors: "#f0f0f0,#1e1e1e".parse().unwrap(),
        seed: 7,
        ..Config::default()
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

fn json(judged: &Judged, run: &Run<'_>) -> Value {
    let text = report::json(&FitReport::of(judged, run)).unwrap();
    assert!(text.ends_with("}\n"));
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_fit_reports_as_the_command_line_does() {
    let config = config();
    let judged = drawn(&config, None);
    let run = Run {
        input: "disc",
        base: None,
        config: &config,
        wall: Duration::from_millis(1500),
        usage: Usage::default(),
    };
    let report = json(&judged, &run);
    assert_eq!(report["schema"], report::SCHEMA);
    assert_eq!(report["input"]["path"], "disc");
    assert_eq!(report["input"]["width"], SIDE);
    assert_eq!(report["strokes"], judged.fit.scene.len());
    assert_eq!(report["svg_bytes"], judged.svg.len());
    assert_eq!(report["wall_s"], 1.5);
    assert_eq!(report["seed"], 7);
    assert!(report["fidelity"]["psnr_db"].as_f64().unwrap() > 20.0);
    assert!(judged.verdict.agrees());
}

#[test]
fn what_is_not_known_or_does_not_apply_is_null() {
    let config = config();
    let run = Run {
        input: "",
        base: None,
        config: &config,
        wall: Duration::ZERO,
        usage: Usage::default(),
    };
    let report = json(&drawn(&config, None), &run);
    for field in ["cpu_s", "peak_rss_bytes", "alpha", "base"] {
        assert_eq!(report.get(field), Some(&Value::Null), "{field}");
    }
}

#[test]
fn a_base_is_reported_with_its_strokes() {
    let config = config();
    let first = drawn(&config, None);
    let base = Base::read(first.svg.clone(), &disc(), false).unwrap();
    let strokes = base.scene.len();
    let run = Run {
        input: "disc",
        base: Some("first.svg"),
        config: &config,
        wall: Duration::ZERO,
        usage: Usage::now(),
    };
    let report = json(&drawn(&config, Some(base)), &run);
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
    let refusals = [
        (
            "bset".parse::<Preset>().map(|_| ()),
            "draft, balanced or best",
        ),
        (
            "mauve".parse::<Background>().map(|_| ()),
            "auto, none or a colour",
        ),
        ("#ff".parse::<Colors>().map(|_| ()), "#rrggbb"),
        ("tiny".parse::<Form>().map(|_| ()), "smallest"),
        ("hue".parse::<Group>().map(|_| ()), "stage, color or object"),
        ("12".parse::<Length>().map(|_| ()), "mm, cm, in, pt or px"),
    ];
    for ((refusal, remedy), word) in refusals
        .into_iter()
        .zip(["bset", "mauve", "#ff", "tiny", "hue", "12"])
    {
        let error = refusal.unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Config);
        let message = error.to_string();
        assert!(message.contains(&format!("'{word}'")), "{message}");
        assert!(message.contains(remedy), "{message}");
    }
}

#[test]
fn rows_of_all_types_and_strides_are_the_same_picture() {
    let (width, height) = (3, 2);
    let bytes = [0_u8, 51, 102, 153, 204, 255];
    let expected = Image::from_rows(Rows::packed(width, height, 1, &bytes)).unwrap();
    for gap in [0, 1, 3, 7] {
        let stride = width + gap;
        // The last row ends with its last pixel.
        let mut words = vec![u16::MAX; stride + width];
        let mut floats = vec![f32::NAN; stride + width];
        for (i, &byte) in bytes.iter().enumerate() {
            let at = i / width * stride + i % width;
            words[at] = u16::from(byte) * 257;
            floats[at] = f32::from(byte) / 255.0;
        }
        let words = Rows {
            stride,
            ..Rows::packed(width, height, 1, &words)
        };
        let floats = Rows {
            stride,
            ..Rows::packed(width, height, 1, &floats)
        };
        assert_eq!(Image::from_rows(words).unwrap(), expected, "{gap}");
        assert_eq!(Image::from_rows(floats).unwrap(), expected, "{gap}");
    }
}

#[test]
fn rows_that_are_too_few_are_refused_with_what_is_needed() {
    let error = Image::from_rows(Rows::packed(4, 4, 3, &[0_u8; 47])).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Picture);
    let message = error.to_string();
    assert!(message.contains("47 samples"), "{message}");
    assert!(
        message.contains("stride × (height − 1) + width × channels"),
        "{message}"
    );
}
