//! The article's large demo: all strokes at once, from a random start.
//!
//! N capsules at random (ends uniform over the picture and 4 normal deviations apart, radius 0.1 to
//! 0.2 px, random colours) on grey ½; L1; Adam at a rate of 0.1 with the betas 0.99 and 0.999 on every
//! number, the background too; after each step ends are clamped to the picture, colours to 0..1 and
//! radii to 0..16 px. The recipe is the article's; the renderer is the crate's own, so that the memory
//! is that of the picture instead of strokes × pixels. Two things differ: pixels are sampled at their
//! centres, and ε of the distance is the renderer's, 1e-6 px² (the article's 1e-3 makes a stroke
//! 0.03 px thinner on its centre line, and no different elsewhere).

use std::time::Instant;

use serde::Serialize;

use super::ResultFolder;
use crate::report::Table;
use strokefit::coverage::{Coverage, CoverageSchedule};
use strokefit::fit::{Execution, Objective};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::math;
use strokefit::optim::{Adam, AdamParams};
use strokefit::render::{
    Backdrop, Canvas, Gradients, Grid, OPACITY, PARAMS, Params, Renderer, Softness, StrokeMut,
    Strokes,
};
use strokefit::rng;
use strokefit::scene::Scene;
use strokefit::svg::{self, WriteOptions};
use strokefit::threads::Workers;
use strokefit::{Error, ErrorKind, Result};

const RATE: f32 = 0.1;

const ADAM: AdamParams = AdamParams {
    betas: [0.99, 0.999],
    eps: 1e-8,
};

/// Width of the soft edge, px; the article knows no other.
const SOFTNESS: f32 = 1.0;

/// Largest radius, px.
const LARGEST: f32 = 16.0;

/// Share of the iterations after which a mix of coverage functions passes to the second.
const EARLY: f64 = 0.7;

/// Standard deviation of `b − a`, px.
const LENGTH: f32 = 4.0;

/// Number of strokes, steps and random start of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct ArticleRun {
    /// Number of capsules.
    pub strokes: usize,
    /// Number of steps.
    pub iterations: usize,
    /// Coverage function; a mix passes to the second after 70 % of the steps.
    pub coverage: CoverageSchedule,
    /// Key of the random start.
    pub seed: u64,
    /// Iterations between rows of the table.
    pub every: usize,
}

/// The article's numbers.
impl Default for ArticleRun {
    fn default() -> Self {
        Self {
            strokes: 5000,
            iterations: 1500,
            coverage: CoverageSchedule::default(),
            seed: 0,
            every: 30,
        }
    }
}

/// Capsules on a background, as the numbers that descent changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Capsules {
    /// Width in px.
    pub width: usize,
    /// Height in px.
    pub height: usize,
    /// The colour behind all strokes.
    pub background: [f32; 3],
    /// Back to front, each of two points.
    pub strokes: Strokes,
}

/// Capsules as they are saved.
#[derive(Serialize)]
struct Saved<'a> {
    width: usize,
    height: usize,
    background: [f32; 3],
    /// ax, ay, bx, by, radius, red, green, blue, opacity.
    strokes: &'a [Params],
}

impl Capsules {
    /// `strokes` capsules at random on grey, as the article starts; `seed` is the key.
    pub fn random(width: usize, height: usize, strokes: usize, seed: u64) -> Self {
        let stroke = |i: u64| {
            let draw = |k| rng::draw(seed, 0, i, k);
            let normal = |k| LENGTH * rng::normal(seed, 1, i, k);
            let (x, y) = (draw(0) * width as f32, draw(1) * height as f32);
            let radius = 0.1 + 0.1 * draw(2);
            let [red, green, blue] = [draw(3), draw(4), draw(5)];
            [
                x,
                y,
                x + normal(0),
                y + normal(1),
                radius,
                red,
                green,
                blue,
                1.0,
            ]
        };
        Self {
            width,
            height,
            background: [0.5; 3],
            strokes: (0..strokes as u64).map(stroke).collect(),
        }
    }

    /// The drawing as JSON; nothing is rounded.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when a number is not finite, which JSON cannot say.
    pub fn to_json(&self) -> Result<String> {
        let saved = Saved {
            width: self.width,
            height: self.height,
            background: self.background,
            strokes: self.strokes.numbers().as_chunks().0,
        };
        serde_json::to_string(&saved).map_err(|e| {
            let message = format!("the drawing cannot be saved: {e}");
            Error::new(ErrorKind::Io, message).caused_by(e)
        })
    }

    /// The drawing as a scene of one stage.
    pub fn scene(&self) -> Scene {
        let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let page = Scene::empty(side(self.width), side(self.height), Some(self.background));
        let stage = self.strokes.iter().map(|stroke| stroke.to_mark()).collect();
        Scene {
            stages: vec![stage],
            ..page
        }
    }
}

