//! Pixels where a distance or an edge has no derivative, and long descents: the fast `f32` renderer against the naive `f64` one.
//! At a kink the gradient has to lie between the slopes of the two sides.

use strokefit::coverage::Coverage;
use strokefit::fit::{Objective, Simd};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::math;
use strokefit::optim::{Adam, AdamParams, Schedule};
use strokefit::render::reference::{self, Reference, Rgb};
use strokefit::render::{
    Backdrop, Canvas, Gradients, Grid, Params, Renderer, STYLE, Softness, StrokeRef, Strokes,
};
use strokefit::rng;
use strokefit::scene::PointKind;

/// Gradients and contributions in `f32` may differ from `f64` by this share of the largest of their kind.
const WITHIN: f64 = 1e-3;

/// Largest difference of two canvases, from culling behind opaque strokes and from `f32`.
const CANVAS_WITHIN: f64 = 4e-4;

/// Gradients and contributions below this count as 0.
const FAINT: f64 = 1e-6;

const SOFTNESS: f32 = 1.5;
const BACKGROUND: [f32; 3] = [0.3, 0.6, 0.8];

/// Kinds of numbers of a stroke, each of one unit: points, radius, colour, opacity; and those of its style.
const KINDS: usize = 4;
const STYLE_KINDS: [usize; STYLE] = [1, 2, 2, 2, 3];

/// Coverage functions without a jump in their derivative.
const SMOOTH: [Coverage; 5] = [
    Coverage::Smoothstep,
    Coverage::Sigmoid,
    Coverage::Tanh,
    Coverage::Atan { k: 1.0 },
    Coverage::Atan { k: 4.0 },
];

/// Strokes on a page, and a target.
#[derive(Clone)]
struct Page {
    strokes: Strokes,
    target: Image,
}

/// Distance of `f32` from `f64`, each relative to the largest value of its kind; the canvas in absolute terms.
#[derive(Debug, Clone, Copy, Default)]
struct Gap {
    canvas: f64,
    gradients: f64,
    contributions: f64,
}

impl Page {
    /// With a target that agrees with the page nowhere.
    fn on_noise(width: usize, height: usize, strokes: Strokes) -> Self {
        let noise = |x, y, c| rng::draw(5, c as u64, (y * width + x) as u64, 0);
        Self {
            strokes,
            target: Image::from_fn(width, height, 3, noise).unwrap(),
        }
    }

    fn grid(&self) -> Grid {
        Grid::new(self.target.width(), self.target.height())
    }

    fn pixels(&self) -> Vec<Rgb> {
        let planes = self.target.planes();
        let pixel = |i: usize| [0, 1, 2].map(|c| f64::from(planes[c][i]));
        (0..planes[0].len()).map(pixel).collect()
    }

    fn naive(&self) -> reference::Scene {
        reference::Scene {
            width: self.target.width(),
            height: self.target.height(),
            background: BACKGROUND.map(f64::from),
            strokes: self.strokes.iter().map(reference::Stroke::from).collect(),
        }
    }

    /// The largest gap over several coverage functions.
    fn gap(&self, functions: &[Coverage]) -> Gap {
        let gaps = functions.iter().map(|&coverage| self.gap_under(coverage));
        gaps.fold(Gap::default(), |a, b| Gap {
            canvas: a.canvas.max(b.canvas),
            gradients: a.gradients.max(b.gradients),
            contributions: a.contributions.max(b.contributions),
        })
    }

