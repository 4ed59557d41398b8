//! DDS that the general decoder refuses: uncompressed pictures, and sizes that are no multiple of 4.

use std::borrow::Cow;
use std::cell::Cell;

use ::image::{DynamicImage, ImageBuffer, ImageFormat};

use super::{Limits, check_size, general};
use crate::image::decoded::{Decoded, Failure, damaged, unsupported};
use crate::image::header::le32;

/// Bytes of the header, and of the one that may follow it.
const HEADER: usize = 128;
const FURTHER: usize = 20;

/// Flags of the pixel format.
const HAS_ALPHA: u32 = 0x1;
const IS_NAMED: u32 = 0x4;
const IS_GREY: u32 = 0x2_0000;

/// The first picture of a DDS.
pub(super) fn read(bytes: &[u8], ran_out: &Cell<bool>, limits: Limits) -> Result<Decoded, Failure> {
    let (width, height) = size(bytes).unwrap_or_default();
    check_size(width, height, limits)?;
    let decoded = match uncompressed(bytes)? {
        Some(picture) => Decoded::plain(picture),
        None => {
            // Compressed blocks are 4×4 px: decode whole blocks, and cut the picture out of them.
            let blocks = general(&padded(bytes), ran_out, ImageFormat::Dds, limits)?;
            Decoded::plain(blocks.picture.crop_imm(0, 0, width, height))
        }
    };
    Ok(Decoded {
        has_more: has_more(bytes),
        ..decoded
    })
}

/// Width and height.
fn size(bytes: &[u8]) -> Option<(u32, u32)> {
    Some((le32(bytes, 16)?, le32(bytes, 12)?))
}

/// True if faces of a cube, layers or smaller copies follow the first picture; copies do not count.
fn has_more(bytes: &[u8]) -> bool {
    let is_cube_or_volume = |caps: u32| caps & 0x20_0200 != 0;
    le32(bytes, 112).is_some_and(is_cube_or_volume)
}

/// The file with both sides rounded up to multiples of 4, if they are none: its blocks have that size.
fn padded(bytes: &[u8]) -> Cow<'_, [u8]> {
    let Some((width, height)) = size(bytes) else {
        return Cow::Borrowed(bytes);
    };
    let whole = |side: u32| side.checked_next_multiple_of(4).unwrap_or(side);
    if (whole(width), whole(height)) == (width, height) {
        return Cow::Borrowed(bytes);
    }
    let mut changed = bytes.to_vec();
    changed[12..16].copy_from_slice(&whole(height).to_le_bytes());
    changed[16..20].copy_from_slice(&whole(width).to_le_bytes());
    Cow::Owned(changed)
}

/// The picture, if it is not compressed. Its size is within the limits.
fn uncompressed(bytes: &[u8]) -> Result<Option<DynamicImage>, Failure> {
    let (width, height) = size(bytes).unwrap_or_default();
    let Some(layout) = Layout::read(bytes)? else {
        return Ok(None);
    };
    let row = width as usize * layout.bytes;
    // Some programs write a stride that is too small or 0: rows then follow without a gap.
    let stride = layout.stride.max(row);
    let rows = bytes.get(layout.start..).unwrap_or_default();
    let rows = rows.chunks(stride).take(height as usize);
    let pixels = rows.flat_map(|row| row.chunks_exact(layout.bytes).take(width as usize));
    let samples: Vec<u16> = pixels.flat_map(|pixel| layout.color(pixel)).collect();
    let cut_short = || std::io::Error::from(std::io::ErrorKind::UnexpectedEof);
    let picture = ImageBuffer::from_raw(width, height, samples).ok_or_else(cut_short)?;
    let picture = DynamicImage::ImageRgba16(picture);
    Ok(Some(match layout.masks[3] {
        0 => picture.into_rgb16().into(),
        _ => picture,
    }))
}

/// Places of colours in a pixel.
struct Layout {
    /// Where the pixels begin.
    start: usize,
    /// Bytes of a pixel, 1 to 4.
    bytes: usize,
    /// Bytes from row to row, 0 if nothing lies between them.
    stride: usize,
    /// Bits of red, green, blue and alpha.
    masks: [u32; 4],
}

