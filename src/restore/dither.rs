//! Dithering: colours that are mixed from those of a palette, pixel by pixel.

use rayon::prelude::*;

use super::cosine::{Block, SIDE};
use super::labels::Labels;
use super::noise;
use super::planes::Planes;
use super::shrink::shrink;
use crate::error::Result;
use crate::image::Image;
use crate::metrics::average;

/// Distance of the mean from the truth, RMS in levels: that of 14 drawings in the palette of old browsers.
pub(super) const DOUBT: f32 = 3.5;

/// Least difference, 0..1, of a lonely pixel from those beside it: JPEG leaves less.
const LEAST: f32 = 0.15;
/// Half the side of the window in which lonely pixels are counted, px.
const AROUND: usize = 4;
/// Share of lonely pixels of a dithered window: random ones of two colours have 0.3, lines 1 px wide none.
const DENSE: f32 = 0.2;
/// Least share of a dithered picture that is. Drawings in the palette of old browsers have 0.08 to 0.8, photographs in 32 or 256
/// colours without dithering up to 0.012, drawings in few colours 0.
const LEAST_SHARE: f32 = 0.04;
/// Coefficients below so many times the mixture's RMS from planes are left out: `FAR` of the lowest ones, and more by [`RISE`] times
/// the square of the frequency, which is 1 for the highest along a side: mixtures are fine. Of 14 drawings, 0.6 and 3.2 come 37.2
/// dB near to the clean picture, 0.3 and 5 36.4; 3 of all frequencies 33.4, a Gaussian of 1.5 px 26.9, the mixture 25.7.
const FAR: f32 = 0.6;
/// See [`FAR`].
const RISE: f32 = 3.2;

/// The picture with the means of the colours that are mixed, and the share of its pixels that are; `None` if that is small.
pub(super) fn mixed(picture: &Image, labels: &Labels) -> Result<Option<(Image, f32)>> {
    let (width, height) = (labels.width, labels.height);
    let place = |i: usize| [i % width, i / width].map(|v| v as isize);
    let is_mixed = |i: usize| f64::from(u8::from(is_mixed(labels, place(i))));
    let lonely = (0..width * height).into_par_iter().map(is_mixed);
    let mut shares: Vec<f64> = lonely.collect();
    average(&mut shares, width, AROUND);
    let mixing: Vec<f32> = shares
        .iter()
        .map(|share| (*share as f32 / DENSE).clamp(0.0, 1.0))
        .collect();
    let share = mixing.iter().filter(|v| **v >= 1.0).count() as f32 / mixing.len() as f32;
    if share < LEAST_SHARE {
        return Ok(None);
    }
    let means = means(picture, &mixing)?.into_planes();
    let blend = |(own, mean): (&Vec<f32>, Vec<f32>)| {
        let pixels = own.iter().zip(mean).zip(&mixing);
        pixels
            .map(|((own, mean), mixing)| own + mixing * (mean - own))
            .collect()
    };
    let mut planes = picture.planes().iter().zip(means).map(blend);
    let planes = std::array::from_fn(|_| planes.next().unwrap_or_default());
    Ok(Some((Image::new(width, height, planes)?, share)))
}

/// True if a pixel is, in a channel, far brighter than three of the pixels beside it or all, and darker than none, or the other way
/// round. One that is antialiased lies between them.
fn is_mixed(labels: &Labels, [x, y]: [isize; 2]) -> bool {
    let label = labels.at(x, y);
    let beside = [[1, 0], [-1, 0], [0, 1], [0, -1]].map(|[dx, dy]| labels.at(x + dx, y + dy));
    // Most pixels of flat art are like those beside them.
    if beside.iter().filter(|other| **other != label).count() < 3 {
        return false;
    }
    let color = |label| labels.colors[usize::from(label)];
    let (own, beside) = (color(label), beside.map(color));
    (0..3).any(|channel| {
        let away = beside.map(|other| other[channel] - own[channel]);
        [1.0, -1.0].iter().any(|sign| {
            let far = away.iter().filter(|away| *sign * **away > LEAST).count();
            far >= 3 && away.iter().all(|away| sign * away >= 0.0)
        })
    })
}

/// The picture without what the mixture explains, where `mixing` is 1.
fn means(picture: &Image, mixing: &[f32]) -> Result<Image> {
    let mut planes = Planes::of(picture);
    let rms = noise::median_deviation(&planes, |pixel| mixing[pixel] >= 1.0);
    planes.planes = shrink(&planes.planes, planes.width, &spectrum(), &|_, _| rms);
    planes.image()
}

/// Least coefficients that are no mixture, in units of its RMS.
fn spectrum() -> Block {
    let last = (SIDE - 1) as f32;
    std::array::from_fn(|v| {
        std::array::from_fn(|u| {
            let frequency2 = (u * u + v * v) as f32 / (last * last);
            FAR + RISE * frequency2
        })
    })
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
        let (mixed, share) = mixed(&picture, &labels).unwrap().unwrap();
        let at = |x: usize| mixed.planes()[0][24 * 96 + x];
        assert!((at(20) - 0.5).abs() < 0.02, "{}", at(20));
        assert!(at(80).abs() < 1e-6);
        assert!((0.3..0.6).contains(&share));
    }

    #[test]
    fn a_channel_alone_is_mixed_and_lines_are_not() {
        let blue = |x: usize, y: usize, c: usize| match c {
            2 if (x + 2 * y).is_multiple_of(4) => 0.6_f32,
            _ => 0.8,
        };
        let lines = |x: usize, y: usize, _| f32::from(u8::from(x.is_multiple_of(6) || x == y));
        let found = |picture: Image| {
            let labels = Labels::of(&picture, 4).unwrap();
            let found = mixed(&picture, &labels).unwrap();
            found.map(|(_, share)| share)
        };
        assert!(found(Image::from_fn(64, 64, 3, blue).unwrap()) > Some(0.9));
        assert_eq!(found(Image::from_fn(64, 64, 1, lines).unwrap()), None);
    }
}
