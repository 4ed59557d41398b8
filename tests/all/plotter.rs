//! Drawings for plotters: little travel between strokes, and the widths of given pens.

use std::collections::BTreeSet;

use crate::support::{Place, agreement, assert_refused, on_white};
use strokefit::svg;

/// A draft of the bicycle, and its report.
fn drawn(options: &str) -> (String, serde_json::Value) {
    let place = Place::new();
    let few = "--preset draft --strokes 120 --report a.json -q";
    place.done(&format!(
        "fit @samples/bicycle.png -o a.svg {few} {options}"
    ));
    (place.text("a.svg"), place.report("a.json"))
}

/// All widths of strokes, in hundredths of a px.
fn widths(text: &str) -> BTreeSet<u32> {
    let scene = svg::read(text).unwrap();
    let hundredths = |radius: f64| (200.0 * radius).round() as u32;
    scene.strokes().map(|s| hundredths(s.radius)).collect()
}

#[test]
fn travel_is_a_third_and_the_picture_stays() {
    let ink = "--opaque --colors 3 --group color";
    let (fitted, without) = drawn(ink);
    let (text, report) = drawn(&format!("{ink} --order travel"));
    assert!(without["travel"].is_null());
    let travel = &report["travel"];
    let px = |field: &str| travel[field].as_f64().unwrap();
    assert!(px("after_px") < 0.33 * px("before_px"), "{travel}");
    let layers = travel["layers"].as_array().unwrap();
    assert_eq!(layers.len(), svg::read(&text).unwrap().stages.len());
    let strokes: u64 = layers.iter().map(|l| l["strokes"].as_u64().unwrap()).sum();
    assert_eq!(strokes, report["strokes"].as_u64().unwrap());
    assert!(text.contains("inkscape:label=\"1 #"));
    let seen = agreement(&on_white(&fitted), &on_white(&text));
    assert!(seen > 45.0, "{seen}");
}

#[test]
fn strokes_have_the_widths_of_the_pens() {
    for (options, expected) in [
        // The picture is 400 px wide.
        ("--pens 0.9mm,0.4mm --width 100mm --opaque", &[160, 360][..]),
        (
            "--pens 0.9mm,0.4mm --width 100mm --opaque --form smallest",
            &[160, 360],
        ),
        ("--pens 2.5 --palette #203040,#ffffff", &[250]),
    ] {
        let found: Vec<u32> = widths(&drawn(options).0).into_iter().collect();
        assert_eq!(found, expected, "{options}");
    }
}

#[test]
fn refined_strokes_get_the_pens_on_the_page_of_the_base() {
    let place = Place::new();
    place.file("a.svg", drawn("--width 100mm").0);
    let few = "--preset draft -q --strokes +20";
    place.done(&format!(
        "refine a.svg @samples/bicycle.png -o b.svg --pens 0.5mm {few}"
    ));
    let text = place.text("b.svg");
    assert_eq!(widths(&text), [200].into());
    assert!(text.contains("width=\"100mm\" height=\"65mm\""));
}

#[test]
fn pens_that_cannot_be_drawn_with_are_refused() {
    let place = Place::new();
    for (pens, words) in [
        ("0", "'0' is not a width"),
        ("2,thin", "'thin' is not a width"),
    ] {
        let fit = format!("fit @samples/bicycle.png -o a.svg --pens {pens}");
        assert_refused(&place, &fit, 2, &[words]);
    }
}