/// The article's descent, one step at a time.
pub struct Reproduction {
    pool: Workers,
    target: Canvas,
    renderer: Renderer,
    drawing: Capsules,
    strokes: Adam<f32>,
    background: Adam<f32>,
    /// 1 for every number but the opacity, which stays as it is.
    scales: Vec<f32>,
    gradients: Gradients,
}

impl Reproduction {
    /// Starts from `drawing` towards `target`, which is as large.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when `execution` asks for what this machine
    /// does not have.
    pub fn new(target: &Image, drawing: Capsules, execution: Execution) -> Result<Self> {
        let level = execution.simd.require()?;
        let pool = execution.pool()?;
        let grid = Grid::new(target.width(), target.height());
        let mut scales = [1.0; PARAMS];
        scales[OPACITY] = 0.0;
        Ok(Self {
            renderer: pool.install(|| Renderer::new(grid, level)),
            pool,
            target: Canvas::from_image(target),
            strokes: Adam::new(drawing.strokes.len() * PARAMS, ADAM),
            background: Adam::new(drawing.background.len(), ADAM),
            scales: scales.repeat(drawing.strokes.len()),
            gradients: Gradients::default(),
            drawing,
        })
    }

    /// One step; the loss is that before it.
    pub fn step(&mut self, coverage: Coverage) -> f64 {
        let Self { drawing, .. } = self;
        let objective = Objective::new(Loss::L1, &self.target);
        let backdrop = Backdrop::Color(drawing.background);
        let (renderer, gradients) = (&mut self.renderer, &mut self.gradients);
        self.pool.install(|| {
            renderer.backward(
                &drawing.strokes,
                softness(coverage),
                backdrop,
                &objective,
                gradients,
            );
        });
        let flat = &gradients.strokes;
        let params = drawing.strokes.numbers_mut();
        self.strokes.step_scaled(params, flat, RATE, &self.scales);
        self.background
            .step(&mut drawing.background, &gradients.backdrop, RATE);
        drawing.background = drawing.background.map(|c| c.clamp(0.0, 1.0));
        let size = [drawing.width as f32, drawing.height as f32];
        drawing.strokes.change(|_, stroke| clamp(stroke, size));
        gradients.loss
    }

    /// The picture as it is.
    pub fn render(&mut self, coverage: Coverage) -> Image {
        let mut canvas = Canvas::flat(self.renderer.grid(), [0.0; 3]);
        let Self {
            drawing, renderer, ..
        } = self;
        let backdrop = Backdrop::Color(drawing.background);
        let out = &mut canvas;
        self.pool
            .install(|| renderer.forward(&drawing.strokes, softness(coverage), backdrop, out));
        canvas.to_image()
    }

    /// The drawing as it is.
    pub fn drawing(&self) -> &Capsules {
        &self.drawing
    }
}

fn softness(coverage: Coverage) -> Softness {
    Softness {
        coverage,
        width: SOFTNESS,
    }
}

fn clamp(mut stroke: StrokeMut<'_>, size: [f32; 2]) {
    for (k, x) in stroke.points.as_flattened_mut().iter_mut().enumerate() {
        *x = x.clamp(0.0, size[k % 2]);
    }
    for c in stroke.color_mut() {
        *c = c.clamp(0.0, 1.0);
    }
    stroke.style[0] = stroke.style[0].clamp(0.0, LARGEST);
}

impl ArticleRun {
    /// The coverage function of step `step`, from 0.
    pub fn coverage_at(&self, step: usize) -> Coverage {
        if (step as f64) < EARLY * self.iterations as f64 {
            self.coverage.early
        } else {
            self.coverage.late
        }
    }
}

/// Runs the demo on `target` from a random drawing.
///
/// Writes `article.csv` (a row every so many iterations), `article.json` (the drawing, unrounded) and `article.svg`.
///
/// # Errors
/// When a file cannot be written.
pub fn run(
    output: &mut ResultFolder,
    target: &Image,
    config: &ArticleRun,
    execution: Execution,
) -> Result<()> {
    let start = Capsules::random(target.width(), target.height(), config.strokes, config.seed);
    let mut descent = Reproduction::new(target, start, execution)?;
    let begin = Instant::now();
    let mut table = Table::new(&HEAD);
    for step in 0..config.iterations {
        let coverage = config.coverage_at(step);
        if !step.is_multiple_of(config.every.max(1)) {
            descent.step(coverage);
            continue;
        }
        let drawn = descent.drawing().clone();
        let loss = descent.step(coverage);
        let done = step as f64 / config.iterations as f64;
        output.doing(done, &format!("L1 {loss:.5}"));
        table.row(row(step, coverage, loss, &drawn, begin));
    }
    let coverage = config.coverage.late;
    let loss = strokefit::metrics::l1(target, &descent.render(coverage))?;
    let drawing = descent.drawing();
    table.row(row(config.iterations, coverage, loss, drawing, begin));
    output.text("article.csv", &table.csv())?;
    output.text("article.json", &drawing.to_json()?)?;
    let text = svg::write(&drawing.scene(), &WriteOptions::default());
    output.text("article.svg", &text)
}

