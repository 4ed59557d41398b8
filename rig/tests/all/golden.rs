//! The reference renderer, the losses and Adam against numbers that were computed with `PyTorch`.
//!
//! `tests/data/golden_gradients.json` says in its `convention` how it counts. It has coordinates as
//! `[row, column]`, with pixels at integer coordinates; here a row is a y and a column an x.

use serde::Deserialize;
use std::collections::BTreeMap;

use rig::lab::matching::Capsule;
use strokefit::coverage::Coverage;
use strokefit::loss::Loss;
use strokefit::optim::{Adam, AdamParams};
use strokefit::render::reference::{Gradients, Reference, Rgb, Scene, Stroke};
use strokefit::render::{OPACITY, PARAMS};
use strokefit::scene::PointKind;

const TOLERANCE: f64 = 1e-9;

#[derive(Deserialize)]
struct Golden {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    name: String,
    rows: usize,
    cols: usize,
    eps: f64,
    #[serde(flatten)]
    params: Params,
    target: Vec<Vec<Rgb>>,
    sdf: Vec<Vec<Vec<f64>>>,
    norms: BTreeMap<String, Norm>,
}

/// All numbers of a scene, or a gradient by them.
#[derive(Deserialize)]
struct Params {
    a: Vec<[f64; 2]>,
    b: Vec<[f64; 2]>,
    r: Vec<f64>,
    c: Vec<Rgb>,
    bg: Rgb,
}

#[derive(Deserialize)]
struct Norm {
    image: Vec<Vec<Rgb>>,
    l1: LossAndGradient,
    l2: LossAndGradient,
    adam20: Adam20,
}

#[derive(Deserialize)]
struct LossAndGradient {
    loss: f64,
    grad: Params,
}

#[derive(Deserialize)]
struct Adam20 {
    losses: Vec<f64>,
    #[serde(rename = "final")]
    last: Params,
}

impl Params {
    /// `[row, column]` becomes `[x, y]`.
    fn strokes(&self) -> Vec<Stroke> {
        let turned = |[row, column]: [f64; 2]| [column, row];
        (0..self.r.len())
            .map(|i| Stroke {
                points: vec![turned(self.a[i]), turned(self.b[i])],
                kinds: vec![PointKind::On; 2],
                closed: false,
                rings: Vec::new(),
                radius: self.r[i],
                color: self.c[i],
                opacity: 1.0,
                paint: None,
            })
            .collect()
    }
}

impl Case {
    fn scene(&self) -> Scene {
        Scene {
            width: self.cols,
            height: self.rows,
            background: self.params.bg,
            strokes: self.params.strokes(),
        }
    }

    fn reference(&self, norm: &str) -> Reference {
        let coverage = match norm {
            "atanx4" => Coverage::Atan { k: 4.0 },
            word => word.parse().unwrap(),
        };
        Reference {
            eps: self.eps,
            sample_offset: 0.0,
            ..Reference::new(coverage, 1.0)
        }
    }
}

/// Comparisons, and those that failed.
#[derive(Default)]
struct Tally {
    compared: usize,
    failures: Vec<String>,
}

impl Tally {
    fn compare(&mut self, what: &str, ours: &[f64], theirs: &[f64]) {
        assert_eq!(ours.len(), theirs.len(), "{what}");
        self.compared += ours.len();
        let gaps = ours.iter().zip(theirs).map(|(o, t)| (o - t).abs());
        let worst = gaps.fold(0.0, |worst: f64, gap| {
            if gap > worst || gap.is_nan() {
                gap
            } else {
                worst
            }
        });
        if worst > TOLERANCE || worst.is_nan() {
            self.failures.push(format!("{what}: {worst:e} apart"));
        }
    }

    /// Compares the numbers that the golden data has: no opacities.
    fn compare_params(
        &mut self,
        what: &str,
        strokes: &[Stroke],
        background: &Rgb,
        theirs: &Params,
    ) {
        let known = |stroke: &Stroke| {
            let mut params = stroke.to_params();
            params.truncate(OPACITY);
            params
        };
        let flat = |strokes: &[Stroke]| strokes.iter().flat_map(known).collect::<Vec<_>>();
        self.compare(what, &flat(strokes), &flat(&theirs.strokes()));
        self.compare(&format!("{what}, background"), background, &theirs.bg);
    }

    fn finish(self, least: usize) {
        assert!(self.failures.is_empty(), "{}", self.failures.join("\n"));
        assert!(
            self.compared >= least,
            "only {} numbers were compared",
            self.compared
        );
    }
}

fn golden() -> Golden {
    serde_json::from_str(include_str!("../../../tests/data/golden_gradients.json")).unwrap()
}