    fn gap_under(&self, coverage: Coverage) -> Gap {
        let mut renderer = Renderer::new(self.grid(), Simd::Auto.level().unwrap());
        let (edge, backdrop) = (softness(coverage), Backdrop::Color(BACKGROUND));
        let mut canvas = Canvas::flat(self.grid(), [0.0; 3]);
        renderer.forward(&self.strokes, edge, backdrop, &mut canvas);
        let target = Canvas::from_image(&self.target);
        let objective = Objective::new(Loss::L2, &target);
        let mut fast = Gradients::default();
        let strokes = &self.strokes;
        renderer.backward_with_contributions(strokes, edge, backdrop, &objective, &mut fast);

        let (naive, scene, expected) = (oracle(coverage), self.naive(), self.pixels());
        let drawn = naive.render(&scene);
        let slow = naive.gradients(&scene, &slopes(&drawn, &expected));
        let slow: Vec<f64> = slow.strokes.iter().flat_map(|s| s.to_params()).collect();
        let numbers = fast.strokes.iter().map(|&v| v.into()).collect();
        let [got, slow] = [numbers, slow].map(|numbers| merged(strokes, numbers));
        let of_kind = |numbers: &[f64], kind| -> Vec<f64> {
            let pairs = numbers.iter().zip(kinds(strokes));
            pairs.filter(|(_, k)| *k == kind).map(|(v, _)| *v).collect()
        };
        let by_kind = (0..KINDS).map(|k| relative(&of_kind(&got, k), &of_kind(&slow, k)));
        let canvas = canvas.to_image();
        let planes = canvas.planes();
        let pixels = drawn.iter().enumerate();
        let apart = pixels.flat_map(|(i, rgb)| [0, 1, 2].map(|c| f64::from(planes[c][i]) - rgb[c]));
        let contributions = naive.leave_one_out(&scene, &expected);
        let got: Vec<f64> = fast.contribution.iter().map(|&v| v.into()).collect();
        Gap {
            canvas: largest(apart),
            gradients: by_kind.fold(0.0, f64::max),
            contributions: relative(&got, &contributions),
        }
    }

    /// Excess of the reference's gradients over the slopes on both sides, as a share of the largest gradient.
    fn beyond_slopes(&self, coverage: Coverage) -> f64 {
        const STEP: f64 = 1e-6;
        let (scene, target, reference) = (self.naive(), self.pixels(), oracle(coverage));
        let gradients = reference.gradients(&scene, &slopes(&reference.render(&scene), &target));
        let (mut most, mut outside) = (f64::MIN_POSITIVE, 0.0_f64);
        for (i, gradient) in gradients.strokes.iter().enumerate() {
            for (k, analytic) in gradient.to_params().into_iter().enumerate() {
                let at = |step: f64| {
                    let mut moved = scene.clone();
                    let mut params = moved.strokes[i].to_params();
                    params[k] += step;
                    moved.strokes[i] = moved.strokes[i].with_params(&params);
                    mean_error(&reference.render(&moved), &target)
                };
                let here = at(0.0);
                let [left, right] = [(here - at(-STEP)) / STEP, (at(STEP) - here) / STEP];
                let (low, high) = (left.min(right), left.max(right));
                outside = outside.max(low - analytic).max(analytic - high);
                most = most.max(analytic.abs());
            }
        }
        outside / most
    }
}

fn softness(coverage: Coverage) -> Softness {
    Softness {
        coverage,
        width: SOFTNESS,
    }
}

/// The reference renderer as the fast one is meant to be.
fn oracle(coverage: Coverage) -> Reference {
    Reference {
        eps: 1e-6,
        cut: true,
        ..Reference::new(coverage, f64::from(SOFTNESS))
    }
}

/// `∂L2/∂canvas`.
fn slopes(canvas: &[Rgb], target: &[Rgb]) -> Vec<Rgb> {
    let slopes = Loss::L2.gradient(canvas.as_flattened(), target.as_flattened());
    slopes.as_chunks().0.to_vec()
}

fn mean_error(canvas: &[Rgb], target: &[Rgb]) -> f64 {
    reference::squared_error(canvas, target) / (3 * target.len()) as f64
}

/// The largest difference in units of the largest expected value.
fn relative(got: &[f64], expected: &[f64]) -> f64 {
    let scale = expected.iter().fold(FAINT, |most, v| most.max(v.abs()));
    largest(got.iter().zip(expected).map(|(got, v)| (got - v) / scale))
}

/// The largest of `values`; infinite where one is not a number.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    let absolute = values.map(|v| if v.is_nan() { f64::INFINITY } else { v.abs() });
    absolute.fold(0.0, f64::max)
}

