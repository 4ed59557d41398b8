//! Dithering: colours that are mixed from those of a palette, pixel by pixel.

use rayon::prelude::*;

use super::labels::Labels;
use super::recipe::Dithering;
use crate::error::Result;
use crate::image::Image;
use crate::math;
use crate::metrics::average;

/// The picture with the means of the colours that are mixed, and the share of its pixels that are; `None` if that is small.
pub(super) fn mixed(
    picture: &Image,
    labels: &Labels,
    recipe: &Dithering,
) -> Result<Option<(Image, f32)>> {
    let (width, height) = (labels.width, labels.height);
    let is_mixed = |i: usize| {
        is_mixed(
            labels,
            [i % width, i / width].map(|v| v as isize),
            recipe.least,
        )
    };
    let lonely = (0..width * height)
        .into_par_iter()
        .map(|i| f64::from(u8::from(is_mixed(i))));
    let mut shares: Vec<f64> = lonely.collect();
    average(&mut shares, width, recipe.around);
    let mixing: Vec<f32> = shares
        .iter()
        .map(|share| (*share as f32 / recipe.dense).clamp(0.0, 1.0))
        .collect();
    let share = mixing.iter().filter(|v| **v >= 1.0).count() as f32 / mixing.len() as f32;
    if share < recipe.least_share {
        return Ok(None);
    }
    let planes = picture.planes().each_ref().map(|plane| {
        let mean = blurred(plane, width, recipe.blur_px);
        let pixels = plane.iter().zip(&mean).zip(&mixing);
        pixels
            .map(|((own, mean), mixing)| own + mixing * (mean - own))
            .collect()
    });
    Ok(Some((Image::new(width, height, planes)?, share)))
}

/// True if a pixel is far brighter than three of the pixels beside it or all, and darker than none, or the other way round. One that
/// is antialiased lies between them.
fn is_mixed(labels: &Labels, [x, y]: [isize; 2], least: f32) -> bool {
    let luma = |x, y| {
        let [red, green, blue, _] = labels.colors[usize::from(labels.at(x, y))];
        (red + green + blue) / 3.0
    };
    let own = luma(x, y);
    let beside = [[1, 0], [-1, 0], [0, 1], [0, -1]].map(|[dx, dy]| luma(x + dx, y + dy) - own);
    [1.0, -1.0].iter().any(|sign| {
        let far = beside.iter().filter(|away| *sign * **away > least).count();
        far >= 3 && beside.iter().all(|away| sign * away >= 0.0)
    })
}

/// A plane under a Gaussian of this standard deviation, px; at the borders it goes on as it ends.
fn blurred(plane: &[f32], width: usize, blur_px: f32) -> Vec<f32> {
    let reach = (3.0 * blur_px) as isize;
    let weights: Vec<f32> = (-reach..=reach)
        .map(|k| math::exp(-(k * k) as f32 / (2.0 * blur_px * blur_px)))
        .collect();
    let whole: f32 = weights.iter().sum();
    let height = plane.len() / width;
    let at = |place: isize, size: usize| place.clamp(0, size as isize - 1) as usize;
    let across = |i: usize| {
        let (x, row) = ((i % width) as isize, &plane[i / width * width..]);
        let taps = weights
            .iter()
            .zip(-reach..)
            .map(|(w, k)| w * row[at(x + k, width)]);
        taps.sum::<f32>() / whole
    };
    let rows: Vec<f32> = (0..plane.len()).into_par_iter().map(across).collect();
    let down = |i: usize| {
        let (x, y) = (i % width, (i / width) as isize);
        let taps = weights
            .iter()
            .zip(-reach..)
            .map(|(w, k)| w * rows[at(y + k, height) * width + x]);
        taps.sum::<f32>() / whole
    };
    (0..plane.len()).into_par_iter().map(down).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checks_become_grey_and_a_flat_place_stays() {
        let value =
            |x: usize, y: usize, _| f32::from(u8::from(x < 48 && (x + y).is_multiple_of(2)));
        let picture = Image::from_fn(96, 48, 1, value).unwrap();
        let labels = Labels::of(&picture, 2).unwrap();
        let (mixed, share) = mixed(&picture, &labels, &Dithering::MEASURED)
            .unwrap()
            .unwrap();
        let at = |x: usize| mixed.planes()[0][24 * 96 + x];
        assert!((at(20) - 0.5).abs() < 0.02, "{}", at(20));
        assert!(at(80).abs() < 1e-6);
        assert!((0.3..0.6).contains(&share));
    }
}
