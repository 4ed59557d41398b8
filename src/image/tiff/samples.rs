//! Rows of samples of one type, and the operations on all of them.

use ::image::{DynamicImage, ImageBuffer, ImageFormat};
use tiff::decoder::DecodingResult;

use super::{Failure, unsupported};

/// Samples on the scale of their type: integers to their largest, floats to 1.
pub(super) enum Samples {
    U8(Vec<u8>),
    U16(Vec<u16>),
    F32(Vec<f32>),
}

/// Does the same to samples of each type.
macro_rules! each {
    ($samples:expr, $vector:ident => $made:expr) => {
        match $samples {
            Samples::U8($vector) => Samples::U8($made),
            Samples::U16($vector) => Samples::U16($made),
            Samples::F32($vector) => Samples::F32($made),
        }
    };
}

impl Samples {
    /// The samples that were read. Of longer integers the first 16 bits count, which are more than can be drawn.
    pub(super) fn of(read: DecodingResult) -> Result<Self, Failure> {
        Ok(match read {
            DecodingResult::U8(samples) => Self::U8(samples),
            DecodingResult::U16(samples) => Self::U16(samples),
            DecodingResult::U32(samples) => {
                Self::U16(samples.iter().map(|&v| (v >> 16) as u16).collect())
            }
            DecodingResult::U64(samples) => {
                Self::U16(samples.iter().map(|&v| (v >> 48) as u16).collect())
            }
            DecodingResult::F16(samples) => Self::F32(samples.iter().map(|v| v.to_f32()).collect()),
            DecodingResult::F32(samples) => Self::F32(samples),
            DecodingResult::F64(samples) => Self::F32(samples.iter().map(|&v| v as f32).collect()),
            _ => return Err(unsupported(ImageFormat::Tiff, "signed integers")),
        })
    }

    /// The samples of rows of `count` of fewer bits than 8, which begin on a byte.
    pub(super) fn unpacked(self, count: usize, rows: usize, bits: u8) -> Self {
        let Self::U8(packed) = self else {
            return self;
        };
        let stride = (count * usize::from(bits)).div_ceil(8).max(1);
        let per_byte = usize::from(8 / bits);
        let sample = |row: &[u8], i: usize| {
            // The first sample has the highest bits.
            let shift = 8 - usize::from(bits) * (i % per_byte + 1);
            row[i / per_byte] >> shift & ((1 << bits) - 1)
        };
        let whole = packed.chunks_exact(stride).take(rows);
        Self::U8(
            whole
                .flat_map(|row| (0..count).map(move |i| sample(row, i)))
                .collect(),
        )
    }

    /// Samples of fewer bits than 8 on the scale of 8.
    pub(super) fn stretched(self, bits: u8) -> Self {
        // 255 is a multiple of 1, 3 and 15, so the scale ends at 255 exactly. The product wraps for no sample of so many bits.
        let factor = 255 / ((1 << bits) - 1);
        match self {
            Self::U8(samples) => {
                Self::U8(samples.iter().map(|&v| v.wrapping_mul(factor)).collect())
            }
            other => other,
        }
    }

    /// The samples of so many planes, interleaved.
    pub(super) fn interleaved(self, planes: usize) -> Self {
        fn mixed<T: Copy>(samples: &[T], planes: usize) -> Vec<T> {
            let pixels = samples.len() / planes;
            let pixel = |i| (0..planes).map(move |plane| samples[plane * pixels + i]);
            (0..pixels).flat_map(pixel).collect()
        }
        each!(self, samples => mixed(&samples, planes))
    }

    /// The first `channels` of each `stored` samples.
    pub(super) fn first_of(self, stored: usize, channels: usize) -> Self {
        fn cut<T: Copy>(samples: &[T], stored: usize, channels: usize) -> Vec<T> {
            let pixels = samples.chunks_exact(stored);
            pixels
                .flat_map(|pixel| &pixel[..channels])
                .copied()
                .collect()
        }
        each!(self, samples => cut(&samples, stored, channels))
    }

    /// The first of each `stored` samples, as numbers of entries of a palette.
    pub(super) fn indices(&self, stored: usize) -> Vec<u16> {
        match self {
            Self::U8(samples) => samples.iter().step_by(stored).map(|&v| v.into()).collect(),
            Self::U16(samples) => samples.iter().step_by(stored).copied().collect(),
            Self::F32(_) => Vec::new(),
        }
    }

