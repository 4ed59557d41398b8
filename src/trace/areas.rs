//! The areas of one colour in a picture, apart from the canvas behind them.
//!
//! Most pixels of flat art and of drawings of lines have one of few colours. The others are antialiased pixels
//! between two colours. An antialiased pixel belongs to the nearer of the colours beside it, so the border
//! of an area lies where it covers half of a pixel.

use std::borrow::Cow;

use rayon::prelude::*;

use super::tracing::Tracing;
use crate::scene::Rgb;

/// A pixel on one or two mattes: the colour on the first one, and that on the second one or zeros.
pub(super) type Pixel = [f32; 6];

/// One level of 8 bits.
pub(super) const LEVEL: f32 = 1.0 / 255.0;

/// The share of the squared residual that has to lie in areas of few colours, or nothing is traced. Drawings of lines have 0.88 to
/// 1.00, photographs 0.55 to 0.85.
const MIN_FLAT_SHARE: f32 = 0.87;
/// Most colours of a picture, and the share of the squared residual that has to be near to each. Guesses.
const MOST_COLORS: (usize, f32) = (24, 0.004);
/// As [`MOST_COLORS`], of lost details, many of which are pale. Guesses.
const MOST_COLORS_OF_DETAILS: (usize, f32) = (48, 0.001);
/// Pixels that colours are chosen from. A guess.
const SAMPLES: usize = 65_536;
/// Farthest that the pixels of a flat area are from its colour. A guess.
const FLAT: f32 = 0.05;

/// The pixels of target and canvas.
pub(super) struct Pixels<'a> {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) target: Planes<'a>,
    pub(super) canvas: Planes<'a>,
    /// Weight of an error, if not everywhere alike.
    pub(super) weights: Option<&'a [f32]>,
}

/// Red, green and blue on each matte.
#[derive(Debug, Default)]
pub(super) struct Planes<'a>(pub(super) Vec<Cow<'a, [f32]>>);

impl Planes<'_> {
    /// Pixel `i`, row by row.
    pub(super) fn at(&self, i: usize) -> Pixel {
        let mut pixel = [0.0; 6];
        let values = pixel.iter_mut().zip(&self.0);
        values.for_each(|(value, plane)| *value = plane[i]);
        pixel
    }
}

/// Owner of a pixel: the canvas, an area of one of the colours, or nothing that is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Label {
    Canvas,
    Color(u8),
    Unknown,
}

/// The pixels of a picture by colour.
pub(super) struct Areas {
    pub(super) labels: Vec<Label>,
    pub(super) colors: Vec<Pixel>,
}

impl Areas {
    /// The areas, unless little of the squared residual lies in pixels close to one of few colours.
    pub(super) fn of(pixels: &Pixels<'_>, tracing: Tracing) -> Option<Self> {
        let edges = pixels.edges();
        let (colors, flat_share) = colors(pixels, &edges, tracing);
        if flat_share < MIN_FLAT_SHARE && !tracing.is_of_details {
            return None;
        }
        let all = (0..edges.len()).into_par_iter();
        let inner: Vec<Label> = all
            .clone()
            .map(|i| nearest_label(pixels, &colors, tracing.near(), i))
            .collect();
        let label = |i: usize| match edges[i] {
            true => label_beside(pixels, &colors, &edges, &inner, i),
            false => inner[i],
        };
        let labels = all.map(label).collect();
        Some(Self { labels, colors })
    }

    /// The colour of each pixel that has one.
    pub(super) fn colors_of_pixels(&self) -> impl Iterator<Item = Option<u8>> + '_ {
        self.labels.iter().map(|label| match label {
            Label::Color(color) => Some(*color),
            _ => None,
        })
    }
}

/// The label of pixel `i` alone.
fn nearest_label(pixels: &Pixels<'_>, colors: &[Pixel], near: f32, i: usize) -> Label {
    let (target, canvas) = (pixels.target.at(i), pixels.canvas.at(i));
    let mut best = (distance2(&target, &canvas), Label::Canvas);
    for (k, color) in colors.iter().enumerate() {
        let away = distance2(&target, color);
        if away < best.0 {
            best = (away, Label::Color(k as u8));
        }
    }
    if best.0 < 4.0 * near * near {
        best.1
    } else {
        Label::Unknown
    }
}

