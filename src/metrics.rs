//! Measures the difference between two pictures: MSE, PSNR, SSIM, L1, and SSIMULACRA2, which predicts the judgement of people.
//!
//! All measures are over 8-bit RGB, as a viewer shows it: both pictures are first flattened onto a white matte and
//! rounded. Errors are in channel values 0..1, averaged over pixels and channels.

mod details;
mod fineness;
mod similarity;
mod ssimulacra2;
mod window;

use std::borrow::Cow;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::{Error, ErrorKind, Result};
use crate::image::{Image, level};
use crate::math;
use crate::scene::Rgb;
pub(crate) use details::Details;
pub(crate) use fineness::fine_share;
pub(crate) use window::{average, extremes};

const WHITE: Rgb = [1.0; 3];

/// Largest [`Agreement::patch_abs`] of renders that have the same in them. Photographs, flat art and line art have 3 to 14, a dithered
/// picture of 5,000 strokes 22; a hole as wide as a patch has its whole contrast, 100 and more.
const MAX_PATCH_ABS: u8 = 40;

/// Fidelity of a picture to another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Peak signal-to-noise ratio, `−10·log10(mse)` in dB; infinite for equal pictures, `null` in
    /// JSON.
    #[serde(deserialize_with = "null_is_infinite")]
    pub psnr_db: f64,
    /// Structural similarity, 1 for equal pictures; see [`ssim`].
    pub ssim: f64,
    /// Mean squared error, 0..1.
    pub mse: f64,
    /// Mean absolute error, 0..1.
    pub l1: f64,
    /// Fidelity as people see it, 100 for equal pictures; see [`fn@ssimulacra2`].
    pub ssimulacra2: f64,
    /// Share of small things, such as letters, dots and thin lines, in and beside which errors are below a third of their contrast;
    /// `None` if the reference has none of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub details_kept: Option<f64>,
}

impl Quality {
    /// Measures `picture` against `reference`.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when their sizes differ.
    pub fn between(reference: &Image, picture: &Image) -> Result<Self> {
        let sums = Sums::between(reference, picture)?;
        let [a, b] = &both_on_white(reference, picture)?;
        Ok(Self {
            psnr_db: psnr_db(sums.mse()),
            ssim: similarity::mean(a, b),
            mse: sums.mse(),
            l1: sums.l1(),
            ssimulacra2: ssimulacra2::score(a, b),
            details_kept: Details::of(reference, details::SEEN).kept(picture),
        })
    }
}

/// Share of the small things of `reference` that `picture` keeps, as [`Quality::details_kept`].
///
/// # Errors
/// [`ErrorKind::Picture`] when their sizes differ.
pub fn details_kept(reference: &Image, picture: &Image) -> Result<Option<f64>> {
    let [reference, picture] = both_on_white(reference, picture)?;
    Ok(Details::of(&reference, details::SEEN).kept(&picture))
}

/// Agreement of two renders of the same drawing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// As [`Quality::psnr_db`].
    #[serde(deserialize_with = "null_is_infinite")]
    pub psnr_db: f64,
    /// Largest difference of a channel of a pixel, 0..=255.
    pub max_abs: u8,
    /// Largest difference of a channel's mean over 5×5 px, 0..=255. Antialiasing hardly counts there, and a gap does.
    #[serde(default)]
    pub patch_abs: u8,
}

impl Agreement {
    /// Compares two renders.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when their sizes differ.
    pub fn between(a: &Image, b: &Image) -> Result<Self> {
        let sums = Sums::between(a, b)?;
        let [a, b] = both_on_white(a, b)?;
        Ok(Self {
            psnr_db: psnr_db(sums.mse()),
            max_abs: sums.max_abs,
            patch_abs: level(window::max_patch_abs(&a, &b)),
        })
    }

    /// True if one render lacks something of a few px that the other has.
    pub fn has_gap(&self) -> bool {
        self.patch_abs > MAX_PATCH_ABS
    }
}

/// Mean squared error over 8-bit RGB on white, 0..1.
///
/// # Errors
/// [`ErrorKind::Picture`] when the sizes differ.
pub fn mse(a: &Image, b: &Image) -> Result<f64> {
    Ok(Sums::between(a, b)?.mse())
}

/// Mean absolute error over 8-bit RGB on white, 0..1.
///
/// # Errors
/// [`ErrorKind::Picture`] when the sizes differ.
pub fn l1(a: &Image, b: &Image) -> Result<f64> {
    Ok(Sums::between(a, b)?.l1())
}

/// Peak signal-to-noise ratio over 8-bit RGB on white, dB; infinite for equal pictures.
///
/// # Errors
/// [`ErrorKind::Picture`] when the sizes differ.
pub fn psnr(a: &Image, b: &Image) -> Result<f64> {
    mse(a, b).map(psnr_db)
}

