use proptest::prelude::*;

use super::*;
use crate::error::ErrorKind;
use crate::math::Point;
use crate::scene::{Scene, Shape, Stage, Stroke};

fn point() -> impl Strategy<Value = Point> {
    let coordinate = prop_oneof![-20.0..120.0_f32, 0.0..0.02_f32, Just(50.0), -1e6..1e6_f32];
    (coordinate.clone(), coordinate).prop_map(|(x, y)| Point::new(x, y))
}

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        point().prop_map(Shape::dot),
        (point(), point()).prop_map(|(a, b)| Shape::capsule(a, b))
    ]
}

fn stroke() -> impl Strategy<Value = Stroke> {
    let unit = || {
        prop_oneof![
            0.0..=1.0_f32,
            Just(0.0),
            Just(1.0),
            -0.5..1.5_f32,
            Just(f32::NAN)
        ]
    };
    let radius = prop_oneof![0.0..20.0_f32, Just(0.5), 0.0..0.01_f32];
    (shape(), radius, unit(), unit(), unit(), unit()).prop_map(
        |(shape, radius, r, g, b, opacity)| Stroke {
            shape,
            radius,
            color: [r, g, b],
            opacity,
        },
    )
}

fn scene() -> impl Strategy<Value = Scene> {
    let stage = prop::collection::vec(stroke(), 0..8).prop_map(|strokes| Stage { strokes });
    let background = prop::option::of([0.0..=1.0_f32, 0.0..=1.0_f32, 0.0..=1.0_f32]);
    (
        1..100_u32,
        1..100_u32,
        background,
        prop::collection::vec(stage, 0..4),
    )
        .prop_map(|(width, height, background, stages)| Scene {
            width,
            height,
            background,
            stages,
        })
}

proptest! {
    #[test]
    fn reading_what_was_written_gives_the_quantised_scene(scene in scene(), precision in 0..=6_u8) {
        let text = write(&scene, &WriteOptions { precision });
        let (quantized, dropped) = scene.quantized(precision);
        prop_assert_eq!(quantized.len() + dropped, scene.len());
        prop_assert_eq!(read(&text).unwrap(), quantized);
    }

    #[test]
    fn quantising_twice_changes_nothing(scene in scene(), precision in 0..=6_u8) {
        let (once, _) = scene.quantized(precision);
        prop_assert_eq!(once.quantized(precision), (once.clone(), 0));
        let options = WriteOptions { precision };
        prop_assert_eq!(write(&once, &options), write(&scene, &options));
    }

    #[test]
    fn the_bytes_of_a_stroke_are_what_the_file_grows_by(stroke in stroke(), precision in 0..=6_u8) {
        let options = WriteOptions { precision };
        let page = |strokes| Scene { stages: vec![Stage { strokes }], ..Scene::empty(1_000_000, 9, None) };
        let (one, two) = (write(&page(vec![stroke]), &options), write(&page(vec![stroke; 2]), &options));
        // The title says "1 stroke" or "2 strokes".
        if one != two && !one.contains("0 strokes") {
            prop_assert_eq!(two.len() - one.len() - 1, stroke_bytes(&stroke, &options));
        }
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in any::<String>(), at in 0..900_usize, byte in 32..127_u8) {
        let _ = read(&text);
        let mut bytes = write(&sample(), &WriteOptions::default()).into_bytes();
        let at = at % bytes.len();
        bytes[at] = byte;
        let _ = read(std::str::from_utf8(&bytes).unwrap());
    }
}

fn sample() -> Scene {
    let line = Stroke {
        shape: Shape::capsule(Point::new(100.25, 20.5), Point::new(97.04, 25.06)),
        radius: 1.5,
        color: [1.0, 0.4, 0.0],
        opacity: 1.0,
    };
    let dot = Stroke {
        shape: Shape::dot(Point::new(3.0, 4.0)),
        opacity: 0.5,
        ..line
    };
    let stages = vec![
        Stage {
            strokes: vec![line],
        },
        Stage {
            strokes: vec![dot, line],
        },
    ];
    Scene {
        stages,
        ..Scene::empty(120, 40, Some([1.0; 3]))
    }
}

#[test]
fn the_dialect_is_this() {
    let expected = r##"<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="120" height="40" viewBox="0 0 120 40">
<rect width="120" height="40" fill="#ffffff"/>
<g id="stage-1" inkscape:groupmode="layer" inkscape:label="Stage 1" fill="none" stroke-linecap="round">
<title>Stage 1: 1 stroke</title>
<path d="M100.25 20.5l-3.21 4.56" stroke="#ff6600" stroke-width="3"/>
</g>
<g id="stage-2" inkscape:groupmode="layer" inkscape:label="Stage 2" fill="none" stroke-linecap="round">
<title>Stage 2: 2 strokes</title>
<path d="M3 4h0.01" stroke="#ff6600" stroke-width="3" stroke-opacity="0.502"/>
<path d="M100.25 20.5l-3.21 4.56" stroke="#ff6600" stroke-width="3"/>
</g>
</svg>
"##;
    assert_eq!(write(&sample(), &WriteOptions::default()), expected);
}

