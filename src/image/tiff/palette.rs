//! Colours by number. The crate `tiff` refuses these pictures, and reads them once the file calls its numbers grey.

use std::borrow::Cow;
use std::io::{Read, Seek};

use ::image::ImageFormat;
use tiff::decoder::Decoder;
use tiff::tags::Tag;

use super::samples::Samples;
use super::{Failure, damaged, explained};
use crate::image::header::is_big_tiff;

/// Values of `PhotometricInterpretation` for numbers of colours, and of grey.
const PALETTE: u16 = 3;
const GREY: u16 = 1;

/// The tag with the meaning of samples.
const INTERPRETATION: u16 = 262;

/// The file with the numbers of a palette called grey, and whether there is a palette.
pub(in crate::image) fn unfolded(bytes: &[u8]) -> (Cow<'_, [u8]>, bool) {
    match interpretation(bytes) {
        Some((at, PALETTE)) => {
            let mut changed = bytes.to_vec();
            let grey = match bytes.first() {
                Some(b'I') => GREY.to_le_bytes(),
                _ => GREY.to_be_bytes(),
            };
            changed[at..at + 2].copy_from_slice(&grey);
            (Cow::Owned(changed), true)
        }
        _ => (Cow::Borrowed(bytes), false),
    }
}

/// Where the first page states the meaning of its samples, and that meaning.
fn interpretation(bytes: &[u8]) -> Option<(usize, u16)> {
    // Offsets and counts of 4 and 2 bytes, or of 8.
    let (first, count, entry, value) = match is_big_tiff(bytes) {
        true => (number(bytes, 8, 8)?, 8, 20, 12),
        false => (number(bytes, 4, 4)?, 2, 12, 8),
    };
    let entries = number(bytes, first, count)?;
    let places = (0..entries).map_while(|i| first.checked_add(count + entry * i));
    for at in places.take_while(|at| at.saturating_add(entry) <= bytes.len()) {
        if number(bytes, at, 2)? == usize::from(INTERPRETATION) {
            let stated = number(bytes, at + value, 2)?;
            return Some((at + value, stated as u16));
        }
    }
    None
}

/// The number of so many bytes at a place, in the file's order.
fn number(bytes: &[u8], at: usize, length: usize) -> Option<usize> {
    let digits = bytes.get(at..at.checked_add(length)?)?;
    let add = |sum: u64, digit: &u8| sum << 8 | u64::from(*digit);
    let number = match bytes.first()? {
        b'I' => digits.iter().rev().fold(0, add),
        _ => digits.iter().fold(0, add),
    };
    usize::try_from(number)
        .ok()
        .filter(|&n| n < usize::MAX / 64)
}

/// The colours of a palette: all reds, all greens, all blues.
pub(super) struct Palette(Vec<u16>);

impl Palette {
    /// The palette of a file of so many bits per sample.
    pub(super) fn read<R: Read + Seek>(file: &mut Decoder<R>, bits: u8) -> Result<Self, Failure> {
        let colors = file.get_tag_u16_vec(Tag::ColorMap).map_err(explained)?;
        if bits > 16 || colors.len() != 3 << bits {
            let message = format!("its palette has {} numbers", colors.len());
            return Err(damaged(ImageFormat::Tiff, message));
        }
        // Some programs write 8 bits where there should be 16.
        let is_short = colors.iter().all(|&v| v < 256);
        let factor = if is_short { 257 } else { 1 };
        Ok(Self(colors.iter().map(|&v| v * factor).collect()))
    }

    /// Red, green and blue of each number.
    pub(super) fn colors(&self, indices: &[u16]) -> Samples {
        let entries = self.0.len() / 3;
        let color = |&i: &u16| {
            let level = |c: usize| self.0.get(c * entries + usize::from(i));
            [0, 1, 2].map(|c| level(c).copied().unwrap_or(0))
        };
        Samples::U16(indices.iter().flat_map(color).collect())
    }
}
