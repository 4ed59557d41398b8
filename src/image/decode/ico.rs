//! ICO: the largest of its pictures, a PNG or a bitmap without a head and with a mask.

use std::cell::Cell;
use std::io::Cursor;

use ::image::codecs::bmp::BmpDecoder;
use ::image::{DynamicImage, ImageDecoder, ImageFormat};

use super::{Limits, check_size, general};
use crate::image::decoded::{Decoded, Failure, damaged};
use crate::image::header::{le16, le32};

/// The bytes that a PNG begins with.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The largest picture of an icon.
pub(super) fn read(bytes: &[u8], ran_out: &Cell<bool>, limits: Limits) -> Result<Decoded, Failure> {
    match largest(bytes)? {
        Largest::Png(file) => general(file, ran_out, ImageFormat::Png, limits),
        Largest::Deep(file) => general(&file, ran_out, ImageFormat::Ico, limits),
        Largest::Bitmap(bitmap) => {
            let (width, height) = bitmap.size;
            check_size(width, height, limits)?;
            Ok(Decoded::plain(bitmap.picture()?))
        }
    }
}

/// The largest picture of an icon.
enum Largest<'a> {
    /// A PNG file.
    Png(&'a [u8]),
    /// An icon of this picture alone, of 32 bits, which the general decoder reads.
    Deep(Vec<u8>),
    /// A bitmap of fewer bits.
    Bitmap(Bitmap<'a>),
}

/// A bitmap without alpha, followed by a mask.
struct Bitmap<'a> {
    bytes: &'a [u8],
    /// Width and height in px.
    size: (u32, u32),
    bits: u32,
}

/// The largest picture of an icon; among equals the one of most bits.
fn largest(bytes: &[u8]) -> Result<Largest<'_>, Failure> {
    let count = le16(bytes, 4).unwrap_or(0) as usize;
    let entries = (0..count).map_while(|i| bytes.get(6 + 16 * i..22 + 16 * i));
    let entries: Vec<&[u8]> = entries.collect();
    // A byte can't hold 256, so 0 stands for it.
    let side = |byte: u8| if byte == 0 { 256 } else { u32::from(byte) };
    let rank = |entry: &&&[u8]| (side(entry[0]) * side(entry[1]), le16(entry, 6));
    // Of equal entries the first.
    let best = entries.iter().rev().max_by_key(rank);
    let entry = best.ok_or_else(|| damaged(ImageFormat::Ico, "it holds no picture"))?;
    let (length, start) = (le32(entry, 8).unwrap_or(0), le32(entry, 12).unwrap_or(0));
    let whole = bytes.get(start as usize..).unwrap_or_default();
    let picture = whole.get(..length as usize);
    // The decoder of the picture reports if it is cut short.
    let picture = picture.unwrap_or(whole);
    if picture.starts_with(PNG) {
        return Ok(Largest::Png(picture));
    }
    let bitmap = Bitmap::new(picture).ok_or_else(cut_short)?;
    Ok(match bitmap.bits {
        32 => Largest::Deep(alone(entry, picture)),
        _ => Largest::Bitmap(bitmap),
    })
}

/// An icon of one entry.
fn alone(entry: &[u8], picture: &[u8]) -> Vec<u8> {
    let head = [0, 0, 1, 0, 1, 0];
    let place = 22_u32.to_le_bytes();
    [&head[..], &entry[..12], &place, picture].concat()
}

fn cut_short() -> Failure {
    std::io::Error::from(std::io::ErrorKind::UnexpectedEof).into()
}

impl<'a> Bitmap<'a> {
    /// The bitmap that begins with its header; `None` if that is cut short.
    fn new(bytes: &'a [u8]) -> Option<Self> {
        // The header states the height of picture and mask together.
        let size = (le32(bytes, 4)?, le32(bytes, 8)? / 2);
        let bits = le16(bytes, 14)?;
        Some(Self { bytes, size, bits })
    }

    /// The picture, transparent where the mask is set. Its size is within the limits.
    fn picture(&self) -> Result<DynamicImage, Failure> {
        let mut bitmap = self.bytes.to_vec();
        // The header counts the mask's rows, too: the decoder has to read half of that.
        bitmap[8..12].copy_from_slice(&self.size.1.to_le_bytes());
        let decoder = BmpDecoder::new_without_file_header(Cursor::new(&bitmap))?;
        if decoder.dimensions() != self.size {
            return Err(damaged(ImageFormat::Ico, "its sides contradict each other"));
        }
        let mut picture = DynamicImage::from_decoder(decoder)?.into_rgba8();
        // The mask is stored from the lowest row up, the highest bit of a byte first.
        let rows = picture.rows_mut().rev();
        for (row, mask) in rows.zip(self.mask()) {
            let bits = mask
                .iter()
                .flat_map(|byte| (0..8).rev().map(move |bit| byte >> bit & 1));
            for (pixel, is_hidden) in row.zip(bits) {
                if is_hidden == 1 {
                    pixel.0[3] = 0;
                }
            }
        }
        Ok(picture.into())
    }

    /// The rows of the mask from below, each bit a pixel. Some icons have none.
    fn mask(&self) -> impl Iterator<Item = &'a [u8]> {
        let stride = |bits: u32| u64::from(self.size.0) * u64::from(bits);
        let stride = |bits: u32| stride(bits).div_ceil(32) * 4;
        let used = le32(self.bytes, 32).unwrap_or(0);
        // Of up to 8 bits, 0 stands for a full palette.
        let palette = match (used, self.bits) {
            (0, 1..=8) => 1 << self.bits,
            _ => used,
        };
        let header = u64::from(le32(self.bytes, 0).unwrap_or(0));
        // Rows of both, pixels and mask, are padded to 4 bytes.
        let pixels = stride(self.bits) * u64::from(self.size.1);
        let start = header + 4 * u64::from(palette) + pixels;
        let start = usize::try_from(start).unwrap_or(usize::MAX);
        let mask = self.bytes.get(start..).unwrap_or_default();
        mask.chunks_exact((stride(1) as usize).max(4))
    }
}