/// Derivatives by number, those by points of a stroke that coincide replaced by their sum: such points are equally near,
/// so it hangs on rounding which of them a pixel counts for.
fn merged(strokes: &Strokes, derivatives: Vec<f64>) -> Vec<f64> {
    let mut merged = derivatives.clone();
    for (i, stroke) in strokes.iter().enumerate() {
        let first = strokes.range(i).start;
        for (k, point) in stroke.points.iter().enumerate() {
            let same = (0..stroke.points.len()).filter(|&j| stroke.points[j] == *point);
            for axis in 0..2 {
                let by_same = same.clone().map(|j| derivatives[first + 2 * j + axis]);
                merged[first + 2 * k + axis] = by_same.sum();
            }
        }
    }
    merged
}

/// The kind of each number.
fn kinds(strokes: &Strokes) -> Vec<usize> {
    let of = |points: usize| std::iter::repeat_n(0, 2 * points).chain(STYLE_KINDS);
    strokes.iter().flat_map(|s| of(s.points.len())).collect()
}

/// Random strokes of mixed size and opacity, some off the page.
fn random(seed: u64, width: usize, height: usize, count: usize) -> Strokes {
    let stroke = |i: u64| {
        let u = |k| rng::draw(seed, 9, i, k);
        let x = (u(0) * 1.2 - 0.1) * width as f32;
        let y = (u(1) * 1.2 - 0.1) * height as f32;
        let (sin, cos) = math::sin_cos(u(2) * std::f32::consts::TAU);
        let length = u(3) * u(3) * width as f32;
        let radius = 0.2 + 0.2 * u(4) * u(4) * height as f32;
        let opacity = if u(8) > 0.8 { 1.0 } else { u(8) };
        let [bx, by] = [x + length * cos, y + length * sin];
        [x, y, bx, by, radius, u(5), u(6), u(7), opacity]
    };
    (0..count as u64).map(stroke).collect()
}

/// Random paths of two to six points, every other one closed, with corners and curves; styles and places as of
/// [`random`] strokes.
fn random_paths(seed: u64, width: usize, height: usize, count: usize) -> Strokes {
    let mut strokes = Strokes::new();
    for (i, capsule) in random(seed, width, height, count).iter().enumerate() {
        let u = |k| rng::draw(seed, 10, i as u64, k) - 0.5;
        let [x, y] = capsule.points[0];
        let spread = 0.6 * width as f32;
        let closed = i % 2 == 1;
        let last = 1 + ((u(0) + 0.5) * 5.0) as u64;
        let at = |k: u64| [x + spread * u(3 * k + 1), y + spread * u(3 * k + 2)];
        let is_off = |k: u64| (closed || !k.is_multiple_of(last)) && u(3 * k + 3) < 0.0;
        let points: Vec<[f32; 2]> = (0..=last).map(at).collect();
        let kinds: Vec<PointKind> = (0..=last).map(|k| PointKind::on_if(!is_off(k))).collect();
        strokes.push(StrokeRef {
            points: &points,
            kinds: &kinds,
            closed,
            ..capsule
        });
    }
    strokes
}

/// The stroke between two ordinary ones, so that there are gradients to compare with.
fn around(stroke: StrokeRef<'_>) -> Page {
    let others = random(8, 24, 20, 2);
    let mut strokes = Strokes::new();
    strokes.push(others.get(0));
    strokes.push(stroke);
    strokes.push(others.get(1));
    Page::on_noise(24, 20, strokes)
}

/// Asserts the bounds of the gap, and of the excess over the one-sided slopes.
fn expect(name: &str, page: &Page, functions: &[Coverage], [gradients, outside]: [f64; 2]) {
    let gap = page.gap(functions);
    assert!(gap.canvas <= CANVAS_WITHIN, "{name}: {gap:?}");
    assert!(gap.contributions <= WITHIN, "{name}: {gap:?}");
    assert!(gap.gradients <= gradients, "{name}: {gap:?}");
    for &coverage in functions {
        let found = page.beyond_slopes(coverage);
        assert!(found <= outside, "{name}, {coverage}: {found:e} beyond");
    }
}

