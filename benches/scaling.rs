//! How time and memory grow with strokes, pixels and threads.
//!
//! ```text
//! cargo bench --bench scaling [-- PICTURE]
//! ```
//!
//! Each point is a process of its own, so that its peak memory is its own. Exponents are slopes of
//! least squares in log–log; beside them is the slope of the last two points, where constant costs
//! weigh least. Last, the program itself draws 24 megapixels with 20,000 strokes.
//!
//! With `--test` a few small points show that it runs.
#![allow(clippy::print_stdout, reason = "its output is tables")]
#![allow(
    clippy::expect_used,
    reason = "what cannot fail, or may end a benchmark"
)]

mod measure;

use std::fs;
use std::hint::black_box;
use std::process::Command;

use strokefit::fit::{self, Budget, Config, Execution, Objective, Preset, Simd};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::render::{Base, Canvas, Gradients, Renderer};
use strokefit::report::{FitReport, Usage};
use strokefit::{Error, ErrorKind, Result};

use measure::{DEPTH, EDGE, Size, fastest, pool, thread_counts};

const PICTURE: &str = "samples/coffee-550x220.png";
const GROUND: [f32; 3] = [0.5; 3];

/// What marks a process that measures one point.
const POINT: &str = "--point";

/// Pixels of the picture where strokes or threads vary, in millions.
const FIXED_MEGAPIXELS: f64 = 1.0;
/// Strokes where pixels or threads vary.
const FIXED_STROKES: usize = 5000;

const GIB: f64 = (1_u64 << 30) as f64;
/// What the largest picture may use, GiB.
const MOST_GIB: f64 = 4.0;

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if let Some(at) = args.iter().position(|arg| arg == POINT) {
        return Point::parse(&args[at + 1..])?.measure();
    }
    let test = args.iter().any(|arg| arg == "--test");
    let picture = args.iter().find(|arg| !arg.starts_with("--"));
    let picture = picture.map_or(PICTURE, String::as_str);
    let series = if test { brief() } else { thorough() };
    for series in series {
        series.run(picture)?;
    }
    if !test {
        program(picture)?;
    }
    Ok(())
}

/// What is timed.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Task {
    /// `Renderer::backward`.
    Backward,
    /// A fit without polish, as quick as there is.
    Stages,
    /// The default fit.
    Fit,
}

impl Task {
    const ALL: [(Self, &str); 3] = [
        (Self::Backward, "backward"),
        (Self::Stages, "stages"),
        (Self::Fit, "fit"),
    ];

    fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

/// One point of a series.
#[derive(Debug, Clone)]
struct Point {
    task: Task,
    picture: String,
    megapixels: f64,
    strokes: usize,
    threads: usize,
}

/// What a point took.
#[derive(Debug, Clone, Copy)]
struct Cost {
    seconds: f64,
    peak_bytes: f64,
}

/// What grows along a series.
#[derive(Debug, Clone, Copy)]
enum Axis {
    Strokes,
    Pixels,
    Threads,
}

/// Points that differ in one thing.
#[derive(Debug)]
struct Series {
    task: Task,
    axis: Axis,
    values: Vec<f64>,
}

impl Series {
    fn new(task: Task, axis: Axis, values: &[f64]) -> Self {
        Self {
            task,
            axis,
            values: values.to_vec(),
        }
    }

    fn point(&self, picture: &str, value: f64) -> Point {
        let threads = thread_counts().pop().unwrap_or(1);
        let mut point = Point {
            task: self.task,
            picture: picture.to_owned(),
            megapixels: FIXED_MEGAPIXELS,
            strokes: FIXED_STROKES,
            threads,
        };
        match self.axis {
            Axis::Strokes => point.strokes = value as usize,
            Axis::Pixels => point.megapixels = value / 1e6,
            Axis::Threads => point.threads = value as usize,
        }
        point
    }