const HEAD: [&str; 8] = [
    "iteration",
    "coverage",
    "l1",
    "strokes",
    "at_radius_zero",
    "mean_radius",
    "deviation_of_radius",
    "wall_s",
];

/// What is known of a drawing.
fn row(
    iteration: usize,
    coverage: Coverage,
    loss: f64,
    drawing: &Capsules,
    begin: Instant,
) -> [String; 8] {
    let radii = || drawing.strokes.iter().map(|s| f64::from(s.radius()));
    let n = drawing.strokes.len().max(1) as f64;
    let mean = radii().sum::<f64>() / n;
    let variance = radii().map(|r| math::powi(r - mean, 2)).sum::<f64>() / n;
    [
        iteration.to_string(),
        coverage.to_string(),
        loss.to_string(),
        drawing.strokes.len().to_string(),
        radii().filter(|&r| r == 0.0).count().to_string(),
        mean.to_string(),
        variance.sqrt().to_string(),
        format!("{:.3}", begin.elapsed().as_secs_f64()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target() -> Image {
        let plane = |k: usize| {
            (0..24 * 20)
                .map(|i| (i % 24 * k % 97) as f32 / 96.0)
                .collect()
        };
        Image::new(24, 20, [plane(3), plane(5), plane(8)]).unwrap()
    }

    #[test]
    fn the_loss_falls_and_numbers_stay_in_their_domain() {
        let start = Capsules::random(24, 20, 60, 1);
        let mut descent = Reproduction::new(&target(), start, Execution::default()).unwrap();
        let first = descent.step(Coverage::Sigmoid);
        let last = (0..60)
            .map(|_| descent.step(Coverage::Sigmoid))
            .last()
            .unwrap();
        assert!(last < 0.8 * first, "{first} {last}");
        for stroke in descent.drawing().strokes.iter() {
            let inside = |[x, y]: &[f32; 2]| (0.0..=24.0).contains(x) && (0.0..=20.0).contains(y);
            assert!(stroke.points.iter().all(inside), "{stroke:?}");
            let is_radius = (0.0..=LARGEST).contains(&stroke.radius());
            assert!(is_radius && stroke.opacity() == 1.0, "{stroke:?}");
            let color = stroke.color();
            assert!(color.iter().all(|c| (0.0..=1.0).contains(c)), "{stroke:?}");
        }
    }

    #[test]
    fn a_mix_passes_to_its_second_function() {
        let config = ArticleRun {
            iterations: 10,
            coverage: "sigmoid>smoothstep".parse().unwrap(),
            ..ArticleRun::default()
        };
        assert_eq!(config.coverage_at(6), Coverage::Sigmoid);
        assert_eq!(config.coverage_at(7), Coverage::Smoothstep);
    }

    #[test]
    fn all_files_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut output = ResultFolder::new(folder.path(), true).unwrap();
        let config = ArticleRun {
            strokes: 20,
            iterations: 5,
            every: 2,
            ..ArticleRun::default()
        };
        run(&mut output, &target(), &config, Execution::default()).unwrap();
        for name in ["article.svg", "article.json"] {
            assert!(
                folder.path().join(name).metadata().unwrap().len() > 0,
                "{name}"
            );
        }
        let table = std::fs::read_to_string(folder.path().join("article.csv")).unwrap();
        assert_eq!(table.lines().count(), 1 + 3 + 1, "{table}");
    }

    #[test]
    fn a_random_drawing_is_as_the_article_says() {
        let drawing = Capsules::random(100, 50, 2000, 3);
        assert_eq!(drawing, Capsules::random(100, 50, 2000, 3));
        assert_ne!(drawing, Capsules::random(100, 50, 2000, 4));
        let squares = drawing
            .strokes
            .iter()
            .map(|stroke| f64::from(math::powi(stroke.points[1][0] - stroke.points[0][0], 2)));
        let deviation = (squares.sum::<f64>() / 2000.0).sqrt();
        assert!((deviation - 4.0).abs() < 0.2, "{deviation}");
        let mut radii = drawing.strokes.iter().map(|stroke| stroke.radius());
        assert!(radii.all(|radius| (0.1..=0.2).contains(&radius)));
    }
}
