//! Damage that is done to clean pictures, the same in every run.

use std::collections::BTreeMap;

use crate::report::Damage;
use strokefit::Result;
use strokefit::image::{Image, Limits};
use strokefit::rng;

/// Least share of the pixels that have a common colour and lie within their own.
const COMMON: f64 = 0.001;

/// Rows and columns around an antialiased pixel in which the colours lie that it is a mixture of.
const AROUND: usize = 2;

/// Levels between the colours of the palette that browsers once had, 6 for each channel.
const WEB_LEVELS: f32 = 51.0;

/// Weights of the four nearest pixels of the half, the middle of a pixel being a quarter away from the second one (Catmull and
/// Rom's cubic).
const CUBIC: [f32; 4] = [-9.0 / 128.0, 111.0 / 128.0, 29.0 / 128.0, -3.0 / 128.0];

/// A photographed page: paper and its least light, in units of white; grain, levels; quality of the JPEG. Guesses.
const PAPER: f32 = 0.92;
const LEAST_LIGHT: f32 = 0.65;
const GRAIN: u8 = 3;
const PHOTOGRAPH: u8 = 90;

/// An opaque picture after `damage`, in whole levels as files have them.
pub(super) fn damaged(picture: &Image, damage: Damage) -> Result<Image> {
    match damage {
        Damage::Clean => Ok(picture.clone()),
        Damage::Jpeg(quality) => compressed(picture, quality),
        Damage::Noise(levels) => noisy(picture, levels),
        Damage::Aliased => aliased(picture),
        Damage::Dithered => dithered(picture),
        Damage::Enlarged => enlarged(picture),
        Damage::Photographed => compressed(&noisy(&in_light(picture)?, GRAIN)?, PHOTOGRAPH),
    }
}

/// The colours of places of one colour, the most common first. Antialiased edges have none, however long they are.
pub(super) fn common_colors(picture: &Image) -> Vec<[u8; 3]> {
    let (width, height) = (picture.width(), picture.height());
    let pixels = picture.to_rgb8();
    let pixels = pixels.as_chunks::<3>().0;
    let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            let color = pixels[y * width + x];
            let row = |y: usize| &pixels[y * width + x - 1..=y * width + x + 1];
            if (y - 1..=y + 1).flat_map(row).all(|other| *other == color) {
                *counts.entry(color).or_default() += 1;
            }
        }
    }
    let least = COMMON * pixels.len() as f64;
    let common = counts.into_iter().filter(|(_, n)| *n as f64 >= least);
    let mut common: Vec<_> = common.collect();
    common.sort_by_key(|(_, count)| usize::MAX - count);
    common.into_iter().map(|(color, _)| color).collect()
}

fn compressed(picture: &Image, quality: u8) -> Result<Image> {
    Image::decode(&picture.encode_jpeg(quality)?, "JPEG", Limits::default())
}

/// With Gaussian noise in each channel.
fn noisy(picture: &Image, levels: u8) -> Result<Image> {
    let width = picture.width();
    mapped(picture, |value, [x, y], c| {
        let i = (y * width + x) as u64;
        255.0 * value + f32::from(levels) * rng::normal(0, 0, i, c as u64)
    })
}

/// Without antialiasing: each pixel has the nearest of the common colours around it, or black or white where a picture has none.
fn aliased(picture: &Image) -> Result<Image> {
    let mut palette = common_colors(picture);
    if palette.len() < 2 {
        palette = vec![[0; 3], [255; 3]];
    }
    let (width, height) = (picture.width(), picture.height());
    let pixels = picture.to_rgb8();
    let pixels = pixels.as_chunks::<3>().0;
    let nearest = |x: usize, y: usize| -> Option<[u8; 3]> {
        let color = pixels[y * width + x];
        let apart = |other: &[u8; 3]| -> u32 {
            let channels = other.iter().zip(color);
            channels.map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
        };
        let rows = y.saturating_sub(AROUND)..(y + AROUND + 1).min(height);
        let columns = x.saturating_sub(AROUND)..(x + AROUND + 1).min(width);
        let around = rows.flat_map(|y| &pixels[y * width..][columns.clone()]);
        let common = around.copied().filter(|other| palette.contains(other));
        let of_all = || palette.iter().copied().min_by_key(apart);
        common.min_by_key(apart).or_else(of_all)
    };
    let nearest: Vec<[u8; 3]> = (0..width * height)
        .map(|i| nearest(i % width, i / width).unwrap_or_default())
        .collect();
    Image::from_fn(width, height, 3, |x, y, c| nearest[y * width + x][c])
}

/// In the palette of old browsers, the error of each pixel handed on to those after it (Floyd and Steinberg, 1976).
fn dithered(picture: &Image) -> Result<Image> {
    let (width, height) = (picture.width(), picture.height());
    let spread = |plane: &Vec<f32>| {
        let mut values: Vec<f32> = plane.iter().map(|v| 255.0 * v).collect();
        for i in 0..values.len() {
            let (x, wanted) = (i % width, values[i]);
            values[i] = ((wanted / WEB_LEVELS).round() * WEB_LEVELS).clamp(0.0, 255.0);
            let error = (wanted - values[i]) / 16.0;
            let (first, last) = (x == 0, x + 1 == width);
            let shares = [
                (1, 7.0, last),
                (width - 1, 3.0, first),
                (width, 5.0, false),
                (width + 1, 1.0, last),
            ];
            for (step, share, is_outside) in shares {
                if let (Some(value), false) = (values.get_mut(i + step), is_outside) {
                    *value += share * error;
                }
            }
        }
        values
    };
    let planes = picture.planes().each_ref().map(spread);
    Image::from_fn(width, height, 3, |x, y, c| planes[c][y * width + x] as u8)
}

