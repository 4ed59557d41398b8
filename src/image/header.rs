//! Checks on the raw bytes of a picture file that the decoders lack or report vaguely: a size of zero,
//! and a JPEG that is cut short.

use std::io::Cursor;

use ::image::{ImageFormat, ImageReader};

/// The name of the format, and width and height in the header of a picture file, if SVG can embed this format. No pixel is
/// decoded.
pub(crate) fn stated_size(bytes: &[u8]) -> Option<(&'static str, u32, u32)> {
    let reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .ok()?;
    let format = match reader.format()? {
        ImageFormat::Png => "png",
        ImageFormat::Jpeg => "jpeg",
        ImageFormat::Gif => "gif",
        ImageFormat::WebP => "webp",
        _ => return None,
    };
    let (width, height) = reader.into_dimensions().ok()?;
    Some((format, width, height))
}

/// True if the file is a TGA. It has no signature at the beginning: it ends as TGA 2 does, or has a header that makes sense and is
/// either as long as its samples take or has the name of one.
pub(super) fn is_tga(bytes: &[u8], is_named: bool) -> bool {
    let is_exact = || tga_length(bytes).is_some_and(|length| length == bytes.len() as u64);
    bytes.ends_with(b"TRUEVISION-XFILE.\0")
        || tga_length(bytes).is_some() && (is_named || is_exact())
}

/// The bytes of a TGA without footer, 0 if it is compressed; `None` if the header makes no sense.
fn tga_length(bytes: &[u8]) -> Option<u64> {
    let header: &[u8; 18] = bytes.first_chunk()?;
    let [id, has_map, kind, ..] = *header;
    let (entry, depth, descriptor) = (header[7], header[16], header[17]);
    let is_mapped = matches!(kind, 1 | 9);
    // Eighteen bytes without a signature: every field that has few legal values is checked.
    let is_sane = matches!(kind, 1..=3 | 9..=11)
        && has_map <= 1
        && (has_map == 1 || !is_mapped)
        && (has_map == 0 || matches!(entry, 15 | 16 | 24 | 32))
        && matches!(depth, 8 | 15 | 16 | 24 | 32)
        && descriptor & 0xc0 == 0;
    let (width, height) = (le16(bytes, 12)?, le16(bytes, 14)?);
    if !is_sane || width == 0 || height == 0 {
        return None;
    }
    let whole = |bits: u8| u64::from(bits.div_ceil(8));
    let map = u64::from(has_map) * u64::from(le16(bytes, 5)?) * whole(entry);
    // A palette, if any, lies between the header with its text and the samples.
    let samples = u64::from(width) * u64::from(height) * whole(depth);
    let length = 18 + u64::from(id) + map + samples;
    Some(if kind > 8 { 0 } else { length })
}

/// True if the file is a TIFF with 64-bit offsets.
pub(super) fn is_big_tiff(bytes: &[u8]) -> bool {
    bytes.starts_with(b"II\x2b\0") || bytes.starts_with(b"MM\0\x2b")
}

/// True if frames or pages follow the first.
pub(super) fn has_more(bytes: &[u8], format: ImageFormat) -> bool {
    match format {
        #[cfg(feature = "formats")]
        ImageFormat::Gif => gif_is_animated(bytes),
        ImageFormat::WebP => webp_is_animated(bytes),
        _ => false,
    }
}

/// True if a GIF has two frames or more. No pixel is decoded.
#[cfg(feature = "formats")]
fn gif_is_animated(bytes: &[u8]) -> bool {
    let mut options = ::gif::DecodeOptions::new();
    options.skip_frame_decoding(true);
    options.read_info(bytes).is_ok_and(|mut frames| {
        let mut has_next = || frames.next_frame_info().is_ok_and(|frame| frame.is_some());
        has_next() && has_next()
    })
}

/// True if the extended header of a WebP says that it is an animation.
fn webp_is_animated(bytes: &[u8]) -> bool {
    let is_extended = bytes.get(12..16) == Some(b"VP8X");
    is_extended && bytes.get(20).is_some_and(|flags| flags & 2 != 0)
}

/// Width and height as written in the header, where their place is fixed or easily found.
pub(super) fn size(bytes: &[u8], format: ImageFormat) -> Option<(u32, u32)> {
    match format {
        ImageFormat::Png => Some((be32(bytes, 16)?, be32(bytes, 20)?)),
        ImageFormat::Gif => Some((le16(bytes, 6)?, le16(bytes, 8)?)),
        ImageFormat::Bmp => bmp_size(bytes),
        ImageFormat::Jpeg => jpeg_size(bytes),
        _ => None,
    }
}

/// True if the JPEG's scans reach their end-of-image marker. The decoder fills missing parts with grey and reports
/// nothing.
pub(super) fn jpeg_is_whole(bytes: &[u8]) -> bool {
    segments(bytes).any(|segment| segment.marker == 0xd9)
}

