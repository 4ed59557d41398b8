//! Compares the fast `f32` renderer with the naive `f64` reference.

use super::WITHIN;
use strokefit::coverage::Coverage;
use strokefit::fit::{Objective, Simd};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::math;
use strokefit::render::reference::{self, Reference, Rgb};
use strokefit::render::{
    Backdrop, Canvas, Gradients, Grid, Renderer, STYLE, Softness, StrokeRef, Strokes,
};
use strokefit::rng;
use strokefit::{Error, ErrorKind, Result};

/// ε of the fast renderer's distances, px².
const EPS: f64 = 1e-6;

/// Largest difference of two canvases, from culling behind opaque strokes and from `f32`.
const CANVAS_WITHIN: f64 = 4e-4;

/// Gradients and contributions below this count as 0.
const FAINT: f64 = 1e-6;

/// Width of the soft edge, px.
const SOFTNESS: f32 = 1.5;

pub(super) const BACKGROUND: [f32; 3] = [0.3, 0.6, 0.8];

/// Kinds of numbers of a stroke: points, radius, colour, opacity. Those of one kind have one unit.
pub(super) const KINDS: usize = 4;

/// The kinds of the last numbers of a stroke.
const STYLE_KINDS: [usize; STYLE] = [1, 2, 2, 2, 3];

/// Strokes on a page.
#[derive(Debug, Clone)]
pub(super) struct Specimen {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) strokes: Strokes,
}

/// Distance of `f32` from `f64`, each relative to the largest value of its kind; the canvas in absolute terms. Infinite
/// where something is not finite.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Gap {
    pub(super) canvas: f64,
    pub(super) gradients: f64,
    pub(super) contribution: f64,
}

impl Gap {
    fn max(self, other: Self) -> Self {
        Self {
            canvas: self.canvas.max(other.canvas),
            gradients: self.gradients.max(other.gradients),
            contribution: self.contribution.max(other.contribution),
        }
    }

    pub(super) fn canvas_holds(self) -> bool {
        self.canvas <= CANVAS_WITHIN
    }

    pub(super) fn worth_holds(self) -> bool {
        self.contribution <= WITHIN
    }

    pub(super) fn holds(self) -> bool {
        self.canvas_holds() && self.gradients <= WITHIN && self.worth_holds()
    }
}

impl std::fmt::Display for Gap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            canvas,
            gradients,
            contribution,
        } = self;
        write!(
            f,
            "f32 from f64: canvas {canvas:.1e}, gradients {gradients:.1e}, contributions {contribution:.1e}"
        )
    }
}

impl Specimen {
    pub(super) fn new(width: usize, height: usize, strokes: Strokes) -> Self {
        Self {
            width,
            height,
            strokes,
        }
    }

    /// The largest gap over several coverage functions.
    pub(super) fn gap(&self, functions: &[Coverage]) -> Result<Gap> {
        let target = self.noise()?;
        let gaps = functions
            .iter()
            .map(|&coverage| self.gap_under(coverage, &target));
        gaps.reduce(|a, b| Ok(a?.max(b?)))
            .unwrap_or(Ok(Gap::default()))
    }

    /// The gap against `target`.
    pub(super) fn gap_under(&self, coverage: Coverage, target: &Image) -> Result<Gap> {
        let softness = Softness {
            coverage,
            width: SOFTNESS,
        };
        let (canvas, gradients) = self.fast(softness, target)?;
        let naive = oracle(coverage);
        let scene = self.naive();
        let (pixels, expected) = (naive.render(&scene), pixels(target));
        let slow = naive.gradients(&scene, &slopes(&pixels, &expected));
        let slow: Vec<f64> = slow.strokes.iter().flat_map(|s| s.to_params()).collect();
        let fast: Vec<f64> = gradients.strokes.iter().map(|&v| v.into()).collect();
        let [fast, slow] = [fast, slow].map(|numbers| merged(&self.strokes, numbers));
        let kinds = kinds(&self.strokes);
        let contribution = naive.leave_one_out(&scene, &expected);
        Ok(Gap {
            canvas: largest_difference(&canvas, &pixels),
            gradients: (0..KINDS)
                .map(|kind| {
                    let got = of_kind(&fast, &kinds, kind);
                    relative(got, of_kind(&slow, &kinds, kind))
                })
                .fold(0.0, f64::max),
            contribution: relative(
                gradients.contribution.iter().copied().map(f64::from),
                contribution.into_iter(),
            ),
        })
    }

    /// Canvas, gradients and contributions of the fast renderer.
    fn fast(&self, softness: Softness, target: &Image) -> Result<(Image, Gradients)> {
        let level = Simd::Auto.level().ok_or_else(|| {
            Error::new(
                ErrorKind::Config,
                "this machine has no instruction set: use another",
            )
        })?;
        let grid = Grid::new(self.width, self.height);
        let mut renderer = Renderer::new(grid, level);
        let mut canvas = Canvas::flat(grid, [0.0; 3]);
        let backdrop = Backdrop::Color(BACKGROUND);
        renderer.forward(&self.strokes, softness, backdrop, &mut canvas);
        let target = Canvas::from_image(target);
        let objective = Objective::new(Loss::L2, &target);
        let mut gradients = Gradients::default();
        renderer.backward_with_contributions(
            &self.strokes,
            softness,
            backdrop,
            &objective,
            &mut gradients,
        );
        Ok((canvas.to_image(), gradients))
    }

