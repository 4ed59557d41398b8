//! The article's recipe against the staged fit, in one run and through the same renderer.
//!
//! The recipe: random strokes, all fitted at once from the start; L1; Adam at one rate for
//! everything; every parameter clamped to its domain after each step. The claim that is checked:
//! the staged fit is at least 3 dB more faithful in at most a fifth of the time.
//!
//! ```text
//! cargo bench --bench article [-- PICTURE [STROKES] [ITERATIONS]]
//! ```
//!
//! With `--test`, or run as a test, a few strokes and iterations show that it runs, and nothing is
//! claimed.
#![allow(clippy::print_stdout, reason = "its output is a table")]
#![allow(clippy::expect_used, reason = "what cannot fail")]

mod random;

use std::time::Instant;

use strokefit::coverage::Coverage;
use strokefit::fit::{self, Budget, Config, Execution, Objective, Preset, Simd};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::metrics::psnr;
use strokefit::optim::{Adam, AdamParams, Optimizer};
use strokefit::render::{
    AX, BY, Base, Canvas, Gradients, OPACITY, PARAMS, Params, RADIUS, RED, Renderer, Softness,
    unpack,
};
use strokefit::scene::{Rgb, Scene, Stage};
use strokefit::svg::{self, WriteOptions};
use strokefit::{Error, ErrorKind, Result, verify};

const PICTURE: &str = "samples/coffee-550x220.png";

/// What the staged fit is to gain at least, dB.
const LEAST_GAIN_DB: f64 = 3.0;
/// The share of the recipe's time that it may take.
const MOST_TIME: f64 = 0.2;

/// The recipe's numbers, from the article.
const LOOK: random::Look = random::Look {
    spread_px: 4.0,
    radius_px: 0.1..0.2,
    opacity: 1.0..1.0,
};
const BACKGROUND: Rgb = [0.5; 3];
const RATE: f32 = 0.1;
const LARGEST_RADIUS_PX: f32 = 16.0;
const EDGE: Softness = Softness {
    coverage: Coverage::Smoothstep,
    width: 1.0,
};

fn main() -> Result<()> {
    let options = Options::parse(std::env::args().skip(1))?;
    let target = Image::open(&options.picture)?.flattened([1.0; 3]);
    println!(
        "{}, {}×{} px, {} strokes, {} iterations of the recipe",
        options.picture,
        target.width(),
        target.height(),
        options.strokes,
        options.iterations
    );
    println!("            seconds   soft dB   file dB   strokes   SVG kB");
    let article = Outcome::of("article", &target, || article(&target, &options))?;
    let staged = Outcome::of("staged", &target, || staged(&target, &options))?;
    compare(&article, &staged, options.claims);
    Ok(())
}

/// What to run.
#[derive(Debug)]
struct Options {
    picture: String,
    strokes: usize,
    iterations: usize,
    /// Whether the claim is checked.
    claims: bool,
}

impl Options {
    fn parse(args: impl Iterator<Item = String>) -> Result<Self> {
        let (flags, words): (Vec<_>, Vec<_>) = args.partition(|arg| arg.starts_with("--"));
        let is_set = |flag: &str| flags.iter().any(|f| f == flag);
        // Cargo passes --bench to benchmarks, unless it runs them as tests.
        let claims = is_set("--bench") && !is_set("--test");
        let [strokes, iterations] = if claims { [5000, 1500] } else { [200, 5] };
        Ok(Self {
            picture: words.first().map_or(PICTURE, String::as_str).to_owned(),
            strokes: words.get(1).map_or(Ok(strokes), |word| count(word))?,
            iterations: words.get(2).map_or(Ok(iterations), |word| count(word))?,
            claims,
        })
    }
}

fn count(word: &str) -> Result<usize> {
    word.parse().ok().filter(|&n| n > 0).ok_or_else(|| {
        let message = format!("'{word}' is no count: give a whole number above 0");
        Error::new(ErrorKind::Config, message)
    })
}

/// A drawing and our own render of it.
struct Drawn {
    scene: Scene,
    soft: Image,
}

/// How a recipe did.
#[derive(Debug)]
struct Outcome {
    seconds: f64,
    /// Of the SVG as resvg draws it.
    fidelity_db: f64,
}