/// From half its size, by a cubic.
fn enlarged(picture: &Image) -> Result<Image> {
    let half = picture.halved();
    // The pixels of the half around one of the whole, the nearer side first.
    let around = |at: usize, size: usize| {
        let towards = if at.is_multiple_of(2) { -1 } else { 1 };
        [-1, 0, 1, 2].map(|k| (at / 2).saturating_add_signed(k * towards).min(size - 1))
    };
    mapped(picture, |_, [x, y], c| {
        let (columns, rows) = (around(x, half.width()), around(y, half.height()));
        let row = |y: &usize| -> f32 {
            let values = columns.iter().zip(CUBIC);
            let values = values.map(|(x, weight)| weight * half.planes()[c][y * half.width() + x]);
            values.sum()
        };
        255.0
            * rows
                .iter()
                .zip(CUBIC)
                .map(|(y, weight)| weight * row(y))
                .sum::<f32>()
    })
}

/// On paper, in light that falls off towards the lower right corner.
fn in_light(picture: &Image) -> Result<Image> {
    // The square of a place, in units of the picture's side.
    let side2 = |at: usize, size: usize| {
        let place = (at as f32 + 0.5) / size as f32;
        place * place
    };
    let (width, height) = (picture.width(), picture.height());
    mapped(picture, |value, [x, y], _| {
        let away = (side2(x, width) + side2(y, height)) / 2.0;
        255.0 * value * PAPER * (1.0 - (1.0 - LEAST_LIGHT) * away)
    })
}

/// A picture of the levels that `level` makes of the value of each place and channel.
fn mapped(picture: &Image, level: impl Fn(f32, [usize; 2], usize) -> f32) -> Result<Image> {
    let width = picture.width();
    Image::from_fn(width, picture.height(), 3, |x, y, c| {
        let value = picture.planes()[c][y * width + x];
        level(value, [x, y], c).round().clamp(0.0, 255.0) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use strokefit::metrics::psnr;

    /// A grey disc on white, with antialiasing.
    fn disc() -> Image {
        Image::from_fn(65, 64, 1, |x, y, _| {
            let [dx, dy] = [x as f32 - 31.5, y as f32 - 31.5];
            let away = (dx * dx + dy * dy).sqrt();
            0.4 + 0.6 * (away - 20.0).clamp(0.0, 1.0)
        })
        .unwrap()
    }

    #[test]
    fn each_damage_changes_pixels_and_no_size() {
        let clean = disc();
        for damage in Damage::ALL {
            let picture = damaged(&clean, damage).unwrap();
            assert_eq!((picture.width(), picture.height()), (65, 64));
            let db = psnr(&clean, &picture).unwrap();
            let expected = match damage {
                Damage::Clean => f64::INFINITY..=f64::INFINITY,
                Damage::Photographed => 8.0..=20.0,
                _ => 20.0..=50.0,
            };
            assert!(expected.contains(&db), "{damage}: {db}");
        }
    }

    #[test]
    fn noise_is_as_strong_as_asked_for_and_the_same_again() {
        let grey = Image::filled(64, 64, [0.5; 3]).unwrap();
        let noisy = damaged(&grey, Damage::Noise(8)).unwrap();
        assert!(noisy == damaged(&grey, Damage::Noise(8)).unwrap());
        let planes = noisy.planes();
        assert!(planes[0] != planes[1]);
        let apart = planes.iter().flatten().map(|v| 255.0 * v - 127.5);
        let variance = apart.map(|d| d * d);
        let deviation = (variance.sum::<f32>() / (3.0 * 64.0 * 64.0)).sqrt();
        assert!((7.7..8.3).contains(&deviation), "{deviation}");
    }

    #[test]
    fn without_antialiasing_the_common_colours_are_left() {
        let picture = damaged(&disc(), Damage::Aliased).unwrap();
        assert_eq!(common_colors(&picture), [[255; 3], [102; 3]]);
        let pixels = picture.to_rgb8();
        assert!(pixels.iter().all(|level| [102, 255].contains(level)));
    }

    #[test]
    fn dithering_keeps_the_mean() {
        let grey = Image::filled(64, 64, [0.5; 3]).unwrap();
        let picture = damaged(&grey, Damage::Dithered).unwrap();
        let pixels = picture.to_rgb8();
        assert!(pixels.iter().all(|level| [102, 153].contains(level)));
        let sum: f64 = pixels.iter().map(|level| f64::from(*level)).sum();
        assert!((sum / pixels.len() as f64 - 127.5).abs() < 1.0);
    }

    #[test]
    fn what_is_smooth_is_enlarged_as_it_was() {
        let ramp = Image::from_fn(64, 64, 1, |x, _, _| x as f32 / 64.0).unwrap();
        let back = damaged(&ramp, Damage::Enlarged).unwrap();
        let middle = |image: &Image| image.to_rgb8()[3 * (32 * 64 + 8)..][..3 * 48].to_vec();
        let pairs = middle(&ramp).into_iter().zip(middle(&back));
        assert!(pairs.into_iter().all(|(a, b)| a.abs_diff(b) <= 1));
    }
}
