//! Seeding: from the residual to candidate strokes, ranked by closed-form gain.
//!
//! The picture is divided into cells, and each cell is represented by the pixel with the largest smoothed squared
//! residual. In the cells where that is largest, seeding probes dots and capsules of three radii, two lengths and eight
//! angles around the pixel, each with its best colour and opacity in closed form ([`crate::render::probe`]). The best
//! shape is the candidate of the cell. There are more cells than strokes wanted, and the best candidates are kept.
//!
//! Large strokes are searched for in a reduced picture, so that a probe costs the same at every scale.

use std::ops::Range;

use fearless_simd::Level;
use rayon::prelude::*;

use crate::image::Image;
use crate::math;
use crate::render::probe::{Patch, Probes};
use crate::render::{Canvas, Params};
use crate::rng;

/// Least radius of a probed shape, px of the reduced picture: a little more than half a pixel.
const MIN_RADIUS: f32 = 0.52;
/// The picture is halved until the scale is at most this, px: the largest shape, 4.5 + 2 scales long, has to fit the
/// 32 px of a patch.
const SCALE_LIMIT: f32 = 4.0;
/// Radii of the probed shapes, in units of the scale. A guess.
const RADII: [f32; 3] = [0.3, 0.55, 1.0];
/// Lengths of the probed capsules, in units of the scale, at most 4.5, so that they fit a patch. A third one of 7.5, in a larger
/// patch: −0.01 dB.
const LENGTHS: [f32; 2] = [2.0, 4.5];
/// Cells per stroke wanted; the best candidates are kept. 1, 2, 4: −0.49, 0, +0.09 dB. More is worse, since all candidates are in the
/// same few spots. Drafts 1.5: −0.18.
const CELLS: f32 = 2.5;
/// Share of the cells that are probed, those with the largest residual. The others hardly ever give a candidate that is kept: with all
/// of them a draft gains 0.01 dB and takes 3 % longer.
const PROBED: f32 = 0.6;

/// Task of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    /// Most candidates.
    pub count: usize,
    /// Their typical radius, px.
    pub scale: f32,
    /// Least opacity of a candidate; 1 for opaque drawings.
    pub min_opacity: f32,
    /// The pyramid level of the canvas; all lengths are in its px.
    pub level: usize,
    /// Key of the random shift of the cells: the seed of the fit and the number of the call, so that no two calls use
    /// the same cells.
    pub key: [u64; 2],
}

/// A proposed stroke and its gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// The stroke.
    pub stroke: Params,
    /// Squared error that the stroke alone would remove, summed over pixels and channels; above 0.
    pub gain: f32,
}

/// The picture and the drawing so far, on one matte.
#[derive(Debug, Clone, Copy)]
pub struct Residual<'a> {
    /// The picture.
    pub target: &'a Pyramid,
    /// The drawing, of the size of the level [`Wanted::level`].
    pub canvas: &'a Canvas,
    /// Weight of an error at each pixel, 0 to 1, in each channel alike; `None` for 1 everywhere.
    pub weights: Option<&'a Pyramid>,
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

    /// The picture halved `level` times.
    ///
    /// # Panics
    /// When `level` is not below [`len`](Self::len).
    pub fn level(&self, level: usize) -> &Image {
        &self.levels[level]
    }

    /// The number of levels, at least 1.
    #[allow(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.levels.len()
    }

    /// Number of times to halve level `from` so that a length of `scale` px becomes at most `limit`, as far as there are
    /// levels.
    pub fn halvings(&self, from: usize, scale: f32, limit: f32) -> usize {
        // scale / 2ⁿ ≤ limit for n ≥ log₂(scale / limit).
        let halvings = math::log2(scale / limit).ceil().max(0.0) as usize;
        halvings.min(self.levels.len() - 1 - from)
    }
}

