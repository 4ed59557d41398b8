//! The areas of one colour in a picture, apart from the canvas behind them.
//!
//! Most pixels of flat art and of drawings of lines have one of few colours. The others are the antialiased pixels
//! between two of them. An antialiased pixel belongs to the nearer one of the colours beside it, so that the border
//! of an area lies where it covers half of a pixel.

use crate::scene::Rgb;

/// A pixel on one or two mattes: the colour on the first one, and that on the second one or zeros.
pub(super) type Pixel = [f32; 6];

/// The pixels of target and canvas.
pub(super) struct Pixels {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) target: Vec<Pixel>,
    pub(super) canvas: Vec<Pixel>,
    /// How much an error counts, if not everywhere alike.
    pub(super) weights: Option<Vec<f32>>,
}

/// What a pixel belongs to: the canvas, an area of one of the colours, or nothing that is known.
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
    /// The share of the squared residual that lies in pixels close to one of the colours.
    pub(super) flat_share: f32,
}

/// Most colours of a picture.
const MOST_COLORS: usize = 24;
/// Pixels that colours are chosen from.
const SAMPLES: usize = 65_536;
/// Farthest that a pixel may be from its colour.
const NEAR: f32 = 0.12;
/// Farthest that the pixels of a flat area are from its colour.
const FLAT: f32 = 0.05;
/// A colour is one that at least this share of the squared residual is near to.
const LEAST_SHARE: f32 = 0.004;

impl Areas {
    pub(super) fn new(pixels: &Pixels) -> Self {
        let edges = pixels.edges();
        let (colors, flat_share) = colors(pixels, &edges);
        let nearest = |i: usize| {
            let mut best = (
                distance2(&pixels.target[i], &pixels.canvas[i]),
                Label::Canvas,
            );
            for (k, color) in colors.iter().enumerate() {
                let away = distance2(&pixels.target[i], color);
                if away < best.0 {
                    best = (away, Label::Color(k as u8));
                }
            }
            if best.0 < 4.0 * NEAR * NEAR {
                best.1
            } else {
                Label::Unknown
            }
        };
        let inner: Vec<Label> = (0..edges.len()).map(nearest).collect();
        let mut areas = Self {
            labels: inner.clone(),
            colors,
            flat_share,
        };
        for i in (0..edges.len()).filter(|&i| edges[i]) {
            areas.labels[i] = areas.beside(pixels, &edges, &inner, i);
        }
        areas
    }

    /// The label of the edge pixel `i`: the nearest one of those around it.
    fn beside(&self, pixels: &Pixels, edges: &[bool], inner: &[Label], i: usize) -> Label {
        let mut best = (f32::INFINITY, inner[i]);
        for k in pixels.around(i, 2).filter(|&k| !edges[k]) {
            let away = match inner[k] {
                Label::Canvas => distance2(&pixels.target[i], &pixels.canvas[i]),
                Label::Color(c) => distance2(&pixels.target[i], &self.colors[usize::from(c)]),
                Label::Unknown => continue,
            };
            if away < best.0 {
                best = (away, inner[k]);
            }
        }
        best.1
    }
}

