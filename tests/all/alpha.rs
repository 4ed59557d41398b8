//! Transparency is fitted: no background is drawn, and a drawing looks right on whatever it is laid.

use crate::support::{draft, drawn, rendered, sample};
use strokefit::fit::{Background, Config};
use strokefit::image::Image;
use strokefit::verify::{self};

/// A red square of half opacity in a clear page.
fn glass() -> Image {
    let inside = |i: usize| (12..36).contains(&(i % 48)) && (8..32).contains(&(i / 48));
    let alpha = (0..48 * 40)
        .map(|i| if inside(i) { 0.5 } else { 0.0 })
        .collect();
    let red = Image::filled(48, 40, [0.9, 0.2, 0.1]).unwrap();
    red.with_alpha(alpha).unwrap()
}

#[test]
fn pictures_look_right_on_every_matte() {
    for (name, strokes, min_db) in [
        ("noto-gem", 150, 36.0),
        ("noto-hibiscus", 150, 32.0),
        ("noto-rocket", 150, 30.0),
    ] {
        let picture = sample(name);
        let fit = drawn(&picture, &draft(strokes));
        let seen = verify::on_mattes(&fit.svg(), &picture).unwrap();
        for db in [seen.black_db, seen.white_db, seen.magenta_db] {
            assert!(db > min_db, "{name}: {seen:?}");
        }
        let verdict = verify::verify(&fit.svg(), &fit.target, &fit.soft, fit.matte).unwrap();
        assert!(verdict.agreement.psnr_db > 36.0, "{name}: {verdict:?}");
        assert_eq!(verdict.fidelity.psnr_db, seen.white_db, "{name}");
        // No background is drawn; its element begins with the width, that of a shape with the place.
        assert!(!fit.svg().contains("<rect width"));
        let drawn = rendered(&fit.svg());
        let pairs = drawn.alpha().unwrap().iter().zip(picture.alpha().unwrap());
        let errors: Vec<f32> = pairs.map(|(a, b)| (a - b).abs()).collect();
        let mean = errors.iter().sum::<f32>() / errors.len() as f32;
        assert!(mean < 0.005, "{name}: alpha is off by {mean} in the mean");
    }
}

#[test]
fn glass_is_drawn_as_glass() {
    let fit = drawn(&glass(), &draft(40));
    let seen = rendered(&fit.svg());
    let at = |x: usize, y: usize| y * 48 + x;
    let alpha = seen.alpha().unwrap();
    assert!(
        (alpha[at(24, 20)] - 0.5).abs() < 0.1,
        "{}",
        alpha[at(24, 20)]
    );
    assert!(alpha[at(3, 3)] < 0.05, "{}", alpha[at(3, 3)]);
}

/// Translucent shapes on a clear page are elements with an opacity: below what is opaque, across each other, on each other.
#[test]
fn translucent_shapes_are_elements() {
    let star = r##"<path d="M120 20L150 90L225 95L168 142L187 215L120 175L53 215L72 142L15 95L90 90Z" fill="#e04020" opacity=".5"/>"##;
    let two_tones = r##"<path fill="#1c274c" opacity=".5" d="M30 60H210V200H30Z"/><path fill="#1c274c" d="M60 30H180V80H60ZM90 110H150V170H90Z"/>"##;
    let circles = r##"<circle cx="90" cy="120" r="65" fill="#f00" opacity=".5"/><circle cx="150" cy="120" r="65" fill="#00f" opacity=".5"/>"##;
    let three = r##"<circle cx="90" cy="90" r="55" fill="#f00" opacity=".5"/><circle cx="150" cy="90" r="55" fill="#00f" opacity=".4"/><circle cx="120" cy="145" r="55" fill="#0c0" opacity=".5"/>"##;
    let target = r##"<circle cx="120" cy="120" r="90" fill="#080" opacity=".4"/><circle cx="120" cy="120" r="40" fill="#fa0" opacity=".6"/>"##;
    let cross = r##"<path d="M40 60L200 180M200 60L40 180" fill="none" stroke="#0a5" stroke-width="12" opacity=".55"/>"##;
    let frame = r##"<rect x="50" y="60" width="140" height="120" fill="none" stroke="#0a5" stroke-width="12" opacity=".55"/>"##;
    let glow = r##"<radialGradient id="g"><stop stop-color="#208" stop-opacity=".7"/><stop offset="1" stop-color="#208" stop-opacity="0"/></radialGradient><circle cx="120" cy="120" r="100" fill="url(#g)"/><path d="M90 90H150V150H90Z" fill="#fc0"/>"##;
    // The opacities of the elements, from back to front, and dB on the worse matte.
    for (name, elements, expected, least_db) in [
        ("star", star, vec![0.5], 52.0),
        ("two tones", two_tones, vec![0.5, 1.0], 60.0),
        ("circles", circles, vec![0.5, 0.5], 45.0),
        ("three", three, vec![0.5, 0.4, 0.5], 44.0),
        ("target", target, vec![0.4, 0.6], 46.0),
        ("cross", cross, vec![0.55], 48.0),
        ("frame", frame, vec![0.55], 55.0),
        ("glow", glow, vec![1.0, 1.0], 48.0),
    ] {
        let svg = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="240" height="240">{elements}</svg>"#
        );
        let picture = rendered(&svg);
        let fit = drawn(&picture, &Config::default());
        let areas = fit.scene.areas();
        let opacities: Vec<f32> = areas.map(|area| area.opacity).collect();
        let is_near = |(a, b): (&f32, &f32)| (a - b).abs() < 0.01;
        assert!(
            fit.scene.len() == expected.len() && opacities.iter().zip(&expected).all(is_near),
            "{name}: {opacities:?} in {}",
            fit.svg()
        );
        let seen = verify::on_mattes(&fit.svg(), &picture).unwrap();
        let db = seen.black_db.min(seen.white_db);
        assert!(db > least_db, "{name}: {db}");
    }
}

#[test]
fn without_a_colour_none_is_what_auto_is() {
    let none = Config {
        background: Background::None,
        ..draft(30)
    };
    let picture = sample("noto-gem");
    assert_eq!(
        drawn(&picture, &none).scene,
        drawn(&picture, &draft(30)).scene
    );
}

#[test]
fn on_a_colour_a_drawing_is_opaque() {
    let config = Config {
        background: Background::Color([0.2, 0.4, 0.6]),
        ..draft(40)
    };
    let fit = drawn(&glass(), &config);
    assert!(
        fit.svg()
            .contains("<rect width=\"48\" height=\"40\" fill=\"#336699\"/>")
    );
    assert_eq!((fit.target.alpha(), fit.soft.alpha()), (None, None));
    assert_eq!(fit.target, glass().flattened([0.2, 0.4, 0.6]));
}
