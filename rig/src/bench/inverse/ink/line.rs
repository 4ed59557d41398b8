//! Lines of ink whose width varies, and their pictures.
//!
//! A line is the union of the discs at its samples and of the *uneven capsules* between neighbours: the convex hulls of two discs.
//! With `L = |b − a|`, `u = (b − a)/L`, `k = (ra − rb)/L`, `c = √(1 − k²)`, `x = (p − a)·u` and `y = |(p − a) × u|`, the
//! disc nearest to a point `p` is at `h = clamp((x − y·k/c)/L, 0, 1)`, and `p` is `ra + h·(rb − ra) − |p − a − h·(b − a)|` px
//! within the capsule. Where one disc contains the other (`|k| ≥ 1`) the capsule is that disc.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::lab::unread;
use strokefit::image::Image;
use strokefit::math::Point;
use strokefit::{Error, ErrorKind, Result};

/// Samples of a px along a side in pictures of lines.
const SAMPLES: usize = 8;

/// Greatest distance of neighbouring samples of a line, px.
const SPACING_PX: f64 = 1.0;

/// A line: x, y and half its width at samples along it, px.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct Line {
    /// At least one.
    pub(super) samples: Vec<[f64; 3]>,
}

impl Line {
    /// The line through points with a radius each, with samples about 1 px apart, to a thousandth of a px.
    pub(super) fn through(points: &[[f64; 3]]) -> Self {
        let mut samples: Vec<[f64; 3]> = points.first().copied().into_iter().collect();
        let mut since = 0.0;
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let length = place(a).distance(place(b));
            let mut at = SPACING_PX - since;
            while at <= length {
                samples.push(between(a, b, at / length));
                at += SPACING_PX;
            }
            since = length - (at - SPACING_PX);
        }
        samples.extend(points.last().filter(|_| since > 0.0));
        for value in samples.iter_mut().flatten() {
            *value = (*value * 1000.0).round() / 1000.0;
        }
        Self { samples }
    }

    /// The centre line through points, with a radius at each share of its length.
    pub(super) fn with_profile(points: &[Point], radius: impl Fn(f64) -> f64) -> Self {
        let flat: Vec<[f64; 3]> = points.iter().map(|p| [p.x, p.y, 0.0]).collect();
        let mut line = Self::through(&flat);
        let last = line.samples.len().max(2) as f64 - 1.0;
        for (i, sample) in line.samples.iter_mut().enumerate() {
            sample[2] = (radius(i as f64 / last) * 1000.0).round() / 1000.0;
        }
        line
    }

    /// Visits the samples of a grid, `per_px` along a side of a px, that are no farther than `beyond_px` from a capsule of the
    /// line, with how deep each lies in that capsule, px.
    fn visit(
        &self,
        [width, height]: [usize; 2],
        per_px: usize,
        beyond_px: f64,
        mut see: impl FnMut(usize, f64),
    ) {
        let q = per_px as f64;
        let range = |low: f64, high: f64, side: usize| {
            let low = (low * q).floor().max(0.0) as usize;
            low..((high * q).ceil().max(0.0) as usize).min(side * per_px)
        };
        let ends = self.samples.windows(2).map(|pair| [pair[0], pair[1]]);
        let only = self.samples.first().filter(|_| self.samples.len() == 1);
        for [a, b] in ends.chain(only.map(|dot| [*dot, *dot])) {
            let reach = a[2].max(b[2]) + beyond_px;
            let [left, right] = [a[0].min(b[0]) - reach, a[0].max(b[0]) + reach];
            let [top, bottom] = [a[1].min(b[1]) - reach, a[1].max(b[1]) + reach];
            for j in range(top, bottom, height) {
                for i in range(left, right, width) {
                    let p = Point::new((i as f64 + 0.5) / q, (j as f64 + 0.5) / q);
                    let depth = depth_px(p, a, b);
                    if depth > -beyond_px {
                        see(j * width * per_px + i, depth);
                    }
                }
            }
        }
    }

    /// The samples of a grid, `per_px` along a side of a px, that the line covers when each side of it is `wider_px` farther out, in
    /// order.
    pub(super) fn covered(&self, size: [usize; 2], per_px: usize, wider_px: f64) -> Vec<usize> {
        let mut covered = Vec::new();
        self.visit(size, per_px, wider_px, |i, _| covered.push(i));
        covered.sort_unstable();
        covered.dedup();
        covered
    }
}

