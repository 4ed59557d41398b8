//! The reference renderer against itself: gradients are central differences, and leaving a stroke
//! out is what its removal does. On random scenes, and on the degenerate ones that a fit runs into.
#![allow(clippy::unwrap_used, clippy::panic)]

use strokefit::coverage::Coverage;
use strokefit::loss::Loss;
use strokefit::render::reference::{Reference, Rgb, Scene, Stroke};
use strokefit::rng;

/// The step of a central difference, and the error that it is good for.
#[derive(Clone, Copy)]
struct Accuracy {
    step: f64,
    tolerance: f64,
}

const SMOOTH: Accuracy = Accuracy {
    step: 1e-6,
    tolerance: 1e-9,
};

/// At a kink, such as that of `clamp` at the ends of a stroke, a difference is off by its step.
const KINKED: Accuracy = Accuracy {
    step: 1e-7,
    tolerance: 1e-7,
};

fn draw(seed: u64, i: u64, k: u64) -> f64 {
    f64::from(rng::draw(seed, 0, i, k))
}

fn stroke(seed: u64, i: u64, size: f64) -> Stroke {
    let place = |k| draw(seed, i, k) * (size + 4.0) - 2.0;
    let value = |k| draw(seed, i, k);
    Stroke {
        a: [place(0), place(1)],
        b: [place(2), place(3)],
        radius: 0.2 + 2.0 * value(4),
        color: [value(5), value(6), value(7)],
        opacity: 0.1 + 0.8 * value(8),
    }
}

fn scene(strokes: Vec<Stroke>) -> Scene {
    Scene {
        width: 9,
        height: 7,
        background: [0.2, 0.5, 0.7],
        strokes,
    }
}

fn random() -> Vec<(String, Scene)> {
    let strokes = |seed| (0..6).map(|i| stroke(seed, i, 8.0)).collect();
    (1..4)
        .map(|seed| (format!("random {seed}"), scene(strokes(seed))))
        .collect()
}

/// A stroke of every degenerate kind, with ordinary ones around.
fn degenerate() -> Vec<(String, Scene)> {
    let plain = stroke(9, 0, 8.0);
    let kinds = [
        (
            "zero length",
            Stroke {
                b: plain.a,
                ..plain
            },
        ),
        (
            "radius zero",
            Stroke {
                radius: 0.0,
                ..plain
            },
        ),
        (
            "off canvas",
            Stroke {
                a: [-90.0, 3.0],
                b: [-80.0, 4.0],
                ..plain
            },
        ),
        (
            "invisible",
            Stroke {
                opacity: 0.0,
                ..plain
            },
        ),
        (
            "opaque",
            Stroke {
                opacity: 1.0,
                radius: 9.0,
                ..plain
            },
        ),
        (
            "through pixel centres",
            Stroke {
                a: [1.5, 2.5],
                b: [7.5, 2.5],
                ..plain
            },
        ),
        (
            "dot on a pixel centre",
            Stroke {
                a: [3.5, 3.5],
                b: [3.5, 3.5],
                ..plain
            },
        ),
    ];
    let around = |kind| scene(vec![stroke(5, 1, 8.0), kind, stroke(5, 2, 8.0)]);
    kinds
        .map(|(name, kind)| (name.to_owned(), around(kind)))
        .into()
}

fn target(scene: &Scene) -> Vec<Rgb> {
    let value = |i, k| draw(77, i, k);
    let pixels = 0..(scene.width * scene.height) as u64;
    pixels
        .map(|i| [value(i, 0), value(i, 1), value(i, 2)])
        .collect()
}

fn flat(strokes: &[Stroke], background: Rgb) -> Vec<f64> {
    let strokes = strokes.iter().flat_map(|stroke| stroke.to_params());
    strokes.chain(background).collect()
}

fn with_params(like: &Scene, params: &[f64]) -> Scene {
    let (strokes, background) = params.as_chunks::<{ Stroke::PARAMS }>();
    Scene {
        background: background.try_into().unwrap(),
        strokes: strokes
            .iter()
            .map(|&params| Stroke::from_params(params))
            .collect(),
        ..*like
    }
}

