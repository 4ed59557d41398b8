//! The fast renderer against the naive one in `f64`: images, gradients, leave-one-out; the same bits
//! at every SIMD level and number of threads.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use strokefit::coverage::Coverage;
use strokefit::fit::{Objective, Simd};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::render::reference::{self, Reference};
use strokefit::render::{Backdrop, Canvas, Gradients, Grid, PARAMS, Params, Renderer, Softness};
use strokefit::rng::draw;

/// ε of the fast renderer's distances, px².
const EPS: f64 = 1e-6;
/// What culling behind opaque strokes (1/4096) and `f32` may change a channel by.
const IMAGE_TOLERANCE: f64 = 4e-4;
/// Largest error of a gradient, relative to the largest gradient of its kind in the scene.
const GRADIENT_TOLERANCE: f64 = 1e-3;

/// Gradients and worths below this are as good as none.
const FAINT: f64 = 1e-6;

#[derive(Clone)]
struct Case {
    name: String,
    width: usize,
    height: usize,
    strokes: Vec<Params>,
    tolerance: f64,
}

/// Random strokes of mixed size and opacity, some off the picture.
fn random(seed: u64, width: usize, height: usize, count: usize) -> Case {
    let u = |i: usize, k: u64| draw(seed, 9, i as u64, k);
    let stroke = |i: usize| {
        let (x, y) = (
            (u(i, 0) * 1.2 - 0.1) * width as f32,
            (u(i, 1) * 1.2 - 0.1) * height as f32,
        );
        let (angle, length) = (u(i, 2) * 6.3, u(i, 3).powi(2) * 40.0);
        let opacity = if u(i, 8) > 0.8 { 1.0 } else { u(i, 8) };
        let radius = 0.2 + 9.0 * u(i, 4).powi(2);
        [
            x,
            y,
            x + length * angle.cos(),
            y + length * angle.sin(),
            radius,
            u(i, 5),
            u(i, 6),
            u(i, 7),
            opacity,
        ]
    };
    Case {
        name: format!("random {count} on {width}×{height}"),
        width,
        height,
        strokes: (0..count).map(stroke).collect(),
        tolerance: GRADIENT_TOLERANCE,
    }
}

/// One kind of trouble each.
fn degenerate() -> Vec<Case> {
    let case = |name: &str, strokes: &[Params]| Case {
        name: name.into(),
        width: 40,
        height: 36,
        strokes: strokes.to_vec(),
        tolerance: GRADIENT_TOLERANCE,
    };
    let red = |a: [f32; 2], b: [f32; 2], radius: f32, opacity: f32| {
        [a[0], a[1], b[0], b[1], radius, 0.9, 0.2, 0.1, opacity]
    };
    vec![
        case("nothing", &[]),
        case("zero length", &[red([20.3, 17.1], [20.3, 17.1], 4.2, 0.7)]),
        case("zero radius", &[red([5.2, 6.1], [30.4, 25.7], 0.0, 0.9)]),
        case(
            "negative radius",
            &[red([5.2, 6.1], [30.4, 25.7], -2.0, 0.9)],
        ),
        case(
            "off the picture",
            &[red([-50.0, -9.0], [-45.0, 50.0], 3.0, 1.0)],
        ),
        case(
            "across the edge",
            &[red([-12.0, 8.0], [60.0, 30.0], 5.0, 0.6)],
        ),
        case("opacity 0", &[red([5.0, 6.0], [30.0, 25.0], 3.0, 0.0)]),
        case(
            "opaque and stacked",
            &[red([5.0, 6.0], [30.0, 25.0], 6.0, 1.0); 5],
        ),
        case(
            "on pixel centres",
            &[red([10.5, 10.5], [30.5, 10.5], 1.5, 0.8)],
        ),
        case(
            "covers everything",
            &[
                red([20.0, 18.0], [21.0, 18.0], 90.0, 1.0),
                red([9.0, 9.0], [30.0, 20.0], 3.0, 0.5),
            ],
        ),
        // Its ends are known to 1/128 px only, in f32.
        Case {
            tolerance: 3e-3,
            ..case("very long", &[red([-1e5, -1e5], [1e5, 1.001e5], 2.0, 0.5)])
        },
    ]
}

fn cases() -> Vec<Case> {
    let mut cases = degenerate();
    // Sizes around the blocks of 4 and the tiles of 32, so that every tail length occurs.
    for (k, (width, height)) in [(1, 1), (3, 70), (33, 31), (64, 64), (97, 35)]
        .into_iter()
        .enumerate()
    {
        cases.push(random(k as u64, width, height, 30));
    }
    cases.push(random(99, 70, 66, 200));
    cases
}