impl Layout {
    /// The layout of a file; `None` if it is compressed.
    fn read(bytes: &[u8]) -> Result<Option<Self>, Failure> {
        let field = |at| le32(bytes, at).ok_or_else(|| damaged(ImageFormat::Dds, "no header"));
        let flags = field(80)?;
        let stride = match field(8)? & 0x8 {
            0 => 0,
            _ => field(20)? as usize,
        };
        if flags & IS_NAMED != 0 {
            return match bytes.get(84..88) {
                Some(b"DX10") => Ok(Self::numbered(field(HEADER)?, stride)),
                _ => Ok(None),
            };
        }
        let bits = field(88)?;
        let mut masks = [field(92)?, field(96)?, field(100)?, field(104)?];
        if flags & IS_GREY != 0 {
            // Grey has one mask, the red one.
            masks = [masks[0], masks[0], masks[0], masks[3]];
        }
        if flags & HAS_ALPHA == 0 {
            masks[3] = 0;
        }
        if !matches!(bits, 8 | 16 | 24 | 32) || masks[..3].contains(&0) {
            let kind = format!("pixels of {bits} bits without red, green and blue");
            return Err(unsupported(ImageFormat::Dds, kind));
        }
        Ok(Some(Self {
            start: HEADER,
            bytes: bits as usize / 8,
            stride,
            masks,
        }))
    }

    /// The layout of a format by its number in the further header; `None` if it is none of 8 bits per sample.
    fn numbered(format: u32, stride: usize) -> Option<Self> {
        const LOW: u32 = 0xff;
        let (bytes, masks) = match format {
            28 | 29 => (4, [LOW, LOW << 8, LOW << 16, LOW << 24]),
            87 | 91 => (4, [LOW << 16, LOW << 8, LOW, LOW << 24]),
            88 | 93 => (4, [LOW << 16, LOW << 8, LOW, 0]),
            61 => (1, [LOW, LOW, LOW, 0]),
            _ => return None,
        };
        Some(Self {
            start: HEADER + FURTHER,
            bytes,
            stride,
            masks,
        })
    }

    /// Red, green, blue and alpha of a pixel.
    fn color(&self, pixel: &[u8]) -> [u16; 4] {
        let add = |sum: u32, byte: &u8| sum << 8 | u32::from(*byte);
        // Little-endian: the last byte has the highest bits.
        let pixel = pixel.iter().rev().fold(0, add);
        self.masks.map(|mask| match mask {
            // A channel without bits is opaque; only alpha may have none.
            0 => u16::MAX,
            _ => {
                let shift = mask.trailing_zeros();
                // Any number of bits to 16, rounded: 5 or 6 bits reach both ends of the scale. In 64 bits, since a mask may have
                // 32.
                let (value, most) = (u64::from((pixel & mask) >> shift), u64::from(mask >> shift));
                ((value * 65535 + most / 2) / most) as u16
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of one row of pixels with these masks.
    fn file(flags: u32, bits: u32, masks: [u32; 4], width: u32, pixels: &[u8]) -> Vec<u8> {
        let mut bytes = vec![0; HEADER];
        bytes[..4].copy_from_slice(b"DDS ");
        let fields = [
            (4, 124),
            (12, 1),
            (16, width),
            (76, 32),
            (80, flags),
            (88, bits),
        ];
        let masks = masks
            .into_iter()
            .enumerate()
            .map(|(i, mask)| (92 + 4 * i, mask));
        for (at, value) in fields.into_iter().chain(masks) {
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        }
        bytes.extend(pixels);
        bytes
    }

    fn samples(bytes: &[u8]) -> Vec<u8> {
        let picture = uncompressed(bytes).ok().flatten().unwrap();
        picture.into_rgba8().into_raw()
    }

    #[test]
    fn colours_are_found_by_their_bits() {
        let bits565 = [0xf800, 0x7e0, 0x1f, 0];
        let bytes = file(0x40, 16, bits565, 2, &[0x00, 0xf8, 0xff, 0xff]);
        assert_eq!(samples(&bytes), [255, 0, 0, 255, 255, 255, 255, 255]);
        let grey = file(IS_GREY | HAS_ALPHA, 16, [0xff, 0, 0, 0xff00], 1, &[7, 9]);
        assert_eq!(samples(&grey), [7, 7, 7, 9]);
    }

    #[test]
    fn what_lacks_pixels_or_colours_is_no_picture() {
        let short = file(0x40, 24, [0xff, 0xff00, 0xff_0000, 0], 2, &[1, 2, 3]);
        assert!(uncompressed(&short).is_err());
        let alpha = file(0x2, 8, [0, 0, 0, 0xff], 1, &[1]);
        assert!(uncompressed(&alpha).is_err());
        assert!(uncompressed(&short[..100]).is_err());
        assert!(uncompressed(&file(IS_NAMED, 0, [0; 4], 4, &[])).is_ok_and(|p| p.is_none()));
    }

    #[test]
    fn sides_become_whole_blocks() {
        let bytes = file(IS_NAMED, 0, [0; 4], 5, &[]);
        assert_eq!(size(&padded(&bytes)), Some((8, 4)));
        assert_eq!(size(&padded(&padded(&bytes))), Some((8, 4)));
    }
}
