//! What the eye sees of an error: weights from the picture itself.
//!
//! An error is plain to see where the picture is smooth, and hidden where it has detail of its own (*contrast masking*). With
//! the standard deviation σ of the luma in a window around a pixel, an error there counts
//!
//! ```text
//! w = c / (c + σ)
//! ```
//!
//! up to a ceiling of σ, since an outline has as large a σ as texture and hides less. Weights are in units of the mean of w over
//! all pixels, each weighted by its σ²: errors that remain in a drawing are roughly as large as the detail they are of, so that
//! the price of a byte keeps its meaning.

use super::focus::Focus;
use super::recipe::Masking;
use crate::image::Image;
use crate::scene::Rgb;

/// What transparent pictures are laid on.
const WHITE: Rgb = [1.0; 3];

/// Shares of red, green and blue in the luma (ITU-R BT.601).
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

/// How much an error counts at each pixel of `picture`, in units of the mean over its detail.
pub(super) fn weights(picture: &Image, masking: Masking) -> Focus {
    let picture = picture.flattened(WHITE);
    let [red, green, blue] = picture.planes();
    let luma: Vec<f64> = red
        .iter()
        .zip(green)
        .zip(blue)
        .map(|((&r, &g), &b)| {
            LUMA[0] * f64::from(r) + LUMA[1] * f64::from(g) + LUMA[2] * f64::from(b)
        })
        .collect();
    let squares = luma.iter().map(|v| v * v).collect();
    let size = [picture.width(), picture.height()];
    let means = window_means(luma, size, masking.window);
    let ceiling = masking.ceiling * masking.ceiling;
    let variances: Vec<f64> = window_means(squares, size, masking.window)
        .iter()
        .zip(means)
        .map(|(square, mean)| (square - mean * mean).clamp(0.0, ceiling))
        .collect();
    let weight = |variance: f64| masking.contrast / (masking.contrast + variance.sqrt());
    let detail: f64 = variances.iter().sum();
    let seen: f64 = variances.iter().map(|&v| v * weight(v)).sum();
    // A picture of one colour has no detail, and all its errors count alike.
    let unit = if detail > 0.0 { seen / detail } else { 1.0 };
    let weights = variances.iter().map(|&v| (weight(v) / unit) as f32);
    Focus::of_weights(size, weights.collect())
}

/// The means of `values` over the windows of 2`radius` + 1 rows and columns around each pixel, as far as these are in the
/// picture.
fn window_means(values: Vec<f64>, [width, height]: [usize; 2], radius: usize) -> Vec<f64> {
    let rows = running_means(&values, width, radius);
    let columns = running_means(&transposed(&rows, width), height, radius);
    transposed(&columns, height)
}

/// The running means of rows of `length` values.
fn running_means(values: &[f64], length: usize, radius: usize) -> Vec<f64> {
    let mut means = Vec::with_capacity(values.len());
    for row in values.chunks_exact(length) {
        let mut sum: f64 = row.iter().take(radius).sum();
        for i in 0..length {
            sum += row.get(i + radius).copied().unwrap_or(0.0);
            let first = i.saturating_sub(radius);
            let end = length.min(i + radius + 1);
            means.push(sum / (end - first) as f64);
            if i >= radius {
                sum -= row[first];
            }
        }
    }
    means
}

fn transposed(values: &[f64], width: usize) -> Vec<f64> {
    let column = |x: usize| values.iter().skip(x).step_by(width).copied();
    (0..width).flat_map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Budget, Config, Fitter, Look, Preset};
    use crate::metrics;

    const MASKING: Masking = Masking {
        window: 2,
        contrast: 0.04,
        ceiling: 0.2,
    };

    fn grey(width: usize, values: Vec<f32>) -> Image {
        let height = values.len() / width;
        Image::new(width, height, [values.clone(), values.clone(), values]).unwrap()
    }

    #[test]
    fn means_are_those_of_the_window() {
        let (width, height) = (5, 4);
        let values: Vec<f64> = (0..width * height).map(|i| (i * i % 7) as f64).collect();
        let means = window_means(values.clone(), [width, height], 1);
        for y in 0..height {
            for x in 0..width {
                let rows = y.saturating_sub(1)..height.min(y + 2);
                let window: Vec<f64> = rows
                    .flat_map(|row| {
                        let columns = x.saturating_sub(1)..width.min(x + 2);
                        columns.map(move |column| row * width + column)
                    })
                    .map(|i| values[i])
                    .collect();
                let mean = window.iter().sum::<f64>() / window.len() as f64;
                assert!((means[y * width + x] - mean).abs() < 1e-9, "{x} {y}");
            }
        }
    }

    #[test]
    fn an_error_counts_most_where_the_picture_is_smooth() {
        let value = |i: usize| {
            let (x, y) = (i % 24, i / 24);
            if x < 12 { 0.5 } else { ((x + y) % 2) as f32 }
        };
        let picture = grey(24, (0..24 * 8).map(value).collect());
        let focus = weights(&picture, MASKING);
        let [weights, ..] = focus.weights().level(0).planes();
        // The checks deviate by a half, which is above the ceiling: 0.04 / 0.24 of what counts in the smooth half.
        let (smooth, detailed) = (weights[2], weights[20]);
        assert!(
            (detailed / smooth - 0.04 / 0.24).abs() < 0.01,
            "{smooth} {detailed}"
        );
        assert!((detailed - 1.0).abs() < 0.2, "{detailed}");
    }

    #[test]
    fn strokes_go_where_errors_are_seen() {
        // A slope beside checks of 6 px, 96×48 px.
        let value = |i: usize| {
            let (x, y) = (i % 96, i / 96);
            match x < 48 {
                true => 0.3 + 0.3 * ((x * x + y * y) as f32 / 4608.0),
                false => 0.2 + 0.6 * ((x / 6 + y / 6) % 2) as f32,
            }
        };
        let picture = grey(96, (0..96 * 48).map(value).collect());
        let smooth_db = |look| {
            let config = Config {
                budget: Budget {
                    strokes: Some(40),
                    ..Budget::default()
                },
                preset: Preset::Draft,
                look: Some(look),
                ..Config::default()
            };
            let fit = Fitter::new(config).fit(&picture).unwrap();
            metrics::psnr_where(&picture, &fit.soft, |i| i % 96 < 48).unwrap()
        };
        let (eye, exact) = (smooth_db(Look::Eye), smooth_db(Look::Exact));
        assert!(eye > exact + 2.0, "{eye} {exact}");
    }

    #[test]
    fn all_errors_count_alike_in_one_colour() {
        let focus = weights(&grey(6, vec![0.3; 36]), MASKING);
        assert!(
            focus.weights().level(0).planes()[0]
                .iter()
                .all(|&w| w == 1.0)
        );
    }
}
