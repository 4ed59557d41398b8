//! Growth of time and memory with strokes, pixels and threads.
//!
//! Each point runs in a process of its own, since a process has only one peak memory.

use std::path::PathBuf;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::measure::{EDGE, StrokeSize, fastest, thread_counts};
use crate::report::scaling::{PointEntry, ScalingReport, SeriesEntry};
use strokefit::Result;
use strokefit::fit::{Budget, Config, Execution, Fitter, Objective, Preset};
use strokefit::image::Image;
use strokefit::loss::Loss;
use strokefit::math;
use strokefit::render::{Backdrop, Canvas, Gradients, Renderer};
use strokefit::report::Usage;
use strokefit::rng;

const BACKDROP: [f32; 3] = [0.5; 3];

/// Values that a series keeps unless it varies them: millions of pixels, and strokes.
const FIXED: (f64, usize) = (1.0, 5000);
/// Values in a short run.
const FIXED_SHORT: (f64, usize) = (0.1, 1000);

/// The largest case: millions of pixels, and strokes.
const LARGEST: (f64, usize) = (24.0, 20_000);

/// Time spent on one point of [`Workload::Backward`], s.
const ROUNDS_S: f64 = 1.0;

/// Work that is timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Workload {
    /// One call of `Renderer::backward`.
    Backward,
    /// A draft without polish, as quick as there is.
    Stages,
    /// A draft.
    Draft,
    /// The default fit.
    Fit,
}

impl Workload {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Backward => "backward",
            Self::Stages => "stages",
            Self::Draft => "draft",
            Self::Fit => "fit",
        }
    }
}

/// Quantity that grows along a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Axis {
    Strokes,
    Pixels,
    Threads,
}

impl Axis {
    fn word(self) -> &'static str {
        match self {
            Self::Strokes => "strokes",
            Self::Pixels => "pixels",
            Self::Threads => "threads",
        }
    }
}

/// One point of a series.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Work that is timed.
    pub workload: Workload,
    /// The picture, resampled to the size; a synthetic one when `None`.
    pub picture: Option<PathBuf>,
    /// Its size, in millions of pixels.
    pub megapixels: f64,
    /// Number of strokes.
    pub strokes: usize,
    /// Number of threads.
    pub threads: usize,
}

/// Points that differ in one thing.
struct Series {
    workload: Workload,
    axis: Axis,
    values: Vec<f64>,
}

/// Measures all series on `picture`, or on a synthetic one, and says a line for each. A point that cannot be
/// measured counts as a failure of its series.
///
/// # Errors
/// When the picture cannot be read.
pub fn run(
    short: bool,
    picture: Option<PathBuf>,
    measure: &dyn Fn(&Point) -> Result<PointEntry>,
    say: &mut dyn FnMut(&str),
) -> Result<ScalingReport> {
    if let Some(path) = &picture {
        Image::open(path)?;
    }
    let mut report = ScalingReport::default();
    for series in if short { brief() } else { thorough() } {
        let entry = series.measured(short, picture.as_ref(), measure);
        say(&entry.line());
        report.series.push(entry);
    }
    if !short {
        let point = Point {
            workload: Workload::Draft,
            picture,
            megapixels: LARGEST.0,
            strokes: LARGEST.1,
            threads: all_threads(),
        };
        match measure(&point) {
            Ok(point) => report.largest = Some(point),
            Err(error) => report.largest_failure = Some(error.to_string()),
        }
        report.largest_line().iter().for_each(|line| say(line));
    }
    Ok(report)
}

fn all_threads() -> usize {
    thread_counts().pop().unwrap_or(1)
}

fn thorough() -> Vec<Series> {
    let decades = [100.0, 300.0, 1e3, 3e3, 1e4, 3e4, 1e5];
    let pixels = [0.05e6, 0.2e6, 1e6, 4e6, 24e6];
    vec![
        Series::new(Workload::Backward, Axis::Strokes, &decades),
        Series::new(Workload::Backward, Axis::Pixels, &pixels),
        Series::of_threads(Workload::Backward),
        Series::new(Workload::Stages, Axis::Strokes, &[100.0, 1e3, 1e4, 1e5]),
        Series::new(Workload::Stages, Axis::Pixels, &pixels),
        Series::of_threads(Workload::Stages),
        Series::new(Workload::Fit, Axis::Strokes, &[300.0, 1e3, 3e3]),
        Series::new(Workload::Fit, Axis::Pixels, &[0.05e6, 0.2e6, 0.8e6]),
        Series::of_threads(Workload::Fit),
    ]
}

