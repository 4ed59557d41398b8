//! Growth of the time and memory of fits with strokes, pixels and threads.

use std::path::Path;

use super::programs::{Cost, STROKEFIT};
use crate::report::scaling::{LARGEST, PointEntry, ScalingReport, SeriesEntry};
use strokefit::Result;
use strokefit::image::Image;
use strokefit::math;
use strokefit::rng;

/// Values that a series keeps unless it varies them: pixels, and strokes.
const FIXED: [f64; 2] = [1e6, 5000.0];
/// Values in a short run.
const FIXED_SHORT: [f64; 2] = [0.1e6, 1000.0];

/// Tasks and their options: a draft without polish, as quick as there is, and the default fit.
const STAGES: [&str; 2] = ["stages", "--preset draft --no-polish"];
const FIT: [&str; 2] = ["fit", "--preset balanced"];

/// A task, what grows, and its values from small to large.
type Series = ([&'static str; 2], &'static str, Vec<f64>);

fn series(short: bool) -> Vec<Series> {
    let threads = || thread_counts().iter().map(|&n| n as f64).collect();
    if short {
        return vec![
            (STAGES, "strokes", vec![300.0, 1e3, 3e3]),
            (STAGES, "pixels", vec![0.05e6, 0.1e6, 0.2e6]),
            (STAGES, "threads", threads()),
        ];
    }
    vec![
        (STAGES, "strokes", vec![100.0, 1e3, 1e4, 1e5]),
        (STAGES, "pixels", vec![0.05e6, 0.2e6, 1e6, 4e6, 24e6]),
        (STAGES, "threads", threads()),
        (FIT, "strokes", vec![300.0, 1e3, 3e3]),
        (FIT, "pixels", vec![0.05e6, 0.2e6, 0.8e6]),
        (FIT, "threads", threads()),
    ]
}

/// 1, 2, 4, … and all of the machine's threads.
pub fn thread_counts() -> Vec<usize> {
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    let doubling = std::iter::successors(Some(1), |n| Some(2 * n));
    let mut counts: Vec<usize> = doubling.take_while(|&n| n < all).collect();
    counts.push(all);
    counts
}

/// Measures all series on `picture`, or on a synthetic one, and says a line for each. A point that cannot be
/// measured counts as a failure of its series.
///
/// # Errors
/// When the picture cannot be read.
pub fn run(
    short: bool,
    picture: Option<&Path>,
    say: &mut dyn FnMut(&str),
) -> Result<ScalingReport> {
    let picture = picture.map(Image::open).transpose()?;
    let picture = picture.map(|picture| picture.flattened([1.0; 3]));
    let mut report = ScalingReport::default();
    let fixed = if short { FIXED_SHORT } else { FIXED };
    let all = thread_counts().pop().unwrap_or(1) as f64;
    for ([task, options], axis, values) in series(short) {
        let (mut measured, mut points, mut failures) = (Vec::new(), Vec::new(), Vec::new());
        for &value in &values {
            let along = |name, fixed| if axis == name { value } else { fixed };
            let size = [
                along("pixels", fixed[0]),
                along("strokes", fixed[1]),
                along("threads", all),
            ];
            match point(picture.as_ref(), options, size) {
                Ok(point) => {
                    measured.push(value);
                    points.push(point);
                }
                Err(error) => failures.push(format!("at {value}: {error}")),
            }
        }
        let entry = SeriesEntry::new(task, axis, &measured, points).failing(failures);
        say(&entry.line());
        report.series.push(entry);
    }
    if !short {
        let [pixels, strokes] = LARGEST;
        match point(picture.as_ref(), "--preset draft", [pixels, strokes, all]) {
            Ok(point) => report.largest = Some(point),
            Err(error) => report.largest_failure = Some(error.to_string()),
        }
        report.largest_line().iter().for_each(|line| say(line));
    }
    Ok(report)
}

/// Measures a fit.
fn point(
    picture: Option<&Image>,
    options: &str,
    [pixels, strokes, threads]: [f64; 3],
) -> Result<PointEntry> {
    let picture = match picture {
        Some(picture) => resampled(picture, pixels)?,
        None => made(pixels)?,
    };
    let settings = format!("{options} --strokes {strokes} --threads {threads}");
    let Cost {
        wall_s,
        cpu_s,
        peak_rss_bytes,
    } = STROKEFIT.trace(&picture, &settings)?.cost;
    Ok(PointEntry {
        megapixels: pixels / 1e6,
        strokes: strokes as usize,
        threads: threads as usize,
        wall_s,
        cpu_s,
        peak_rss_bytes,
    })
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
            let small = Image::filled(40, 30, [0.5; 3]).unwrap();
            for image in [made(pixels), resampled(&small, pixels)] {
                let image = image.unwrap();
                let count = (image.width() * image.height()) as f64;
                assert!((count / pixels - 1.0).abs() < 0.05, "{count} of {pixels}");
            }
        }
    }

    #[test]
    fn threads_double_up_to_all() {
        let counts = thread_counts();
        assert_eq!(counts[0], 1);
        assert!(counts.is_sorted_by(|a, b| a < b), "{counts:?}");
    }
}
