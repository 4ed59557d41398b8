//! Drawings for plotters: little travel between strokes, and the widths of given pens.

use std::collections::BTreeSet;
use std::fs;

use crate::support::place::Place;
use crate::support::refusal::assert_refused;
use crate::support::repository::committed;
use strokefit::image::Image;
use strokefit::svg;
use strokefit::verify::{self, Size};

/// A draft of the bicycle, and its report.
fn drawn(options: &[&str]) -> (String, serde_json::Value) {
    let place = Place::new();
    let input = committed("samples/bicycle.png");
    let fit = ["fit", &input, "-o", "a.svg", "--report", "a.json", "-q"];
    let few = ["--preset", "draft", "--strokes", "120"];
    place.done(&[&fit[..], &few, options].concat());
    let text = fs::read_to_string(place.path("a.svg")).unwrap();
    (text, place.report("a.json"))
}

fn image(text: &str) -> Image {
    verify::render(text, Size::Scale(1.0), Some([1.0; 3])).unwrap()
}

/// All widths of strokes, in hundredths of a px.
fn widths(text: &str) -> BTreeSet<u32> {
    let scene = svg::read(text).unwrap();
    let hundredths = |radius: f64| (200.0 * radius).round() as u32;
    scene.strokes().map(|s| hundredths(s.radius)).collect()
}

#[test]
fn travel_is_a_third_and_the_picture_stays() {
    let ink = ["--opaque", "--colors", "3", "--group", "color"];
    let (fitted, without) = drawn(&ink);
    let (text, report) = drawn(&[&ink[..], &["--order", "travel"]].concat());
    assert!(without["travel"].is_null());
    let px = |field: &str| report["travel"][field].as_f64().unwrap();
    assert!(
        px("after_px") < 0.33 * px("before_px"),
        "{}",
        report["travel"]
    );
    let layers = report["travel"]["layers"].as_array().unwrap();
    assert_eq!(layers.len(), svg::read(&text).unwrap().stages.len());
    let strokes: u64 = layers.iter().map(|l| l["strokes"].as_u64().unwrap()).sum();
    assert_eq!(strokes, report["strokes"].as_u64().unwrap());
    assert!(text.contains("inkscape:label=\"1 #"));
    let agreement = strokefit::metrics::Agreement::between(&image(&fitted), &image(&text)).unwrap();
    assert!(agreement.psnr_db > 45.0, "{agreement:?}");
}

#[test]
fn strokes_have_the_widths_of_the_pens() {
    // The picture is 400 px wide.
    let pens = ["--pens", "0.9mm,0.4mm", "--width", "100mm"];
    for form in ["plain", "smallest"] {
        let (text, _) = drawn(&[&pens[..], &["--opaque", "--form", form]].concat());
        assert_eq!(widths(&text), [160, 360].into(), "{form}");
    }
    let (text, _) = drawn(&["--pens", "2.5", "--palette", "#203040,#ffffff"]);
    assert_eq!(widths(&text), [250].into());
}

#[test]
fn refined_strokes_get_the_pens_on_the_page_of_the_base() {
    let place = Place::new();
    let input = committed("samples/bicycle.png");
    place.file("a.svg", drawn(&["--width", "100mm"]).0);
    let refine = ["refine", "a.svg", &input, "-o", "b.svg", "--pens", "0.5mm"];
    let few = ["--preset", "draft", "-q", "--strokes", "+20"];
    place.done(&[&refine[..], &few].concat());
    let text = fs::read_to_string(place.path("b.svg")).unwrap();
    assert_eq!(widths(&text), [200].into());
    assert!(text.contains("width=\"100mm\""));
}

#[test]
fn pens_that_cannot_be_drawn_with_are_refused() {
    let place = Place::new();
    let input = committed("samples/bicycle.png");
    let fit = ["fit", &input, "-o", "a.svg", "--pens"];
    for (pens, words) in [
        ("0", "'0' is not a width"),
        ("2,thin", "'thin' is not a width"),
    ] {
        assert_refused(&place, &[&fit[..], &[pens]].concat(), 2, &[words]);
    }
}
