//! JPEG that the general decoder refuses: kinds to be named, and inks. The one door of `zune-jpeg`.

use ::image::metadata::Orientation;
use ::image::{DynamicImage, ImageBuffer, ImageFormat};
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::image::decoded::{Coding, Decoded, Failure, damaged, unsupported};
use crate::image::header::{self, JpegFrame};

/// The amounts of ink of a picture of four, that is within its limits; `None` if the picture has other colours. Fails on a kind of
/// JPEG that is not read.
pub(super) fn inks(bytes: &[u8]) -> Result<Option<Decoded>, Failure> {
    let Some(frame) = header::jpeg_frame(bytes) else {
        return Ok(None);
    };
    let kind = match frame {
        JpegFrame { coding: 3, .. } => "lossless JPEG".into(),
        JpegFrame { coding: 9.., .. } => "arithmetic coding".into(),
        JpegFrame { coding: 5..=7, .. } => "hierarchical JPEG".into(),
        JpegFrame { bits, .. } if bits != 8 => format!("{bits} bits per sample"),
        _ => String::new(),
    };
    if !kind.is_empty() {
        return Err(unsupported(ImageFormat::Jpeg, kind));
    }
    if frame.components != 4 {
        return Ok(None);
    }
    let failed = |error: DecodeErrors| damaged(ImageFormat::Jpeg, error.to_string());
    let mut decoder = JpegDecoder::new(ZCursor::new(bytes));
    let options = || {
        let most = usize::from(u16::MAX);
        let options = DecoderOptions::default().set_strict_mode(false);
        options.set_max_width(most).set_max_height(most)
    };
    // Read the headers first: asking for the colour space of the file keeps the decoder from converting.
    decoder.set_options(options());
    decoder.decode_headers().map_err(failed)?;
    let space = decoder.input_colorspace().unwrap_or(ColorSpace::CMYK);
    decoder.set_options(options().jpeg_set_out_colorspace(space));
    let mut samples = decoder.decode().map_err(failed)?;
    // Adobe's programs store 255 less the amount of ink.
    for pixel in samples.as_chunks_mut().0 {
        *pixel = ink(*pixel, space == ColorSpace::YCCK, frame.is_adobe);
    }
    let (width, height) = decoder.dimensions().unwrap_or_default();
    let pixels = ImageBuffer::from_raw(width as u32, height as u32, samples);
    let pixels = pixels.ok_or_else(|| damaged(ImageFormat::Jpeg, "too few samples"))?;
    let mut picture = DynamicImage::ImageRgba8(pixels);
    let exif = decoder.exif().map(Vec::as_slice);
    let orientation = exif.and_then(Orientation::from_exif_chunk);
    picture.apply_orientation(orientation.unwrap_or(Orientation::NoTransforms));
    Ok(Some(Decoded {
        is_ink: true,
        coding: decoder.icc_profile().map(Coding::Icc),
        ..Decoded::plain(picture)
    }))
}

/// Amounts of ink of a pixel as it is stored: with luma and chroma for the three colours, or inverted.
fn ink(stored: [u8; 4], is_luma: bool, is_inverted: bool) -> [u8; 4] {
    let [y, cb, cr, black] = stored;
    let [cyan, magenta, yellow] = if is_luma {
        // JFIF's matrix gives red, green and blue; each ink is 255 less one of these.
        let (y, cb, cr) = (f32::from(y), f32::from(cb) - 128.0, f32::from(cr) - 128.0);
        let green = y - 0.344_136 * cb - 0.714_136 * cr;
        let level = |v: f32| 255 - (v + 0.5) as u8;
        [level(y + 1.402 * cr), level(green), level(y + 1.772 * cb)]
    } else {
        [y, cb, cr]
    };
    let stored = [cyan, magenta, yellow, black];
    if is_inverted {
        stored.map(|v| 255 - v)
    } else {
        stored
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inks_are_the_same_however_they_are_stored() {
        assert_eq!(ink([1, 2, 3, 4], false, false), [1, 2, 3, 4]);
        assert_eq!(ink([254, 253, 252, 251], false, true), [1, 2, 3, 4]);
        // Neutral luma 200 is 55 of each ink stored as such, which Adobe's marker inverts.
        assert_eq!(ink([200, 128, 128, 9], true, false), [55, 55, 55, 9]);
        assert_eq!(ink([200, 128, 128, 9], true, true), [200, 200, 200, 246]);
    }
}
