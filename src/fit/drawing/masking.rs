//! Masking: weights of errors by how well the eye sees them, from the picture itself.
//!
//! An error is easy to see where the picture is smooth. Detail of the picture hides it (*contrast masking*). With
//! the standard deviation σ of the luma in a window around a pixel, an error there counts
//!
//! ```text
//! w = c / (c + σ)
//! ```
//!
//! up to a ceiling of σ, since an outline has as large a σ as texture and hides less. Weights are in units of the mean of w over
//! all pixels, each weighted by its σ². The errors that remain in a drawing are roughly as large as the detail around them, so
//! the price of a byte keeps its meaning.

use rayon::prelude::*;

use crate::fit::drawing::focus::Focus;
use crate::image::Image;
use crate::metrics::average;
use crate::scene::Rgb;

/// Matte of transparent pictures.
const WHITE: Rgb = [1.0; 3];

/// Shares of red, green and blue in the luma (ITU-R BT.601).
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

/// Rows and columns of the window to each side of a pixel. A guess.
const WINDOW: usize = 6;
/// The standard deviation of the luma in the window that halves what an error counts, of 0..1. A guess.
const CONTRAST: f64 = 0.04;
/// The standard deviation of the luma from which on detail hides no more, of 0..1. 0.1, 0.15, 0.2, none: Kodak in 94,000 bytes has
/// SSIMULACRA2 11.4, 13.6, 14.0, 14.4 and 29.90, 29.85, 29.80, 29.76 dB; without a ceiling, small things of high contrast (the
/// pupils of a cat in 20,000 bytes) are drawn worse than by exact errors.
const CEILING: f64 = 0.2;

/// Weight of an error at each pixel of `picture`, in units of the mean over its detail.
pub(in crate::fit) fn weights(picture: &Image) -> Focus {
    let size = [picture.width(), picture.height()];
    let mut means = luma(picture);
    // σ² = mean of squares − square of the mean, both over the window.
    let mut variances: Vec<f64> = means.par_iter().map(|v| v * v).collect();
    rayon::join(
        || average(&mut means, size[0], WINDOW),
        || average(&mut variances, size[0], WINDOW),
    );
    let ceiling = CEILING * CEILING;
    let of_square = |(square, mean): (&mut f64, &f64)| {
        // Rounding of the difference may leave less than 0 where the picture is flat.
        *square = (*square - mean * mean).clamp(0.0, ceiling);
    };
    variances.par_iter_mut().zip(&means).for_each(of_square);
    let weight = |variance: f64| CONTRAST / (CONTRAST + variance.sqrt());
    // The mean of w, weighted by σ², is the unit of weights.
    let detail: f64 = variances.iter().sum();
    let seen: f64 = variances.iter().map(|&v| v * weight(v)).sum();
    // A picture of one colour has no detail, and all its errors count alike.
    let unit = if detail > 0.0 { seen / detail } else { 1.0 };
    let weights = variances.par_iter().map(|&v| (weight(v) / unit) as f32);
    Focus::of_weights(size, weights.collect())
}

/// The luma of each pixel, on white.
fn luma(picture: &Image) -> Vec<f64> {
    let on_white = picture.on(WHITE);
    let [red, green, blue] = on_white.planes();
    let pixels = red.par_iter().zip(green).zip(blue);
    let luma = |((&r, &g), &b): ((&f32, &f32), &f32)| {
        LUMA[0] * f64::from(r) + LUMA[1] * f64::from(g) + LUMA[2] * f64::from(b)
    };
    pixels.map(luma).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Budget, Config, ErrorWeighting, Fitter, Preset};
    use crate::metrics;
    use crate::scene::Marks;

    fn grey(width: usize, values: Vec<f32>) -> Image {
        let height = values.len() / width;
        Image::new(width, height, [values.clone(), values.clone(), values]).unwrap()
    }

    #[test]
    fn an_error_counts_most_where_the_picture_is_smooth() {
        let value = |i: usize| {
            let (x, y) = (i % 24, i / 24);
            if x < 12 { 0.5 } else { ((x + y) % 2) as f32 }
        };
        let picture = grey(24, (0..24 * 8).map(value).collect());
        let focus = weights(&picture);
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
        let smooth_db = |look, seed| {
            let config = Config {
                seed,
                budget: Budget {
                    strokes: Some(40),
                    ..Budget::default()
                },
                preset: Preset::Draft,
                look: Some(look),
                marks: Marks::Strokes,
                ..Config::default()
            };
            let fit = Fitter::new(config).fit(&picture).unwrap();
            metrics::psnr_where(&picture, &fit.soft, |i| i % 96 < 48).unwrap()
        };
        // Chance decides where each of so few strokes ends, by some dB.
        let gains: Vec<f64> = (0..8)
            .map(|seed| {
                smooth_db(ErrorWeighting::Eye, seed) - smooth_db(ErrorWeighting::Exact, seed)
            })
            .collect();
        assert!(gains.iter().sum::<f64>() > 1.5 * 8.0, "{gains:?}");
    }

    #[test]
    fn all_errors_count_alike_in_one_colour() {
        let focus = weights(&grey(6, vec![0.3; 36]));
        assert!(
            focus.weights().level(0).planes()[0]
                .iter()
                .all(|&w| w == 1.0)
        );
    }
}
