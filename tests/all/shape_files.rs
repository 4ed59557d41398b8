//! Shapes through the program: refined, animated, cut out, as DXF.

use crate::support::{Place, agreement, assert_says, on_white, rendered};
use strokefit::scene::{Mark, Path, PathPoint, Scene, Shape, Stage, Stroke};
use strokefit::svg::{self, WriteOptions};
use strokefit::verify::{self, Size};

const SHAPES: &str = r##"<circle cx="32.3" cy="30.6" r="18.2" fill="#c03020"/><rect x="80.5" y="62.2" width="60.3" height="44" rx="9.5" fill="#404858"/>
<circle cx="36" cy="86" r="20" fill="none" stroke="#208040" stroke-width="5"/>"##;

/// Lines with square ends and mitred corners.
const BANDS: &str = r##"<g fill="none" stroke="#204080" stroke-width="6"><path d="M20 20H90V70"/><path d="M20 40L60 100H140"/></g>"##;

/// A page of these elements, 160×120 px.
fn page(elements: &str) -> String {
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="160" height="120"><rect width="160" height="120" fill="#fff"/>{elements}</svg>"##
    )
}

/// A folder with the picture `a.png` of shapes.
fn with_picture() -> Place {
    let place = Place::new();
    put_picture(&place, "a.png", SHAPES);
    place
}

fn put_picture(place: &Place, name: &str, elements: &str) {
    let picture = verify::render(&page(elements), Size::Scale(4.0), None).unwrap();
    place.file(name, picture.reduced(160, 120).encode_png().unwrap());
}

/// The lines of a file that are shapes.
fn elements(text: &str) -> Vec<&str> {
    let is_shape = |line: &&str| line.starts_with("<circle") || line.starts_with("<rect x=");
    text.lines().filter(is_shape).collect()
}

fn shapes(scene: &Scene) -> usize {
    scene.marks().filter_map(Mark::shape).count()
}

/// Draws `a.svg`, whose marks are three shapes.
fn fitted(place: &Place, options: &str) -> String {
    place.done(&format!("fit a.png -o a.svg -q {options}"));
    let text = place.text("a.svg");
    assert_eq!(elements(&text).len(), 3, "{text}");
    text
}

#[test]
fn shapes_of_a_base_stay_shapes() {
    let place = with_picture();
    let base = fitted(&place, "");
    // The circle has moved, and something is new.
    let more = SHAPES.replace("cx=\"32.3\"", "cx=\"32.7\"");
    let more = more + r##"<path d="M90 20L150 40L100 50z" fill="#2060c0"/>"##;
    put_picture(&place, "b.png", &more);
    place.done("refine a.svg b.png -o b.svg -q");
    let refined = place.text("b.svg");
    let scene = svg::read(&refined).unwrap();
    assert!(shapes(&scene) >= 3 && scene.len() > 3, "{refined}");
    let moved = scene.areas().any(|area| match area.rings[0].shape() {
        Some(Shape::Circle { center, .. }) => (center.x - 32.7).abs() < 0.1,
        _ => false,
    });
    assert!(moved, "{refined}");
    place.done("refine a.svg b.png -o c.svg -q --freeze-base");
    let frozen = place.text("c.svg");
    for element in elements(&base) {
        assert!(frozen.contains(element), "{element}: {frozen}");
    }
}

/// The lines with square ends of a file that strokefit wrote.
fn bands(text: &str) -> usize {
    let scene = svg::read(text).unwrap();
    scene.marks().filter(|mark| mark.is_butt()).count()
}

#[test]
fn bands_are_lines_in_every_file() {
    let place = Place::new();
    put_picture(&place, "a.png", BANDS);
    let kept = "--checkpoint fit.state --checkpoint-every 0.001";
    place.done(&format!(
        "fit a.png -o a.svg -o a.animated.svg -o a.dxf -q {kept}"
    ));
    let text = place.text("a.svg");
    assert_eq!(bands(&text), 2, "{text}");
    assert_eq!(svg::read(&text).unwrap().len(), 2, "{text}");
    // A file without round ends needs not say that there are none.
    assert!(!text.contains("stroke-linecap"), "{text}");
    let dxf = place.text("a.dxf");
    // Two corners each, and no outline around them.
    assert_eq!(dxf.matches("\nLWPOLYLINE\n").count(), 2, "{dxf}");
    let animated = place.text("a.animated.svg");
    assert_eq!(
        animated.matches("\"stroke-dasharray\"").count(),
        2,
        "{animated}"
    );
    // A style sheet has their colour and width.
    place.done("fit a.png -o css.svg -q --form css");
    let css = place.text("css.svg");
    assert!(bands(&css) == 2 && css.contains("class="), "{css}");
    // What is read back is written the same way, and frozen ones stay.
    place.done("refine a.svg a.png -o b.svg -q --freeze-base --strokes +1");
    assert!(bands(&place.text("b.svg")) >= 2);
    for form in ["--outline", "--cutout"] {
        place.done(&["render", "a.svg", "-o", "c.svg", form]);
        let filled = place.text("c.svg");
        assert!(
            bands(&filled) == 0 && !filled.contains("stroke="),
            "{filled}"
        );
        let seen = agreement(&on_white(&filled), &on_white(&text));
        assert!(seen > 35.0, "{form}");
    }
}