/// PSNR of the pixels for which `counts` is true, dB; infinite where there are none. `counts` takes the index of a
/// pixel, row by row.
///
/// # Errors
/// [`ErrorKind::Picture`] when the sizes differ.
pub fn psnr_where(a: &Image, b: &Image, counts: impl Fn(usize) -> bool) -> Result<f64> {
    let [a, b] = both_on_white(a, b)?;
    let (mut squares, mut count) = (0_u64, 0_u64);
    for (a, b) in a.planes().iter().zip(b.planes()) {
        let pairs = a.iter().zip(b).enumerate();
        for (_, (a, b)) in pairs.filter(|(i, _)| counts(*i)) {
            squares += u64::from(level(*a).abs_diff(level(*b))).pow(2);
            count += 1;
        }
    }
    Ok(match count {
        0 => f64::INFINITY,
        _ => psnr_db(squares as f64 / (count as f64 * 255.0 * 255.0)),
    })
}

/// Peak signal-to-noise ratio in dB of a mean squared error of values 0..1.
pub fn psnr_db(mse: f64) -> f64 {
    if mse > 0.0 {
        -10.0 * math::log10(mse)
    } else {
        f64::INFINITY
    }
}

/// Structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004), −1..1, of 8-bit RGB on white.
///
/// Window: Gaussian, 11 × 11 px, σ = 1.5 px, `K1 = 0.01`, `K2 = 0.03`; the mean over red, green
/// and blue and over all pixels. At the border the window is cut off, and its weights are rescaled to sum 1;
/// so pictures smaller than the window need no special rule. Implementations that crop the border or work on
/// luma give slightly different numbers.
///
/// # Errors
/// [`ErrorKind::Picture`] when the sizes differ.
pub fn ssim(a: &Image, b: &Image) -> Result<f64> {
    let [a, b] = both_on_white(a, b)?;
    Ok(similarity::mean(&a, &b))
}

/// SSIMULACRA2 2.1 of 8-bit RGB on white: how different two pictures look to people. 100 for equal pictures, 90 lossless to
/// the eye, 70 high, 50 medium, 30 low quality; below 0 for pictures that have little in common.
///
/// # Errors
/// [`ErrorKind::Picture`] when the sizes differ.
pub fn ssimulacra2(reference: &Image, picture: &Image) -> Result<f64> {
    let [reference, picture] = both_on_white(reference, picture)?;
    Ok(ssimulacra2::score(&reference, &picture))
}

/// Where [`fn@ssimulacra2`] is lost, row by row: the score if all of the picture were as bad as it is there.
///
/// # Errors
/// [`ErrorKind::Picture`] when the sizes differ.
pub fn ssimulacra2_map(reference: &Image, picture: &Image) -> Result<Vec<f32>> {
    let [reference, picture] = both_on_white(reference, picture)?;
    Ok(ssimulacra2::map(&reference, &picture))
}

/// Small things of `reference` that `picture` has lost, row by row: 1 in and beside one that stands alone, less among many others,
/// and 0 where nothing is lost. [`Quality::details_kept`] is their sum.
///
/// # Errors
/// [`ErrorKind::Picture`] when the sizes differ.
pub fn details_lost(reference: &Image, picture: &Image) -> Result<Vec<f32>> {
    let [reference, picture] = both_on_white(reference, picture)?;
    Ok(Details::of(&reference, details::SEEN).losses(&picture))
}

/// Both pictures as a viewer shows them on white, of one size.
fn both_on_white<'a>(a: &'a Image, b: &'a Image) -> Result<[Cow<'a, Image>; 2]> {
    let size = |image: &Image| (image.width(), image.height());
    if size(a) != size(b) {
        let ((aw, ah), (bw, bh)) = (size(a), size(b));
        let message = format!(
            "pictures of {aw}×{ah} and {bw}×{bh} px cannot be compared: make their sizes equal"
        );
        return Err(Error::new(ErrorKind::Picture, message));
    }
    Ok([a, b].map(|image| image.on(WHITE)))
}

/// Sums over all differences, in integers, so that the order of summation does not matter.
#[derive(Default)]
struct Sums {
    count: u64,
    squares: u64,
    absolutes: u64,
    max_abs: u8,
}

/// Number of squared differences whose sum fits 32 bits: 2¹⁶·255² < 2³². The compiler vectorises sums of 32 bits.
const ADDED_IN_32_BITS: usize = 1 << 16;

impl Sums {
    /// The sums over two pictures, rounded to levels on the fly.
    fn between(a: &Image, b: &Image) -> Result<Self> {
        let [a, b] = both_on_white(a, b)?;
        let of_chunk = |(a, b): (&[f32], &[f32])| {
            let (mut squares, mut absolutes, mut max_abs) = (0, 0, 0);
            for (a, b) in a.iter().zip(b) {
                let d = level(*a).abs_diff(level(*b));
                squares += u32::from(d) * u32::from(d);
                absolutes += u32::from(d);
                max_abs = d.max(max_abs);
            }
            Self {
                count: a.len() as u64,
                squares: u64::from(squares),
                absolutes: u64::from(absolutes),
                max_abs,
            }
        };
        let of_plane = |(a, b): (&Vec<f32>, &Vec<f32>)| {
            let chunks = a.par_chunks(ADDED_IN_32_BITS);
            let chunks = chunks.zip(b.par_chunks(ADDED_IN_32_BITS));
            // Integer sums are exact, so the order in which threads add them makes no difference.
            chunks.map(of_chunk).reduce(Self::default, Self::plus)
        };
        let planes = a.planes().iter().zip(b.planes());
        Ok(planes.map(of_plane).fold(Self::default(), Self::plus))
    }