#[test]
fn gradients_at_kinks_of_capsules_lie_between_the_slopes_of_both_sides() {
    // Along pixel centres, with ends on pixel centres.
    let horizontal = |radius: f32| -> Params { [6.5, 9.5, 17.5, 9.5, radius, 0.9, 0.2, 0.1, 0.7] };
    let page = |stroke: Params| around(Strokes::from_iter([&stroke]).get(0));
    for (name, radius) in [
        ("a line of pixel centres on the centre line", 2.0),
        ("pixel centres abreast of the ends, where h is clamped", 4.0),
        ("pixel centres where smoothstep begins and ends", 2.75),
        ("pixel centres on the edge, d = 0", 3.0),
    ] {
        expect(name, &page(horizontal(radius)), &SMOOTH, [WITHIN; 2]);
    }
    // The derivative of `raw` jumps at its end, and f32 rounds some pixels to the other side.
    let bounds = [f64::INFINITY, 1e-2];
    expect(
        "end of raw",
        &page(horizontal(2.5)),
        &[Coverage::Raw],
        bounds,
    );
    // A capsule of zero length is a disc by definition: the gradient of both ends goes to the first, although the loss also has a
    // slope along the other, different on each side.
    let dot = page([11.5, 9.5, 11.5, 9.5, 3.3, 0.9, 0.2, 0.1, 0.7]);
    expect(
        "a pixel centre on both ends of a dot",
        &dot,
        &SMOOTH,
        [WITHIN, 0.1],
    );
}

/// A path where it has kinks: its name, its points, whether each is off it, whether it is closed, and the bounds of its gap and of
/// the excess over the slopes.
type Bend = (
    &'static str,
    &'static [[f32; 2]],
    &'static [bool],
    bool,
    [f64; 2],
);

#[test]
fn gradients_at_kinks_of_paths_lie_between_the_slopes_of_both_sides() {
    let exact = [WITHIN; 2];
    // Where pixels are equally near to two segments, rounding chooses between two derivatives.
    let medial = [f64::INFINITY, 1e-2];
    let bends: [Bend; 7] = [
        (
            "a point in the middle of a line, on a pixel centre",
            &[[6.5, 9.5], [12.5, 9.5], [17.5, 9.5]],
            &[false; 3],
            false,
            exact,
        ),
        (
            "a right angle on a pixel centre, its arms along pixel centres",
            &[[6.5, 4.5], [6.5, 12.5], [17.5, 12.5]],
            &[false; 3],
            false,
            medial,
        ),
        (
            "a turn by 180° on a pixel centre",
            &[[6.5, 9.5], [17.5, 9.5], [6.5, 9.5]],
            &[false; 3],
            false,
            exact,
        ),
        (
            "three points in one place between two arms",
            &[
                [6.2, 4.1],
                [9.3, 11.7],
                [9.3, 11.7],
                [9.3, 11.7],
                [18.1, 13.2],
            ],
            &[false; 5],
            false,
            exact,
        ),
        (
            "a path that crosses itself at right angles on a pixel centre",
            &[
                [5.5, 9.5],
                [17.5, 9.5],
                [17.5, 3.5],
                [11.5, 3.5],
                [11.5, 16.5],
            ],
            &[false; 5],
            false,
            medial,
        ),
        (
            "a curve that comes back to where it began",
            &[[6.5, 9.5], [18.5, 9.5], [6.5, 9.5]],
            &[false, true, false],
            false,
            exact,
        ),
        (
            "a closed spline about a pixel centre, symmetric on both axes",
            &[[6.5, 4.5], [16.5, 4.5], [16.5, 14.5], [6.5, 14.5]],
            &[true; 4],
            true,
            medial,
        ),
    ];
    for (name, points, off, closed, bounds) in bends {
        let page = around(StrokeRef {
            points,
            kinds: &off
                .iter()
                .map(|off| PointKind::on_if(!off))
                .collect::<Vec<_>>(),
            closed,
            rings: &[],
            form: None,
            paint: None,
            sweep: None,
            style: &[2.2, 0.9, 0.2, 0.1, 0.7],
        });
        expect(name, &page, &SMOOTH, bounds);
    }
}

/// Side of a small picture, px, and its strokes.
const SIDE: usize = 16;
const STROKES: usize = 6;

/// Learning rates by kind.
const RATES: [f64; KINDS] = [0.1, 0.05, 0.01, 0.01];
const SCHEDULE: Schedule = Schedule::Cosine { end: 0.01 };