fn target(case: &Case) -> Image {
    let plane = |c: u64| {
        (0..case.width * case.height)
            .map(|i| draw(5, c, i as u64, 0))
            .collect()
    };
    Image::new(case.width, case.height, [plane(0), plane(1), plane(2)]).unwrap()
}

const BACKGROUND: [f32; 3] = [0.3, 0.6, 0.8];

fn naive(case: &Case) -> reference::Scene {
    reference::Scene {
        width: case.width,
        height: case.height,
        background: BACKGROUND.map(f64::from),
        strokes: case
            .strokes
            .iter()
            .map(|p| reference::Stroke::from_params(p.map(f64::from)))
            .collect(),
    }
}

fn oracle(coverage: Coverage, softness: f32) -> Reference {
    Reference {
        eps: EPS,
        cut: true,
        ..Reference::new(coverage, f64::from(softness))
    }
}

fn renderer(case: &Case, simd: Simd) -> Renderer {
    Renderer::new(Grid::new(case.width, case.height), simd.level().unwrap())
}

fn rendered(case: &Case, simd: Simd, softness: Softness) -> Image {
    let mut canvas = Canvas::flat(Grid::new(case.width, case.height), [0.0; 3]);
    renderer(case, simd).forward(
        &case.strokes,
        softness,
        Backdrop::Color(BACKGROUND),
        &mut canvas,
    );
    canvas.to_image()
}

fn differentiated(case: &Case, simd: Simd, softness: Softness, loss: Loss) -> Gradients {
    let target = Canvas::from_image(&target(case));
    let mut gradients = Gradients::default();
    renderer(case, simd).backward_with_worth(
        &case.strokes,
        softness,
        Backdrop::Color(BACKGROUND),
        &Objective::new(loss, &target),
        &mut gradients,
    );
    gradients
}