/// The label of the edge pixel `i`: the nearest one of those around it, which have their own.
fn label_beside(
    pixels: &Pixels<'_>,
    colors: &[Pixel],
    edges: &[bool],
    inner: &[Label],
    i: usize,
) -> Label {
    let target = pixels.target.at(i);
    let mut best = (f32::INFINITY, inner[i]);
    for k in pixels.around(i, 2).filter(|&k| !edges[k]) {
        let away = match inner[k] {
            Label::Canvas => distance2(&target, &pixels.canvas.at(i)),
            Label::Color(c) => distance2(&target, &colors[usize::from(c)]),
            Label::Unknown => continue,
        };
        if away < best.0 {
            best = (away, inner[k]);
        }
    }
    best.1
}

/// The colours of the pixels that differ from the canvas and are no edges, and the share of flat pixels among those.
/// Everything is weighted by the squared residual: what stands out from the canvas is what strokes have to draw.
fn colors(pixels: &Pixels<'_>, edges: &[bool], tracing: Tracing) -> (Vec<Pixel>, f32) {
    let near = tracing.near();
    let (most, least_share) = match tracing.is_of_details {
        true => MOST_COLORS_OF_DETAILS,
        false => MOST_COLORS,
    };
    // Samples: antialiased pixels would add the mixtures of two colours, and what is like the canvas needs no colour.
    let residual2 = |i: usize| distance2(&pixels.target.at(i), &pixels.canvas.at(i));
    let differs = |i: usize| !edges[i] && residual2(i) > near * near;
    let differs: Vec<bool> = (0..edges.len()).into_par_iter().map(differs).collect();
    let count = differs.iter().filter(|differs| **differs).count();
    let stride = count.div_ceil(SAMPLES).max(1);
    let samples = (0..edges.len()).filter(|&i| differs[i]).step_by(stride);
    let samples: Vec<(Pixel, f32)> = samples
        .map(|i| (pixels.target.at(i), residual2(i)))
        .collect();
    let all: f32 = samples.iter().map(|(_, weight)| weight).sum();
    // Clusters: the first round begins one wherever none is near, and so needs no number of them; k-means follows.
    let mut means: Vec<(Pixel, f32)> = Vec::new();
    for round in 0..3 {
        let mut sums: Vec<(Pixel, f32)> = means.iter().map(|_| ([0.0; 6], 0.0)).collect();
        for (pixel, weight) in &samples {
            let k = match nearest(&means, pixel, near) {
                Some(k) => k,
                None if round == 0 && means.len() < 4 * most => {
                    means.push((*pixel, 0.0));
                    sums.push(([0.0; 6], 0.0));
                    means.len() - 1
                }
                None => continue,
            };
            let (sum, count) = &mut sums[k];
            let channels = sum.iter_mut().zip(pixel);
            channels.for_each(|(s, p)| *s += weight * p);
            *count += weight;
        }
        for ((mean, weight), (sum, count)) in means.iter_mut().zip(sums) {
            if count > 0.0 {
                *mean = sum.map(|s| s / count);
            }
            *weight = count;
        }
        means.retain(|(_, weight)| *weight > least_share * all);
    }
    means.sort_by(|a, b| b.1.total_cmp(&a.1));
    means.truncate(most);
    // The share tells drawings from photographs, whose pixels are near to a mean and not like it.
    let is_flat = |(pixel, _): &&(Pixel, f32)| nearest(&means, pixel, FLAT).is_some();
    let flat: f32 = samples
        .iter()
        .filter(is_flat)
        .map(|(_, weight)| weight)
        .sum();
    (
        means.into_iter().map(|(mean, _)| mean).collect(),
        flat / all.max(f32::MIN_POSITIVE),
    )
}

fn nearest(means: &[(Pixel, f32)], pixel: &Pixel, limit: f32) -> Option<usize> {
    let mut best = (limit * limit, None);
    for (k, (mean, _)) in means.iter().enumerate() {
        let away = distance2(mean, pixel);
        if away < best.0 {
            best = (away, Some(k));
        }
    }
    best.1
}

