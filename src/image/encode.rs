//! Encodes a picture as PNG or JPEG.

use ::image::codecs::png::{CompressionType, FilterType, PngEncoder};
use ::image::{ExtendedColorType, ImageEncoder, ImageResult};

use super::{Image, level};
use crate::error::{Error, ErrorKind, Result};

/// 8-bit RGB, or RGBA where there is alpha.
pub(super) fn png(image: &Image) -> Result<Vec<u8>> {
    let rgb = image.to_rgb8();
    let (samples, color) = match image.alpha() {
        Some(alpha) => (with_alpha(&rgb, alpha), ExtendedColorType::Rgba8),
        None => (rgb, ExtendedColorType::Rgb8),
    };
    encoded(image, "PNG", |bytes, [width, height]| {
        PngEncoder::new_with_quality(bytes, CompressionType::Default, FilterType::Adaptive)
            .write_image(&samples, width, height, color)
    })
}

/// 8-bit RGB.
#[cfg(feature = "cli")]
pub(super) fn jpeg(image: &Image, quality: u8) -> Result<Vec<u8>> {
    encoded(image, "JPEG", |bytes, [width, height]| {
        ::image::codecs::jpeg::JpegEncoder::new_with_quality(bytes, quality).write_image(
            &image.to_rgb8(),
            width,
            height,
            ExtendedColorType::Rgb8,
        )
    })
}

/// The file that `encode` makes of a picture of these sides.
fn encoded(
    image: &Image,
    format: &str,
    encode: impl FnOnce(&mut Vec<u8>, [u32; 2]) -> ImageResult<()>,
) -> Result<Vec<u8>> {
    let [width, height] = [image.width(), image.height()];
    // PNG stores a side in 31 bits.
    if width.max(height) > i32::MAX as usize {
        let most = i32::MAX;
        let message =
            format!("a PNG of {width}×{height} px is not possible: at most {most} px per side");
        return Err(Error::new(ErrorKind::Picture, message));
    }
    let mut bytes = Vec::new();
    encode(&mut bytes, [width as u32, height as u32]).map_err(|e| {
        let message = format!("cannot encode the picture as {format}: {e}");
        Error::new(ErrorKind::Picture, message).caused_by(e)
    })?;
    Ok(bytes)
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