    fn plus(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            squares: self.squares + other.squares,
            absolutes: self.absolutes + other.absolutes,
            max_abs: self.max_abs.max(other.max_abs),
        }
    }

    fn mse(&self) -> f64 {
        self.squares as f64 / (self.count as f64 * 255.0 * 255.0)
    }

    fn l1(&self) -> f64 {
        self.absolutes as f64 / (self.count as f64 * 255.0)
    }
}

/// JSON has no infinity; serde writes it as `null`.
pub(crate) fn null_is_infinite<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn noise(width: usize, height: usize, seed: u32) -> Image {
        let mut state = seed;
        let mut plane = || {
            let next = |_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f32::from((state >> 24) as u8) / 255.0
            };
            (0..width * height).map(next).collect()
        };
        Image::new(width, height, [plane(), plane(), plane()]).unwrap()
    }

    fn grey(values: &[u8], width: usize) -> Image {
        let plane: Vec<f32> = values.iter().map(|&v| f32::from(v) / 255.0).collect();
        Image::new(
            width,
            values.len() / width,
            [plane.clone(), plane.clone(), plane],
        )
        .unwrap()
    }

    #[test]
    fn errors_of_a_known_difference() {
        let (a, b) = (grey(&[0, 0, 0, 0], 2), grey(&[51, 0, 0, 0], 2));
        let quality = Quality::between(&a, &b).unwrap();
        assert!((quality.mse - 0.01).abs() < 1e-12);
        assert!((quality.psnr_db - 20.0).abs() < 1e-9);
        assert!((quality.l1 - 0.05).abs() < 1e-12);
        assert_eq!(Agreement::between(&a, &b).unwrap().max_abs, 51);
    }

    #[test]
    fn the_largest_errors_of_many_pixels_add_up() {
        let [black, white] = [0.0, 1.0].map(|v| Image::filled(300, 500, [v; 3]).unwrap());
        let quality = Quality::between(&black, &white).unwrap();
        assert_eq!([quality.mse, quality.l1], [1.0; 2]);
        assert_eq!(mse(&black, &white).unwrap(), 1.0);
    }

    #[test]
    fn equal_pictures_are_infinitely_alike() {
        let a = noise(17, 23, 1);
        let quality = Quality::between(&a, &a).unwrap();
        assert_eq!(
            quality,
            Quality {
                details_kept: None,
                psnr_db: f64::INFINITY,
                ssim: 1.0,
                mse: 0.0,
                l1: 0.0,
                ssimulacra2: 100.0
            }
        );
        let agreement = Agreement::between(&a, &a).unwrap();
        assert_eq!(
            agreement,
            Agreement {
                psnr_db: f64::INFINITY,
                max_abs: 0,
                patch_abs: 0,
            }
        );
    }

    #[test]
    fn infinity_is_null_in_json_and_comes_back() {
        let quality = Quality {
            details_kept: None,
            psnr_db: f64::INFINITY,
            ssim: 1.0,
            mse: 0.0,
            l1: 0.0,
            ssimulacra2: 100.0,
        };
        let json = serde_json::to_string(&quality).unwrap();
        assert_eq!(
            json,
            r#"{"psnr_db":null,"ssim":1.0,"mse":0.0,"l1":0.0,"ssimulacra2":100.0}"#
        );
        assert_eq!(serde_json::from_str::<Quality>(&json).unwrap(), quality);
    }

    #[test]
    fn a_lost_dot_is_lost_where_it_is() {
        let is_dot = |x: usize, y: usize| (20..22).contains(&x) && (30..32).contains(&y);
        let value = |x, y, _| if is_dot(x, y) { 0.3_f32 } else { 1.0 };
        let dotted = Image::from_fn(64, 64, 1, value).unwrap();
        let blank = Image::filled(64, 64, [1.0; 3]).unwrap();
        let lost = details_lost(&dotted, &blank).unwrap();
        let expected = |i: usize| f32::from(u8::from(is_dot(i % 64, i / 64)));
        assert!((0..64 * 64).all(|i| lost[i] == expected(i)));
        assert!(
            details_lost(&dotted, &dotted)
                .unwrap()
                .iter()
                .all(|v| *v == 0.0)
        );
    }

    #[test]
    fn transparency_is_compared_on_white() {
        let clear = noise(4, 4, 1).with_alpha(vec![0.0; 16]).unwrap();
        let white = Image::filled(4, 4, [1.0; 3]).unwrap();
        assert_eq!(mse(&clear, &white).unwrap(), 0.0);
    }

    #[test]
    fn sizes_must_match() {
        let error = mse(&noise(2, 3, 1), &noise(3, 2, 1)).unwrap_err();
        assert!(error.to_string().contains("2×3 and 3×2"), "{error}");
    }
}
