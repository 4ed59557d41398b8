//! The forms of a file, as users of the program and of the library meet them.

use std::collections::BTreeSet;

use crate::support::{Place, agreement, assert_refused, assert_says, on_white, sample, stderr};
use strokefit::image::Image;
use strokefit::scene::{Mark, Stage};
use strokefit::svg;
use strokefit::verify;

/// A folder with a drawing of a sample.
struct Drawn {
    place: Place,
    text: String,
    report: serde_json::Value,
}

/// A draft of a sample in 150 strokes.
fn drawn(name: &str, options: &str) -> Drawn {
    fitted(name, &format!("--preset draft --strokes 150 {options}"))
}

fn fitted(name: &str, options: &str) -> Drawn {
    let place = Place::new();
    let files = format!("@samples/{name}.png -o a.svg --report a.json");
    place.done(&format!("fit {files} -q {options}"));
    Drawn {
        text: place.text("a.svg"),
        report: place.report("a.json"),
        place,
    }
}

impl Drawn {
    fn number(&self, field: &str) -> f64 {
        self.report[field].as_f64().unwrap()
    }

    fn psnr_db(&self) -> f64 {
        self.report["fidelity"]["psnr_db"].as_f64().unwrap()
    }

    /// All colours of strokes and background.
    fn colors(&self) -> BTreeSet<String> {
        let scene = svg::read(&self.text).unwrap();
        let strokes = scene.marks().map(Mark::color);
        let hex = |rgb: [f32; 3]| {
            let [r, g, b] = rgb.map(|c| (c * 255.0).round() as u8);
            format!("#{r:02x}{g:02x}{b:02x}")
        };
        strokes.chain(scene.background).map(hex).collect()
    }
}

#[test]
fn the_smallest_file_of_as_many_strokes_is_a_fifth_shorter() {
    let plain = drawn("coffee-300", "--opaque --precision 1");
    let smallest = drawn("coffee-300", "--opaque --precision 1 --form smallest");
    assert!(smallest.number("bytes_per_stroke") < 0.8 * plain.number("bytes_per_stroke"));
    assert!(smallest.number("svg_gzip_bytes") < plain.number("svg_gzip_bytes"));
}

#[test]
fn the_smallest_file_of_lines_and_flat_art_looks_like_the_plain_one() {
    for name in ["bicycle", "noto-gem"] {
        let plain = fitted(name, "--preset draft");
        let smallest = fitted(name, "--preset draft --form smallest");
        assert!(smallest.text.len() < plain.text.len(), "{name}");
        let lost = plain.psnr_db() - smallest.psnr_db();
        assert!(lost < 0.5, "{name}: {lost}");
    }
}

#[test]
fn an_opaque_capsule_of_the_smallest_file_takes_52_bytes_at_most() {
    for name in ["coffee-300", "noto-hibiscus", "noto-telescope"] {
        let options = "--opaque --precision 1 --form smallest --strokes 600 --points 2";
        let drawn = fitted(name, options);
        let bytes = drawn.number("bytes_per_stroke");
        assert_eq!(drawn.number("strokes"), 600.0);
        assert!(bytes <= 52.0, "{name}: {bytes}");
        let scene = svg::read(&drawn.text).unwrap();
        assert_eq!(scene.len(), 600);
    }
}

#[test]
fn a_budget_of_bytes_buys_more_in_the_smallest_form() {
    let bought = |form: &str| {
        // Drafts differ by 0.6 dB from one budget to the next, which is more than the form brings.
        let options = format!("--bytes 9000 --opaque --form {form} --look exact");
        let drawn = fitted("coffee-300", &options);
        assert!(drawn.text.len() <= 9000);
        (drawn.number("strokes"), drawn.psnr_db())
    };
    let (plain, smallest) = (bought("plain"), bought("smallest"));
    assert!(smallest.0 > 1.2 * plain.0);
    assert!(smallest.1 > plain.1 + 0.2, "{smallest:?} {plain:?}");
}

