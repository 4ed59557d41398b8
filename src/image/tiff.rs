//! TIFF: from the samples of the crate `tiff` to a picture. The one door of that crate.

mod palette;
mod samples;

use std::io::{Read, Seek};

use ::image::metadata::Orientation;
use ::image::{ImageError, ImageFormat};
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use self::samples::Samples;
use super::decoded::{Coding, Decoded, Failure, damaged, unsupported};
use crate::error::Result;

pub(super) use palette::unfolded;

/// Light and colour differences of `YCbCr`, where a file does not say which.
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];
const REFERENCE: [f64; 6] = [0.0, 255.0, 128.0, 255.0, 128.0, 255.0];

/// Extra samples that are alpha, premultiplied and straight.
const ASSOCIATED: u16 = 1;
const UNASSOCIATED: u16 = 2;

/// The first page of at most `max_bytes` of samples, if `check` lets its width and height pass. The file is one that
/// [`unfolded`] has returned, together with `is_palette`.
pub(super) fn read(
    file: impl Read + Seek,
    is_palette: bool,
    max_bytes: u64,
    check: impl Fn(u32, u32) -> Result<()>,
) -> Result<Decoded, Failure> {
    let mut file = Decoder::new(file).map_err(explained)?;
    let (width, height) = file.dimensions().map_err(explained)?;
    check(width, height)?;
    file = file.with_limits(limits(max_bytes));
    let page = Page::new(&mut file, is_palette)?;
    let samples = page.samples(&mut file)?;
    let mut picture = samples
        .picture(width, height, page.channels())
        .ok_or_else(|| damaged(ImageFormat::Tiff, "its samples are too few"))?;
    let orientation = file
        .find_tag_unsigned::<u8>(Tag::Orientation)
        .ok()
        .flatten();
    let orientation = orientation.and_then(Orientation::from_exif);
    picture.apply_orientation(orientation.unwrap_or(Orientation::NoTransforms));
    Ok(Decoded {
        is_ink: page.is_ink(),
        coding: file.get_tag_u8_vec(Tag::IccProfile).ok().map(Coding::Icc),
        has_more: file.more_images(),
        picture,
    })
}

fn limits(max_bytes: u64) -> Limits {
    let most = usize::try_from(max_bytes).unwrap_or(usize::MAX);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = most;
    limits.intermediate_buffer_size = most;
    limits.ifd_value_size = most;
    limits
}

/// The layout and the meaning of a page's samples.
struct Page {
    width: usize,
    height: usize,
    color: ColorType,
    /// Meaning of the first sample after the colour's samples.
    extra: Option<u16>,
    palette: Option<palette::Palette>,
}

