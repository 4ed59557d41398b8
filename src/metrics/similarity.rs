//! Structural similarity (SSIM): compares means, variances and covariance in a window around each sample.

use rayon::prelude::*;

use super::CHANNELS;
use crate::math;

/// Reach of the SSIM window: 11 × 11 px.
const REACH: usize = 5;
/// Standard deviation of the SSIM window, px.
const SIGMA: f64 = 1.5;
/// Constants that keep SSIM stable where means (`C1`) or variances (`C2`) are near 0: `(0.01·L)²` and
/// `(0.03·L)²` for the range `L = 1`.
const C1: f32 = 0.01 * 0.01;
const C2: f32 = 0.03 * 0.03;

/// The mean over all samples of `a` and `b`, interleaved levels in rows of `width` pixels.
pub(super) fn mean(a: &[u8], b: &[u8], width: usize) -> f64 {
    // The window is a product of one down and one across: sum down the columns, then along the row. A row needs no more memory
    // than its own sums.
    let stride = CHANNELS * width;
    let window = window();
    let across = Cut::new(&window, stride, CHANNELS);
    let rows = a.len() / stride;
    let sums: Vec<f64> = (0..rows)
        .into_par_iter()
        .map_init(
            || (Moments::new(stride), Moments::new(stride)),
            |(down, both), y| {
                down.gather_column_sums(a, b, &window, y, rows);
                both.gather_row_sums(down, &across);
                both.similarity_sum()
            },
        )
        .collect();
    // Row by row in order, so that the mean is the same for every number of threads.
    sums.iter().sum::<f64>() / a.len() as f64
}

/// One axis of the window; the weights sum to 1.
fn window() -> [f32; 2 * REACH + 1] {
    let weights = std::array::from_fn::<f64, { 2 * REACH + 1 }, _>(|k| {
        let x = k as f64 - REACH as f64;
        math::exp(-x * x / (2.0 * SIGMA * SIGMA))
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|w| (w / sum) as f32)
}

/// The weights of the window along a row, and the factor that rescales them where the window is cut off.
struct Cut<'a> {
    window: &'a [f32],
    step: usize,
    scale: Vec<f32>,
}

impl<'a> Cut<'a> {
    fn new(window: &'a [f32], len: usize, step: usize) -> Self {
        let mut cut = Self {
            window,
            step,
            scale: Vec::new(),
        };
        let mut weight = vec![0.0; len];
        cut.sum(&vec![1.0; len], &mut weight);
        // The weights that fall on each sample of a row of ones; only near the border less than 1.
        cut.scale = weight.iter().map(|w| 1.0 / w).collect();
        cut
    }

    /// Adds the weighted samples of `from`, not rescaled, to `to`.
    fn sum(&self, from: &[f32], to: &mut [f32]) {
        for (k, &w) in self.window.iter().enumerate() {
            // Add the whole row, shifted by each tap's distance, so that the inner loop is a plain multiply-add. Samples of a
            // channel are `step` apart.
            let shift = self.step * k.abs_diff(REACH);
            if shift >= from.len() {
                continue;
            }
            let rest = from.len() - shift;
            let (from, to) = if k < REACH {
                (&from[..rest], &mut to[shift..])
            } else {
                (&from[shift..], &mut to[..rest])
            };
            for (t, f) in to.iter_mut().zip(from) {
                *t += w * f;
            }
        }
    }
}

/// Weighted sums over a window, for every sample of a row: of both pictures' values, of their
/// squares and of their product.
struct Moments([Vec<f32>; 5]);

impl Moments {
    fn new(stride: usize) -> Self {
        Self(std::array::from_fn(|_| vec![0.0; stride]))
    }

    /// Sums down the columns around row `y`.
    fn gather_column_sums(&mut self, a: &[u8], b: &[u8], window: &[f32], y: usize, rows: usize) {
        self.clear();
        let (first, last) = (y.saturating_sub(REACH), (y + REACH).min(rows - 1));
        let tap = |row: usize| window[row + REACH - y];
        // Where the picture cuts the window off, the remaining weights are scaled to sum 1.
        let scale = 1.0 / (first..=last).map(tap).sum::<f32>();
        let stride = self.0[0].len();
        for row in first..=last {
            let span = row * stride..(row + 1) * stride;
            self.add_row(&a[span.clone()], &b[span], tap(row) * scale);
        }
    }