fn brief() -> Vec<Series> {
    vec![
        Series::new(Workload::Backward, Axis::Strokes, &[300.0, 3e3, 3e4]),
        Series::new(Workload::Backward, Axis::Pixels, &[0.05e6, 0.2e6, 1e6]),
        Series::of_threads(Workload::Backward),
        Series::new(Workload::Stages, Axis::Strokes, &[300.0, 1e3, 3e3]),
        Series::new(Workload::Stages, Axis::Pixels, &[0.05e6, 0.1e6, 0.2e6]),
        Series::of_threads(Workload::Stages),
    ]
}

impl Series {
    fn new(workload: Workload, axis: Axis, values: &[f64]) -> Self {
        Self {
            workload,
            axis,
            values: values.to_vec(),
        }
    }

    fn of_threads(workload: Workload) -> Self {
        let threads: Vec<f64> = thread_counts().iter().map(|&n| n as f64).collect();
        Self::new(workload, Axis::Threads, &threads)
    }

    fn measured(
        &self,
        short: bool,
        picture: Option<&PathBuf>,
        measure: &dyn Fn(&Point) -> Result<PointEntry>,
    ) -> SeriesEntry {
        let (mut values, mut points, mut failures) = (Vec::new(), Vec::new(), Vec::new());
        for (&value, point) in self.values.iter().zip(self.points(short, picture)) {
            match measure(&point) {
                Ok(point) => {
                    values.push(value);
                    points.push(point);
                }
                Err(error) => failures.push(format!("at {value}: {error}")),
            }
        }
        SeriesEntry::new(self.workload.word(), self.axis.word(), &values, points).failing(failures)
    }

    fn points(&self, short: bool, picture: Option<&PathBuf>) -> Vec<Point> {
        let (megapixels, strokes) = if short { FIXED_SHORT } else { FIXED };
        let point = |&value: &f64| {
            let point = Point {
                workload: self.workload,
                picture: picture.cloned(),
                megapixels,
                strokes,
                threads: all_threads(),
            };
            match self.axis {
                Axis::Strokes => Point {
                    strokes: value as usize,
                    ..point
                },
                Axis::Pixels => Point {
                    megapixels: value / 1e6,
                    ..point
                },
                Axis::Threads => Point {
                    threads: value as usize,
                    ..point
                },
            }
        };
        self.values.iter().map(point).collect()
    }
}

/// Wall and CPU time, s.
#[derive(Debug, Clone, Copy)]
struct Time {
    wall_s: f64,
    cpu_s: Option<f64>,
}

impl Point {
    /// Measures this point. The peak memory of this process is reported as the point's.
    ///
    /// # Errors
    /// When the picture cannot be read or there are too many threads.
    pub fn measure(&self) -> Result<PointEntry> {
        let pixels = self.megapixels * 1e6;
        let picture = match &self.picture {
            Some(path) => resampled(&Image::open(path)?.flattened([1.0; 3]), pixels)?,
            None => made(pixels)?,
        };
        let time = match self.workload {
            Workload::Backward => self.backward(&picture)?,
            Workload::Stages => self.fit(&picture, Preset::Draft, false)?,
            Workload::Draft => self.fit(&picture, Preset::Draft, true)?,
            Workload::Fit => self.fit(&picture, Preset::Balanced, true)?,
        };
        Ok(PointEntry {
            megapixels: self.megapixels,
            strokes: self.strokes,
            threads: self.threads,
            wall_s: time.wall_s,
            cpu_s: time.cpu_s,
            peak_rss_bytes: Usage::now().peak_rss_bytes,
        })
    }

    fn execution(&self) -> Execution {
        Execution {
            threads: Some(self.threads),
            ..Execution::default()
        }
    }