/// Proposes at most `wanted.count` strokes on top of the canvases of `residuals`, which have one size, best first. Each
/// of them removes error; its gain is the mean over the residuals.
pub fn propose(level: Level, residuals: &[Residual<'_>], wanted: Wanted) -> Vec<Candidate> {
    let Some(first) = residuals.first() else {
        return Vec::new();
    };
    // A picture in which the largest shape fits a patch.
    let halvings = (first.target).halvings(wanted.level, wanted.scale, SCALE_LIMIT);
    let residuals: Vec<Reduced<'_>> = residuals
        .iter()
        .map(|residual| Reduced::new(residual, wanted.level, halvings))
        .collect();
    // Probing happens in px of the reduced picture: shapes, cells and energies are all in these.
    let reduction = (1 << halvings) as f32;
    let scale = (wanted.scale / reduction).min(SCALE_LIMIT);
    let radii = RADII.map(|r| (r * scale).max(MIN_RADIUS));
    let probes = Probes::new(level, &radii, &LENGTHS.map(|l| l * scale));
    // The cells with the largest residual.
    let energy = smoothed_energy(&residuals, (scale / 2.0).round() as usize);
    let cells = Cells::new(
        &residuals[0].canvas,
        wanted.count as f32 * CELLS,
        wanted.key,
    );
    // A reduced pixel stands for reduction² pixels, and the gain is the mean over the mattes.
    let gain_scale = reduction * reduction / residuals.len() as f32;
    let patches = || -> Vec<_> { residuals.iter().map(|_| Patch::new()).collect() };
    // Probe the cells in parallel. The order of the cells is kept, and with the stable sort below it decides between equal gains,
    // whatever the threads.
    let mut candidates: Vec<Candidate> = cells
        .peaks(&energy, PROBED)
        .into_par_iter()
        .map_init(patches, |patches, (x, y)| {
            for (patch, residual) in patches.iter_mut().zip(&residuals) {
                patch.fill(&probes, residual.target, &residual.canvas, x, y);
            }
            let (shape, probe) = probes.best(patches, wanted.min_opacity)?;
            // The centre of the reduced pixel in px of the canvas.
            let center = [x, y].map(|v| (v as f32 + 0.5) * reduction);
            let stroke = probe.stroke(shape, center, reduction);
            // A candidate is small, so the weight at its centre stands for all of it.
            let weight = residuals[0].weight(x, y);
            (probe.gain > 0.0 && weight > 0.0).then_some(Candidate {
                stroke,
                gain: probe.gain * gain_scale * weight,
            })
        })
        .flatten()
        .collect();
    candidates.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    candidates.truncate(wanted.count);
    candidates
}

/// A residual at the resolution of the search.
struct Reduced<'a> {
    target: &'a Image,
    canvas: Image,
    weights: Option<&'a Image>,
}

impl<'a> Reduced<'a> {
    fn new(residual: &Residual<'a>, level: usize, halvings: usize) -> Self {
        Self {
            target: residual.target.level(level + halvings),
            canvas: match halvings {
                // The first halving reads the tiles, which saves a copy of the whole canvas.
                0 => residual.canvas.to_image(),
                _ => (1..halvings).fold(residual.canvas.halved(), |image, _| image.halved()),
            },
            weights: residual
                .weights
                .map(|weights| weights.level(level + halvings)),
        }
    }

    /// Weight of an error at a pixel.
    fn weight(&self, x: usize, y: usize) -> f32 {
        let at = |weights: &Image| weights.planes()[0][y * weights.width() + x];
        self.weights.map_or(1.0, at)
    }
}

/// The squared residual, summed over channels and mattes and over boxes of side `2·radius + 1`.
fn smoothed_energy(residuals: &[Reduced<'_>], radius: usize) -> Vec<f32> {
    let (width, height) = (residuals[0].canvas.width(), residuals[0].canvas.height());
    let mut energy = vec![0.0; width * height];
    // |target − canvas|² of each pixel, summed over mattes and channels.
    let planes = residuals.iter().flat_map(|residual| {
        residual
            .target
            .planes()
            .iter()
            .zip(residual.canvas.planes())
    });
    for (t, c) in planes {
        for ((energy, t), c) in energy.iter_mut().zip(t).zip(c) {
            *energy += (t - c) * (t - c);
        }
    }
    if let Some(weights) = residuals[0].weights {
        let weights = energy.iter_mut().zip(&weights.planes()[0]);
        weights.for_each(|(energy, weight)| *energy *= weight);
    }
    // A box is a product of two spans: sum along the rows, and then down the columns.
    let mut rows = vec![0.0; width * height];
    for (out, row) in rows.chunks_exact_mut(width).zip(energy.chunks_exact(width)) {
        box_sums(row.iter().copied(), radius, out.iter_mut());
    }
    column_sums(&rows, width, radius, &mut energy);
    energy
}

/// Sums over windows of `2·radius + 1` values, clipped at both ends.
fn box_sums<'a>(
    values: impl Iterator<Item = f32> + Clone,
    radius: usize,
    out: impl Iterator<Item = &'a mut f32>,
) {
    // A running sum: the value `radius` ahead enters, the one `radius + 1` behind leaves. In `f64`, or what a bright spot leaves
    // behind by rounding would outweigh dark places after it.
    let mut entering = values.clone().chain(std::iter::repeat_n(0.0, radius));
    let leaving = std::iter::repeat_n(0.0, radius + 1).chain(values);
    let mut sum: f64 = entering.by_ref().take(radius).map(f64::from).sum();
    for ((out, new), old) in out.zip(entering).zip(leaving) {
        sum += f64::from(new) - f64::from(old);
        *out = sum as f32;
    }
}

