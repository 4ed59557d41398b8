//! Structural similarity (SSIM): compares means, variances and covariance in a window around each sample.

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

use super::window::Moments;
use crate::image::{Image, level};
use crate::math;

/// Half of the SSIM window of 11 × 11 px, the middle included.
const TAPS: usize = 6;
/// Standard deviation of the SSIM window, px.
const SIGMA: f64 = 1.5;
/// Constants that keep SSIM stable where means (`C1`) or variances (`C2`) are near 0: `(0.01·L)²` and
/// `(0.03·L)²` for the range `L = 1`.
const C1: f32 = 0.01 * 0.01;
const C2: f32 = 0.03 * 0.03;

/// The mean over all samples of two pictures of one size.
pub(super) fn mean(a: &Image, b: &Image) -> f64 {
    let taps: [f32; TAPS] = std::array::from_fn(|k| {
        let x = k as f64;
        math::exp(-x * x / (2.0 * SIGMA * SIGMA)) as f32
    });
    let (width, height) = (a.width(), a.height());
    let of_plane = |(a, b): (&Vec<f32>, &Vec<f32>)| {
        // As a viewer shows it.
        let shown = |plane: &[f32]| -> Vec<f32> {
            let levels = plane.iter().map(|value| f32::from(level(*value)));
            levels.map(|level| level / 255.0).collect()
        };
        let planes = [shown(a), shown(b)];
        let rows: Vec<f64> = (0..height)
            .into_par_iter()
            .map_init(
                || Moments::new(&taps, width),
                |moments, y| dispatch!(Level::new(), _simd => sum(moments, &taps, &planes, y)),
            )
            .collect();
        // Row by row in order, so that the mean is the same for every number of threads.
        rows.iter().sum::<f64>()
    };
    let planes = a.planes().iter().zip(b.planes());
    planes.map(of_plane).sum::<f64>() / (3 * width * height) as f64
}

/// The sum over a row of samples, with the instructions of the caller.
#[inline(always)]
fn sum(moments: &mut Moments<'_>, taps: &[f32], [a, b]: &[Vec<f32>; 2], y: usize) -> f64 {
    let [mean_a, mean_b, aa, bb, ab] = moments.of_row(a, b, y);
    let (width, height) = (mean_a.len(), a.len() / mean_a.len());
    let down = weight(taps, y, height);
    let similarity = |x: usize| {
        // Where the picture cuts the window off, the remaining weights are scaled to sum 1.
        let scale = 1.0 / (down * weight(taps, x, width));
        let moments = [mean_a[x], mean_b[x], aa[x], bb[x], ab[x]];
        f64::from(similarity(moments.map(|sum| sum * scale)))
    };
    (0..width).map(similarity).sum()
}

/// The sum of the weights of one axis of the window around place `at` of `length`.
fn weight(taps: &[f32], at: usize, length: usize) -> f32 {
    let within = |reach: usize| taps[..=reach.min(TAPS - 1)].iter().sum::<f32>();
    within(at) + within(length - 1 - at) - taps[0]
}

/// SSIM of one window from the means of a, b, a², b² and ab.
fn similarity([a, b, aa, bb, ab]: [f32; 5]) -> f32 {
    // Var a = E[a²] − E[a]², Cov = E[ab] − E[a]E[b].
    let (variance_a, variance_b, covariance) = (aa - a * a, bb - b * b, ab - a * b);
    let luminance = (2.0 * a * b + C1) / (a * a + b * b + C1);
    luminance * (2.0 * covariance + C2) / (variance_a + variance_b + C2)
}

#[cfg(test)]
mod tests {
    use super::*;
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
