//! The article's large demo: all strokes at once, from a random start.
//!
//! N capsules at random (ends uniform over the picture and 4 normal deviations apart, radius 0.1 to
//! 0.2 px, random colours) on grey ½; L1; Adam at a rate of 0.1 with the betas 0.99 and 0.999 on every
//! number, the background too; after each step ends are clamped to the picture, colours to 0..1 and
//! radii to 0..16 px. The recipe is the article's; the renderer is the crate's own, so that the memory
//! is that of the picture instead of strokes × pixels. Two things differ: pixels are sampled at their
//! centres, and ε of the distance is the renderer's, 1e-6 px² (the article's 1e-3 makes a stroke
//! 0.03 px thinner on its centre line, and no different elsewhere).

mod drawing;

use std::time::Instant;

pub use drawing::{Capsules, Statistics};

use super::ResultFolder;
use crate::report::Table;
use crate::report::plot::captioned;
use strokefit::Result;
use strokefit::coverage::{Coverage, CoverageSchedule};
use strokefit::fit::{Execution, Objective};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::optim::{Adam, AdamParams};
use strokefit::render::{
    Backdrop, Canvas, Gradients, Grid, OPACITY, PARAMS, Renderer, Softness, StrokeMut,
};
use strokefit::svg::{self, WriteOptions};
use strokefit::threads::Workers;
use strokefit::verify;

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

const FRAME_MS: u32 = 80;

/// Number of strokes, steps and random start of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct ArticleRun {
    /// Number of capsules, unless some are given.
    pub strokes: usize,
    /// Number of steps.
    pub iterations: usize,
    /// Coverage function; a mix passes to the second after 70 % of the steps.
    pub coverage: CoverageSchedule,
    /// Key of the random start.
    pub seed: u64,
    /// Iterations between pictures.
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
    /// [`ErrorKind::Config`](strokefit::ErrorKind::Config) when `execution` asks for what this machine
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

/// Runs the demo on `target`, from `start` or from a random drawing.
///
/// Writes `article.csv` (a row per picture), `article.json` (the drawing, to be read by
/// [`Capsules::from_json`]), `article.svg` with `article-svg.png` as resvg draws it,
/// `article-initial.png`, `article-NNNNNN.png` every so many iterations, `article-final.png`, and
/// the animations `article.gif` and, with legends, `article-legend.gif`.
///
/// # Errors
/// When a file cannot be written, or `start` is of another size than `target`.
pub fn run(
    output: &mut ResultFolder<'_>,
    target: &Image,
    config: &ArticleRun,
    start: Option<Capsules>,
    execution: Execution,
) -> Result<()> {
    let (width, height) = (target.width(), target.height());
    let start = match start {
        Some(drawing) => drawing.fitting(width, height)?,
        None => Capsules::random(width, height, config.strokes, config.seed),
    };
    let mut descent = Reproduction::new(target, start, execution)?;
    let mut film = Recording::new();
    let begin = Instant::now();
    for step in 0..config.iterations {
        let shown = step % config.every.max(1) == 0;
        // The picture is of the same drawing as the loss, before the step.
        let coverage = config.coverage_at(step);
        let picture = shown.then(|| (descent.render(coverage), descent.drawing().statistics()));
        let loss = descent.step(coverage);
        if let Some((picture, statistics)) = picture {
            output.doing(
                step as f64 / config.iterations as f64,
                &format!("L1 {loss:.5}"),
            );
            let name = match step {
                0 => "article-initial.png".to_owned(),
                _ => format!("article-{step:06}.png"),
            };
            output.picture(&name, &picture)?;
            let row = Row::new(step, coverage, loss, statistics, begin);
            film.push(&picture, &row)?;
        }
    }
    finish(output, film, target, config, &mut descent, begin)
}