/// How far `p` is within the capsule from `a` to `b`, px; negative outside.
fn depth_px(p: Point, a: [f64; 3], b: [f64; 3]) -> f64 {
    let (away, axis) = (p - place(a), place(b) - place(a));
    let length = axis.hypot();
    let k = (a[2] - b[2]) / length;
    // Without length, not a number.
    if k.is_nan() || k.abs() >= 1.0 {
        let [to_a, to_b] = [a, b].map(|end| end[2] - p.distance(place(end)));
        return to_a.max(to_b);
    }
    let (x, y) = (away.dot(axis) / length, away.cross(axis).abs() / length);
    let h = ((x - y * k / (1.0 - k * k).sqrt()) / length).clamp(0.0, 1.0);
    let nearest = between(a, b, h);
    nearest[2] - p.distance(place(nearest))
}

/// The centre of a sample.
pub(super) fn place([x, y, _]: [f64; 3]) -> Point {
    Point::new(x, y)
}

/// The sample at a share of the way from `a` to `b`.
pub(super) fn between(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] + share * (b[k] - a[k]))
}

/// The picture of black lines on white: each px is as dark as the share of its 8 × 8 samples that are covered.
///
/// # Errors
/// As [`Image::from_fn`].
pub(super) fn picture(lines: &[Line], [width, height]: [usize; 2]) -> Result<Image> {
    let row = width * SAMPLES;
    let mut covered = vec![false; row * height * SAMPLES];
    for line in lines {
        line.visit([width, height], SAMPLES, 0.0, |i, _| covered[i] = true);
    }
    let mut counts = vec![0_usize; width * height];
    for (i, _) in covered.iter().enumerate().filter(|(_, is)| **is) {
        counts[i / row / SAMPLES * width + i % row / SAMPLES] += 1;
    }
    let whole = SAMPLES * SAMPLES;
    Image::from_fn(width, height, 1, |x, y, _| {
        let light = whole - counts[y * width + x];
        ((light * 255 + whole / 2) / whole) as u8
    })
}

/// The lines of a JSON file: a list of lines, each a list of `[x, y, radius]`.
///
/// # Errors
/// [`ErrorKind::Io`] when it cannot be read, [`ErrorKind::Config`] when it has no lines or other things; both name it.
pub(super) fn read(path: &Path) -> Result<Vec<Line>> {
    let text = std::fs::read_to_string(path).map_err(|cause| unread(path, cause))?;
    let refused = |why: String| {
        let message = format!(
            "{}: {why}: give a list of lines, each a list of [x, y, half the width] in px",
            path.display()
        );
        Error::new(ErrorKind::Config, message)
    };
    let lines: Vec<Line> = serde_json::from_str(&text).map_err(|e| refused(e.to_string()))?;
    if lines.is_empty() {
        return Err(refused("no lines".into()));
    }
    for (i, line) in lines.iter().enumerate() {
        let wrong = |s: &&[f64; 3]| s[2] < 0.0 || s.iter().any(|value| !value.is_finite());
        match line.samples.iter().find(wrong) {
            Some(sample) => return Err(refused(format!("line {i} has {sample:?}"))),
            None if line.samples.is_empty() => return Err(refused(format!("line {i} is empty"))),
            None => {}
        }
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_is_the_hull_of_its_discs() {
        let (a, b) = ([0.0, 0.0, 3.0], [10.0, 0.0, 1.0]);
        // On the tangent, whose normal is (k, c), and beyond both ends.
        let k = 0.2;
        let c = (1.0_f64 - k * k).sqrt();
        for h in [0.0, 0.4, 1.0] {
            let r = 3.0 - 2.0 * h;
            let p = Point::new(10.0 * h + r * k, r * c);
            assert!(depth_px(p, a, b).abs() < 1e-12, "{h}");
        }
        assert_eq!(depth_px(Point::new(-4.0, 0.0), a, b), -1.0);
        assert_eq!(depth_px(Point::new(12.0, 0.0), a, b), -1.0);
        // One disc in the other, and a dot.
        assert_eq!(depth_px(Point::new(0.0, 1.0), a, [1.0, 0.0, 1.0]), 2.0);
        assert_eq!(depth_px(Point::new(0.0, 1.0), a, a), 2.0);
    }

    #[test]
    fn a_picture_has_the_area_of_its_lines() {
        let line = Line::with_profile(&[Point::new(8.0, 10.0), Point::new(32.0, 10.0)], |_| 4.0);
        assert_eq!(line.samples.len(), 25);
        let picture = picture(&[line], [40, 20]).unwrap();
        let dark: f64 = picture.planes()[0]
            .iter()
            .map(|v| 1.0 - f64::from(*v))
            .sum();
        let expected = 24.0 * 8.0 + 16.0 * std::f64::consts::PI;
        assert!((dark - expected).abs() < 0.5, "{dark} {expected}");
    }
}
