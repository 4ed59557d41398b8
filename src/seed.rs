//! Seeding: from the residual to candidate strokes, ranked by closed-form gain.
//!
//! The picture is cut in cells. In each, the pixel where the smoothed squared residual is largest is
//! probed with a fixed set of shapes, dots and capsules of three radii, two lengths and eight angles,
//! each with its best colour and opacity in closed form ([`crate::render::probe`]); the best one is
//! the cell's candidate. More cells are probed than strokes are wanted and the best are kept, which
//! was worth 0.2 dB over one cell per stroke.
//!
//! Large strokes are sought in a reduced picture, so that a probe costs the same at every scale.

use fearless_simd::Level;
use rayon::prelude::*;

use crate::image::Image;
use crate::render::probe::{PATCH_CENTER, Patch, Template, best};
use crate::render::{Canvas, Params};

/// Radii of the probed shapes, in units of the scale.
const RADII: [f32; 3] = [0.3, 0.55, 1.0];
/// Lengths of the probed capsules, in units of the scale.
const LENGTHS: [f32; 2] = [2.0, 4.5];
/// Directions of the probed capsules, evenly over half a turn.
const ANGLES: usize = 8;
/// Least radius of a probed shape, px of the reduced picture: half a pixel and the edge.
const LEAST_RADIUS: f32 = 0.52;
/// The scale is brought below this, px, by halving the picture: the largest shape, 4.5 + 2 scales
/// long, must fit the 32 px of a patch.
const SCALE_LIMIT: f32 = 4.0;

/// What is sought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    /// How many strokes.
    pub count: usize,
    /// Their typical radius, px.
    pub scale: f32,
    /// Cells probed per stroke wanted, at least 1.
    pub oversampling: f32,
    /// Candidates less opaque than this are not proposed; 1 for opaque drawings.
    pub least_opacity: f32,
}

/// A proposed stroke and the squared error (summed over pixels and channels) it would remove alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// The stroke.
    pub stroke: Params,
    /// Above 0.
    pub gain: f32,
}

/// The target and its reductions by 2, 4, 8 …
#[derive(Debug)]
pub struct Pyramid {
    levels: Vec<Image>,
}

impl Pyramid {
    /// The reductions of `image` by powers of 2, down to a side of 16 px.
    pub fn new(image: Image) -> Self {
        let mut levels = vec![image];
        while let Some(last) = levels.last().filter(|l| l.width().min(l.height()) >= 32) {
            let half = last.halved();
            levels.push(half);
        }
        Self { levels }
    }

    /// How many times the picture is halved for strokes of `scale` px.
    fn level(&self, scale: f32) -> usize {
        let halvings = (scale / SCALE_LIMIT).log2().ceil().max(0.0) as usize;
        halvings.min(self.levels.len() - 1)
    }
}

/// Candidates for strokes on top of `canvas`, best first; at most `wanted.count`, and only such as
/// remove error.
pub fn propose(level: Level, target: &Pyramid, canvas: &Canvas, wanted: Wanted) -> Vec<Candidate> {
    let halvings = target.level(wanted.scale);
    let target = &target.levels[halvings];
    let canvas = (0..halvings).fold(canvas.to_image(), |image, _| image.halved());
    let reduction = (1 << halvings) as f32;
    let scale = (wanted.scale / reduction).min(SCALE_LIMIT);
    let templates = templates(level, scale);
    let energy = smoothed_energy(target, &canvas, (scale / 2.0).round() as usize);
    let cells = Cells::new(&canvas, wanted.count as f32 * wanted.oversampling);
    let gain_scale = reduction * reduction;
    let mut candidates: Vec<Candidate> = (0..cells.len())
        .into_par_iter()
        .map_init(Patch::new, |patch, cell| {
            let (x, y) = cells.peak(cell, &energy);
            patch.fill(target, &canvas, x, y);
            let (index, probe) = best(level, &templates, patch, wanted.least_opacity)?;
            let center = [x, y].map(|v| (v as f32 + 0.5) * reduction);
            let stroke = probe.stroke(templates[index].shape(), center, reduction);
            (probe.gain > 0.0).then_some(Candidate {
                stroke,
                gain: probe.gain * gain_scale,
            })
        })
        .flatten()
        .collect();
    candidates.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    candidates.truncate(wanted.count);
    candidates
}

