//! Pages that shade: a gradient is chosen where the picture is one, and kept.

use crate::support::{draft, drawn, sample};
use strokefit::fit::{Background, Base, Colors, Config, Fitter};
use strokefit::image::Image;
use strokefit::scene::{Scene, Shade};
use strokefit::{svg, verify};

/// A ramp with a red square on it.
fn sign() -> Image {
    let (width, height) = (96, 64);
    let ends = [[0.2, 0.9], [0.5, 0.6], [0.9, 0.3]];
    let level = |x: usize, y: usize, c: usize| {
        if (30..50).contains(&x) && (20..40).contains(&y) {
            return [0.9, 0.1, 0.1][c];
        }
        let [from, to] = ends[c];
        let part = (x as f32 + 0.5) / width as f32;
        ((from + (to - from) * part) * 255.0).round() / 255.0
    };
    Image::from_fn(width, height, 3, level).unwrap()
}

/// The gradient of a page.
fn shade(scene: &Scene) -> Option<&Shade> {
    scene.ground.iter().find_map(|area| area.shade.as_ref())
}

#[test]
fn a_glow_and_a_fade_are_a_gradient_each() {
    for name in ["glow-300", "fade-400"] {
        let picture = sample(name);
        let fit = drawn(&picture, &Config::default());
        assert!(
            shade(&fit.scene).is_some() && fit.scene.len() <= 40,
            "{name}"
        );
        let seen = verify::on_mattes(&fit.svg(), &picture).unwrap();
        let scores = [
            seen.black_ssimulacra2,
            seen.white_ssimulacra2,
            seen.magenta_ssimulacra2,
        ];
        assert!(
            scores.iter().all(|&score| score >= 85.0),
            "{name}: {seen:?}"
        );
    }
}

#[test]
fn strokes_are_drawn_on_a_shade() {
    let fit = drawn(&sign(), &draft(20));
    assert!(shade(&fit.scene).is_some() && fit.scene.background.is_none());
    assert!(!fit.scene.is_empty());
    let verdict = verify::verify(&fit.svg(), &fit.target, &fit.soft).unwrap();
    assert!(
        verdict.fidelity.psnr_db > 30.0 && verdict.agreement.psnr_db > 36.0,
        "{verdict:?}"
    );
    assert_eq!(svg::read(&fit.svg()).unwrap(), fit.scene);
}

#[test]
fn a_refined_drawing_keeps_its_shade() {
    let picture = sign();
    let first = drawn(&picture, &draft(5));
    let base = Base::read(first.svg(), &picture, false).unwrap();
    let second = Fitter::new(draft(15)).on(base).fit(&picture).unwrap();
    assert_eq!(second.scene.ground, first.scene.ground);
    assert_eq!(svg::read(&second.svg()).unwrap(), second.scene);
}

#[test]
fn a_background_or_colours_that_are_given_leave_no_shade() {
    let picture = sign();
    let background = |background| Config {
        background,
        ..draft(5)
    };
    let few_colors = Config {
        colors: Colors::AtMost(3),
        ..draft(5)
    };
    let white = Background::Color([1.0; 3]);
    for config in [background(white), background(Background::None), few_colors] {
        assert_eq!(drawn(&picture, &config).scene.ground, []);
    }
}

#[test]
fn other_samples_have_no_shade() {
    for name in [
        "chelsea-cat",
        "coffee-300",
        "rocket-320",
        "noto-gem",
        "noto-hibiscus",
        "bicycle",
    ] {
        let fit = drawn(&sample(name), &draft(1));
        assert_eq!(shade(&fit.scene), None, "{name}");
    }
}