fn report(failures: Vec<String>) {
    assert!(
        failures.is_empty(),
        "{} failures:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

fn levels() -> impl Iterator<Item = Simd> {
    Simd::ALL.into_iter().filter(|simd| simd.level().is_some())
}

#[test]
fn images_are_the_oracles() {
    let mut failures = Vec::new();
    for case in cases() {
        for coverage in Coverage::EACH {
            for width in [0.6, 1.0, 3.0] {
                let fast = rendered(&case, Simd::Auto, Softness { coverage, width });
                let slow = oracle(coverage, width).render(&naive(&case));
                for (i, expected) in slow.iter().enumerate() {
                    for (plane, expected) in fast.planes().iter().zip(expected) {
                        let got = f64::from(plane[i]);
                        if (got - expected).abs() > IMAGE_TOLERANCE {
                            failures.push(format!(
                                "{}, {coverage} {width}: {got} not {expected} at {i}",
                                case.name
                            ));
                        }
                    }
                }
            }
        }
    }
    report(failures);
}

/// The kinds of parameters whose gradients are of one unit.
const KINDS: [(&str, std::ops::Range<usize>); 4] = [
    ("ends", 0..4),
    ("radius", 4..5),
    ("colour", 5..8),
    ("opacity", 8..9),
];

#[test]
fn gradients_and_worths_are_the_oracles() {
    let mut failures = Vec::new();
    for case in cases() {
        for (coverage, loss) in Coverage::EACH
            .into_iter()
            .zip([Loss::L2, Loss::L1].into_iter().cycle())
        {
            let softness = Softness {
                coverage,
                width: 1.5,
            };
            let fast = differentiated(&case, Simd::Auto, softness, loss);
            let (scene, oracle) = (naive(&case), oracle(coverage, 1.5));
            let canvas = oracle.render(&scene);
            let target = target(&case);
            let target: Vec<[f64; 3]> = (0..canvas.len())
                .map(|i| [0, 1, 2].map(|c| f64::from(target.planes()[c][i])))
                .collect();
            let scale = 1.0 / (canvas.len() * 3) as f64;
            let g: Vec<[f64; 3]> = canvas
                .iter()
                .zip(&target)
                .map(|(c, t)| [0, 1, 2].map(|k| loss.derivative(c[k] - t[k]) * scale))
                .collect();
            let slow = oracle.gradients(&scene, &g);
            let slow_strokes: Vec<[f64; PARAMS]> =
                slow.strokes.iter().map(|s| s.to_params()).collect();
            for (kind, range) in KINDS {
                let largest = slow_strokes
                    .iter()
                    .flat_map(|p| &p[range.clone()])
                    .fold(FAINT, |m, v| m.max(v.abs()));
                for (i, (got, expected)) in fast.strokes.iter().zip(&slow_strokes).enumerate() {
                    for k in range.clone() {
                        let error = (f64::from(got[k]) - expected[k]).abs();
                        if error > case.tolerance * largest {
                            failures.push(format!(
                                "{}, {coverage}: {kind} {k} of stroke {i}: {} not {}",
                                case.name, got[k], expected[k]
                            ));
                        }
                    }
                }
            }
            for c in 0..3 {
                let (got, expected) = (f64::from(fast.backdrop[c]), slow.background[c]);
                if (got - expected).abs() > 1e-4 {
                    failures.push(format!(
                        "{}, {coverage}: background {got} not {expected}",
                        case.name
                    ));
                }
            }
            let worths = oracle.leave_one_out_by_removal(&scene, &target);
            let largest = worths.iter().fold(FAINT, |m, v| m.max(v.abs()));
            for (i, (&got, expected)) in fast.worth.iter().zip(worths).enumerate() {
                if (f64::from(got) - expected).abs() > case.tolerance * largest {
                    failures.push(format!(
                        "{}, {coverage}: worth of stroke {i}: {got} not {expected}",
                        case.name
                    ));
                }
            }
        }
    }
    report(failures);
}

/// The loss rises as its gradient says, by central differences of the fast renderer itself.
#[test]
fn gradients_are_central_differences() {
    let softness = Softness {
        coverage: Coverage::Smoothstep,
        width: 3.0,
    };
    let case = random(4, 48, 40, 12);
    let gradients = differentiated(&case, Simd::Auto, softness, Loss::L2);
    let mut failures = Vec::new();
    for i in 0..case.strokes.len() {
        for k in 0..PARAMS {
            let step = 2e-3;
            let loss = |sign: f32| {
                let mut moved = case.clone();
                moved.strokes[i][k] += sign * step;
                differentiated(&moved, Simd::Auto, softness, Loss::L2).loss
            };
            let difference = (loss(1.0) - loss(-1.0)) / f64::from(2.0 * step);
            let gradient = f64::from(gradients.strokes[i][k]);
            if (difference - gradient).abs() > 2e-5 + 0.02 * gradient.abs() {
                failures.push(format!(
                    "stroke {i} parameter {k}: {gradient} but rises by {difference}"
                ));
            }
        }
    }
    report(failures);
}

#[test]
fn every_level_gives_the_same_bits() {
    for case in cases() {
        for coverage in Coverage::EACH {
            let softness = Softness {
                coverage,
                width: 1.25,
            };
            let expected = differentiated(&case, Simd::Scalar, softness, Loss::L2);
            for simd in levels() {
                let got = differentiated(&case, simd, softness, Loss::L2);
                let bits = |g: &Gradients| -> Vec<u32> {
                    let strokes = g.strokes.iter().flatten();
                    strokes
                        .chain(&g.backdrop)
                        .chain(&g.worth)
                        .map(|v| v.to_bits())
                        .collect()
                };
                assert_eq!(
                    bits(&got),
                    bits(&expected),
                    "{simd}, {coverage}, {}",
                    case.name
                );
                assert_eq!(
                    got.loss.to_bits(),
                    expected.loss.to_bits(),
                    "{simd}, {coverage}, {}",
                    case.name
                );
            }
        }
    }
}

#[test]
fn every_number_of_threads_gives_the_same_bits() {
    let case = random(1, 200, 150, 300);
    let softness = Softness {
        coverage: Coverage::Smoothstep,
        width: 1.25,
    };
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let gradients = pool.install(|| differentiated(&case, Simd::Auto, softness, Loss::L2));
        (gradients.strokes, gradients.worth, gradients.loss.to_bits())
    };
    let expected = with_threads(1);
    for threads in [2, 3, 8] {
        assert_eq!(with_threads(threads), expected, "{threads} threads");
    }
}

#[test]
fn numbers_that_are_not_finite_draw_nothing_and_spoil_nothing() {
    let softness = Softness {
        coverage: Coverage::Smoothstep,
        width: 1.0,
    };
    let clean = random(2, 40, 40, 5);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for k in 0..5 {
            let mut case = clean.clone();
            let mut stroke = case.strokes[0];
            stroke[k] = bad;
            case.strokes.push(stroke);
            let got = rendered(&case, Simd::Auto, softness);
            assert!(
                got.planes().iter().flatten().all(|v| v.is_finite()),
                "parameter {k} is {bad}"
            );
            let gradients = differentiated(&case, Simd::Auto, softness, Loss::L2);
            let others = &gradients.strokes[..clean.strokes.len()];
            assert!(
                others.iter().flatten().all(|v| v.is_finite()),
                "parameter {k} is {bad}"
            );
        }
    }
}