#[test]
fn a_drawing_in_classes_looks_like_the_plain_one_and_is_refined() {
    let plain = drawn("coffee-300", "--colors 8");
    let classes = drawn("coffee-300", "--colors 8 --form css");
    assert_eq!(
        svg::read(&classes.text).unwrap(),
        svg::read(&plain.text).unwrap()
    );
    assert!(on_white(&classes.text) == on_white(&plain.text));
    let (sheet, elements) = classes.text.split_once("</style>").unwrap();
    assert!(!elements.contains("fill=\"#") && !elements.contains("stroke=\"#"));
    let colors = sheet.matches("{fill:").count() + sheet.matches("{stroke:").count();
    assert!((5..=16).contains(&colors), "{sheet}");
    let place = &classes.place;
    for (options, name) in [("--form css", "b.svg"), ("--freeze-base", "c.svg")] {
        let refine = "refine a.svg @samples/coffee-300.png -q --strokes 170 --preset draft";
        place.done(&format!("{refine} -o {name} {options}"));
        let text = place.text(name);
        assert!(svg::read(&text).unwrap().len() > 150, "{name}");
        assert_eq!(text.matches("<style>").count(), 1);
    }
    let check = place.done("check a.svg @samples/coffee-300.png");
    let said = stderr(&check) + &String::from_utf8(check.stdout).unwrap();
    assert_says(&said, &["style-classes"]);
}

#[test]
fn outlines_are_verified_and_read_back_as_areas() {
    let drawn = drawn("noto-gem", "--outline");
    assert!(drawn.report["agreement"]["psnr_db"].as_f64().unwrap() > 36.0);
    let scene = svg::read(&drawn.text).unwrap();
    assert!(scene.marks().all(|mark| mark.as_area().is_some()));
    let again = svg::write(&scene, &svg::WriteOptions::default());
    assert!(agreement(&on_white(&drawn.text), &on_white(&again)) > 45.0);
}

#[test]
fn one_element_is_one_stroke_on_a_page_of_the_width_asked_for() {
    let drawn = drawn("coffee-300", "--width 120mm");
    let elements = drawn.text.matches("<path").count();
    assert_eq!(elements as f64, drawn.number("strokes"));
    let head = r#"width="120mm" height="80mm" viewBox="0 0 300 200""#;
    assert!(drawn.text.contains(head));
    drawn.place.done("check a.svg @samples/coffee-300.png");
}

#[test]
fn at_most_so_many_colours_are_used() {
    for (options, count) in [
        ("--colors 5", 5),
        ("--colors 5 --opaque", 5),
        ("--colors 3 --background #00ff00", 3),
    ] {
        let colors = drawn("coffee-300", options).colors();
        assert_eq!(colors.len(), count, "{options}");
        // A background that was asked for is one of them.
        assert_eq!(colors.contains("#00ff00"), count == 3);
    }
}

#[test]
fn only_colours_of_the_palette_are_used() {
    let palette = ["#000000", "#ffffff", "#c0392b", "#d35400"];
    let drawn = drawn("coffee-300", &format!("--palette {}", palette.join(",")));
    let palette = palette.map(String::from).into_iter().collect();
    assert!(drawn.colors().is_subset(&palette));
}

/// Strokes that know their palette make up for each other's missing colours; colours that are exchanged
/// afterwards do not.
#[test]
fn a_palette_is_fitted_and_not_only_applied() {
    let free = drawn("coffee-300", "");
    let fitted = drawn("coffee-300", "--palette #200804,#f0e0d0,#a03010,#c08050");
    let palette = [[32, 8, 4], [240, 224, 208], [160, 48, 16], [192, 128, 80]]
        .map(|rgb| rgb.map(|c: u8| f32::from(c) / 255.0));
    let nearest = |wanted: [f32; 3]| {
        let away = |c: &[f32; 3]| (0..3).map(|k| (c[k] - wanted[k]).powi(2)).sum::<f32>();
        palette
            .into_iter()
            .min_by(|a, b| away(a).total_cmp(&away(b)))
            .unwrap()
    };
    let mut applied = svg::read(&free.text).unwrap();
    applied.background = applied.background.map(nearest);
    for mark in applied.stages.iter_mut().flat_map(|stage| &mut stage.marks) {
        match mark {
            Mark::Stroke(stroke) => stroke.color = nearest(stroke.color),
            Mark::Area(area) => area.color = nearest(area.color),
        }
    }
    let text = svg::write(&applied, &svg::WriteOptions::default());
    let target = sample("coffee-300");
    let applied = verify::fidelity(&text, &target).unwrap().psnr_db;
    assert!(
        fitted.psnr_db() > applied + 1.0,
        "{} {applied}",
        fitted.psnr_db()
    );
}

