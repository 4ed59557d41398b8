//! Decodes the bytes of a picture file to an [`Image`].

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufRead, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use ::image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};

use super::rows::{self, Rows, Sample};
use super::{Image, Remark, foreign, header};
use crate::error::{Error, ErrorKind, Result};
use crate::math;

/// Limits on the size of a picture file. They are checked on the header, before memory is spent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most pixels, width × height.
    pub max_pixels: u64,
    /// Most bytes of the file, and most bytes of the decoded samples.
    pub max_bytes: u64,
}

impl Default for Limits {
    /// 128 Mpx and 1 GiB: a poster at 300 dpi passes, a decompression bomb does not. The planes of
    /// an [`Image`] at the limit take 1.5 GiB.
    fn default() -> Self {
        Self {
            max_pixels: 1 << 27,
            max_bytes: 1 << 30,
        }
    }
}

/// The files that this build reads.
const READABLE: &str = if cfg!(feature = "formats") {
    "a PNG, JPEG, WebP, GIF, BMP, TIFF, ICO, QOI, TGA, DDS, HDR or PNM file"
} else {
    "a PNG file, or use a build with the feature `formats`"
};

/// Reads and decodes the file at `path`.
pub(super) fn open(path: &Path, limits: Limits) -> Result<(Image, Vec<Remark>)> {
    read(path, limits)
        .and_then(|bytes| decode(&bytes, limits))
        .map_err(|error| error.within(path.display()))
}

fn read(path: &Path, limits: Limits) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // One byte more than allowed distinguishes a file at the limit from a longer one.
    let mut input = File::open(path)
        .map_err(unreadable)?
        .take(limits.max_bytes.saturating_add(1));
    input.read_to_end(&mut bytes).map_err(unreadable)?;
    Ok(bytes)
}

fn unreadable(error: io::Error) -> Error {
    let remedy = match error.kind() {
        io::ErrorKind::NotFound => "no such file: check the name",
        io::ErrorKind::PermissionDenied => "permission denied: make the file readable",
        io::ErrorKind::IsADirectory => "is a directory: name a picture file",
        _ => return Error::new(ErrorKind::Io, format!("cannot be read: {error}")).caused_by(error),
    };
    Error::new(ErrorKind::Io, remedy).caused_by(error)
}

/// Decodes the bytes of a picture file, and says what of it is changed or left out.
pub(super) fn decode(bytes: &[u8], limits: Limits) -> Result<(Image, Vec<Remark>)> {
    let format = format(bytes, limits)?;
    if let Some((width, height)) = header::size(bytes, format) {
        check_size(width, height, limits)?;
    }
    if format == ImageFormat::Jpeg && !header::jpeg_is_whole(bytes) {
        return Err(truncated(format));
    }
    let ran_out = Cell::new(false);
    let watched = Supply {
        inner: Cursor::new(bytes),
        ran_out: &ran_out,
    };
    let (picture, profile) = samples(watched, format, limits).map_err(|error| {
        // The JPEG decoder always reads to the end.
        if ran_out.get() && format != ImageFormat::Jpeg {
            return truncated(format).caused_by(error);
        }
        refused(error, format)
    })??;
    let (image, clipped) = planar(&picture, format)?;
    let (image, converted) = match profile {
        Some(profile) => in_srgb(image, &profile),
        None => (image, None),
    };
    let clipped = (clipped > 0).then_some(Remark::Clipped(clipped));
    let frames = header::has_more(bytes, format).then_some(Remark::FirstOfSeveral);
    let remarks = [converted, clipped, frames].into_iter().flatten();
    Ok((image, remarks.collect()))
}

#[cfg(feature = "formats")]
use super::profile::to_srgb as in_srgb;

/// The library alone leaves colours as they are.
#[cfg(not(feature = "formats"))]
fn in_srgb(image: Image, _: &[u8]) -> (Image, Option<Remark>) {
    let why = "of no use to this build, which lacks the feature `formats`,";
    (image, Some(Remark::ProfileIgnored(why)))
}

/// The format, by the first bytes.
fn format(bytes: &[u8], limits: Limits) -> Result<ImageFormat> {
    if bytes.is_empty() {
        return Err(bad(format!("the file is empty: give {READABLE}")));
    }
    if bytes.len() as u64 > limits.max_bytes {
        return Err(bad(format!(
            "the file is longer than {} MiB: give a smaller picture",
            limits.max_bytes >> 20
        )));
    }
    let tga = header::is_tga(bytes).then_some(ImageFormat::Tga);
    let found = ::image::guess_format(bytes).ok().or(tga);
    found
        .filter(|format| format.reading_enabled())
        .ok_or_else(|| {
            bad(match foreign::advice(bytes) {
                Some(advice) => advice,
                None => format!("not a picture in a known format: give {READABLE}"),
            })
        })
}

fn check_size(width: u32, height: u32, limits: Limits) -> Result<()> {
    if width == 0 || height == 0 {
        return Err(bad(format!(
            "the picture has no pixels ({width}×{height}): give one of at least 1×1"
        )));
    }
    if u64::from(width) * u64::from(height) > limits.max_pixels {
        let most = limits.max_pixels;
        return Err(bad(format!(
            "the picture is too large ({width}×{height} px, at most {most} pixels): scale it down"
        )));
    }
    Ok(())
}

