//! The reference renderer against itself: gradients are central differences, and leaving a stroke
//! out is what its removal does. On random scenes, and on the degenerate ones that a fit runs into.

use crate::support::areas::{Rings, areas, paints};
use crate::support::paths::{mixed, paths};
use strokefit::coverage::Coverage;
use strokefit::loss::Loss;
use strokefit::math::Point;
use strokefit::render::reference::{Reference, Rgb, Scene, Stroke};
use strokefit::render::{PARAMS, STYLE};
use strokefit::scene::PointKind;
use strokefit::{rng, scene};

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
        points: vec![[place(0), place(1)], [place(2), place(3)]],
        kinds: vec![PointKind::On; 2],
        closed: false,
        rings: Vec::new(),
        radius: 0.2 + 2.0 * value(4),
        color: [value(5), value(6), value(7)],
        opacity: 0.1 + 0.8 * value(8),
        paint: None,
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

/// A stroke of a path of every kind, with ordinary ones around.
fn of_paths() -> Vec<(String, Scene)> {
    let case = |(name, path): (&str, scene::Path)| {
        let points = path.points();
        let kind = Stroke {
            points: points.iter().map(|p| [p.at.x, p.at.y]).collect(),
            kinds: points.iter().map(|p| p.kind).collect(),
            closed: path.is_closed(),
            ..stroke(9, 0, 8.0)
        };
        (name.to_owned(), around(kind))
    };
    // Wider than the picture by a bit: a pixel centre on the axis of a symmetric curve is as near to two segments, and has a
    // kink there.
    let paths = paths(9.1, 7.0).into_iter();
    paths.chain((0..8).map(random_path)).map(case).collect()
}

/// A path of one to four pieces of all kinds, open or closed.
fn random_path(seed: u64) -> (&'static str, scene::Path) {
    let value = |i: u64, k: u64| draw(seed, 20 + i, k);
    let place = |k: u64| Point::new(9.1 * value(0, k), 7.0 * value(1, k));
    let closed = seed.is_multiple_of(2);
    let path = mixed(1 + seed / 2, closed, |k| value(2, k) as f32, place);
    ("pieces of all kinds", path)
}

/// An area of every kind, and one with a gradient of every kind, with ordinary strokes around.
fn of_areas() -> Vec<(String, Scene)> {
    let case = |rings: Rings| {
        let area = Stroke {
            points: rings.points.iter().map(|p| p.map(f64::from)).collect(),
            kinds: rings.kinds,
            rings: rings.ends.iter().map(|&end| end as usize).collect(),
            radius: 0.0,
            ..stroke(9, 0, 8.0)
        };
        (rings.name, around(area))
    };
    let mut cases: Vec<_> = areas(9.1, 7.0).into_iter().map(case).collect();
    let plain = cases[0].1.clone();
    cases.extend(paints().into_iter().map(|(name, paint)| {
        let mut painted = plain.clone();
        painted.strokes[1].paint = Some(paint);
        (name.to_owned(), painted)
    }));
    cases
}

fn around(kind: Stroke) -> Scene {
    scene(vec![stroke(5, 1, 8.0), kind, stroke(5, 2, 8.0)])
}

/// A stroke of every degenerate kind, with ordinary ones around.
fn degenerate() -> Vec<(String, Scene)> {
    let plain = stroke(9, 0, 8.0);
    let between = |a, b| Stroke {
        points: vec![a, b],
        ..plain.clone()
    };
    let of = |radius, opacity| Stroke {
        radius,
        opacity,
        ..plain.clone()
    };
    let kinds = [
        ("zero length", between(plain.points[0], plain.points[0])),
        ("radius zero", of(0.0, plain.opacity)),
        ("off canvas", between([-90.0, 3.0], [-80.0, 4.0])),
        ("invisible", of(plain.radius, 0.0)),
        ("opaque", of(9.0, 1.0)),
        ("through pixel centres", between([1.5, 2.5], [7.5, 2.5])),
        ("dot on a pixel centre", between([3.5, 3.5], [3.5, 3.5])),
    ];
    let named = kinds.map(|(name, kind)| (name.to_owned(), around(kind)));
    named.into()
}