/// The parameters whose derivative is not its central difference.
fn differing(name: &str, reference: &Reference, scene: &Scene, accuracy: Accuracy) -> Vec<String> {
    let Accuracy { step, tolerance } = accuracy;
    let mut failures = Vec::new();
    let target = target(scene);
    let loss = |params: &[f64]| {
        let canvas = reference.render(&with_params(scene, params));
        Loss::L2.mean(canvas.as_flattened(), target.as_flattened())
    };
    let canvas = reference.render(scene);
    let d_canvas = Loss::L2.gradient(canvas.as_flattened(), target.as_flattened());
    let gradients = reference.gradients(scene, d_canvas.as_chunks().0);
    let params = flat(&scene.strokes, scene.background);
    for (k, analytic) in flat(&gradients.strokes, gradients.background)
        .into_iter()
        .enumerate()
    {
        let (mut low, mut high) = (params.clone(), params.clone());
        low[k] -= step;
        high[k] += step;
        let numeric = (loss(&high) - loss(&low)) / (2.0 * step);
        let gap = (numeric - analytic).abs();
        if gap > tolerance * analytic.abs().max(1.0) || gap.is_nan() {
            failures.push(format!(
                "{name}, parameter {k}: {analytic} against {numeric}"
            ));
        }
    }
    failures
}

fn expect_central_differences(scenes: Vec<(String, Scene)>, accuracy: Accuracy) {
    let mut failures = Vec::new();
    for (name, scene) in scenes {
        for coverage in Coverage::EACH {
            for softness in [1.0, 2.5] {
                let reference = Reference {
                    eps: 1e-3,
                    ..Reference::new(coverage, softness)
                };
                let name = format!("{name}, {coverage}, softness {softness}");
                failures.extend(differing(&name, &reference, &scene, accuracy));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn gradients_are_central_differences_in_random_scenes() {
    expect_central_differences(random(), SMOOTH);
}

#[test]
fn gradients_are_central_differences_in_degenerate_scenes() {
    expect_central_differences(degenerate(), KINKED);
}

#[test]
fn gradients_are_finite_without_eps() {
    for (name, scene) in random().into_iter().chain(degenerate()) {
        for coverage in Coverage::EACH {
            let reference = Reference::new(coverage, 1.0);
            let d_canvas = vec![[1.0; 3]; scene.width * scene.height];
            let gradients = reference.gradients(&scene, &d_canvas);
            let all = flat(&gradients.strokes, gradients.background);
            assert!(
                all.iter().all(|g| g.is_finite()),
                "{name}, {coverage}: {all:?}"
            );
        }
    }
}

#[test]
fn an_opaque_stroke_hides_what_is_behind() {
    let cover = Stroke {
        radius: 50.0,
        opacity: 1.0,
        ..stroke(9, 0, 8.0)
    };
    let scene = scene(vec![stroke(5, 1, 8.0), cover]);
    let reference = Reference::new(Coverage::Smoothstep, 1.0);
    let d_canvas = vec![[1.0; 3]; scene.width * scene.height];
    let gradients = reference.gradients(&scene, &d_canvas);
    assert_eq!(gradients.strokes[0].to_params(), [0.0; Stroke::PARAMS]);
    assert_eq!(gradients.background, [0.0; 3]);
}

#[test]
fn leaving_out_is_removing() {
    let mut failures = Vec::new();
    for (name, scene) in random().into_iter().chain(degenerate()) {
        for coverage in Coverage::EACH {
            for cut in [false, true] {
                let reference = Reference {
                    cut,
                    ..Reference::new(coverage, 1.5)
                };
                let target = target(&scene);
                let at_once = reference.leave_one_out(&scene, &target);
                let one_by_one = reference.leave_one_out_by_removal(&scene, &target);
                for (i, (x, y)) in at_once.iter().zip(&one_by_one).enumerate() {
                    if (x - y).abs() > 1e-12 * y.abs().max(1.0) {
                        failures.push(format!("{name}, {coverage}, stroke {i}: {x} against {y}"));
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
