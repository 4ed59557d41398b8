//! Encodes a picture as PNG.

use std::borrow::Cow;

use ::image::codecs::png::{CompressionType, FilterType, PngEncoder};
use ::image::{ExtendedColorType, ImageEncoder};

use super::{Image, level};
use crate::error::{Error, ErrorKind, Result};

/// 8-bit RGB, or RGBA where there is alpha.
pub(super) fn png(image: &Image) -> Result<Vec<u8>> {
    let (width, height) = size(image)?;
    let rgb = image.to_rgb8();
    let (samples, color) = match image.alpha() {
        Some(alpha) => (
            Cow::Owned(with_alpha(&rgb, alpha)),
            ExtendedColorType::Rgba8,
        ),
        None => (Cow::Borrowed(&rgb), ExtendedColorType::Rgb8),
    };
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
        .write_image(&samples, width, height, color)
        .map_err(|e| {
            Error::new(
                ErrorKind::Picture,
                format!("cannot encode the picture as PNG: {e}"),
            )
            .caused_by(e)
        })?;
    Ok(bytes)
}

/// 8-bit RGB.
#[cfg(feature = "cli")]
pub(super) fn jpeg(image: &Image, quality: u8) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let (width, height) = size(image)?;
    ::image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, quality)
        .write_image(&image.to_rgb8(), width, height, ExtendedColorType::Rgb8)
        .map_err(|e| {
            let message = format!("cannot encode the picture as JPEG: {e}");
            Error::new(ErrorKind::Picture, message).caused_by(e)
        })?;
    Ok(bytes)
}

fn size(image: &Image) -> Result<(u32, u32)> {
    // PNG stores a side in 31 bits.
    let side = |n: usize| u32::try_from(n).ok().filter(|&n| n <= i32::MAX as u32);
    side(image.width())
        .zip(side(image.height()))
        .ok_or_else(|| {
            let message = format!(
                "a PNG of {}×{} px is not possible: at most {} px per side",
                image.width(),
                image.height(),
                i32::MAX
            );
            Error::new(ErrorKind::Picture, message)
        })
}

fn with_alpha(rgb: &[u8], alpha: &[f32]) -> Vec<u8> {
    let pixels = rgb.chunks_exact(3).zip(alpha);
    pixels
        .flat_map(|(p, &a)| [p[0], p[1], p[2], level(a)])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Limits;

    #[test]
    fn rgb_and_alpha_survive_a_png() {
        let plane = |k: usize| {
            (0..12)
                .map(|i| ((i * k) % 256) as f32 / 255.0)
                .collect::<Vec<_>>()
        };
        let opaque = Image::new(4, 3, [plane(1), plane(7), plane(20)]).unwrap();
        let clear = opaque.clone().with_alpha(plane(21)).unwrap();
        for image in [opaque, clear] {
            let bytes = png(&image).unwrap();
            assert_eq!(
                Image::decode(&bytes, "a.png", Limits::default()).unwrap(),
                image
            );
        }
    }
}