/// A file with two lines whose width varies, one of which bends more sharply than it is wide.
fn varying() -> String {
    let on = |x: f64, y: f64| PathPoint::on((x, y).into());
    let off = |x: f64, y: f64| PathPoint::off((x, y).into());
    let line = |points: &[PathPoint], radii: &[f64], color| {
        let path = Path::new(points.to_vec(), false).unwrap();
        Stroke::varying(path, radii.to_vec(), color, 1.0).unwrap()
    };
    let wave = [
        on(20.0, 30.0),
        off(50.0, 10.0),
        off(80.0, 60.0),
        on(140.0, 25.0),
    ];
    let hairpin = [
        on(20.0, 80.0),
        on(90.0, 80.0),
        off(98.0, 84.0),
        on(90.0, 90.0),
        on(60.0, 100.0),
    ];
    let lines = [
        line(&wave, &[0.0, 6.0], [0.1, 0.2, 0.5]),
        line(&hairpin, &[2.0, 7.0, 7.0, 0.0], [0.6, 0.1, 0.1]),
    ];
    let scene = Scene {
        stages: vec![Stage::from_iter(lines)],
        ..Scene::empty(160, 120, Some([1.0; 3]))
    };
    svg::write(&scene, &WriteOptions::default())
}

/// The lines whose width varies of a file that strokefit wrote.
fn varying_in(text: &str) -> usize {
    let scene = svg::read(text).unwrap();
    scene.marks().filter(|mark| mark.is_varying()).count()
}

#[test]
fn lines_whose_width_varies_are_lines_in_every_file() {
    let place = Place::new();
    let text = varying();
    place.file("a.svg", &text);
    let picture = verify::render(&text, Size::Scale(4.0), None).unwrap();
    place.file("a.png", picture.reduced(160, 120).encode_png().unwrap());
    place.done("check a.svg a.png -q --renderer resvg");
    // Frozen ones are as they were. Free ones keep their lines, and only colours are fitted.
    place.done("refine a.svg a.png -o b.svg -q --freeze-base --strokes +1");
    assert_eq!(varying_in(&place.text("b.svg")), 2);
    for form in ["plain", "css", "smallest", "powerstroke"] {
        let kept = "--checkpoint fit.state --checkpoint-every 0.001";
        place.done(&format!(
            "refine a.svg a.png -o c.svg -q --strokes +2 --form {form} {kept}"
        ));
        let refined = place.text("c.svg");
        assert_eq!(varying_in(&refined), 2, "{refined}");
        let seen = agreement(&on_white(&refined), &on_white(&text));
        assert!(seen > 35.0, "{form} {seen}: {refined}");
        assert_eq!(refined.contains("original-d"), form == "powerstroke");
    }
    for (option, least) in [
        ("--outline", 45.0),
        ("--cutout", 35.0),
        ("--hatch=3px", 15.0),
    ] {
        place.done(&["render", "a.svg", "-o", "d.svg", option]);
        let filled = place.text("d.svg");
        assert_eq!(varying_in(&filled), 0);
        let seen = agreement(&on_white(&filled), &on_white(&text));
        assert!(seen > least, "{option} {seen}");
    }
}

#[test]
fn shapes_appear_in_an_animation() {
    let place = with_picture();
    fitted(&place, "-o a.animated.svg -o a.apng");
    let animated = place.text("a.animated.svg");
    assert_says(
        &animated,
        &[
            "<circle cx=",
            "attributeName=\"fill-opacity\"",
            "attributeName=\"stroke-dasharray\"",
            "</circle>",
            "</rect>",
        ],
    );
    assert!(rendered(&animated) == rendered(&place.text("a.svg")));
}

#[test]
fn circles_are_circles_in_a_dxf() {
    let place = with_picture();
    let text = fitted(&place, "--width 160mm -o a.dxf");
    let dxf = place.text("a.dxf");
    assert_eq!(dxf.matches("\nCIRCLE\n").count(), 2, "{dxf}");
    assert_eq!(dxf.matches("\nLWPOLYLINE\n").count(), 1, "{dxf}");
    // The radius of the disc, mm.
    let circles = dxf.split("\nAcDbCircle\n").skip(1);
    let radii = circles.map(|circle| circle.split("\n40\n").nth(1).unwrap());
    let radii = radii.map(|radius| radius.lines().next().unwrap().parse().unwrap());
    let radii: Vec<f64> = radii.collect();
    let is_found = radii.iter().any(|mm| (mm - 18.2).abs() < 0.15);
    assert!(is_found, "{radii:?} {text}");
}

#[test]
fn a_shape_is_cut_out_hatched_and_outlined_like_any_area() {
    let place = with_picture();
    let text = fitted(&place, "--background none --opaque");
    for (option, least) in [
        ("--cutout", 30.0),
        ("--outline", 30.0),
        ("--hatch=3px", 18.0),
    ] {
        place.done(&["render", "a.svg", "-o", "b.svg", option]);
        let seen = agreement(&on_white(&place.text("b.svg")), &on_white(&text));
        assert!(seen > least, "{option}");
    }
}