/// The colours of the pixels that differ from the canvas and are no edges, and the share of flat pixels among those.
fn colors(pixels: &Pixels, edges: &[bool]) -> (Vec<Pixel>, f32) {
    let residual2 = |i: usize| distance2(&pixels.target[i], &pixels.canvas[i]);
    let differs: Vec<usize> = (0..edges.len())
        .filter(|&i| !edges[i] && residual2(i) > NEAR * NEAR)
        .collect();
    let stride = differs.len().div_ceil(SAMPLES).max(1);
    let samples: Vec<usize> = differs.into_iter().step_by(stride).collect();
    let all: f32 = samples.iter().map(|&i| residual2(i)).sum();
    let mut means: Vec<(Pixel, f32)> = Vec::new();
    for round in 0..3 {
        let mut sums: Vec<(Pixel, f32)> = means.iter().map(|_| ([0.0; 6], 0.0)).collect();
        for &i in &samples {
            let pixel = &pixels.target[i];
            let weight = residual2(i);
            let found = nearest(&means, pixel, NEAR);
            let k = match found {
                Some(k) => k,
                None if round == 0 && means.len() < 4 * MOST_COLORS => {
                    means.push((*pixel, 0.0));
                    sums.push(([0.0; 6], 0.0));
                    means.len() - 1
                }
                None => continue,
            };
            let (sum, count) = &mut sums[k];
            sum.iter_mut()
                .zip(pixel)
                .for_each(|(s, p)| *s += weight * p);
            *count += weight;
        }
        for ((mean, weight), (sum, count)) in means.iter_mut().zip(sums) {
            if count > 0.0 {
                *mean = sum.map(|s| s / count);
            }
            *weight = count;
        }
        means.retain(|(_, weight)| *weight > LEAST_SHARE * all);
    }
    means.sort_by(|a, b| b.1.total_cmp(&a.1));
    means.truncate(MOST_COLORS);
    let is_flat = |&&i: &&usize| nearest(&means, &pixels.target[i], FLAT).is_some();
    let flat: f32 = samples.iter().filter(is_flat).map(|&i| residual2(i)).sum();
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

impl Pixels {
    /// Whether each pixel is one of an edge: its colour lies between those of its neighbours on opposite sides.
    fn edges(&self) -> Vec<bool> {
        (0..self.target.len()).map(|i| self.is_edge(i)).collect()
    }

    fn is_edge(&self, i: usize) -> bool {
        let (x, y) = (i % self.width, i / self.width);
        let at = |dx: isize, dy: isize| {
            let x = x.checked_add_signed(dx).filter(|&x| x < self.width)?;
            let y = y.checked_add_signed(dy).filter(|&y| y < self.height)?;
            Some(&self.target[y * self.width + x])
        };
        [(1, 0), (0, 1), (1, 1), (1, -1)]
            .iter()
            .any(|&(dx, dy)| match (at(-dx, -dy), at(dx, dy)) {
                (Some(a), Some(b)) => is_between(a, b, &self.target[i]),
                _ => false,
            })
    }

    /// How much of pixel `i` a stroke of `color` covers, if nothing else does.
    pub(super) fn coverage(&self, i: usize, color: &Pixel) -> f32 {
        let (target, canvas) = (&self.target[i], &self.canvas[i]);
        let along: f32 = (0..6)
            .map(|k| (target[k] - canvas[k]) * (color[k] - canvas[k]))
            .sum();
        (along / distance2(color, canvas).max(1e-6)).clamp(0.0, 1.0)
    }

    /// The pixel at a place of the picture plane.
    pub(super) fn at(&self, [x, y]: [f32; 2]) -> Option<usize> {
        let is_inside = x >= 0.0 && y >= 0.0;
        let (x, y) = (x as usize, y as usize);
        (is_inside && x < self.width && y < self.height).then_some(y * self.width + x)
    }

    /// The pixels at most `reach` columns and rows away from `i`.
    fn around(&self, i: usize, reach: usize) -> impl Iterator<Item = usize> + '_ {
        let (x, y) = (i % self.width, i / self.width);
        let rows = y.saturating_sub(reach)..(y + reach + 1).min(self.height);
        let columns = x.saturating_sub(reach)..(x + reach + 1).min(self.width);
        rows.flat_map(move |y| columns.clone().map(move |x| y * self.width + x))
    }
}

/// Whether `pixel` is a mixture of two clearly different ones.
fn is_between(a: &Pixel, b: &Pixel, pixel: &Pixel) -> bool {
    let length2 = distance2(a, b);
    if length2 < 0.02 {
        return false;
    }
    let along: f32 = (0..6).map(|k| (pixel[k] - a[k]) * (b[k] - a[k])).sum();
    let share = along / length2;
    (0.08..0.92).contains(&share) && distance2(a, pixel) - share * along < 0.02 * length2
}

pub(super) fn distance2(a: &Pixel, b: &Pixel) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// The colour of an opaque stroke that looks like `pixel` on `mattes` mattes.
pub(super) fn color(pixel: &Pixel, mattes: usize) -> Rgb {
    std::array::from_fn(|k| match mattes {
        1 => pixel[k],
        _ => 0.5 * (pixel[k] + pixel[k + 3]),
    })
}