/// The decoded samples in the orientation given by EXIF, and the colour profile.
fn samples(
    bytes: Supply<'_>,
    format: ImageFormat,
    limits: Limits,
) -> Result<Result<Decoded>, ImageError> {
    let mut allowed = ::image::Limits::no_limits();
    allowed.max_alloc = Some(limits.max_bytes);
    let mut reader = ImageReader::with_format(bytes, format);
    reader.limits(allowed.clone());
    let mut decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    if let Err(error) = check_size(width, height, limits) {
        return Ok(Err(error));
    }
    allowed.reserve(decoder.total_bytes())?;
    decoder.set_limits(allowed)?;
    // A picture with damaged metadata can still be used.
    let orientation = decoder
        .orientation()
        .unwrap_or(::image::metadata::Orientation::NoTransforms);
    let profile = decoder.icc_profile().ok().flatten();
    let mut picture = DynamicImage::from_decoder(decoder)?;
    picture.apply_orientation(orientation);
    Ok(Ok((picture, profile)))
}

/// Samples, and the colour profile of their file.
type Decoded = (DynamicImage, Option<Vec<u8>>);

fn bad(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Picture, message)
}

fn truncated(format: ImageFormat) -> Error {
    bad(format!(
        "the {} file is cut short: get a complete copy",
        name(format)
    ))
}

fn name(format: ImageFormat) -> String {
    format!("{format:?}").to_uppercase()
}

/// Explains the decoder's error to the owner of the file.
fn refused(error: ImageError, format: ImageFormat) -> Error {
    let message = match &error {
        ImageError::Limits(_) => "the picture needs too much memory: scale it down".into(),
        ImageError::Unsupported(e) => {
            format!(
                "this kind of {} cannot be read ({e}): save it as an ordinary PNG",
                name(format)
            )
        }
        e => format!(
            "the {} file is damaged ({}): get an intact copy",
            name(format),
            one_line(e)
        ),
    };
    bad(message).caused_by(error)
}

fn one_line(error: &ImageError) -> String {
    error
        .to_string()
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

/// The bytes of a file, and whether a reader wanted more than there are. Decoders report a file that is cut
/// short in different ways, but all of them try to read on.
struct Supply<'a> {
    inner: Cursor<&'a [u8]>,
    ran_out: &'a Cell<bool>,
}

impl Read for Supply<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        if count == 0 && !buffer.is_empty() {
            self.ran_out.set(true);
        }
        Ok(count)
    }
}

impl BufRead for Supply<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let rest = self.inner.fill_buf()?;
        if rest.is_empty() {
            self.ran_out.set(true);
        }
        Ok(rest)
    }

    fn consume(&mut self, amount: usize) {
        self.inner.consume(amount);
    }
}

impl Seek for Supply<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}

/// The picture, and how many of its samples were beyond the range of 0 to 1.
fn planar(picture: &DynamicImage, format: ImageFormat) -> Result<(Image, usize)> {
    match picture {
        DynamicImage::ImageLuma8(p) => levels(picture, p.as_raw()),
        DynamicImage::ImageLumaA8(p) => levels(picture, p.as_raw()),
        DynamicImage::ImageRgb8(p) => levels(picture, p.as_raw()),
        DynamicImage::ImageRgba8(p) => levels(picture, p.as_raw()),
        DynamicImage::ImageLuma16(p) => levels(picture, p.as_raw()),
        DynamicImage::ImageLumaA16(p) => levels(picture, p.as_raw()),
        DynamicImage::ImageRgb16(p) => levels(picture, p.as_raw()),
        DynamicImage::ImageRgba16(p) => levels(picture, p.as_raw()),
        DynamicImage::ImageRgb32F(p) => floats(picture, p.as_raw(), format),
        DynamicImage::ImageRgba32F(p) => floats(picture, p.as_raw(), format),
        other => {
            let other = DynamicImage::from(other.to_rgba32f());
            planar(&other, format)
        }
    }
}

fn levels<T: Sample>(picture: &DynamicImage, samples: &[T]) -> Result<(Image, usize)> {
    Ok((rows::image(packed(picture, samples))?, 0))
}

/// Whatever a file says: what is no number is 0, what is beyond the range at its end.
fn floats(picture: &DynamicImage, samples: &[f32], format: ImageFormat) -> Result<(Image, usize)> {
    let is_linear = format == ImageFormat::Hdr;
    let level = |v: f32| match v.clamp(0.0, 1.0) {
        v if v.is_nan() => 0.0,
        v if is_linear => encoded(v),
        v => v,
    };
    let clipped = samples.iter().filter(|v| !(0.0..=1.0).contains(*v));
    let image = rows::planar(packed(picture, samples), level)?;
    Ok((image, clipped.count()))
}

/// Light of 0..1 as sRGB encodes it.
fn encoded(light: f32) -> f32 {
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * math::powf(light, 1.0 / 2.4) - 0.055
    }
}

fn packed<'a, T>(picture: &DynamicImage, samples: &'a [T]) -> Rows<'a, T> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let channels = usize::from(picture.color().channel_count());
    Rows::packed(width, height, channels, samples)
}

#[cfg(test)]
mod tests;