    fn add_row(&mut self, a: &[u8], b: &[u8], weight: f32) {
        let [sum_a, sum_b, sum_aa, sum_bb, sum_ab] = &mut self.0;
        let samples = a
            .iter()
            .zip(b)
            .map(|(&a, &b)| (f32::from(a) / 255.0, f32::from(b) / 255.0));
        let sums = sum_a
            .iter_mut()
            .zip(sum_b)
            .zip(sum_aa)
            .zip(sum_bb)
            .zip(sum_ab);
        for ((a, b), ((((sum_a, sum_b), sum_aa), sum_bb), sum_ab)) in samples.zip(sums) {
            *sum_a += weight * a;
            *sum_b += weight * b;
            *sum_aa += weight * a * a;
            *sum_bb += weight * b * b;
            *sum_ab += weight * a * b;
        }
    }

    /// Sums the column sums along the row.
    fn gather_row_sums(&mut self, down: &Self, across: &Cut<'_>) {
        self.clear();
        for (to, from) in self.0.iter_mut().zip(&down.0) {
            across.sum(from, to);
            to.iter_mut().zip(&across.scale).for_each(|(t, s)| *t *= s);
        }
    }

    fn similarity_sum(&self) -> f64 {
        let [a, b, aa, bb, ab] = &self.0;
        let moments = a.iter().zip(b).zip(aa).zip(bb).zip(ab);
        moments
            .map(|((((a, b), aa), bb), ab)| f64::from(similarity(*a, *b, *aa, *bb, *ab)))
            .sum()
    }

    fn clear(&mut self) {
        self.0.iter_mut().for_each(|row| row.fill(0.0));
    }
}

/// SSIM of one window from the means of a, b, a², b² and ab.
fn similarity(a: f32, b: f32, aa: f32, bb: f32, ab: f32) -> f32 {
    // Var a = E[a²] − E[a]², Cov = E[ab] − E[a]E[b].
    let (variance_a, variance_b, covariance) = (aa - a * a, bb - b * b, ab - a * b);
    let luminance = (2.0 * a * b + C1) / (a * a + b * b + C1);
    luminance * (2.0 * covariance + C2) / (variance_a + variance_b + C2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::metrics::{ssim, tests::noise};

    /// SSIM by its definition, in f64, one window at a time.
    fn naive_ssim(a: &Image, b: &Image) -> f64 {
        let (w, h) = (a.width() as i64, a.height() as i64);
        let mut sum = 0.0;
        for c in 0..3 {
            let at =
                |image: &Image, x: i64, y: i64| f64::from(image.planes()[c][(y * w + x) as usize]);
            for (y, x) in (0..h).flat_map(|y| (0..w).map(move |x| (y, x))) {
                let mut m = [0.0; 6];
                for (v, u) in (y - 5..=y + 5).flat_map(|v| (x - 5..=x + 5).map(move |u| (v, u))) {
                    if u < 0 || v < 0 || u >= w || v >= h {
                        continue;
                    }
                    let weight = math::exp(
                        -((u - x).pow(2) + (v - y).pow(2)) as f64 / (2.0 * SIGMA * SIGMA),
                    );
                    let (p, q) = (at(a, u, v), at(b, u, v));
                    for (sum, value) in m.iter_mut().zip([1.0, p, q, p * p, q * q, p * q]) {
                        *sum += weight * value;
                    }
                }
                let [weight, rest @ ..] = m;
                let [p, q, pp, qq, pq] = rest.map(|v| v / weight);
                let (c1, c2) = (1e-4, 9e-4);
                sum += (2.0 * p * q + c1) * (2.0 * (pq - p * q) + c2)
                    / ((p * p + q * q + c1) * (pp - p * p + qq - q * q + c2));
            }
        }
        sum / (3 * w * h) as f64
    }

    #[test]
    fn ssim_is_that_of_its_definition_at_every_size() {
        for (width, height) in [(1, 1), (1, 40), (40, 1), (3, 4), (11, 11), (30, 20)] {
            let (a, b) = (noise(width, height, 1), noise(width, height, 2));
            let (fast, naive) = (ssim(&a, &b).unwrap(), naive_ssim(&a, &b));
            assert!(
                (fast - naive).abs() < 1e-4,
                "{width}×{height}: {fast}, naively {naive}"
            );
        }
    }
}