#[test]
fn layers_are_the_document_without_its_head() {
    let (text, layers) = (
        write(&sample(), &WriteOptions::default()),
        layers(&sample(), &WriteOptions::default(), 1),
    );
    assert!(layers.starts_with("<g id=\"stage-1\""));
    assert!(text.ends_with(&(layers + "</svg>\n")));
}

#[test]
fn layers_are_numbered_from_where_they_are_told() {
    let layers = layers(&sample(), &WriteOptions::default(), 4);
    let found = ["id=\"stage-4\"", "Stage 5: 2 strokes"].map(|text| layers.contains(text));
    assert_eq!(found, [true; 2]);
}

fn refusal(text: &str) -> String {
    let error = read(text).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Svg);
    let message = error.to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

#[test]
fn what_is_not_the_dialect_is_named_with_its_line() {
    let text = write(&sample(), &WriteOptions::default());
    let cases = [
        (
            "2000/svg",
            "1999/svg",
            "line 1: <svg> is in the namespace \"http://www.w3.org/1999/svg\"",
        ),
        (
            " xmlns=\"http://www.w3.org/2000/svg\"",
            "",
            "line 1: <svg> is in no namespace",
        ),
        (
            "viewBox=\"0 0 120 40\"",
            "viewBox=\"0 0 120 41\"",
            "line 1: <svg> has viewBox=\"0 0 120 41\"",
        ),
        (
            "width=\"120\"",
            "width=\"1e99\"",
            "line 1: <svg> has width=\"1e99\"",
        ),
        (
            "<title>Stage 1",
            "<circle/><title>Stage 1",
            "line 4: <circle> is not of the dialect",
        ),
        (
            "id=\"stage-2\"",
            "id=\"stage-2\" transform=\"scale(2)\"",
            "line 7: <g> has the attribute transform",
        ),
        (
            "id=\"stage-2\"",
            "id=\"stage-7\"",
            "line 7: <g> has id=\"stage-7\"",
        ),
        ("M3 4h0.01", "M3 4h5", "line 9: <path> has d=\"M3 4h5\""),
        (
            "M3 4h0.01",
            "M3e30 4h0.01",
            "line 9: <path> has d=\"M3e30 4h0.01\"",
        ),
        ("M3 4h0.01", "M39999999999 4h0.01", "line 9: <path> has d="),
        (
            "stroke-opacity=\"0.502\"",
            "stroke-opacity=\"7\"",
            "line 9: <path> has stroke-opacity=\"7\"",
        ),
        (
            "stroke-width=\"3\" ",
            "stroke-width=\"-3\" ",
            "line 9: <path> has stroke-width=\"-3\"",
        ),
        (
            "stroke=\"#ff6600\" stroke-width=\"3\" ",
            "",
            "line 9: <path> has no stroke",
        ),
        (
            "h0.01\"",
            "h0.01\" d=\"M1 1h0.01\"",
            "line 9: not well-formed XML",
        ),
        ("</g>\n</svg>", "</svg>", "line 11: not well-formed XML"),
        ("</svg>\n", "", "the file ends before </svg>"),
        (
            "</svg>\n",
            "</svg>\n<svg xmlns=\"http://www.w3.org/2000/svg\"/>",
            "something follows </svg>",
        ),
        ("<rect", "<!DOCTYPE svg><rect", "line 2"),
    ];
    for (from, to, expected) in cases {
        assert!(text.contains(from), "{from}");
        let message = refusal(&text.replace(from, to));
        assert!(message.contains(expected), "{to}: {message}");
    }
    assert!(refusal("").contains("there is no <svg> element"));
    assert!(refusal("<html/>").contains("no namespace"));
}

#[test]
fn comments_white_space_and_prefixed_attributes_do_not_matter() {
    let text = write(&sample(), &WriteOptions::default())
        .replace("<rect", "<!-- a comment --><rect")
        .replace("<title>Stage 2", "<title>&amp; <!-- c --> Stage 2")
        .replace(
            "inkscape:label=",
            "inkscape:insensitive=\"true\" inkscape:label=",
        )
        .replace("/>\n</g>", "></path>\n  </g>");
    assert_eq!(read(&text).unwrap(), sample().quantized(2).0);
}
