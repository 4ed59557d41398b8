use super::*;
use crate::math::Point;
use crate::scene::{Cap, Path, Scene, Stage, Stroke};
use crate::svg::{WriteOptions, write};

fn page(body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\" viewBox=\"0 0 9 9\">\n{body}\n</svg>\n"
    )
}

/// The names of the rules that `text` breaks.
fn names(text: &str) -> Vec<String> {
    lint(text).into_iter().map(|f| f.rule).collect()
}

#[test]
fn each_rule_finds_its_case_and_nothing_else() {
    for (body, rule) in [
        (
            "<path d=\"M5 5h0\" stroke=\"#000\" stroke-width=\"2\"/>",
            "zero-length",
        ),
        (
            "<line x1=\"3\" y1=\"3\" x2=\"3\" y2=\"3\" stroke=\"red\" stroke-width=\"2\"/>",
            "zero-length",
        ),
        ("<path d=\"M5 5h2\" stroke=\"#000\"/>", "thin-stroke"),
        (
            "<g stroke=\"#000\" transform=\"scale(0.1)\"><path d=\"M5 5h2\" stroke-width=\"9\"/></g>",
            "thin-stroke",
        ),
        (
            "<path d=\"M5 5h2\" style=\"stroke:#000;stroke-width:0.5px\" stroke-width=\"9\"/>",
            "thin-stroke",
        ),
        (
            "<rect width=\"5\" height=\"5\" fill=\"#11223344\"/>",
            "color-alpha",
        ),
        (
            "<rect width=\"5\" height=\"5\" style=\"fill: rgba(1,2,3,0.5)\"/>",
            "color-alpha",
        ),
        (
            "<g opacity=\"0.5\"><path d=\"M1 1h1\"/></g>",
            "group-opacity",
        ),
        ("<rect width=\"5\" height=\"5\" x=\".5\"/>", "leading-dot"),
        ("<filter/>", "feature"),
        ("<linearGradient id=\"g\"/>", "feature"),
        (
            "<radialGradient id=\"g\" gradientUnits=\"userSpaceOnUse\" cx=\"2\" cy=\"2\" r=\"3\" fx=\"1\"/>",
            "feature",
        ),
        ("<image href=\"data:image/png;base64,\"/>", "feature"),
        ("<text>url</text>", "text"),
        ("<style>path{fill:red}</style>", "style-sheet"),
        ("<style>.a{fill:red}</style>", "style-classes"),
        ("<script>1</script>", "script"),
        ("<rect width=\"5\" height=\"5\" onclick=\"x()\"/>", "script"),
        ("<style>@import 'x.css';</style>", "external-reference"),
        (
            "<image href=\"http://example.org/a.png\"/>",
            "external-reference",
        ),
        (
            "<use xlink:href=\"other.svg#a\" xmlns:xlink=\"http://www.w3.org/1999/xlink\"/>",
            "external-reference",
        ),
        (
            "<rect width=\"5\" height=\"5\" fill=\"url(paint.svg#a)\"/>",
            "external-reference",
        ),
        (
            "<rect width=\"5\" height=\"5\" fill=\"url(#none)\"/>",
            "missing-id",
        ),
        ("<g id=\"a\"/><g id=\"a\"/>", "duplicate-id"),
        ("<g id=\"1a\"/>", "id-start"),
        (
            "<g xmlns:inkscape=\"i\" inkscape:groupmode=\"layer\"/>",
            "layer-id",
        ),
        ("<line x2=\"3\"/>", "dialect"),
    ] {
        let found = names(&page(body));
        assert!(found.contains(&rule.to_owned()), "{body}: {found:?}");
        let expected = ["feature", "style-sheet", "style-classes", "dialect"];
        let others = found
            .iter()
            .filter(|f| *f != rule && !expected.contains(&f.as_str()));
        assert_eq!(others.count(), 0, "{body}: {found:?}");
    }
    let run = page("").replace("<svg ", "<svg onload=\"x()\" ");
    assert_eq!(names(&run), ["script"]);
}

#[test]
fn classes_override_attributes_and_are_overridden_by_styles() {
    let thin = |line: &str| {
        let body =
            format!("<style>.a{{stroke:#000;stroke-width:0.4}} .b{{stroke-width:3}}</style>{line}");
        names(&page(&body)).contains(&"thin-stroke".to_owned())
    };
    assert!(thin("<path class=\"a\" d=\"M5 5h2\" stroke-width=\"3\"/>"));
    assert!(thin("<g class=\"a\"><path d=\"M5 5h2\"/></g>"));
    assert!(!thin(
        "<path class=\"a\" d=\"M5 5h2\" style=\"stroke-width:3\"/>"
    ));
    assert!(!thin(
        "<path class=\"b\" d=\"M5 5h2\" stroke=\"#000\" stroke-width=\"0.4\"/>"
    ));
}