fn templates(level: Level, scale: f32) -> Vec<Template> {
    let mut shapes = Vec::new();
    for radius in RADII.map(|r| (r * scale).max(LEAST_RADIUS)) {
        shapes.push(shape(radius, 0.0, 0.0));
        for length in LENGTHS.map(|l| l * scale) {
            shapes.extend((0..ANGLES).map(|k| {
                let angle = std::f32::consts::PI * k as f32 / ANGLES as f32;
                shape(radius, length, angle)
            }));
        }
    }
    shapes
        .into_iter()
        .map(|shape| Template::new(level, shape))
        .collect()
}

/// A shape about the centre of a patch.
fn shape(radius: f32, length: f32, angle: f32) -> Params {
    let (dx, dy) = (angle.cos() * length / 2.0, angle.sin() * length / 2.0);
    let c = PATCH_CENTER;
    [c - dx, c - dy, c + dx, c + dy, radius, 0.0, 0.0, 0.0, 1.0]
}

/// The squared residual, summed over channels and averaged over boxes of side `2·radius + 1`.
fn smoothed_energy(target: &Image, canvas: &Image, radius: usize) -> Vec<f32> {
    let (width, height) = (canvas.width(), canvas.height());
    let mut energy = vec![0.0; width * height];
    for (t, c) in target.planes().iter().zip(canvas.planes()) {
        for ((energy, t), c) in energy.iter_mut().zip(t).zip(c) {
            *energy += (t - c) * (t - c);
        }
    }
    let mut rows = vec![0.0; width * height];
    for (out, row) in rows.chunks_exact_mut(width).zip(energy.chunks_exact(width)) {
        box_sums(row.iter().copied(), radius, out.iter_mut());
    }
    for x in 0..width {
        let column = rows[x..].iter().step_by(width).copied();
        box_sums(column, radius, energy[x..].iter_mut().step_by(width));
    }
    energy
}

/// Sums over windows of `2·radius + 1` values, cut at both ends.
fn box_sums<'a>(
    values: impl Iterator<Item = f32> + Clone,
    radius: usize,
    out: impl Iterator<Item = &'a mut f32>,
) {
    let mut entering = values.clone().chain(std::iter::repeat_n(0.0, radius));
    let leaving = std::iter::repeat_n(0.0, radius + 1).chain(values);
    let mut sum: f64 = entering.by_ref().take(radius).map(f64::from).sum();
    for ((out, new), old) in out.zip(entering).zip(leaving) {
        sum += f64::from(new) - f64::from(old);
        *out = sum as f32;
    }
}

/// The picture cut in about `count` nearly square cells.
#[derive(Debug, Clone, Copy)]
struct Cells {
    width: usize,
    height: usize,
    columns: usize,
    rows: usize,
}

impl Cells {
    fn new(image: &Image, count: f32) -> Self {
        let (width, height) = (image.width(), image.height());
        let side = ((width * height) as f32 / count.max(1.0)).sqrt().max(1.0);
        let along = |size: usize| ((size as f32 / side).round() as usize).clamp(1, size);
        Self {
            width,
            height,
            columns: along(width),
            rows: along(height),
        }
    }

    fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// The pixel of a cell where `energy` is largest; the first of equals.
    fn peak(&self, cell: usize, energy: &[f32]) -> (usize, usize) {
        let (column, row) = (cell % self.columns, cell / self.columns);
        let span = |i: usize, n: usize, size: usize| i * size / n..(i + 1) * size / n;
        let xs = span(column, self.columns, self.width);
        let ys = span(row, self.rows, self.height);
        let mut peak = (xs.start, ys.start);
        for y in ys {
            for x in xs.clone() {
                if energy[y * self.width + x] > energy[peak.1 * self.width + peak.0] {
                    peak = (x, y);
                }
            }
        }
        peak
    }
}