impl Page {
    fn new<R: Read + Seek>(file: &mut Decoder<R>, is_palette: bool) -> Result<Self, Failure> {
        let color = file.colortype().map_err(explained)?;
        let (width, height) = file.dimensions().map_err(explained)?;
        let extras = file.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples);
        let extra = extras
            .ok()
            .flatten()
            .and_then(|extras| extras.first().copied());
        let palette = match is_palette {
            true => Some(palette::Palette::read(file, color.bit_depth())?),
            false => None,
        };
        Ok(Self {
            width: width as usize,
            height: height as usize,
            color,
            extra,
            palette,
        })
    }

    fn is_ink(&self) -> bool {
        matches!(self.color, ColorType::CMYK(_))
    }

    /// Samples of a pixel as the file has them.
    fn stored(&self) -> Result<usize, Failure> {
        Ok(match self.color {
            ColorType::Gray(_) => 1,
            ColorType::RGB(_) | ColorType::YCbCr(_) => 3,
            ColorType::RGBA(_) | ColorType::CMYK(_) => 4,
            ColorType::Multiband { num_samples, .. } => usize::from(num_samples),
            other => {
                return Err(unsupported(
                    ImageFormat::Tiff,
                    format!("colour type {other:?}"),
                ));
            }
        })
    }

    /// Samples of a pixel of the picture: 1 grey, 2 with alpha, 3 RGB, 4 RGBA or inks.
    fn channels(&self) -> usize {
        let has_alpha = matches!(self.extra, Some(ASSOCIATED | UNASSOCIATED));
        match self.color {
            _ if self.palette.is_some() => 3,
            ColorType::Gray(_) => 1,
            ColorType::Multiband { .. } => 1 + usize::from(has_alpha),
            ColorType::RGB(_) | ColorType::YCbCr(_) => 3,
            _ => 4,
        }
    }

    /// The samples of the picture, interleaved, with straight alpha.
    fn samples<R: Read + Seek>(&self, file: &mut Decoder<R>) -> Result<Samples, Failure> {
        let stored = self.stored()?;
        let mut read = DecodingResult::U8(Vec::new());
        let layout = file.read_image_to_buffer(&mut read).map_err(explained)?;
        // A buffer shorter than the whole picture means that the limit has cut it off.
        if read.as_buffer(0).as_bytes().len() < layout.complete_len {
            return Err(too_large());
        }
        let samples = Samples::of(read)?;
        // Unpack first, since samples of less than a byte can't be moved; then bring planes together, look up colours, bring to
        // full scale, drop samples that are no channel, convert, and divide by alpha.
        let samples = match self.color.bit_depth() {
            // A row of a page of planes is one of a plane.
            bits @ (1 | 2 | 4) if layout.planes > 1 => {
                samples.unpacked(self.width, self.height * layout.planes, bits)
            }
            bits @ (1 | 2 | 4) => samples.unpacked(self.width * stored, self.height, bits),
            _ => samples,
        };
        let samples = if layout.planes > 1 {
            samples.interleaved(layout.planes)
        } else {
            samples
        };
        if let Some(palette) = &self.palette {
            return Ok(palette.colors(&samples.indices(stored)));
        }
        let mut samples = match self.color.bit_depth() {
            bits @ (1 | 2 | 4) => samples.stretched(bits),
            _ => samples,
        };
        let channels = self.channels();
        if channels < stored {
            samples = samples.first_of(stored, channels);
        }
        if let ColorType::YCbCr(_) = self.color {
            samples = in_rgb(samples, file)?;
        }
        if self.extra == Some(ASSOCIATED) && !self.is_ink() {
            samples.unmultiply(channels);
        }
        Ok(samples)
    }
}

/// Samples of light and colour differences as red, green and blue.
fn in_rgb<R: Read + Seek>(samples: Samples, file: &mut Decoder<R>) -> Result<Samples, Failure> {
    let Samples::U8(mut samples) = samples else {
        let kind = "YCbCr of other than 8 bits per sample";
        return Err(unsupported(ImageFormat::Tiff, kind));
    };
    let [red, green, blue] = numbers(file, Tag::Unknown(529)).unwrap_or(LUMA);
    let [black, white, cb_zero, cb_one, cr_zero, cr_one] =
        numbers(file, Tag::Unknown(532)).unwrap_or(REFERENCE);
    for pixel in samples.as_chunks_mut::<3>().0 {
        let [y, cb, cr] = pixel.map(f64::from);
        // To the full range: luma 0 to 255, differences −127 to 127 about 0.
        let y = (y - black) * 255.0 / (white - black);
        let cb = (cb - cb_zero) * 127.0 / (cb_one - cb_zero);
        let cr = (cr - cr_zero) * 127.0 / (cr_one - cr_zero);
        // Cr = (R − Y)/(2 − 2·k_R), Cb likewise, and Y = k_R·R + k_G·G + k_B·B gives G.
        let (r, b) = (y + cr * (2.0 - 2.0 * red), y + cb * (2.0 - 2.0 * blue));
        let g = (y - red * r - blue * b) / green;
        // `as` saturates.
        *pixel = [r, g, b].map(|v| (v + 0.5) as u8);
    }
    Ok(Samples::U8(samples))
}

/// The numbers of a tag, if there are so many.
fn numbers<const N: usize, R: Read + Seek>(file: &mut Decoder<R>, tag: Tag) -> Option<[f64; N]> {
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
