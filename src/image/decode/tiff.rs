//! TIFF: from the samples of the crate `tiff` to a picture. The one door of that crate.

use std::borrow::Cow;
use std::cell::Cell;
use std::io::{Read, Seek};

use ::image::metadata::Orientation;
use ::image::{DynamicImage, ImageBuffer, ImageError, ImageFormat};
use tiff::decoder::{self, Decoder, DecodingResult};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use super::{Limits, Supply, check_size};
use crate::image::decoded::{Coding, Decoded, Failure, damaged, unsupported};
use crate::image::header::is_big_tiff;

/// Light and colour differences of `YCbCr`, where a file does not say which.
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];
const REFERENCE: [f64; 6] = [0.0, 255.0, 128.0, 255.0, 128.0, 255.0];

/// Extra samples that are alpha, premultiplied and straight.
const ASSOCIATED: u16 = 1;
const UNASSOCIATED: u16 = 2;

/// Values of `PhotometricInterpretation` for numbers of colours, and of grey.
const PALETTE: u16 = 3;
const GREY: u16 = 1;

/// The tag with the meaning of samples.
const INTERPRETATION: u16 = 262;

/// The first page.
pub(super) fn read(bytes: &[u8], ran_out: &Cell<bool>, limits: Limits) -> Result<Decoded, Failure> {
    let (bytes, is_palette) = unfolded(bytes);
    let mut file = Decoder::new(Supply::new(&bytes, ran_out)).map_err(explained)?;
    let (width, height) = file.dimensions().map_err(explained)?;
    check_size(width, height, limits)?;
    let most = usize::try_from(limits.max_bytes).unwrap_or(usize::MAX);
    let mut limits = decoder::Limits::default();
    limits.decoding_buffer_size = most;
    limits.intermediate_buffer_size = most;
    limits.ifd_value_size = most;
    file = file.with_limits(limits);
    let color = file.colortype().map_err(explained)?;
    let extras = file.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples);
    let extra = extras.ok().flatten().and_then(|tags| tags.first().copied());
    let has_alpha = matches!(extra, Some(ASSOCIATED | UNASSOCIATED));
    // Samples of a pixel in the file, and those of the picture among them: 1 grey, 2 with alpha, 3 RGB, 4 RGBA or inks.
    let (stored, channels) = match color {
        ColorType::Gray(_) => (1, 1),
        ColorType::RGB(_) | ColorType::YCbCr(_) => (3, 3),
        ColorType::RGBA(_) | ColorType::CMYK(_) => (4, 4),
        ColorType::Multiband { num_samples, .. } => {
            (usize::from(num_samples), 1 + usize::from(has_alpha))
        }
        other => {
            let kind = format!("colour type {other:?}");
            return Err(unsupported(ImageFormat::Tiff, kind));
        }
    };
    let bits = color.bit_depth();
    let palette = is_palette.then(|| palette(&mut file, bits)).transpose()?;
    let mut read = DecodingResult::U8(Vec::new());
    let layout = file.read_image_to_buffer(&mut read).map_err(explained)?;
    // A buffer shorter than the whole picture means that the limit has cut it off.
    if read.as_buffer(0).as_bytes().len() < layout.complete_len {
        return Err(too_large());
    }
    let pixels = width as usize * height as usize;
    // A row of a page of planes is one of a plane.
    let row = width as usize * if layout.planes > 1 { 1 } else { stored };
    let (numbers, most) = numbers(read, bits, row)?;
    if numbers.len() < pixels * layout.planes.max(stored) {
        return Err(damaged(ImageFormat::Tiff, "its samples are too few"));
    }
    let to_rgb = match color {
        ColorType::YCbCr(8) => Some(rgb_of_ycbcr(&mut file)),
        ColorType::YCbCr(_) => {
            let kind = "YCbCr of other than 8 bits per sample";
            return Err(unsupported(ImageFormat::Tiff, kind));
        }
        _ => None,
    };
    let is_ink = matches!(color, ColorType::CMYK(_));
    let is_multiplied = extra == Some(ASSOCIATED) && !is_ink;
    // Red, green, blue and alpha of a pixel, or its inks.
    let pixel = |i: usize| {
        let number = |c: usize| match layout.planes {
            2.. => numbers[c * pixels + i],
            _ => numbers[i * stored + c],
        };
        if let Some(palette) = &palette {
            let [red, green, blue] = palette.get(number(0) as usize).copied().unwrap_or_default();
            return [red, green, blue, 1.0];
        }
        let level = |c: usize| number(c) / most;
        let mut pixel = match channels {
            1 => [level(0), level(0), level(0), 1.0],
            2 => [level(0), level(0), level(0), level(1)],
            3 => [level(0), level(1), level(2), 1.0],
            _ => [level(0), level(1), level(2), level(3)],
        };
        if let Some(to_rgb) = &to_rgb {
            let [red, green, blue] = to_rgb([0, 1, 2].map(|c| f64::from(number(c))));
            pixel = [red, green, blue, 1.0];
        }
        let [colors @ .., alpha] = &mut pixel;
        for color in colors.iter_mut().filter(|_| is_multiplied) {
            let straight = *color / *alpha;
            *color = if *alpha > 0.0 {
                straight.clamp(0.0, 1.0)
            } else {
                0.0
            };
        }
        pixel
    };
    // A picture without alpha takes no memory for it.
    let picture = if palette.is_none() && channels.is_multiple_of(2) {
        let samples = (0..pixels).flat_map(pixel).collect();
        ImageBuffer::from_raw(width, height, samples).map(DynamicImage::ImageRgba32F)
    } else {
        let opaque = |i| pixel(i).into_iter().take(3);
        let samples = (0..pixels).flat_map(opaque).collect();
        ImageBuffer::from_raw(width, height, samples).map(DynamicImage::ImageRgb32F)
    };
    let too_few = || damaged(ImageFormat::Tiff, "its samples are too few");
    let mut picture = picture.ok_or_else(too_few)?;
    let orientation = file.find_tag_unsigned::<u8>(Tag::Orientation);
    let orientation = orientation.ok().flatten().and_then(Orientation::from_exif);
    picture.apply_orientation(orientation.unwrap_or(Orientation::NoTransforms));
    Ok(Decoded {
        is_ink,
        coding: file.get_tag_u8_vec(Tag::IccProfile).ok().map(Coding::Icc),
        has_more: file.more_images(),
        picture,
    })
}