    /// Divides the colours of pixels of 2 or 4 channels by their alpha, the last of these.
    pub(super) fn unmultiply(&mut self, channels: usize) {
        let straight = |color: f32, alpha: f32| {
            if alpha > 0.0 {
                (color / alpha).clamp(0.0, 1.0)
            } else {
                0.0
            }
        };
        match self {
            Self::U8(samples) => pixelwise(samples, channels, |v, a| {
                (straight(f32::from(v), f32::from(a)) * 255.0 + 0.5) as u8
            }),
            Self::U16(samples) => pixelwise(samples, channels, |v, a| {
                (straight(f32::from(v), f32::from(a)) * 65535.0 + 0.5) as u16
            }),
            Self::F32(samples) => pixelwise(samples, channels, straight),
        }
    }

    /// The picture of these samples; `None` if there are too few.
    pub(super) fn picture(self, width: u32, height: u32, channels: usize) -> Option<DynamicImage> {
        macro_rules! picture {
            ($samples:expr, $variant:ident) => {
                ImageBuffer::from_raw(width, height, $samples).map(DynamicImage::$variant)
            };
        }
        match (self, channels) {
            (Self::U8(samples), 1) => picture!(samples, ImageLuma8),
            (Self::U8(samples), 2) => picture!(samples, ImageLumaA8),
            (Self::U8(samples), 3) => picture!(samples, ImageRgb8),
            (Self::U8(samples), _) => picture!(samples, ImageRgba8),
            (Self::U16(samples), 1) => picture!(samples, ImageLuma16),
            (Self::U16(samples), 2) => picture!(samples, ImageLumaA16),
            (Self::U16(samples), 3) => picture!(samples, ImageRgb16),
            (Self::U16(samples), _) => picture!(samples, ImageRgba16),
            (Self::F32(samples), 1) => {
                picture!(samples.iter().flat_map(|&v| [v; 3]).collect(), ImageRgb32F)
            }
            (Self::F32(samples), 2) => {
                let pixels = samples.as_chunks().0.iter();
                picture!(
                    pixels.flat_map(|&[v, a]| [v, v, v, a]).collect(),
                    ImageRgba32F
                )
            }
            (Self::F32(samples), 3) => picture!(samples, ImageRgb32F),
            (Self::F32(samples), _) => picture!(samples, ImageRgba32F),
        }
    }
}

/// Changes each colour of pixels by the last of their channels.
fn pixelwise<T: Copy>(samples: &mut [T], channels: usize, change: impl Fn(T, T) -> T) {
    for pixel in samples.chunks_exact_mut(channels) {
        if let Some((&mut alpha, colors)) = pixel.split_last_mut() {
            for color in colors {
                *color = change(*color, alpha);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(samples: Samples) -> Vec<u8> {
        match samples {
            Samples::U8(samples) => samples,
            _ => panic!("other samples than bytes"),
        }
    }

    #[test]
    fn bits_are_unpacked_row_by_row_and_stretched() {
        let packed = Samples::U8(vec![0b1011_0000, 0b0100_0000]);
        let unpacked = packed.unpacked(3, 2, 1).stretched(1);
        assert_eq!(bytes(unpacked), [255, 0, 255, 0, 255, 0]);
        let packed = Samples::U8(vec![0x1f, 0xa0]);
        assert_eq!(bytes(packed.unpacked(3, 1, 4).stretched(4)), [17, 255, 170]);
    }

    #[test]
    fn planes_become_pixels_of_the_channels_that_count() {
        let planes = Samples::U8(vec![1, 2, 10, 20, 100, 200]);
        let pixels = planes.interleaved(3);
        assert_eq!(bytes(pixels.first_of(3, 2)), [1, 10, 2, 20]);
    }

    #[test]
    fn alpha_is_taken_out_of_colours_of_every_type() {
        let mut samples = Samples::U8(vec![50, 100, 7, 0, 200, 100]);
        samples.unmultiply(2);
        assert_eq!(bytes(samples), [128, 100, 0, 0, 255, 100]);
        let mut samples = Samples::F32(vec![0.25, 0.5, 0.75, 0.5]);
        samples.unmultiply(4);
        assert!(matches!(samples, Samples::F32(v) if v == [0.5, 1.0, 1.0, 0.5]));
    }

    #[test]
    fn long_integers_keep_their_first_bits() {
        let read = Samples::of(DecodingResult::U32(vec![0, 0x8000_0000, u32::MAX]));
        assert!(matches!(read, Ok(Samples::U16(v)) if v == [0, 0x8000, 0xffff]));
        assert!(Samples::of(DecodingResult::I8(vec![1])).is_err());
    }
}