impl Outcome {
    /// Runs `draw`, judges what it drew and prints a row of the table.
    fn of(name: &str, target: &Image, draw: impl FnOnce() -> Result<Drawn>) -> Result<Self> {
        let start = Instant::now();
        let Drawn { scene, soft } = draw()?;
        let seconds = start.elapsed().as_secs_f64();
        let text = svg::write(&scene, &WriteOptions::default());
        let soft_db = psnr(target, &soft)?;
        let fidelity_db = verify::fidelity(&text, target)?.psnr_db;
        let strokes = scene.quantized(2).0.len();
        let kilobytes = text.len() as f64 / 1000.0;
        println!(
            "{name:<8} {seconds:>10.2} {soft_db:>9.2} {fidelity_db:>9.2} {strokes:>9} {kilobytes:>8.0}"
        );
        Ok(Self {
            seconds,
            fidelity_db,
        })
    }
}

fn compare(article: &Outcome, staged: &Outcome, claims: bool) {
    let gain_db = staged.fidelity_db - article.fidelity_db;
    let time = staged.seconds / article.seconds;
    println!("staged against article: {gain_db:+.2} dB in {time:.2} of the time");
    if claims {
        let holds = gain_db >= LEAST_GAIN_DB && time <= MOST_TIME;
        let verdict = if holds { "holds" } else { "does not hold" };
        println!("claim, {LEAST_GAIN_DB:+} dB or more in {MOST_TIME} or less: {verdict}");
    }
}

fn staged(target: &Image, options: &Options) -> Result<Drawn> {
    let config = Config {
        preset: Preset::Draft,
        budget: Budget {
            strokes: Some(options.strokes),
            ..Budget::default()
        },
        polish: false,
        ..Config::default()
    };
    let fit = fit::fit(target, &config, &Execution::default(), &mut ())?;
    Ok(Drawn {
        scene: fit.scene,
        soft: fit.soft,
    })
}

fn article(target: &Image, options: &Options) -> Result<Drawn> {
    let target = Canvas::from_image(target);
    let grid = target.grid();
    let level = Simd::Auto.level().expect("every machine has a SIMD level");
    let mut renderer = Renderer::new(grid, level);
    let mut strokes = random::strokes(grid, options.strokes, &LOOK);
    descend(&mut renderer, &mut strokes, &target, options.iterations);
    let mut canvas = Canvas::flat(grid, BACKGROUND);
    renderer.forward(&strokes, EDGE, Base::Flat(BACKGROUND), &mut canvas);
    let page = Scene::empty(grid.width as u32, grid.height as u32, Some(BACKGROUND));
    let stage = Stage {
        strokes: strokes.iter().map(unpack).collect(),
    };
    Ok(Drawn {
        scene: Scene {
            stages: vec![stage],
            ..page
        },
        soft: canvas.to_image(),
    })
}

/// All strokes at once, as the article has it.
fn descend(renderer: &mut Renderer, strokes: &mut [Params], target: &Canvas, iterations: usize) {
    let size = [target.grid().width as f32, target.grid().height as f32];
    let objective = Objective::new(Loss::L1, target);
    let mut adam = Adam::new(strokes.len() * PARAMS, AdamParams::default());
    // The article's strokes have no opacity: it stays 1.
    let mut scales = [1.0; PARAMS];
    scales[OPACITY] = 0.0;
    let scales = scales.repeat(strokes.len());
    let mut gradients = Gradients::default();
    for _ in 0..iterations {
        renderer.backward(
            strokes,
            EDGE,
            Base::Flat(BACKGROUND),
            &objective,
            &mut gradients,
        );
        let flat = gradients.strokes.as_flattened();
        adam.step_scaled(strokes.as_flattened_mut(), flat, RATE, &scales);
        for stroke in &mut *strokes {
            clamp(stroke, size);
        }
    }
}

/// Ends inside the picture of `size` px, radius up to 16 px, colours 0..1.
fn clamp(stroke: &mut Params, size: [f32; 2]) {
    for k in AX..=BY {
        stroke[k] = stroke[k].clamp(0.0, size[k % 2]);
    }
    stroke[RADIUS] = stroke[RADIUS].clamp(0.0, LARGEST_RADIUS_PX);
    for color in &mut stroke[RED..OPACITY] {
        *color = color.clamp(0.0, 1.0);
    }
}