#[test]
fn every_colour_has_one_layer_and_the_report_says_what_that_costs() {
    let by_stage = drawn("coffee-300", "--colors 6");
    let by_color = drawn("coffee-300", "--colors 6 --group color");
    assert!(by_color.text.contains(r#"<g id="color-1""#));
    let scene = svg::read(&by_color.text).unwrap();
    let one_color = |stage: &Stage| {
        stage
            .marks
            .iter()
            .all(|mark| mark.color() == stage.marks[0].color())
    };
    assert!(scene.stages.iter().all(one_color));
    // The background is one of the six.
    assert!(scene.stages.len() <= 6, "{}", scene.stages.len());
    let (cost, lost) = (
        by_color.number("stacking_db"),
        by_stage.psnr_db() - by_color.psnr_db(),
    );
    assert!(lost < 4.0 && (cost - lost).abs() < 1.0, "{cost} {lost}");
    assert!(by_stage.report["stacking_db"].is_null());
}

/// Blue ink on paper that is not quite white.
fn ink(place: &Place) -> Image {
    let picture = image::RgbImage::from_fn(120, 90, |x, y| {
        let (x, y) = (x as f32 - 60.0, y as f32 - 45.0);
        let away = ((x * x + y * y).sqrt() - 30.0).abs();
        image::Rgb(if away < 3.0 {
            [10, 20, 200]
        } else {
            [250, 247, 240]
        })
    });
    picture.save(place.path("ink.png")).unwrap();
    Image::open(place.path("ink.png")).unwrap()
}

#[test]
fn paper_stays_paper_if_the_palette_has_nothing_like_it() {
    let place = Place::new();
    let picture = ink(&place);
    let fit = "fit ink.png -o a.svg --strokes 20 --palette";
    let said = place.said(&format!("{fit} #0000ff"), 0);
    assert!(!said.contains("warning"));
    let text = place.text("a.svg");
    let scene = svg::read(&text).unwrap();
    assert!(scene.marks().all(|mark| mark.color() == [0.0, 0.0, 1.0]));
    assert!(scene.background.unwrap().iter().all(|&c| c > 0.9));
    assert!(verify::fidelity(&text, &picture).unwrap().psnr_db > 20.0);
    // A palette with something like it is all there is.
    place.done(&format!("{fit} #0000ff,#ffffff"));
    let scene = svg::read(&place.text("a.svg")).unwrap();
    assert_eq!(scene.background, Some([1.0; 3]));
}

#[test]
fn strokes_that_nobody_can_see_are_left_out_and_counted() {
    let drawn_white = drawn("coffee-300", "--colors 1 --background #ffffff");
    assert_eq!(drawn_white.number("strokes"), 0.0);
    let unseen = &drawn_white.report["dropped_for"]["invisible"];
    assert!(unseen.as_u64() > Some(0) && drawn_white.report["dropped"].as_u64() >= unseen.as_u64());
    // A background of the one colour is all that pays.
    let plain = drawn("coffee-300", "--colors 1");
    assert_eq!(plain.number("strokes"), 0.0);
}

#[test]
fn a_drawing_worse_than_a_page_of_one_colour_is_spoken_of() {
    let place = Place::new();
    ink(&place);
    let fit = "fit ink.png -o a.svg --colors 1";
    let poor = place.said(&format!("{fit} --background #000000"), 0);
    assert_says(&poor, &["warning: a page of one colour"]);
    assert!(!place.said(fit, 0).contains("warning"));
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let place = Place::new();
    place.file("bad.gpl", "GIMP Palette\n1 2 x\n");
    for (options, words) in [
        ("--width 12", "such as 120mm"),
        ("--width -3mm", "such as 120mm"),
        ("--outline --form smallest", "--outline"),
        ("--form tiny", "smallest"),
        ("--group size", "color"),
        ("--colors 0", "whole number"),
        ("--palette #12,#ffffff", "'#12' is not a colour"),
        ("--palette none.gpl", "no such file"),
        ("--palette bad.gpl", "line 2"),
        ("--palette #ffffff --colors 3", "--colors"),
        (
            "--palette #ffffff --background #000000",
            "the background #000000 is not in the palette",
        ),
    ] {
        let fit = format!("fit @samples/noto-gem.png -o a.svg {options}");
        assert_refused(&place, &fit, 2, &[words]);
    }
}