    /// Measures and prints all points, and the exponent.
    fn run(&self, picture: &str) -> Result<()> {
        println!(
            "\n{} against {}",
            self.task.name(),
            format!("{:?}", self.axis).to_lowercase()
        );
        println!(
            "{:>10} {:>8} {:>7} {:>10} {:>9}",
            "megapixels", "strokes", "threads", "seconds", "peak MiB"
        );
        let mut seen = Vec::new();
        for &value in &self.values {
            let point = self.point(picture, value);
            let cost = point.cost()?;
            println!(
                "{:>10.2} {:>8} {:>7} {:>10.4} {:>9.0}",
                point.megapixels,
                point.strokes,
                point.threads,
                cost.seconds,
                cost.peak_bytes / f64::from(1 << 20)
            );
            seen.push((value, cost));
        }
        let exponent = |of: fn(&Cost) -> f64, seen: &[(f64, Cost)]| {
            slope(seen.iter().map(|(x, cost)| (*x, of(cost))))
        };
        let last = &seen[seen.len().saturating_sub(2)..];
        let (time, memory) = (|c: &Cost| c.seconds, |c: &Cost| c.peak_bytes);
        println!(
            "exponent of time {:.2}, of the last two points {:.2}; of memory {:.2}, {:.2}",
            exponent(time, &seen),
            exponent(time, last),
            exponent(memory, &seen),
            exponent(memory, last)
        );
        Ok(())
    }
}

/// Slope of ln y over ln x by least squares.
fn slope(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let logs: Vec<(f64, f64)> = points.map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / n;
    let both: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let square: f64 = logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    both / square
}

fn thorough() -> Vec<Series> {
    let decades = [100.0, 300.0, 1e3, 3e3, 1e4, 3e4, 1e5];
    let pixels = [0.05e6, 0.2e6, 1e6, 4e6, 24e6];
    let threads: Vec<f64> = thread_counts().iter().map(|&n| n as f64).collect();
    vec![
        Series::new(Task::Backward, Axis::Strokes, &decades),
        Series::new(Task::Backward, Axis::Pixels, &pixels),
        Series::new(Task::Backward, Axis::Threads, &threads),
        Series::new(Task::Stages, Axis::Strokes, &[100.0, 1e3, 1e4, 1e5]),
        Series::new(Task::Stages, Axis::Pixels, &pixels),
        Series::new(Task::Stages, Axis::Threads, &threads),
        Series::new(Task::Fit, Axis::Strokes, &[300.0, 1e3, 3e3]),
        Series::new(Task::Fit, Axis::Pixels, &[0.05e6, 0.2e6, 0.8e6]),
        Series::new(Task::Fit, Axis::Threads, &threads),
    ]
}

fn brief() -> Vec<Series> {
    vec![
        Series::new(Task::Backward, Axis::Strokes, &[100.0, 1000.0]),
        Series::new(Task::Stages, Axis::Pixels, &[0.01e6, 0.02e6]),
    ]
}

impl Point {
    /// Measures this point in a process of its own.
    fn cost(&self) -> Result<Cost> {
        let failed = |what: String| Error::new(ErrorKind::Config, what);
        let program = std::env::current_exe().map_err(|e| failed(e.to_string()))?;
        let output = Command::new(program)
            .args([POINT, self.task.name(), &self.picture])
            .args([self.megapixels.to_string(), self.strokes.to_string()])
            .arg(self.threads.to_string())
            .output()
            .map_err(|e| failed(e.to_string()))?;
        let text = String::from_utf8_lossy(&output.stdout);
        let mut numbers = text.split_whitespace().map(str::parse::<f64>);
        match (numbers.next(), numbers.next()) {
            (Some(Ok(seconds)), Some(Ok(peak_bytes))) => Ok(Cost {
                seconds,
                peak_bytes,
            }),
            _ => Err(failed(format!(
                "{self:?}: {}",
                String::from_utf8_lossy(&output.stderr)
            ))),
        }
    }

    fn parse(words: &[String]) -> Result<Self> {
        let refuse = || Error::new(ErrorKind::Config, format!("{words:?} is no point"));
        let [task, picture, megapixels, strokes, threads] = words else {
            return Err(refuse());
        };
        let named = Task::ALL.into_iter().find(|(_, name)| name == task);
        Ok(Self {
            task: named.ok_or_else(refuse)?.0,
            picture: picture.clone(),
            megapixels: megapixels.parse().map_err(|_| refuse())?,
            strokes: strokes.parse().map_err(|_| refuse())?,
            threads: threads.parse().map_err(|_| refuse())?,
        })
    }

    /// Prints seconds and peak bytes.
    fn measure(&self) -> Result<()> {
        let picture = resampled(&Image::open(&self.picture)?, self.megapixels * 1e6)?;
        let seconds = match self.task {
            Task::Backward => self.backward(&picture),
            Task::Stages => self.fit(&picture, Preset::Draft, false)?,
            Task::Fit => self.fit(&picture, Preset::Balanced, true)?,
        };
        let peak = Usage::now().peak_rss_bytes.unwrap_or(0);
        println!("{seconds} {peak}");
        Ok(())
    }

    /// Strokes of one size that cover the picture [`DEPTH`] times, whatever their number.
    fn backward(&self, picture: &Image) -> f64 {
        let target = Canvas::from_image(picture);
        let grid = target.grid();
        let strokes = self
            .size((grid.width * grid.height) as f32)
            .strokes(grid, self.strokes);
        let objective = Objective::new(Loss::L2, &target);
        let level = Simd::Auto.level().expect("every machine has a SIMD level");
        pool(self.threads).install(|| {
            let mut renderer = Renderer::new(grid, level);
            let mut gradients = Gradients::default();
            let base = Base::Flat(GROUND);
            let mut run = || {
                renderer.backward(&strokes, EDGE, base, &objective, &mut gradients);
                black_box(&gradients);
            };
            let [once] = fastest(1, [&mut run]);
            let rounds = (2.0 / once).clamp(5.0, 100.0) as usize;
            let [best] = fastest(rounds, [&mut run]);
            best
        })
    }

