//! Interleaved rows of samples, as other libraries hold pictures, taken apart into planes.

use std::fmt;

use super::Image;
use crate::error::{Error, ErrorKind, Result};

/// A picture as rows of interleaved samples: the samples of a pixel side by side.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a, T> {
    /// Width in px.
    pub width: usize,
    /// Height in px.
    pub height: usize,
    /// Samples of a pixel: 1 is grey, 2 grey and alpha, 3 RGB, 4 RGBA. Alpha is straight, not premultiplied.
    pub channels: usize,
    /// Samples from the start of a row to the start of the next, `width·channels` or more.
    pub stride: usize,
    /// The rows; samples behind the last pixel of a row are skipped, and the last row needs none there.
    pub samples: &'a [T],
}

impl<'a, T> Rows<'a, T> {
    /// Rows without a gap between them.
    pub fn packed(width: usize, height: usize, channels: usize, samples: &'a [T]) -> Self {
        Self {
            width,
            height,
            channels,
            stride: width.saturating_mul(channels),
            samples,
        }
    }

    /// Fails where there can be no such picture.
    fn check(&self) -> Result<()> {
        let Self {
            width,
            height,
            channels,
            stride,
            samples,
        } = *self;
        check_shape(width, height, channels)?;
        let refuse = |message: String| Err(Error::new(ErrorKind::Picture, message));
        let row = width.checked_mul(channels).filter(|&row| row <= stride);
        let Some(row) = row else {
            return refuse(format!(
                "rows {stride} samples apart overlap where one has {width} pixels of {channels} samples: \
                 give a stride of width × channels or more"
            ));
        };
        // The last row needs its pixels alone, and not a whole stride. Sizes come from the caller, so no product may overflow.
        let needed = stride.checked_mul(height - 1);
        let needed = needed.and_then(|before| before.checked_add(row));
        match needed.filter(|&needed| needed <= samples.len()) {
            Some(_) => Ok(()),
            None => refuse(format!(
                "{} samples are too few for {width}×{height} px of {channels} samples, rows {stride} apart: \
                 give stride × (height − 1) + width × channels or more",
                samples.len()
            )),
        }
    }
}

/// A type of samples. They are encoded as sRGB, as in files.
pub trait Sample: Copy + fmt::Display + sealed::Sealed {
    /// The sample as a value of 0..1; `None` if it is on no known scale.
    fn level(self) -> Option<f32>;
}

/// 0 to 255.
impl Sample for u8 {
    fn level(self) -> Option<f32> {
        Some(f32::from(self) / 255.0)
    }
}

/// 0 to 65535.
impl Sample for u16 {
    fn level(self) -> Option<f32> {
        Some(f32::from(self) / 65535.0)
    }
}

/// 0 to 1. Filters overshoot a little, which is cut off; anything farther away is on another scale.
impl Sample for f32 {
    fn level(self) -> Option<f32> {
        (-OVERSHOOT..=1.0 + OVERSHOOT)
            .contains(&self)
            .then(|| self.clamp(0.0, 1.0))
    }
}

/// Sharpening and resampling overshoot by a fifth of a step at most; a scale of 0 to 255 is far beyond.
const OVERSHOOT: f32 = 0.5;

mod sealed {
    pub trait Sealed {}
    impl Sealed for u8 {}
    impl Sealed for u16 {}
    impl Sealed for f32 {}
}

/// Fails where there can be no picture of these sides and samples per pixel.
fn check_shape(width: usize, height: usize, channels: usize) -> Result<()> {
    let refuse = |message: String| Err(Error::new(ErrorKind::Picture, message));
    if width == 0 || height == 0 {
        return refuse(format!(
            "a picture of {width}×{height} has no pixels: give both sides 1 px or more"
        ));
    }
    if !(1..=4).contains(&channels) {
        return refuse(format!(
            "a pixel of {channels} samples has no meaning: \
             give 1 (grey), 2 (grey, alpha), 3 (RGB) or 4 (RGBA)"
        ));
    }
    Ok(())
}

/// The picture that the rows are.
pub(super) fn image<T: Sample>(rows: Rows<'_, T>) -> Result<Image> {
    rows.check()?;
    sampled(rows.width, rows.height, rows.channels, |x, y, c| {
        rows.samples[y * rows.stride + x * rows.channels + c]
    })
}

/// The picture whose channel `c` of the pixel (x, y) is `sample(x, y, c)`.
pub(super) fn sampled<T: Sample>(
    width: usize,
    height: usize,
    channels: usize,
    sample: impl Fn(usize, usize, usize) -> T,
) -> Result<Image> {
    check_shape(width, height, channels)?;
    let mut foreign = None;
    let mut plane = |c: usize| {
        let mut plane = Vec::with_capacity(width.saturating_mul(height));
        for y in 0..height {
            plane.extend((0..width).map(|x| {
                // A closure can't fail, so keep the first error and go on with 0.
                let sample = sample(x, y, c);
                sample.level().unwrap_or_else(|| {
                    foreign.get_or_insert_with(|| no_level(x, y, sample));
                    0.0
                })
            }));
        }
        plane
    };
    let planes = if channels < 3 {
        // All of the crate works on three planes.
        let grey = plane(0);
        [grey.clone(), grey.clone(), grey]
    } else {
        [plane(0), plane(1), plane(2)]
    };
    // 2 and 4 channels end in alpha.
    let alpha = channels.is_multiple_of(2).then(|| plane(channels - 1));
    if let Some(error) = foreign {
        return Err(error);
    }
    let image = Image::new(width, height, planes)?;
    match alpha {
        Some(alpha) => image.with_alpha(alpha),
        None => Ok(image),
    }
}

