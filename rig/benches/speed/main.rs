//! The speed of the renderer.
//!
//! ```text
//! cargo bench -p rig --bench speed [-- PICTURE]
//! ```
//!
//! All in one run, so that figures of different machines can be compared as ratios: pairs per second
//! by size of stroke, opacity, threads and SIMD level, on random drawings and on finished ones, of capsules and of paths.
//!
//! A *pair* is a stroke and a pixel of the picture where its coverage is above 0. They are counted
//! apart from the renderer, hidden ones included: what the renderer need not look at is its gain. A pixel that
//! several segments of one path cover is one pair, since the stroke is painted there once. A
//! *lane* is what it does look at: blocks visited × 16. Times are the shortest of several.
//!
//! With `--test` everything is done once, on few strokes: it shows that it runs.
#![allow(clippy::print_stdout, reason = "its output is tables")]
#![allow(clippy::expect_used, reason = "what cannot fail")]

mod count;

use rig::bench::measure::{DEPTH, EDGE, StrokeSize, fastest, go_to_root};
use rig::bench::scaling::thread_counts;
use strokefit::Result;
use strokefit::fit::{Budget, Config, Fitter, Objective, Simd};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::render::{Backdrop, Canvas, Gradients, Renderer, StrokeRef, Strokes, flattened};

use count::Count;

const PICTURE: &str = "samples/coffee-550x220.png";
const BACKDROP: [f32; 3] = [0.5; 3];

/// Sizes of random strokes: radius and length, px.
const SIZES: [(&str, f32, f32); 3] = [
    ("thin", 0.7, 12.0),
    ("medium", 3.0, 14.0),
    ("large", 12.0, 40.0),
];
const OPACITIES: [f32; 2] = [1.0, 0.5];

fn main() -> Result<()> {
    go_to_root().expect("the benchmark lies in it");
    let options = Options::parse(std::env::args().skip(1));
    let image = Image::open(&options.picture)?.flattened([1.0; 3]);
    let target = Canvas::from_image(&image);
    println!(
        "{}, {}×{} px, smoothstep of {} px, best of {}\n",
        options.picture,
        image.width(),
        image.height(),
        EDGE.width,
        options.rounds
    );
    let mut drawings = random(&target);
    drawings.push(settled("settled 2", Some(2), &image, &options)?);
    drawings.push(settled("settled", None, &image, &options)?);
    speeds(&drawings, &target, options.rounds);
    let settled = drawings.last().expect("one was pushed");
    levels(settled, &target, options.rounds);
    Ok(())
}

/// Options of a run.
#[derive(Debug)]
struct Options {
    picture: String,
    rounds: usize,
    /// Strokes of the settled drawing.
    strokes: usize,
    polish: bool,
}

impl Options {
    fn parse(args: impl Iterator<Item = String>) -> Self {
        let (flags, words): (Vec<_>, Vec<_>) = args.partition(|arg| arg.starts_with("--"));
        let test = flags.iter().any(|flag| flag == "--test");
        Self {
            picture: words.first().map_or(PICTURE, String::as_str).to_owned(),
            rounds: if test { 1 } else { 60 },
            strokes: if test { 50 } else { 5000 },
            polish: !test,
        }
    }
}

/// Strokes to measure, and the work that they are.
struct Workload {
    name: String,
    strokes: Strokes,
    backdrop: [f32; 3],
    count: Count,
}

impl Workload {
    fn new(name: String, strokes: Strokes, backdrop: [f32; 3], target: &Canvas) -> Self {
        let count = Count::of(target.grid(), &strokes);
        Self {
            name,
            strokes,
            backdrop,
            count,
        }
    }
}

fn random(target: &Canvas) -> Vec<Workload> {
    let grid = target.grid();
    let mut drawings = Vec::new();
    for (name, radius_px, length_px) in SIZES {
        for opacity in OPACITIES {
            let size = StrokeSize {
                radius_px,
                length_px,
                opacity,
            };
            let count = DEPTH * (grid.width * grid.height) as f32 / size.area_px();
            let strokes = size.strokes(grid, count as usize);
            let name = format!("{name} {opacity:.1}");
            drawings.push(Workload::new(name, strokes, BACKDROP, target));
        }
    }
    drawings
}

/// A fit of the picture, as it is when finished, of strokes of at most `points` points. Curves are polylines, as the renderer
/// draws them.
fn settled(
    name: &str,
    points: Option<usize>,
    image: &Image,
    options: &Options,
) -> Result<Workload> {
    let config = Config {
        budget: Budget {
            strokes: Some(options.strokes),
            ..Budget::default()
        },
        points,
        polish: options.polish,
        ..Config::default()
    };
    let scene = Fitter::new(config).fit(image)?.scene;
    let paths: Strokes = scene.marks().collect();
    let mut strokes = Strokes::new();
    for path in paths.iter() {
        let points = flattened(path);
        strokes.push(StrokeRef {
            points: &points,
            off: &vec![false; points.len()],
            closed: false,
            rings: &[],
            form: None,
            paint: None,
            style: path.style,
        });
    }
    let backdrop = scene.background.unwrap_or([1.0; 3]);
    let target = Canvas::from_image(image);
    Ok(Workload::new(name.into(), strokes, backdrop, &target))
}

/// Shortest times of one drawing on some number of threads, s.
#[derive(Debug, Clone, Copy)]
struct Speed {
    threads: usize,
    forward: f64,
    backward: f64,
    contribution: f64,
}

