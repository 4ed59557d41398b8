//! Removal of noise: coefficients that noise explains are left out, in all blocks that hold a pixel.
//!
//! Shrinkage over shifted blocks is by Coifman and Donoho (1995).

use rayon::prelude::*;

use super::cosine::{Block, Cosines, SIDE};

/// Rows that are worked on together.
const BAND: usize = 64;

/// Largest picture, px, in which blocks begin at every pixel; at every second one in larger ones, and at every fourth one in those
/// eight times as large. A guess.
const ALL_BLOCKS: usize = 600_000;

/// White noise: all coefficients have as much of it.
pub(super) const WHITE: Block = [[1.0; SIDE]; SIDE];

/// Luma and chromas, rows of `width`, without noise. Coefficients below `least` of the middle of a block's luma and of its range,
/// times their part in the `spectrum` of the noise, are noise.
pub(super) fn shrink(
    planes: &[Vec<f32>; 3],
    width: usize,
    spectrum: &Block,
    least: &(impl Fn(f32, f32) -> f32 + Sync),
) -> [Vec<f32>; 3] {
    let height = planes[0].len() / width;
    let step = step(width * height);
    let cosines = Cosines::new();
    // Blocks that begin outside of the picture hold its border as often as others hold their pixels.
    let starts = |from: usize, to: usize| {
        let first = (from as isize - (SIDE as isize - 1)).div_euclid(step) * step;
        (first..to as isize).step_by(step as usize)
    };
    let of_band = |&top: &usize| {
        let rows = BAND.min(height - top);
        let mut bands = [(); 3].map(|()| Band::new(top, rows, width));
        for y in starts(top, top + rows) {
            for x in starts(0, width) {
                let blocks = planes
                    .each_ref()
                    .map(|plane| block_at(plane, width, [x, y]));
                let [low, high] = bounds(&blocks[0]);
                let least = least((low + high) / 2.0, high - low);
                for (band, block) in bands.iter_mut().zip(&blocks) {
                    band.add(&kept(&cosines, block, spectrum, least), [x, y]);
                }
            }
        }
        bands.map(|band| band.means())
    };
    let tops: Vec<usize> = (0..height).step_by(BAND).collect();
    let bands: Vec<[Vec<f32>; 3]> = tops.par_iter().map(of_band).collect();
    [0, 1, 2].map(|k| bands.iter().flat_map(|band| &band[k]).copied().collect())
}

/// Rows and columns from one block to the next in a picture of so many pixels: of a large one fewer blocks hold each pixel, for
/// time.
fn step(pixels: usize) -> isize {
    match pixels.div_ceil(ALL_BLOCKS) {
        0..=1 => 1,
        2..=8 => 2,
        _ => 4,
    }
}

/// The least and the largest value of a block.
fn bounds(block: &Block) -> [f32; 2] {
    let widened = |[low, high]: [f32; 2], &v: &f32| [low.min(v), high.max(v)];
    block.iter().flatten().fold([f32::MAX, f32::MIN], widened)
}

/// The block that begins at a place, mirrored at the borders.
fn block_at(values: &[f32], width: usize, [x, y]: [isize; 2]) -> Block {
    let height = values.len() / width;
    let (columns, rows) = (mirrored(x, width), mirrored(y, height));
    rows.map(|row| columns.map(|column| values[row * width + column]))
}

/// The places from `start` on, those outside of 0 to `size` mirrored.
fn mirrored(start: isize, size: usize) -> [usize; SIDE] {
    let last = size as isize - 1;
    std::array::from_fn(|k| {
        let at = start + k as isize;
        let at = if at < 0 { -1 - at } else { at };
        let at = if at > last { 2 * last + 1 - at } else { at };
        at.clamp(0, last) as usize
    })
}

/// A block without coefficients below `least`, and its weight: the fewer coefficients are left, the less noise is.
fn kept(cosines: &Cosines, block: &Block, spectrum: &Block, least: f32) -> (Block, f32) {
    // Most blocks of flat art need no transform.
    let first = block[0][0];
    if block.iter().flatten().all(|value| *value == first) {
        return (*block, 1.0);
    }
    let mut coefficients = cosines.forward(block);
    let mean = coefficients[0][0];
    // Noise is spread over all coefficients, and what is drawn gathers in a few. The mean stays.
    let mut count = 1;
    let parts = spectrum.as_flattened().iter();
    for (value, part) in coefficients
        .as_flattened_mut()
        .iter_mut()
        .zip(parts)
        .skip(1)
    {
        if value.abs() < part * least {
            *value = 0.0;
        } else {
            count += 1;
        }
    }
    if count == 1 {
        return ([[mean / SIDE as f32; SIDE]; SIDE], 1.0);
    }
    (cosines.inverse(&coefficients), 1.0 / count as f32)
}

/// Rows of weighted sums.
struct Band {
    top: usize,
    width: usize,
    /// The sum of the weighted values of a pixel, and that of the weights.
    sums: Vec<[f32; 2]>,
}

impl Band {
    fn new(top: usize, rows: usize, width: usize) -> Self {
        let sums = vec![[0.0; 2]; rows * width];
        Self { top, width, sums }
    }

    fn means(&self) -> Vec<f32> {
        self.sums.iter().map(|[sum, weight]| sum / weight).collect()
    }

    /// Adds the pixels of a block that are in the band.
    fn add(&mut self, (block, weight): &(Block, f32), [x, y]: [isize; 2]) {
        let rows = self.sums.len() / self.width;
        for (dy, line) in block.iter().enumerate() {
            let row = y + dy as isize - self.top as isize;
            if !(0..rows as isize).contains(&row) {
                continue;
            }
            for (dx, value) in line.iter().enumerate() {
                let column = x + dx as isize;
                if (0..self.width as isize).contains(&column) {
                    let [sum, weights] =
                        &mut self.sums[row as usize * self.width + column as usize];
                    *sum += weight * value;
                    *weights += weight;
                }
            }
        }
    }
}