/// Sums over windows of `2·radius + 1` rows of `width` values, clipped at both ends.
fn column_sums(values: &[f32], width: usize, radius: usize, out: &mut [f32]) {
    let row = |y: usize| values.get(y * width..(y + 1) * width).unwrap_or_default();
    // The same, with a running sum for each column, so that memory is read row by row.
    let mut sums = vec![0.0_f64; width];
    for y in 0..radius {
        sums.iter_mut()
            .zip(row(y))
            .for_each(|(sum, &v)| *sum += f64::from(v));
    }
    for (y, out) in out.chunks_exact_mut(width).enumerate() {
        sums.iter_mut()
            .zip(row(y + radius))
            .for_each(|(sum, &v)| *sum += f64::from(v));
        if let Some(left) = y.checked_sub(radius + 1) {
            sums.iter_mut()
                .zip(row(left))
                .for_each(|(sum, &v)| *sum -= f64::from(v));
        }
        out.iter_mut()
            .zip(&sums)
            .for_each(|(out, &sum)| *out = sum as f32);
    }
}

/// A grid of square cells over the picture, shifted at random.
#[derive(Debug, Clone, Copy)]
struct Cells {
    width: usize,
    height: usize,
    /// Side of a cell, px.
    side: f32,
    /// Part of the first column and row that is outside the picture, px.
    shift: [f32; 2],
    columns: usize,
    rows: usize,
}

impl Cells {
    fn new(image: &Image, count: f32, [seed, call]: [u64; 2]) -> Self {
        let (width, height) = (image.width(), image.height());
        // `count` squares of this side have the picture's area; a cell has at least one pixel.
        let side = ((width * height) as f32 / count.max(1.0)).sqrt().max(1.0);
        // A new shift for each call: the borders of the cells, across which two peaks may be neighbours, fall elsewhere.
        let shift = [0, 1].map(|axis| rng::draw(seed, call, axis, 0) * side);
        let along = |size: usize, shift: f32| ((size as f32 + shift) / side).ceil() as usize;
        Self {
            width,
            height,
            side,
            shift,
            columns: along(width, shift[0]),
            rows: along(height, shift[1]),
        }
    }

    fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Cell `i` of a row or column of `size` px; empty where rounding leaves no pixel.
    fn span(&self, i: usize, shift: f32, size: usize) -> Range<usize> {
        // Neighbours share the expression of their common edge, so cells neither overlap nor leave gaps.
        let edge = |i: usize| ((i as f32 * self.side - shift).max(0.0).ceil() as usize).min(size);
        edge(i)..edge(i + 1)
    }

    /// The pixel of largest `energy` of each cell, for the share `kept` of the cells in which it is largest. Ties may
    /// keep more cells.
    fn peaks(&self, energy: &[f32], kept: f32) -> Vec<(usize, usize)> {
        let energy_at = |&(x, y): &(usize, usize)| energy[y * self.width + x];
        let cells = 0..self.len();
        let mut peaks: Vec<_> = cells.filter_map(|cell| self.peak(cell, energy)).collect();
        let mut energies: Vec<f32> = peaks.iter().map(energy_at).collect();
        // A selection, not a sort: only the threshold is needed, and the peaks stay in the order of their cells.
        let dropped = ((1.0 - kept) * peaks.len() as f32) as usize;
        if dropped > 0 {
            let (_, &mut least, _) = energies.select_nth_unstable_by(dropped, f32::total_cmp);
            peaks.retain(|peak| energy_at(peak) >= least);
        }
        peaks
    }