/// The samples as numbers, and the number that stands for 1. Of longer integers the first 16 bits count, which are more than can
/// be drawn. Rows of `row` samples of fewer bits than 8 begin on a byte.
fn numbers(read: DecodingResult, bits: u8, row: usize) -> Result<(Vec<f32>, f32), Failure> {
    let short = |v: u64| f32::from(v as u16);
    Ok(match read {
        DecodingResult::U8(bytes) if matches!(bits, 1 | 2 | 4) => {
            let per_byte = 8 / bits;
            let most = (1 << bits) - 1;
            // The first sample has the highest bits.
            let unpacked = |byte: &u8| {
                let byte = *byte;
                (1..=per_byte).map(move |i| f32::from(byte >> (8 - bits * i) & most))
            };
            let rows = bytes.chunks_exact(row.div_ceil(per_byte.into()).max(1));
            let rows = rows.flat_map(|packed| packed.iter().flat_map(unpacked).take(row));
            (rows.collect(), most.into())
        }
        DecodingResult::U8(v) => (v.into_iter().map(f32::from).collect(), 255.0),
        DecodingResult::U16(v) => (v.into_iter().map(f32::from).collect(), 65535.0),
        DecodingResult::U32(v) => {
            let first = v.into_iter().map(|v| short(u64::from(v) >> 16));
            (first.collect(), 65535.0)
        }
        DecodingResult::U64(v) => (v.into_iter().map(|v| short(v >> 48)).collect(), 65535.0),
        DecodingResult::F16(v) => (v.into_iter().map(|v| v.to_f32()).collect(), 1.0),
        DecodingResult::F32(v) => (v, 1.0),
        DecodingResult::F64(v) => (v.into_iter().map(|v| v as f32).collect(), 1.0),
        _ => return Err(unsupported(ImageFormat::Tiff, "signed integers")),
    })
}

/// The colours of a palette for so many bits per sample.
fn palette<R: Read + Seek>(file: &mut Decoder<R>, bits: u8) -> Result<Vec<[f32; 3]>, Failure> {
    // All reds, all greens, all blues.
    let colors = file.get_tag_u16_vec(Tag::ColorMap).map_err(explained)?;
    if bits > 16 || colors.len() != 3 << bits {
        let message = format!("its palette has {} numbers", colors.len());
        return Err(damaged(ImageFormat::Tiff, message));
    }
    // Some programs write 8 bits where there should be 16.
    let is_short = colors.iter().all(|&v| v < 256);
    let most = if is_short { 255.0 } else { 65535.0 };
    let entries = colors.len() / 3;
    let color = |i: usize| [0, 1, 2].map(|c| f32::from(colors[c * entries + i]) / most);
    Ok((0..entries).map(color).collect())
}

/// Red, green and blue of light and colour differences, 0 to 255.
fn rgb_of_ycbcr<R: Read + Seek>(file: &mut Decoder<R>) -> impl Fn([f64; 3]) -> [f32; 3] + use<R> {
    let [red, green, blue] = stated(file, Tag::Unknown(529)).unwrap_or(LUMA);
    let [black, white, cb_zero, cb_one, cr_zero, cr_one] =
        stated(file, Tag::Unknown(532)).unwrap_or(REFERENCE);
    move |[y, cb, cr]| {
        // To the full range: luma 0 to 255, differences −127 to 127 about 0.
        let y = (y - black) * 255.0 / (white - black);
        let cb = (cb - cb_zero) * 127.0 / (cb_one - cb_zero);
        let cr = (cr - cr_zero) * 127.0 / (cr_one - cr_zero);
        // Cr = (R − Y)/(2 − 2·k_R), Cb likewise, and Y = k_R·R + k_G·G + k_B·B gives G.
        let (r, b) = (y + cr * (2.0 - 2.0 * red), y + cb * (2.0 - 2.0 * blue));
        let g = (y - red * r - blue * b) / green;
        // `as` saturates.
        [r, g, b].map(|v| f32::from((v + 0.5) as u8) / 255.0)
    }
}

/// The numbers of a tag, if there are so many.
fn stated<const N: usize, R: Read + Seek>(file: &mut Decoder<R>, tag: Tag) -> Option<[f64; N]> {
    file.get_tag_f64_vec(tag).ok()?.try_into().ok()
}

fn too_large() -> Failure {
    let kind = ::image::error::LimitErrorKind::InsufficientMemory;
    ImageError::Limits(::image::error::LimitError::from_kind(kind)).into()
}

fn explained(error: TiffError) -> Failure {
    match error {
        TiffError::IoError(error) => error.into(),
        TiffError::UnsupportedError(kind) => unsupported(ImageFormat::Tiff, kind.to_string()),
        TiffError::LimitsExceeded => too_large(),
        other => damaged(ImageFormat::Tiff, other),
    }
}

/// The file with the numbers of a palette called grey, and whether there is a palette: the crate `tiff` refuses colours by
/// number, and reads them as grey.
fn unfolded(bytes: &[u8]) -> (Cow<'_, [u8]>, bool) {
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