impl Pixels<'_> {
    /// True if each pixel is one of an edge: its colour lies between those of its neighbours on opposite sides.
    fn edges(&self) -> Vec<bool> {
        let all = (0..self.width * self.height).into_par_iter();
        all.map(|i| self.is_edge(i)).collect()
    }

    fn is_edge(&self, i: usize) -> bool {
        let pixel = self.target.at(i);
        let (x, y) = (i % self.width, i / self.width);
        let at = |dx: isize, dy: isize| {
            let x = x.checked_add_signed(dx).filter(|&x| x < self.width)?;
            let y = y.checked_add_signed(dy).filter(|&y| y < self.height)?;
            Some(self.target.at(y * self.width + x))
        };
        [(1, 0), (0, 1), (1, 1), (1, -1)]
            .iter()
            .any(|&(dx, dy)| match (at(-dx, -dy), at(dx, dy)) {
                (Some(a), Some(b)) => is_between(&a, &b, &pixel),
                _ => false,
            })
    }

    /// Share of pixel `i` that a stroke of `color` covers, if nothing else does.
    pub(super) fn coverage(&self, i: usize, color: &Pixel) -> f32 {
        let (target, canvas) = (self.target.at(i), self.canvas.at(i));
        let along: f32 = (0..6)
            .map(|k| (target[k] - canvas[k]) * (color[k] - canvas[k]))
            .sum();
        (along / distance2(color, &canvas).max(1e-6)).clamp(0.0, 1.0)
    }

    /// The pixel at a place of the picture plane.
    pub(super) fn at(&self, [x, y]: [f32; 2]) -> Option<usize> {
        let is_inside = x >= 0.0 && y >= 0.0;
        let (x, y) = (x as usize, y as usize);
        (is_inside && x < self.width && y < self.height).then_some(y * self.width + x)
    }

    /// True if nothing is drawn yet at pixel `i` of a page that is on a black and a white matte.
    pub(super) fn is_clear(&self, i: usize) -> bool {
        through(&self.canvas.at(i)) > 1.0 - LEVEL
    }

    /// The pixels at most `reach` columns and rows away from `i`.
    pub(super) fn around(&self, i: usize, reach: usize) -> impl Iterator<Item = usize> + '_ {
        let (x, y) = (i % self.width, i / self.width);
        let rows = y.saturating_sub(reach)..(y + reach + 1).min(self.height);
        let columns = x.saturating_sub(reach)..(x + reach + 1).min(self.width);
        rows.flat_map(move |y| columns.clone().map(move |x| y * self.width + x))
    }
}

/// True if `pixel` is a mixture of two clearly different ones.
fn is_between(a: &Pixel, b: &Pixel, pixel: &Pixel) -> bool {
    let length2 = distance2(a, b);
    if length2 < 0.02 {
        return false;
    }
    let along: f32 = (0..6).map(|k| (pixel[k] - a[k]) * (b[k] - a[k])).sum();
    let share = along / length2;
    (0.08..0.92).contains(&share) && distance2(a, pixel) - share * along < 0.02 * length2
}

/// The mixture of two pixels that has this share of `b`.
pub(super) fn mix(a: &Pixel, b: &Pixel, share: f32) -> Pixel {
    std::array::from_fn(|k| a[k] + share * (b[k] - a[k]))
}

pub(super) fn distance2(a: &Pixel, b: &Pixel) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// The colour of something opaque that looks like `pixel` on so many mattes, in the mean.
pub(super) fn color(pixel: &Pixel, mattes: usize) -> Rgb {
    [0, 1, 2].map(|k| match mattes {
        1 => pixel[k].clamp(0.0, 1.0),
        _ => (0.5 * (pixel[k] + pixel[k + 3])).clamp(0.0, 1.0),
    })
}

/// The colour and the opacity of what looks like `pixel` on a clear page, on so many mattes.
pub(super) fn ink(pixel: &Pixel, mattes: usize) -> (Rgb, f32) {
    if mattes == 1 || is_opaque(pixel) {
        return (color(pixel, mattes), 1.0);
    }
    let opacity = 1.0 - through(pixel);
    let own = [0, 1, 2].map(|k| (pixel[k] / opacity.max(LEVEL)).clamp(0.0, 1.0));
    (own, opacity)
}

/// The share of light that a colour on a black and a white matte lets through.
pub(super) fn through(pixel: &Pixel) -> f32 {
    let shines = (0..3).map(|k| pixel[k + 3] - pixel[k]);
    (shines.sum::<f32>() / 3.0).clamp(0.0, 1.0)
}

/// True if a colour on a black and a white matte is opaque.
pub(super) fn is_opaque(pixel: &Pixel) -> bool {
    through(pixel) < OPAQUE * LEVEL
}

/// A colour whose pixels on a black and a white matte differ by less is opaque, levels. A guess.
const OPAQUE: f32 = 5.0;

/// The largest difference of a channel.
pub(super) fn away(a: &Pixel, b: &Pixel) -> f32 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f32::max)
}