/// A last loss in `f32` may be larger than in `f64` by this factor: both find a minimum, and with kinks
/// in the way not always the same.
const LOSS_FACTOR: f64 = 1.25;

/// Descends in `f32`; the loss at the end.
fn descend32(page: &mut Page, rates: &[f64], iterations: usize) -> f64 {
    let target = Canvas::from_image(&page.target);
    let objective = Objective::new(Loss::L2, &target);
    let mut renderer = Renderer::new(page.grid(), Simd::Auto.level().unwrap());
    let mut gradients = Gradients::default();
    let mut adam = Adam::new(rates.len(), AdamParams::default());
    let scales: Vec<f32> = rates.iter().map(|&rate| rate as f32).collect();
    let (edge, backdrop) = (softness(Coverage::Smoothstep), Backdrop::Color(BACKGROUND));
    for step in 0..iterations {
        renderer.backward(&page.strokes, edge, backdrop, &objective, &mut gradients);
        let rate = SCHEDULE.factor(step, iterations) as f32;
        let (numbers, slopes) = (page.strokes.numbers_mut(), &gradients.strokes);
        adam.step_scaled(numbers, slopes, rate, &scales);
        page.strokes.change(|_, stroke| {
            let [.., opacity] = stroke.style;
            *opacity = opacity.clamp(0.05, 1.0);
        });
    }
    renderer.backward(&page.strokes, edge, backdrop, &objective, &mut gradients);
    gradients.loss
}

/// Descends in `f64`, with the reference renderer; the loss at the end.
fn descend64(page: &Page, rates: &[f64], iterations: usize) -> f64 {
    let (reference, target) = (oracle(Coverage::Smoothstep), page.pixels());
    let mut scene = page.naive();
    let mut adam = Adam::new(rates.len(), AdamParams::default());
    for step in 0..iterations {
        let gradients = reference.gradients(&scene, &slopes(&reference.render(&scene), &target));
        let flat = |strokes: &[reference::Stroke]| -> Vec<f64> {
            strokes.iter().flat_map(|s| s.to_params()).collect()
        };
        let (slopes, mut params) = (flat(&gradients.strokes), flat(&scene.strokes));
        adam.step_scaled(
            &mut params,
            &slopes,
            SCHEDULE.factor(step, iterations),
            rates,
        );
        let mut rest = params.as_slice();
        for stroke in &mut scene.strokes {
            *stroke = stroke.with_params(rest);
            rest = &rest[2 * stroke.points.len() + STYLE..];
            stroke.opacity = stroke.opacity.clamp(0.05, 1.0);
        }
    }
    mean_error(&reference.render(&scene), &target)
}

/// The same descent runs in both, and the two renderers are compared at the strokes that the `f32` descent ends with.
#[test]
fn long_descents_in_f32_end_as_those_in_f64() {
    // A disc on a ramp.
    let target = Image::from_fn(SIDE, SIDE, 3, |x, y, c| {
        if math::hypot(x as f32 - 6.0, y as f32 - 8.0) < 4.0 {
            0.2 + 0.3 * c as f32
        } else {
            x as f32 / SIDE as f32
        }
    });
    let target = target.unwrap();
    for (strokes, iterations) in [
        (random(6, SIDE, SIDE, STROKES), 1_000),
        (random(6, SIDE, SIDE, STROKES), 10_000),
        (random_paths(6, SIDE, SIDE, STROKES), 1_000),
    ] {
        let mut page = Page {
            strokes,
            target: target.clone(),
        };
        let rates: Vec<f64> = kinds(&page.strokes).iter().map(|&k| RATES[k]).collect();
        let double = descend64(&page, &rates, iterations);
        let single = descend32(&mut page, &rates, iterations);
        assert!(
            single <= LOSS_FACTOR * double,
            "{iterations}: {single} {double}"
        );
        let at_end = Page::on_noise(SIDE, SIDE, page.strokes);
        let gap = at_end.gap(&Coverage::EACH);
        let holds = gap.canvas <= CANVAS_WITHIN && gap.gradients.max(gap.contributions) <= WITHIN;
        assert!(holds, "{iterations}: {gap:?}");
    }
}