    /// This scene for the reference.
    pub(super) fn naive(&self) -> reference::Scene {
        reference::Scene {
            width: self.width,
            height: self.height,
            background: BACKGROUND.map(f64::from),
            strokes: self.strokes.iter().map(reference::Stroke::from).collect(),
        }
    }

    /// A target that agrees with the page nowhere.
    pub(super) fn noise(&self) -> Result<Image> {
        let plane = |c: u64| {
            let pixels = 0..(self.width * self.height) as u64;
            pixels.map(|i| rng::draw(5, c, i, 0)).collect()
        };
        Image::new(self.width, self.height, [plane(0), plane(1), plane(2)])
    }
}

/// The reference renderer as the fast one is meant to be.
pub(super) fn oracle(coverage: Coverage) -> Reference {
    Reference {
        eps: EPS,
        cut: true,
        ..Reference::new(coverage, f64::from(SOFTNESS))
    }
}

/// The pixels of a picture for the reference.
pub(super) fn pixels(image: &Image) -> Vec<Rgb> {
    let [red, green, blue] = image.planes();
    let pixels = red.iter().zip(green).zip(blue);
    pixels
        .map(|((&r, &g), &b)| [r, g, b].map(f64::from))
        .collect()
}

/// `∂L2/∂canvas`.
pub(super) fn slopes(canvas: &[Rgb], target: &[Rgb]) -> Vec<Rgb> {
    let slopes = Loss::L2.gradient(canvas.as_flattened(), target.as_flattened());
    slopes.as_chunks().0.to_vec()
}

fn largest_difference(image: &Image, expected: &[Rgb]) -> f64 {
    let values = image.planes().iter().enumerate().flat_map(|(c, plane)| {
        let expected = expected.iter().map(move |rgb| rgb[c]);
        plane.iter().zip(expected)
    });
    let gaps = values.map(|(&got, expected)| (f64::from(got) - expected).abs());
    largest(gaps)
}

/// The largest difference in units of the largest expected value.
fn relative(got: impl Iterator<Item = f64>, expected: impl Iterator<Item = f64> + Clone) -> f64 {
    let scale = expected.clone().fold(FAINT, |most, v| most.max(v.abs()));
    largest(got.zip(expected).map(|(got, v)| (got - v).abs() / scale))
}

/// The largest of `values`; infinite where one is not a number.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, v| {
        if v.is_nan() {
            f64::INFINITY
        } else {
            most.max(v)
        }
    })
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
pub(super) fn kinds(strokes: &Strokes) -> Vec<usize> {
    let of = |points: usize| std::iter::repeat_n(0, 2 * points).chain(STYLE_KINDS);
    strokes.iter().flat_map(|s| of(s.points.len())).collect()
}

fn of_kind(numbers: &[f64], kinds: &[usize], kind: usize) -> impl Iterator<Item = f64> + Clone {
    let pairs = numbers.iter().zip(kinds);
    pairs.filter(move |(_, k)| **k == kind).map(|(v, _)| *v)
}

/// Random paths of two to six points, every other one closed, with corners and curves; styles and places as of
/// [`random`] strokes.
pub(super) fn random_paths(seed: u64, width: usize, height: usize, count: usize) -> Strokes {
    let mut strokes = Strokes::new();
    for (i, capsule) in random(seed, width, height, count).iter().enumerate() {
        let u = |k| rng::draw(seed, 10, i as u64, k);
        let [x, y] = capsule.points[0];
        let spread = 0.6 * width as f32;
        let closed = i % 2 == 1;
        let last = 1 + (u(0) * 5.0) as u64;
        let at = |k: u64| {
            [
                x + spread * (u(3 * k + 1) - 0.5),
                y + spread * (u(3 * k + 2) - 0.5),
            ]
        };
        let is_off = |k: u64| (closed || !k.is_multiple_of(last)) && u(3 * k + 3) < 0.5;
        let points: Vec<[f32; 2]> = (0..=last).map(at).collect();
        let off: Vec<bool> = (0..=last).map(is_off).collect();
        strokes.push(StrokeRef {
            points: &points,
            off: &off,
            closed,
            ..capsule
        });
    }
    strokes
}

/// Random strokes of mixed size and opacity, some off the page.
pub(super) fn random(seed: u64, width: usize, height: usize, count: usize) -> Strokes {
    let stroke = |i: u64| {
        let u = |k| rng::draw(seed, 9, i, k);
        let x = (u(0) * 1.2 - 0.1) * width as f32;
        let y = (u(1) * 1.2 - 0.1) * height as f32;
        let (sin, cos) = math::sin_cos(u(2) * std::f32::consts::TAU);
        let length = u(3) * u(3) * width as f32;
        let radius = 0.2 + 0.2 * u(4) * u(4) * height as f32;
        let [red, green, blue] = [u(5), u(6), u(7)];
        let opacity = if u(8) > 0.8 { 1.0 } else { u(8) };
        [
            x,
            y,
            x + length * cos,
            y + length * sin,
            radius,
            red,
            green,
            blue,
            opacity,
        ]
    };
    (0..count as u64).map(stroke).collect()
}