#[test]
fn what_looks_like_it_but_is_not_is_let_pass() {
    for body in [
        "<path d=\"M5 5h0\" fill=\"#000\"/>",
        "<path d=\"M5 5h2\" stroke=\"none\" stroke-width=\"0.1\"/>",
        "<g transform=\"scale(10)\"><path d=\"M5 5h2\" stroke=\"#000\" stroke-width=\"0.2\"/></g>",
        "<path d=\"M5 5h2\" stroke=\"#000\" stroke-width=\"0.2\" style=\"stroke-width:3\"/>",
        "<g opacity=\"1\"/>",
        "<g id=\"face\" href=\"#face\" data-name=\"#face\"/>",
        "<g id=\"a.5\"><title>#11223344 .5 rgba(</title></g>",
        "<path id=\"a\" d=\"M1 1h1\"/><path fill=\"url(#a)\" d=\"M1 1h1\"/>",
    ] {
        assert_eq!(lint(&page(body)), [], "{body}");
    }
}

#[test]
fn the_page_should_have_the_size_of_its_view() {
    let good = page("");
    for (from, to, rule) in [
        ("viewBox=\"0 0 9 9\"", "", "page-size"),
        ("viewBox=\"0 0 9 9\"", "viewBox=\"0 0 9 8\"", "page-size"),
        ("width=\"9\"", "width=\"100%\"", "page-size"),
        ("width=\"9\"", "width=\"9mm\"", "page-size"),
        ("height=\"9\"", "", "page-size"),
        ("viewBox=\"0 0 9 9\"", "viewBox=\"0 0 18 18\"", "page-scale"),
        ("viewBox=\"0 0 9 9\"", "viewBox=\"1 0 9 9\"", "page-scale"),
        (
            "width=\"9\" height=\"9\"",
            "width=\"5\" height=\"5\"",
            "page-scale",
        ),
    ] {
        assert_eq!(names(&good.replace(from, to)), [rule], "{to}");
    }
    assert!(names(&good.replace("width=\"9\"", "width=\"9px\"")).is_empty());
}

#[test]
fn a_page_of_a_stated_width_is_as_it_was_asked_for() {
    let scene = Scene {
        stages: vec![Stage::from_iter([Stroke {
            path: Path::line(Point::new(9.0, 9.0), Point::new(60.0, 30.0)),
            radius: 0.6,
            radii: Vec::new(),
            cap: Cap::Round,
            color: [0.5; 3],
            opacity: 1.0,
        }])],
        ..Scene::empty(400, 300, Some([1.0; 3]))
    };
    for (width, found) in [
        ("40mm", &[][..]),
        ("7in", &[]),
        ("800px", &[]),
        ("200px", &["thin-stroke"]),
    ] {
        let options = WriteOptions {
            width: Some(width.parse().unwrap()),
            ..WriteOptions::default()
        };
        assert_eq!(names(&write(&scene, &options)), found, "{width}");
    }
}

#[test]
fn what_nothing_is_drawn_of_is_an_error() {
    let good = page("<g/>");
    for (text, rule) in [
        (good.replace("http:", "https:"), "namespace"),
        (good.replace("</svg>", ""), "not-xml"),
        (good.replace("<g/>", "<g></p>"), "not-xml"),
        (
            format!("<?xml-stylesheet href=\"a.css\"?>{good}"),
            "external-reference",
        ),
        (page(&("<g>".repeat(300) + &"</g>".repeat(300))), "deep"),
        (page(&" ".repeat(10_000_000)), "large-file"),
    ] {
        let findings = lint(&text);
        assert_eq!(
            (findings[0].rule.as_str(), findings[0].severity),
            (rule, Severity::Error)
        );
    }
}

#[test]
fn all_lines_are_kept_and_three_are_shown() {
    let thin = "<path d=\"M1 1h1\"\n stroke=\"#000\"/>\n".repeat(5);
    let findings = lint(&page(&thin));
    assert_eq!(findings[0].lines, [2, 4, 6, 8, 10]);
    let shown = findings[0].to_string();
    assert!(
        shown.starts_with(
            "warning: lines 2, 4, 6 and 2 more: thin-stroke: <path> with a stroke 1.000 px wide: "
        ),
        "{shown}"
    );
}

#[test]
fn the_worst_comes_first() {
    let body = "<line x2=\"3\"/>\n<g opacity=\"0.5\"/>\n<image href=\"a.png\"/>";
    assert_eq!(
        names(&page(body)),
        ["external-reference", "group-opacity", "feature", "dialect"]
    );
}

#[test]
fn no_text_makes_it_panic() {
    let text =
        page("<path d=\"M5é 5h0\" style=\"stroke:url(\" transform=\"é(\"/><!-- é --><![CDATA[é]]>");
    for end in (0..text.len()).filter(|&end| text.is_char_boundary(end)) {
        lint(&text[..end]);
    }
}
