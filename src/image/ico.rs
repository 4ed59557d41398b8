//! ICO: the largest of its pictures, as a file of its own.

use ::image::ImageFormat;

use super::decoded::{Failure, damaged};
use super::header::{le16, le32};

/// The bytes that a PNG begins with.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The largest picture of an icon, among equals the one of most bits: a PNG, of whichever kind, or an icon of this picture alone,
/// which the general decoder reads.
pub(super) fn largest(bytes: &[u8]) -> Result<(Vec<u8>, ImageFormat), Failure> {
    let count = le16(bytes, 4).unwrap_or(0) as usize;
    let entries = (0..count).map_while(|i| bytes.get(6 + 16 * i..22 + 16 * i));
    let entries: Vec<&[u8]> = entries.collect();
    // A byte can't hold 256, so 0 stands for it.
    let side = |byte: u8| if byte == 0 { 256 } else { u32::from(byte) };
    let worth = |entry: &&&[u8]| (side(entry[0]) * side(entry[1]), le16(entry, 6));
    // Of equal entries the first.
    let best = entries.iter().rev().max_by_key(worth);
    let entry = best.ok_or_else(|| damaged(ImageFormat::Ico, "it holds no picture"))?;
    let (length, start) = (le32(entry, 8).unwrap_or(0), le32(entry, 12).unwrap_or(0));
    let whole = bytes.get(start as usize..).unwrap_or_default();
    // The decoder of the picture reports if it is cut short.
    let picture = whole.get(..length as usize).unwrap_or(whole);
    if picture.starts_with(PNG) {
        return Ok((picture.to_vec(), ImageFormat::Png));
    }
    // One entry, whose sides are those of the bitmap's header, which counts the rows of a mask, too.
    let side = |at, rows| le32(picture, at).map_or(0, |side| (side / rows) as u8);
    let head = [0, 0, 1, 0, 1, 0, side(4, 1), side(8, 2)];
    let place = 22_u32.to_le_bytes();
    let alone = [&head[..], &entry[2..12], &place, picture].concat();
    Ok((alone, ImageFormat::Ico))
}