fn no_level(x: usize, y: usize, sample: impl fmt::Display) -> Error {
    let message = format!("a sample of the pixel ({x}, {y}) is {sample}: give numbers from 0 to 1");
    Error::new(ErrorKind::Picture, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2×2 px; where a sample has no meaning it is 9.
    fn rows(channels: usize, stride: usize, samples: &[u8]) -> Result<Image> {
        let (width, height) = (2, 2);
        image(Rows {
            width,
            height,
            channels,
            stride,
            samples,
        })
    }

    fn level(byte: u8) -> f32 {
        f32::from(byte) / 255.0
    }

    #[test]
    fn channels_and_strides_are_taken_apart() {
        let grey = rows(1, 3, &[10, 20, 9, 30, 40]).unwrap();
        for plane in grey.planes() {
            assert_eq!(*plane, [10, 20, 30, 40].map(level));
        }
        let clear = rows(2, 5, &[10, 0, 20, 255, 9, 30, 51, 40, 255]).unwrap();
        assert_eq!(clear.planes()[1], [10, 20, 30, 40].map(level));
        assert_eq!(clear.alpha(), Some(&[0.0, 1.0, 0.2, 1.0][..]));
        let rgb = rows(3, 7, &[1, 2, 3, 4, 5, 6, 9, 7, 8, 9, 10, 11, 12]).unwrap();
        assert_eq!(rgb.planes()[0], [1, 4, 7, 10].map(level));
        assert_eq!(rgb.planes()[2], [3, 6, 9, 12].map(level));
        assert_eq!(rgb.alpha(), None);
        let rgba = rows(
            4,
            8,
            &[1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 255, 10, 11, 12, 0],
        )
        .unwrap();
        assert_eq!(rgba.planes(), rgb.planes());
        assert_eq!(rgba.alpha(), Some(&[1.0, 1.0, 1.0, 0.0][..]));
    }

    #[test]
    fn a_function_of_the_place_says_the_same() {
        let samples: Vec<u8> = (0..24).map(|i| 10 * i).collect();
        for channels in 1..=4 {
            let packed = image(Rows::packed(3, 2, channels, &samples)).unwrap();
            let at = |x, y, c| samples[(3 * y + x) * channels + c];
            assert_eq!(sampled(3, 2, channels, at).unwrap(), packed);
        }
        let message = |width, channels, value: f32| {
            let outcome = sampled(width, 2, channels, |x, y, _| [0.0, value][x * y]);
            outcome.unwrap_err().to_string()
        };
        assert!(message(0, 3, 0.0).contains("0×2"));
        assert!(message(2, 5, 0.0).contains("give 1 (grey)"));
        assert!(message(2, 3, 9.0).contains("(1, 1) is 9"));
    }

    #[test]
    fn every_type_of_sample_says_the_same() {
        let bytes = image(Rows::packed(3, 1, 1, &[0_u8, 51, 255])).unwrap();
        let words = image(Rows::packed(3, 1, 1, &[0_u16, 13107, 65535])).unwrap();
        let floats = image(Rows::packed(3, 1, 1, &[-0.01_f32, 0.2, 1.01])).unwrap();
        assert_eq!(bytes, words);
        assert_eq!(bytes, floats);
    }

    #[test]
    fn shapes_that_do_not_fit_are_refused_with_those_that_do() {
        for (rows, words) in [
            (Rows::packed(0, 2, 3, &[0_u8; 9]), "0×2"),
            (Rows::packed(1, 1, 5, &[0; 9]), "give 1 (grey)"),
            (Rows::packed(1, 1, 0, &[0; 9]), "give 1 (grey)"),
            (
                Rows {
                    stride: 5,
                    ..Rows::packed(2, 1, 3, &[0; 9])
                },
                "stride of width × channels",
            ),
            (Rows::packed(2, 2, 3, &[0; 9]), "9 samples are too few"),
            (Rows::packed(usize::MAX, 2, 4, &[0; 9]), "overlap"),
            (
                Rows {
                    stride: usize::MAX,
                    ..Rows::packed(2, 3, 3, &[0; 9])
                },
                "too few",
            ),
        ] {
            let error = image(rows).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Picture);
            assert!(error.to_string().contains(words), "{error}");
        }
    }

    #[test]
    fn floats_on_another_scale_are_refused_with_their_place() {
        for (value, word) in [
            (f32::NAN, "NaN"),
            (200.0, "200"),
            (f32::NEG_INFINITY, "-inf"),
        ] {
            let samples = [0.5, 0.5, 0.5, value];
            let error = image(Rows::packed(1, 4, 1, &samples))
                .unwrap_err()
                .to_string();
            assert!(error.contains("(0, 3)") && error.contains(word), "{error}");
        }
    }
}