/// The frame of a JPEG: how it is coded, and its samples.
#[cfg(feature = "formats")]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct JpegFrame {
    /// The marker's number: 0 to 2 baseline and progressive, 3 lossless, 9 and more arithmetic.
    pub(super) coding: u8,
    /// Bits of a sample.
    pub(super) bits: u8,
    /// Samples of a pixel.
    pub(super) components: u8,
    /// True if Adobe's marker is there, whose CMYK is inverted.
    pub(super) is_adobe: bool,
}

/// The frame of a JPEG; `None` if there is none.
#[cfg(feature = "formats")]
pub(super) fn jpeg_frame(bytes: &[u8]) -> Option<JpegFrame> {
    let frame = segments(bytes).find(|segment| is_frame(segment.marker))?;
    let is_adobe = |segment: Segment| {
        // Behind the marker and the length, 2 bytes each.
        let body = bytes.get(segment.at + 4..);
        segment.marker == 0xee && body.is_some_and(|body| body.starts_with(b"Adobe"))
    };
    Some(JpegFrame {
        coding: frame.marker - 0xc0,
        bits: *bytes.get(frame.at + 4)?,
        components: *bytes.get(frame.at + 9)?,
        is_adobe: segments(bytes).any(is_adobe),
    })
}

/// True if the marker begins a frame.
fn is_frame(marker: u8) -> bool {
    (0xc0..=0xcf).contains(&marker) && !matches!(marker, 0xc4 | 0xc8 | 0xcc)
}

fn bmp_size(bytes: &[u8]) -> Option<(u32, u32)> {
    match le32(bytes, 14)? {
        // The oldest header has 16-bit sides.
        12 => Some((le16(bytes, 18)?, le16(bytes, 20)?)),
        // A negative height means top-down rows.
        _ => Some((le32(bytes, 18)?, (le32(bytes, 22)? as i32).unsigned_abs())),
    }
}

fn jpeg_size(bytes: &[u8]) -> Option<(u32, u32)> {
    let frame = segments(bytes).find(|segment| is_frame(segment.marker))?;
    Some((be16(bytes, frame.at + 7)?, be16(bytes, frame.at + 5)?))
}

/// A marker segment of a JPEG: its marker and where its 0xff stands.
struct Segment {
    marker: u8,
    at: usize,
}

/// The marker segments of a JPEG in order, scan data skipped, up to end of image or of bytes.
fn segments(bytes: &[u8]) -> impl Iterator<Item = Segment> + '_ {
    let mut at = 2;
    std::iter::from_fn(move || {
        let start = next_marker(bytes, at)?;
        let marker = bytes[start + 1];
        at = match marker {
            // The end of the picture: nothing behind it counts.
            0xd9 => bytes.len(),
            // Restart markers, TEM and SOI stand alone.
            0x01 | 0xd0..=0xd8 => start + 2,
            _ => start + 2 + be16(bytes, start + 2)? as usize,
        };
        Some(Segment { marker, at: start })
    })
}

/// Where the next marker stands at or after `from`: 0xff and a byte that is neither fill (0xff)
/// nor stuffing (0x00).
fn next_marker(bytes: &[u8], from: usize) -> Option<usize> {
    // Scan data are skipped by the same search: in these, each 0xff is followed by 0 or by a restart marker.
    let pairs = bytes.get(from..)?.windows(2);
    let found = pairs
        .into_iter()
        .position(|p| p[0] == 0xff && !matches!(p[1], 0x00 | 0xff))?;
    Some(from + found)
}

pub(super) fn be32(bytes: &[u8], at: usize) -> Option<u32> {
    array(bytes, at).map(u32::from_be_bytes)
}

pub(super) fn le32(bytes: &[u8], at: usize) -> Option<u32> {
    array(bytes, at).map(u32::from_le_bytes)
}

fn be16(bytes: &[u8], at: usize) -> Option<u32> {
    array(bytes, at).map(|b| u16::from_be_bytes(b).into())
}

pub(super) fn le16(bytes: &[u8], at: usize) -> Option<u32> {
    array(bytes, at).map(|b| u16::from_le_bytes(b).into())
}

/// So many bytes from a place on.
fn array<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

#[cfg(test)]
#[cfg(feature = "formats")]
mod tests {
    use super::*;
    use ::image::{DynamicImage, RgbImage};

    fn file(format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let picture =
            RgbImage::from_fn(19, 11, |x, y| ::image::Rgb([x as u8 * 13, y as u8 * 20, 7]));
        DynamicImage::from(picture)
            .write_to(&mut bytes, format)
            .unwrap();
        bytes.into_inner()
    }

    #[test]
    fn sizes_are_found_where_the_formats_put_them() {
        for format in [
            ImageFormat::Png,
            ImageFormat::Gif,
            ImageFormat::Bmp,
            ImageFormat::Jpeg,
        ] {
            assert_eq!(size(&file(format), format), Some((19, 11)), "{format:?}");
        }
    }

    #[test]
    fn no_cut_of_a_jpeg_is_whole() {
        let bytes = file(ImageFormat::Jpeg);
        assert!(jpeg_is_whole(&bytes));
        for cut in 0..bytes.len() {
            assert!(!jpeg_is_whole(&bytes[..cut]), "{cut} of {}", bytes.len());
        }
    }
}