fn finish(
    output: &mut ResultFolder<'_>,
    mut film: Recording,
    target: &Image,
    config: &ArticleRun,
    descent: &mut Reproduction,
    begin: Instant,
) -> Result<()> {
    let coverage = config.coverage.late;
    let picture = descent.render(coverage);
    let loss = strokefit::metrics::l1(target, &picture)?;
    let statistics = descent.drawing().statistics();
    film.push(
        &picture,
        &Row::new(config.iterations, coverage, loss, statistics, begin),
    )?;
    film.finish(output)?;
    output.picture("article-final.png", &picture)?;
    output.text("article.json", &descent.drawing().to_json()?)?;
    let text = svg::write(&descent.drawing().scene(), &WriteOptions::default());
    output.text("article.svg", &text)?;
    let drawn = verify::render(&text, verify::Size::Scale(1.0), Some([1.0; 3]))?;
    output.picture("article-svg.png", &drawn)
}

/// Row of the table on one picture.
struct Row {
    iteration: usize,
    coverage: Coverage,
    loss: f64,
    statistics: Statistics,
    wall_s: f64,
}

impl Row {
    fn new(
        iteration: usize,
        coverage: Coverage,
        loss: f64,
        statistics: Statistics,
        begin: Instant,
    ) -> Self {
        Self {
            iteration,
            coverage,
            loss,
            statistics,
            wall_s: begin.elapsed().as_secs_f64(),
        }
    }

    fn legend(&self) -> [String; 2] {
        let (iteration, coverage, loss) = (self.iteration, &self.coverage, self.loss);
        let Statistics {
            strokes,
            at_zero,
            mean_radius,
            deviation,
        } = self.statistics;
        [
            format!("iteration {iteration}, {coverage}, L1 {loss:.5}"),
            format!("{strokes} radii: {at_zero} zero, mean {mean_radius:.2} ± {deviation:.2} px"),
        ]
    }

    fn cells(&self) -> [String; 8] {
        let radii = &self.statistics;
        [
            self.iteration.to_string(),
            self.coverage.to_string(),
            self.loss.to_string(),
            radii.strokes.to_string(),
            radii.at_zero.to_string(),
            radii.mean_radius.to_string(),
            radii.deviation.to_string(),
            format!("{:.3}", self.wall_s),
        ]
    }
}

/// Least width of a picture with its legend, px: some 46 letters.
const CAPTION: usize = 380;

/// The pictures so far.
struct Recording {
    table: Table,
    plain: Vec<Image>,
    legend: Vec<Image>,
}

impl Recording {
    fn new() -> Self {
        let head = [
            "iteration",
            "coverage",
            "l1",
            "strokes",
            "at_radius_zero",
            "mean_radius",
            "deviation_of_radius",
            "wall_s",
        ];
        Self {
            table: Table::new(&head),
            plain: Vec::new(),
            legend: Vec::new(),
        }
    }

    fn push(&mut self, picture: &Image, row: &Row) -> Result<()> {
        self.table.row(row.cells());
        self.plain.push(picture.clone());
        self.legend
            .push(captioned(picture, &row.legend(), CAPTION)?);
        Ok(())
    }

    fn finish(self, output: &mut ResultFolder<'_>) -> Result<()> {
        for (name, frames) in [
            ("article.gif", self.plain),
            ("article-legend.gif", self.legend),
        ] {
            output.animation(name, FRAME_MS, frames.into_iter().map(Ok))?;
        }
        output.text("article.csv", &self.table.csv())
    }
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
    fn all_files_are_written_and_the_drawing_can_be_loaded() {
        let folder = tempfile::tempdir().unwrap();
        let mut tell = |_: crate::lab::Notice<'_>| {};
        let mut output = ResultFolder::new(folder.path(), &mut tell).unwrap();
        let config = ArticleRun {
            strokes: 20,
            iterations: 5,
            every: 2,
            ..ArticleRun::default()
        };
        run(&mut output, &target(), &config, None, Execution::default()).unwrap();
        let names = [
            "article.csv",
            "article.svg",
            "article.gif",
            "article-legend.gif",
            "article-initial.png",
            "article-000004.png",
            "article-final.png",
            "article-svg.png",
        ];
        for name in names {
            assert!(
                folder.path().join(name).metadata().unwrap().len() > 0,
                "{name}"
            );
        }
        let json = std::fs::read_to_string(folder.path().join("article.json")).unwrap();
        let drawing = Capsules::from_json(&json).unwrap();
        assert_eq!(drawing.strokes.len(), 20);
        run(
            &mut output,
            &target(),
            &config,
            Some(drawing),
            Execution::default(),
        )
        .unwrap();
    }
}