    /// Times the backward pass on strokes of one size, chosen so that any number of them covers the picture
    /// equally often: the shortest wall time of several rounds, and their mean CPU time.
    fn backward(&self, picture: &Image) -> Result<Time> {
        let target = Canvas::from_image(picture);
        let grid = target.grid();
        let size = StrokeSize::covering((grid.width * grid.height) as f32, self.strokes);
        let strokes = size.strokes(grid, self.strokes);
        let objective = Objective::new(Loss::L2, &target);
        let level = self.execution().simd.require()?;
        Ok(self.execution().pool()?.install(|| {
            let mut renderer = Renderer::new(grid, level);
            let mut gradients = Gradients::default();
            let backdrop = Backdrop::Color(BACKDROP);
            let mut run =
                || renderer.backward(&strokes, EDGE, backdrop, &objective, &mut gradients);
            let [once] = fastest(1, [&mut run]);
            let rounds = (ROUNDS_S / once).clamp(5.0, 500.0) as usize;
            let before = Usage::now().cpu_s;
            let [wall_s] = fastest(rounds, [&mut run]);
            let cpu_s = Usage::now().cpu_s.zip(before);
            Time {
                wall_s,
                cpu_s: cpu_s.map(|(now, before)| (now - before) / rounds as f64),
            }
        }))
    }

    fn fit(&self, picture: &Image, preset: Preset, polish: bool) -> Result<Time> {
        let config = Config {
            budget: Budget {
                strokes: Some(self.strokes),
                ..Budget::default()
            },
            preset,
            polish,
            ..Config::default()
        };
        let (start, before) = (Instant::now(), Usage::now().cpu_s);
        Fitter::new(config)
            .execution(self.execution())
            .fit(picture)?;
        Ok(Time {
            wall_s: start.elapsed().as_secs_f64(),
            cpu_s: Usage::now()
                .cpu_s
                .zip(before)
                .map(|(now, before)| now - before),
        })
    }
}

/// A picture of about `pixels` pixels with detail at every scale.
fn made(pixels: f64) -> Result<Image> {
    let height = (pixels / 2.5).sqrt().round().max(1.0) as usize;
    let width = (pixels / height as f64).round().max(1.0) as usize;
    let value = |c: u64, x: f32, y: f32| {
        let wave = |k: u64| {
            let frequency = f32::from(1_u16 << k) * std::f32::consts::PI;
            let angle = std::f32::consts::TAU * rng::draw(1, 2, k, c);
            let (sin, cos) = math::sin_cos(angle);
            math::sin(frequency * (x * cos + y * sin) + angle) / f32::from(1_u16 << k).sqrt()
        };
        0.5 + (0..7).map(wave).sum::<f32>() / 6.0
    };
    let plane = |c| {
        let at = |i: usize| {
            let (x, y) = ((i % width) as f32, (i / width) as f32);
            value(c, x / height as f32, y / height as f32).clamp(0.0, 1.0)
        };
        (0..width * height).map(at).collect()
    };
    Image::new(width, height, [plane(0), plane(1), plane(2)])
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

/// Where pixel `i` of `count` lies among `from` pixels: the index before it, and the fraction beyond.
fn between(i: usize, count: usize, from: usize) -> (usize, f32) {
    let at = (i as f64 + 0.5) * from as f64 / count as f64 - 0.5;
    let at = at.clamp(0.0, (from - 1) as f64);
    (at as usize, at.fract() as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_have_about_the_pixels_asked_for() {
        for pixels in [1.0, 5_000.0, 50_000.0] {
            let (new, small) = (
                made(pixels).unwrap(),
                Image::filled(40, 30, [0.5; 3]).unwrap(),
            );
            let again = resampled(&small, pixels).unwrap();
            for image in [new, again] {
                let count = (image.width() * image.height()) as f64;
                assert!((count / pixels - 1.0).abs() < 0.05, "{count} of {pixels}");
            }
        }
    }

    #[test]
    fn a_point_has_its_time_and_memory() {
        let point = Point {
            workload: Workload::Backward,
            picture: None,
            megapixels: 0.002,
            strokes: 10,
            threads: 1,
        };
        let entry = point.measure().unwrap();
        assert!(entry.wall_s > 0.0 && entry.strokes == 10);
    }
}