    /// The pixel of a cell with the largest `energy`, the first one of equals; `None` in an empty cell.
    fn peak(&self, cell: usize, energy: &[f32]) -> Option<(usize, usize)> {
        let xs = self.span(cell % self.columns, self.shift[0], self.width);
        let ys = self.span(cell / self.columns, self.shift[1], self.height);
        let mut peak = None;
        let mut most = f32::NEG_INFINITY;
        for y in ys {
            for x in xs.clone() {
                let e = energy[y * self.width + x];
                if e > most {
                    (most, peak) = (e, Some((x, y)));
                }
            }
        }
        peak
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(width: usize, height: usize) -> Image {
        Image::from_planes(
            width,
            height,
            [0, 1, 2].map(|_| (0..width * height).map(|i| i as f32).collect()),
        )
    }

    #[test]
    fn cells_partition_the_picture() {
        for (width, height, count) in [(37, 23, 40.0), (1, 1, 5.0), (1, 100, 7.0), (64, 64, 1.0)] {
            for call in 0..5 {
                let cells = Cells::new(&ramp(width, height), count, [3, call]);
                let mut hits = vec![0; width * height];
                for cell in 0..cells.len() {
                    for y in cells.span(cell / cells.columns, cells.shift[1], height) {
                        for x in cells.span(cell % cells.columns, cells.shift[0], width) {
                            hits[y * width + x] += 1;
                        }
                    }
                }
                assert!(
                    hits.iter().all(|&n| n == 1),
                    "{width}×{height} in {count}, call {call}"
                );
            }
        }
    }

    #[test]
    fn the_cells_of_most_energy_are_kept() {
        let image = ramp(40, 40);
        let cells = Cells::new(&image, 25.0, [1, 1]);
        let energy = &image.planes()[0];
        let all = cells.peaks(energy, 1.0);
        let kept = cells.peaks(energy, 0.6);
        assert_eq!(kept.len(), all.len() - (0.4 * all.len() as f32) as usize);
        let at = |&(x, y): &(usize, usize)| energy[y * 40 + x];
        let least = kept.iter().map(at).fold(f32::INFINITY, f32::min);
        let dropped = all.iter().filter(|peak| !kept.contains(peak));
        assert!(dropped.map(at).all(|e| e < least));
    }

    #[test]
    fn box_sums_add_their_windows() {
        for radius in [0, 1, 3, 20] {
            let values: Vec<f32> = (0..11).map(|i| (i * i) as f32).collect();
            let mut out = [0.0; 11];
            box_sums(values.iter().copied(), radius, out.iter_mut());
            for (i, &sum) in out.iter().enumerate() {
                let window = &values[i.saturating_sub(radius)..(i + radius + 1).min(11)];
                assert_eq!(sum, window.iter().sum::<f32>(), "radius {radius} at {i}");
            }
        }
    }

    #[test]
    fn column_sums_are_box_sums_of_columns() {
        let (width, height) = (5, 13);
        let values: Vec<f32> = (0..width * height).map(|i| (i * i % 17) as f32).collect();
        for radius in [0, 2, 20] {
            let (mut by_rows, mut by_columns) = (values.clone(), values.clone());
            column_sums(&values, width, radius, &mut by_rows);
            for x in 0..width {
                let column = values[x..].iter().step_by(width).copied();
                box_sums(column, radius, by_columns[x..].iter_mut().step_by(width));
            }
            assert_eq!(by_rows, by_columns, "radius {radius}");
        }
    }

    /// A red bar on white is found where it lies, in its colour, and its gain is what it removes.
    #[test]
    fn a_bar_is_proposed_where_it_lies() {
        let (width, height) = (48, 40);
        let inside = |i: usize| (14..=34).contains(&(i % width)) && (18..22).contains(&(i / width));
        let plane = |bar: f32| {
            (0..width * height)
                .map(|i| if inside(i) { bar } else { 1.0 })
                .collect()
        };
        let target = Image::from_planes(width, height, [plane(0.9), plane(0.1), plane(0.2)]);
        let canvas = Canvas::flat(Canvas::from_image(&target).grid(), [1.0; 3]);
        let wanted = Wanted {
            count: 4,
            scale: 4.0,
            min_opacity: 1.0,
            level: 0,
            // A shift of the cells with which one of them begins at the end of the bar.
            key: [2, 0],
        };
        let target = Pyramid::new(target);
        let residual = Residual {
            target: &target,
            canvas: &canvas,
            weights: None,
        };
        let found = propose(Level::new(), &[residual], wanted);
        let Candidate { stroke, gain } = found[0];
        assert_eq!(
            propose(Level::new(), &[residual; 2], wanted),
            found,
            "the mean of two equal residuals is one of them"
        );
        assert!(
            (stroke[5] - 0.9).abs() < 0.1 && stroke[6] < 0.25,
            "{stroke:?}"
        );
        let center = [(stroke[0] + stroke[2]) / 2.0, (stroke[1] + stroke[3]) / 2.0];
        assert!(
            (14.0..35.0).contains(&center[0]) && (17.0..23.0).contains(&center[1]),
            "{stroke:?}"
        );
        let error = 21.0 * 4.0 * [0.1, 0.9, 0.8].map(|e: f32| e * e).iter().sum::<f32>();
        assert!(gain > 0.4 * error && gain < error, "gain {gain} of {error}");
    }
}