/// Prints pairs per second, by drawing and number of threads.
fn speeds(drawings: &[Workload], target: &Canvas, rounds: usize) {
    println!(
        "million pairs per second; forward+backward in `backward`, leave-one-out too in `worth`"
    );
    println!(
        "{:<12} {:>7} {:>8} {:>9} {:>6} {:>7} {:>8} {:>9} {:>7} {:>9}",
        "strokes",
        "number",
        "pairs/px",
        "lanes/pr",
        "core",
        "threads",
        "forward",
        "backward",
        "worth",
        "speed-up"
    );
    for drawing in drawings {
        speed(drawing, target, rounds);
    }
}

fn speed(drawing: &Workload, target: &Canvas, rounds: usize) {
    let grid = target.grid();
    let count = &drawing.count;
    let pixels = (grid.width * grid.height) as f64;
    let speeds = times(drawing, target, rounds);
    for times in &speeds {
        let rate = |seconds: f64| count.pairs as f64 / seconds / 1e6;
        println!(
            "{:<12} {:>7} {:>8.1} {:>9.2} {:>5.0}% {:>7} {:>8.0} {:>9.0} {:>7.0} {:>8.2}×",
            drawing.name,
            drawing.strokes.len(),
            count.pairs as f64 / pixels,
            count.lanes() as f64 / count.pairs as f64,
            100.0 * (count.core * count::LANES) as f64 / count.lanes() as f64,
            times.threads,
            rate(times.forward),
            rate(times.backward),
            rate(times.contribution),
            speeds[0].contribution / times.contribution,
        );
    }
}

/// Times for every number of threads, which take turns.
fn times(drawing: &Workload, target: &Canvas, rounds: usize) -> Vec<Speed> {
    let level = Simd::Auto.level().expect("every machine has a SIMD level");
    let mut benches: Vec<Bench<'_>> = thread_counts()
        .into_iter()
        .map(|threads| Bench::new(drawing, target, level, threads))
        .collect();
    let mut speeds: Vec<Speed> = benches.iter().map(Bench::unmeasured).collect();
    for _ in 0..rounds {
        for (bench, best) in benches.iter_mut().zip(&mut speeds) {
            bench.measure(best);
        }
    }
    for bench in &benches {
        bench.check();
    }
    speeds
}

/// A drawing on a number of threads.
struct Bench<'a> {
    drawing: &'a Workload,
    target: &'a Canvas,
    pool: rayon::ThreadPool,
    renderer: Renderer,
    canvas: Canvas,
    gradients: Gradients,
}

impl<'a> Bench<'a> {
    fn new(
        drawing: &'a Workload,
        target: &'a Canvas,
        level: fearless_simd::Level,
        threads: usize,
    ) -> Self {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = builder.build().expect("so few threads can be started");
        let grid = target.grid();
        Self {
            drawing,
            target,
            renderer: pool.install(|| Renderer::new(grid, level)),
            pool,
            canvas: Canvas::flat(grid, BACKDROP),
            gradients: Gradients::default(),
        }
    }

    fn unmeasured(&self) -> Speed {
        Speed {
            threads: self.pool.current_num_threads(),
            forward: f64::INFINITY,
            backward: f64::INFINITY,
            contribution: f64::INFINITY,
        }
    }

    /// One time of each kind.
    fn measure(&mut self, best: &mut Speed) {
        let Self {
            drawing,
            target,
            pool,
            renderer,
            canvas,
            gradients,
        } = self;
        let (strokes, backdrop) = (&drawing.strokes, Backdrop::Color(drawing.backdrop));
        let objective = Objective::new(Loss::L2, target);
        pool.install(|| {
            let [forward] = fastest(
                1,
                [&mut || renderer.forward(strokes, EDGE, backdrop, canvas)],
            );
            let [backward] = fastest(
                1,
                [&mut || renderer.backward(strokes, EDGE, backdrop, &objective, gradients)],
            );
            let [contribution] = fastest(
                1,
                [&mut || {
                    renderer
                        .backward_with_contributions(strokes, EDGE, backdrop, &objective, gradients)
                }],
            );
            best.forward = best.forward.min(forward);
            best.backward = best.backward.min(backward);
            best.contribution = best.contribution.min(contribution);
        });
    }

    /// The work counted is the work done, up to rounding at the borders of blocks.
    fn check(&self) {
        let (done, counted) = (
            self.gradients.blocks as f64,
            self.drawing.count.blocks() as f64,
        );
        let excess = done / counted - 1.0;
        assert!(
            excess.abs() < 0.01,
            "blocks of {}: {done} done, {counted} counted",
            self.drawing.name
        );
    }
}

/// Prints `backward` of a drawing at every level of this machine.
fn levels(drawing: &Workload, target: &Canvas, rounds: usize) {
    let levels = Simd::available().filter_map(|simd| Some((simd, simd.level()?)));
    let mut benches: Vec<_> = levels
        .map(|(simd, level)| {
            let bench = Bench::new(drawing, target, level, 1);
            let speed = bench.unmeasured();
            (simd, bench, speed)
        })
        .collect();
    for _ in 0..rounds.div_ceil(3) {
        for (_, bench, best) in &mut benches {
            bench.measure(best);
        }
    }
    println!("\n{}, one thread, `backward` by SIMD level", drawing.name);
    println!("{:<12} {:>9} {:>9}", "level", "M pairs/s", "of best");
    let best = benches.iter().fold(f64::INFINITY, |best, (_, _, speed)| {
        best.min(speed.backward)
    });
    for (simd, _, speed) in &benches {
        println!(
            "{:<12} {:>9.0} {:>9.2}",
            simd.to_string(),
            drawing.count.pairs as f64 / speed.backward / 1e6,
            best / speed.backward
        );
    }
}