fn for_each_norm(mut check: impl FnMut(&str, &Case, &Norm, Reference)) {
    for case in golden().cases {
        for (name, norm) in &case.norms {
            check(
                &format!("{}, {name}", case.name),
                &case,
                norm,
                case.reference(name),
            );
        }
    }
}

#[test]
fn signed_distances() {
    let mut tally = Tally::default();
    for case in golden().cases {
        for (i, (stroke, theirs)) in case.scene().strokes.iter().zip(&case.sdf).enumerate() {
            let capsule = Capsule {
                a: stroke.points[0],
                b: stroke.points[1],
                radius: stroke.radius,
            };
            for (y, row) in theirs.iter().enumerate() {
                let at = |x| capsule.distance([x as f64, y as f64], case.eps);
                let ours: Vec<f64> = (0..case.cols).map(at).collect();
                tally.compare(&format!("{}, stroke {i}, row {y}", case.name), &ours, row);
            }
        }
    }
    tally.finish(10_000);
}

#[test]
fn images() {
    let mut tally = Tally::default();
    for_each_norm(|name, case, norm, reference| {
        let canvas = reference.render(&case.scene());
        tally.compare(
            name,
            canvas.as_flattened(),
            norm.image.concat().as_flattened(),
        );
    });
    tally.finish(30_000);
}

/// The loss of `scene` and its gradient.
fn backward(reference: &Reference, scene: &Scene, target: &[Rgb], loss: Loss) -> (f64, Gradients) {
    let canvas = reference.render(scene);
    let (canvas, target) = (canvas.as_flattened(), target.as_flattened());
    let d_canvas = loss.gradient(canvas, target);
    let gradients = reference.gradients(scene, d_canvas.as_chunks().0);
    (loss.mean(canvas, target), gradients)
}

#[test]
fn losses_and_gradients() {
    let mut tally = Tally::default();
    for_each_norm(|name, case, norm, reference| {
        for (loss, theirs) in [(Loss::L1, &norm.l1), (Loss::L2, &norm.l2)] {
            let target = case.target.concat();
            let (value, ours) = backward(&reference, &case.scene(), &target, loss);
            let name = format!("{name}, {loss:?}");
            tally.compare(&name, &[value], &[theirs.loss]);
            tally.compare_params(&name, &ours.strokes, &ours.background, &theirs.grad);
        }
    });
    tally.finish(2_000);
}

/// All numbers of the strokes, then the background.
fn flat(strokes: &[Stroke], background: Rgb) -> Vec<f64> {
    let strokes = strokes.iter().flat_map(|stroke| stroke.to_params());
    strokes.chain(background).collect()
}

/// Scene of the parameters as the golden data's program clamps them after each step; its strokes have no opacity to
/// fit.
fn clamped(params: &[f64], case: &Case) -> Scene {
    let (width, height) = (case.cols as f64, case.rows as f64);
    let unit = |rgb: Rgb| rgb.map(|c| c.clamp(0.0, 1.0));
    let inside = |[x, y]: [f64; 2]| [x.clamp(0.0, width), y.clamp(0.0, height)];
    let (strokes, background) = params.as_chunks::<PARAMS>();
    let strokes = strokes.iter().map(|&params| {
        let stroke = Stroke::capsule(params);
        Stroke {
            points: stroke.points.into_iter().map(inside).collect(),
            radius: stroke.radius.clamp(0.0, 16.0),
            color: unit(stroke.color),
            opacity: 1.0,
            ..stroke
        }
    });
    Scene {
        background: unit(background.try_into().unwrap()),
        strokes: strokes.collect(),
        ..case.scene()
    }
}

#[test]
fn twenty_steps_of_adam() {
    let adam_params = AdamParams {
        betas: [0.99, 0.999],
        eps: 1e-8,
    };
    let mut tally = Tally::default();
    for_each_norm(|name, case, norm, reference| {
        let target = case.target.concat();
        let mut scene = case.scene();
        let mut params = flat(&scene.strokes, scene.background);
        let mut adam = Adam::new(params.len(), adam_params);
        let mut losses = Vec::new();
        for _ in 0..20 {
            let (loss, gradients) = backward(&reference, &scene, &target, Loss::L1);
            losses.push(loss);
            adam.step(
                &mut params,
                &flat(&gradients.strokes, gradients.background),
                0.1,
            );
            scene = clamped(&params, case);
            params = flat(&scene.strokes, scene.background);
        }
        let name = format!("{name}, Adam");
        tally.compare(&name, &losses, &norm.adam20.losses);
        tally.compare_params(&name, &scene.strokes, &scene.background, &norm.adam20.last);
    });
    tally.finish(1_500);
}