fn all() -> Vec<(String, Scene)> {
    [random(), degenerate(), of_paths(), of_areas()].concat()
}

fn target(scene: &Scene) -> Vec<Rgb> {
    let pixels = 0..(scene.width * scene.height) as u64;
    pixels.map(|i| [0, 1, 2].map(|k| draw(77, i, k))).collect()
}

fn flat(strokes: &[Stroke], background: Rgb) -> Vec<f64> {
    let strokes = strokes.iter().flat_map(|stroke| stroke.to_params());
    strokes.chain(background).collect()
}

fn with_params(like: &Scene, params: &[f64]) -> Scene {
    let mut rest = params;
    let stroke = |stroke: &Stroke| {
        let (params, others) = rest.split_at(2 * stroke.points.len() + STYLE);
        rest = others;
        stroke.with_params(params)
    };
    let strokes = like.strokes.iter().map(stroke).collect();
    Scene {
        background: rest.try_into().unwrap(),
        strokes,
        ..*like
    }
}

/// The numbers that move together: those of points that coincide, since the derivatives by each of them alone are
/// different on its two sides. Each number is in one set.
fn sets(scene: &Scene) -> Vec<Vec<usize>> {
    let (mut sets, mut first) = (Vec::new(), 0);
    for stroke in &scene.strokes {
        for (i, point) in stroke.points.iter().enumerate() {
            let is_same = |k: &usize| stroke.points[*k] == *point;
            if !(0..i).any(|k| is_same(&k)) {
                let same = || (i..stroke.points.len()).filter(is_same);
                sets.extend([0, 1].map(|axis| same().map(|k| first + 2 * k + axis).collect()));
            }
        }
        let style = first + 2 * stroke.points.len();
        sets.extend((style..style + STYLE).map(|k| vec![k]));
        first = style + STYLE;
    }
    sets.extend((first..first + 3).map(|k| vec![k]));
    sets
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
    let slopes = flat(&gradients.strokes, gradients.background);
    for set in sets(scene) {
        let (mut low, mut high) = (params.clone(), params.clone());
        for &k in &set {
            low[k] -= step;
            high[k] += step;
        }
        let analytic: f64 = set.iter().map(|&k| slopes[k]).sum();
        let numeric = (loss(&high) - loss(&low)) / (2.0 * step);
        let gap = (numeric - analytic).abs();
        if gap > tolerance * analytic.abs().max(1.0) || gap.is_nan() {
            failures.push(format!(
                "{name}, parameters {set:?}: {analytic} against {numeric}"
            ));
        }
    }
    failures
}

fn expect_central_differences(scenes: Vec<(String, Scene)>, eps: f64, accuracy: Accuracy) {
    let mut failures = Vec::new();
    for (name, scene) in scenes {
        for coverage in Coverage::EACH {
            for softness in [1.0, 2.5] {
                let reference = Reference {
                    eps,
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
fn gradients_are_central_differences() {
    expect_central_differences(random(), 1e-3, SMOOTH);
    expect_central_differences(degenerate(), 1e-3, KINKED);
    // With an ε, a line there and one back would be farther than each other by turns.
    expect_central_differences(of_paths(), 0.0, KINKED);
}

#[test]
fn gradients_are_finite_without_eps() {
    for (name, scene) in all() {
        for coverage in Coverage::EACH {
            let reference = Reference::new(coverage, 1.0);
            let d_canvas = vec![[1.0; 3]; scene.width * scene.height];
            let gradients = reference.gradients(&scene, &d_canvas);
            let all = flat(&gradients.strokes, gradients.background);
            let is_finite = all.iter().all(|g| g.is_finite());
            assert!(is_finite, "{name}, {coverage}: {all:?}");
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
    assert_eq!(gradients.strokes[0].to_params(), [0.0; PARAMS]);
    assert_eq!(gradients.background, [0.0; 3]);
}

#[test]
fn leaving_out_is_removing() {
    let mut failures = Vec::new();
    for (name, scene) in all() {
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