    /// Four radii long, half opaque.
    fn size(&self, pixels: f32) -> Size {
        let of_radius = |radius_px: f32| Size {
            radius_px,
            length_px: 4.0 * radius_px,
            opacity: 0.5,
        };
        let wanted = DEPTH * pixels / self.strokes as f32;
        // The area grows with the radius: halve the interval until it is small.
        let (mut low, mut high) = (0.0, pixels.sqrt());
        for _ in 0..40 {
            let middle = f32::midpoint(low, high);
            if of_radius(middle).area_px() < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        of_radius(high)
    }

    fn fit(&self, picture: &Image, preset: Preset, polish: bool) -> Result<f64> {
        let config = Config {
            budget: Budget {
                strokes: Some(self.strokes),
                ..Budget::default()
            },
            preset,
            polish,
            ..Config::default()
        };
        let execution = Execution {
            threads: Some(self.threads),
            ..Execution::default()
        };
        let mut done = Ok(());
        let [seconds] = fastest(
            1,
            [&mut || done = fit::fit(picture, &config, &execution, &mut ()).map(drop)],
        );
        done.map(|()| seconds)
    }
}

/// `image` at about `pixels` pixels, linearly interpolated.
fn resampled(image: &Image, pixels: f64) -> Result<Image> {
    let (from_width, from_height) = (image.width(), image.height());
    let zoom = (pixels / (from_width * from_height) as f64).sqrt();
    let size = |side: usize| ((side as f64 * zoom).round() as usize).max(1);
    let (width, height) = (size(from_width), size(from_height));
    let columns: Vec<_> = (0..width).map(|x| between(x, width, from_width)).collect();
    let planes = image.planes().each_ref().map(|plane| {
        let mut to = Vec::with_capacity(width * height);
        for y in 0..height {
            let (top, below) = between(y, height, from_height);
            let bottom = (top + 1).min(from_height - 1);
            for &(left, beside) in &columns {
                let right = (left + 1).min(from_width - 1);
                let row = |y: usize| {
                    let (a, b) = (plane[y * from_width + left], plane[y * from_width + right]);
                    a + beside * (b - a)
                };
                to.push(row(top) + below * (row(bottom) - row(top)));
            }
        }
        to
    });
    Image::new(width, height, planes)
}

/// Where pixel `i` of `count` lies among `from`: the one before, and how far from it.
fn between(i: usize, count: usize, from: usize) -> (usize, f32) {
    let at = (i as f64 + 0.5) * from as f64 / count as f64 - 0.5;
    let at = at.clamp(0.0, (from - 1) as f64);
    (at as usize, at.fract() as f32)
}

/// Draws 24 megapixels with the program itself.
fn program(picture: &str) -> Result<()> {
    let io = |e: std::io::Error| Error::new(ErrorKind::Config, e.to_string());
    let folder = tempfile::tempdir().map_err(io)?;
    let at = |name: &str| folder.path().join(name);
    let large = resampled(&Image::open(picture)?, 24e6)?;
    fs::write(at("in.png"), large.encode_png()?).map_err(io)?;
    drop(large);
    let status = Command::new(env!("CARGO_BIN_EXE_strokefit"))
        .arg("fit")
        .args([at("in.png").as_os_str(), "-o".as_ref()])
        .arg(at("out.svg"))
        .args(["--strokes", "20000", "--preset", "draft", "-q", "--report"])
        .arg(at("report.json"))
        .status()
        .map_err(io)?;
    assert!(status.success(), "the fit failed: {status}");
    let report = fs::read(at("report.json")).map_err(io)?;
    let report: FitReport = serde_json::from_slice(&report).expect("a report is JSON");
    let peak = report.peak_rss_bytes.unwrap_or(0) as f64 / GIB;
    println!(
        "\nstrokefit fit, {}×{} px, {} strokes, draft: {:.1} s, CPU {:.1} s, {:.2} dB, peak {peak:.2} GiB",
        report.input.width,
        report.input.height,
        report.strokes,
        report.wall_s,
        report.cpu_s.unwrap_or(f64::NAN),
        report.fidelity.psnr_db
    );
    let verdict = if peak <= MOST_GIB {
        "holds"
    } else {
        "does not hold"
    };
    println!("claim, {MOST_GIB} GiB or less: {verdict}");
    Ok(())
}
