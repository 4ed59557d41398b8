//! `f32` against `f64` over many iterations: the same descent runs in both, and the two renderers are compared
//! at the strokes that the `f32` descent ends with.

use super::oracle::{
    BACKGROUND, KINDS, Specimen, kinds, oracle, pixels, random, random_paths, slopes,
};
use super::{Check, Observation};
use strokefit::Result;
use strokefit::coverage::Coverage;
use strokefit::fit::{Execution, Objective};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::math;
use strokefit::optim::{Adam, AdamParams, Schedule};
use strokefit::render::reference::Scene;
use strokefit::render::{Backdrop, Canvas, Gradients, Grid, Renderer, STYLE, Softness, Strokes};

const SIDE: usize = 16;
const STROKES: usize = 6;

/// Learning rates of points, radius, colour and opacity at the start.
const RATES: [f64; KINDS] = [0.1, 0.05, 0.01, 0.01];

/// A last loss in `f32` may be larger than in `f64` by this factor: both find a minimum, and with kinks
/// in the way not always the same.
const LOSS_FACTOR: f64 = 1.25;

pub(super) fn checks() -> Vec<Check<'static>> {
    let check = |name: String, strokes: &str, iterations: usize, random: Random| {
        let what = format!(
            "forward, gradients and contributions of {STROKES} {strokes} after {iterations} iterations in f32; \
             the same descent in f64"
        );
        Check::new("precision", name, what, move || after(iterations, random))
    };
    let capsules = [0, 1_000, 10_000].map(|n| check(format!("after-{n}"), "capsules", n, random));
    let paths = [0, 1_000].map(|n| check(format!("paths-after-{n}"), "paths", n, random_paths));
    capsules.into_iter().chain(paths).collect()
}

/// Makes strokes: seed, width, height, number.
type Random = fn(u64, usize, usize, usize) -> Strokes;

fn after(iterations: usize, random: Random) -> Result<Observation> {
    let start = Specimen::new(SIDE, SIDE, random(6, SIDE, SIDE, STROKES));
    let rates: Vec<f64> = kinds(&start.strokes)
        .into_iter()
        .map(|kind| RATES[kind])
        .collect();
    let target = target()?;
    let (single, loss32) = descend32(start.clone(), &target, &rates, iterations)?;
    let (double, loss64) = descend64(start.naive(), &target, &rates, iterations);
    let finite = double
        .strokes
        .iter()
        .all(|s| s.to_params().iter().all(|v| v.is_finite()));
    let gap = single.gap(&Coverage::EACH)?;
    let alike = loss32 <= LOSS_FACTOR * loss64;
    let figure = format!("{gap}; loss {loss32:.3e} in f32, {loss64:.3e} in f64");
    Ok(Observation::new(figure, gap.holds() && alike && finite))
}

/// A disc on a ramp.
fn target() -> Result<Image> {
    let value = |c: usize, i: usize| {
        let (x, y) = ((i % SIDE) as f32, (i / SIDE) as f32);
        if math::hypot(x - 6.0, y - 8.0) < 4.0 {
            0.2 + 0.3 * c as f32
        } else {
            x / SIDE as f32
        }
    };
    let plane = |c| (0..SIDE * SIDE).map(|i| value(c, i)).collect();
    Image::new(SIDE, SIDE, [plane(0), plane(1), plane(2)])
}

const SCHEDULE: Schedule = Schedule::Cosine { end: 0.01 };

/// Descends in `f32`; the page it comes to and the loss there.
fn descend32(
    mut page: Specimen,
    target: &Image,
    rates: &[f64],
    iterations: usize,
) -> Result<(Specimen, f64)> {
    let softness = Softness {
        coverage: Coverage::Smoothstep,
        width: 1.5,
    };
    let canvas = Canvas::from_image(target);
    let objective = Objective::new(Loss::L2, &canvas);
    let level = Execution::default().simd.require()?;
    let mut renderer = Renderer::new(Grid::new(page.width, page.height), level);
    let mut gradients = Gradients::default();
    let mut adam = Adam::new(rates.len(), AdamParams::default());
    let scales: Vec<f32> = rates.iter().map(|&rate| rate as f32).collect();
    let backdrop = Backdrop::Color(BACKGROUND);
    for step in 0..iterations {
        renderer.backward(
            &page.strokes,
            softness,
            backdrop,
            &objective,
            &mut gradients,
        );
        let rate = SCHEDULE.factor(step, iterations) as f32;
        let (numbers, slopes) = (page.strokes.numbers_mut(), &gradients.strokes);
        adam.step_scaled(numbers, slopes, rate, &scales);
        page.strokes.change(|_, stroke| {
            let [.., opacity] = stroke.style;
            *opacity = opacity.clamp(0.05, 1.0);
        });
    }
    renderer.backward(
        &page.strokes,
        softness,
        backdrop,
        &objective,
        &mut gradients,
    );
    Ok((page, gradients.loss))
}

/// Descends in `f64`, with the reference renderer.
fn descend64(mut scene: Scene, target: &Image, rates: &[f64], iterations: usize) -> (Scene, f64) {
    let (reference, target) = (oracle(Coverage::Smoothstep), pixels(target));
    let mut adam = Adam::new(rates.len(), AdamParams::default());
    for step in 0..iterations {
        let canvas = reference.render(&scene);
        let gradients = reference.gradients(&scene, &slopes(&canvas, &target));
        let flat: Vec<f64> = gradients
            .strokes
            .iter()
            .flat_map(|s| s.to_params())
            .collect();
        let mut params: Vec<f64> = scene.strokes.iter().flat_map(|s| s.to_params()).collect();
        adam.step_scaled(&mut params, &flat, SCHEDULE.factor(step, iterations), rates);
        let mut rest = params.as_slice();
        for stroke in &mut scene.strokes {
            *stroke = stroke.with_params(rest);
            rest = &rest[2 * stroke.points.len() + STYLE..];
            stroke.opacity = stroke.opacity.clamp(0.05, 1.0);
        }
    }
    let canvas = reference.render(&scene);
    let loss = Loss::L2.mean(canvas.as_flattened(), target.as_flattened());
    (scene, loss)
}
