//! Decodes the bytes of a picture file to an [`Image`].

#[cfg(feature = "formats")]
mod dds;
#[cfg(feature = "formats")]
mod ico;
#[cfg(feature = "formats")]
mod jpeg;
#[cfg(feature = "formats")]
mod tiff;

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufRead, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use ::image::error::UnsupportedErrorKind;
use ::image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};

use super::decoded::{Coding, Decoded, Failure};
use super::rows::{self, Rows, Sample};
use super::{Image, Remark, foreign, formats, header, png};
use crate::error::{Error, ErrorKind, Result};

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

/// Reads and decodes the file at `path`.
pub(super) fn open(path: &Path, limits: Limits) -> Result<(Image, Vec<Remark>)> {
    read(path, limits)
        .and_then(|bytes| decode(&bytes, &path.to_string_lossy(), limits))
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

/// Decodes the bytes of a picture file, with remarks on changes and omissions. The name decides the format where the bytes
/// don't.
pub(super) fn decode(bytes: &[u8], name: &str, limits: Limits) -> Result<(Image, Vec<Remark>)> {
    let format = format(bytes, name, limits)?;
    // The sides as the header has them: a picture that is too large costs no memory.
    if let Some((width, height)) = header::size(bytes, format) {
        check_size(width, height, limits)?;
    }
    // The decoder would fill the missing part with grey and report success.
    if format == ImageFormat::Jpeg && !header::jpeg_is_whole(bytes) {
        return Err(truncated(format));
    }
    let ran_out = Cell::new(false);
    let decoded = samples(bytes, &ran_out, format, limits).map_err(|failure| match failure {
        Failure::Ours(error) => error,
        // The JPEG decoder always reads to the end.
        Failure::Theirs(error) if ran_out.get() && format != ImageFormat::Jpeg => {
            truncated(format).caused_by(error)
        }
        Failure::Theirs(error) => refused(error, format),
    })?;
    image(decoded, format)
}

/// The picture in sRGB, and remarks on it.
fn image(decoded: Decoded, format: ImageFormat) -> Result<(Image, Vec<Remark>)> {
    let (image, clipped) = planar(&decoded.picture, format)?;
    let (image, converted) = match &decoded.coding {
        #[cfg(feature = "formats")]
        coding if decoded.is_ink => super::profile::of_inks(image, coding.as_ref())?,
        Some(coding) => in_srgb(image, coding),
        None => (image, None),
    };
    // A picture of which nothing can be seen is likely a mistake: draw it, and say so.
    let is_clear = image.alpha().is_some_and(|a| a.iter().all(|&a| a == 0.0));
    let remarks = [
        converted,
        (clipped > 0).then_some(Remark::Clipped(clipped)),
        decoded.has_more.then_some(Remark::FirstOfSeveral),
        is_clear.then_some(Remark::Transparent),
    ];
    Ok((image, remarks.into_iter().flatten().collect()))
}

#[cfg(feature = "formats")]
use super::profile::to_srgb as in_srgb;

/// The library alone leaves colours as they are.
#[cfg(not(feature = "formats"))]
fn in_srgb(image: Image, _: &Coding) -> (Image, Option<Remark>) {
    let why = "of no use to this build, which lacks the feature `formats`,";
    (image, Some(Remark::ProfileIgnored(why)))
}

/// The format of a file that is read.
fn format(bytes: &[u8], name: &str, limits: Limits) -> Result<ImageFormat> {
    let give = || format!("give {}", formats::readable());
    if bytes.is_empty() {
        return Err(bad(format!("the file is empty: {}", give())));
    }
    if bytes.len() as u64 > limits.max_bytes {
        return Err(bad(format!(
            "the file is longer than {} MiB: give a smaller picture",
            limits.max_bytes >> 20
        )));
    }
    // Apple's variant has the signature of PNG, but its rows would be read as other colours.
    let found = formats::detect(bytes, name).filter(|_| !foreign::is_cgbi(bytes));
    found.ok_or_else(|| {
        bad(match foreign::advice(bytes) {
            Some(advice) => advice,
            None => format!("not a picture in a known format: {}", give()),
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

/// The decoded samples in the orientation given by EXIF. Sets `ran_out` if the file is too short.
fn samples(
    bytes: &[u8],
    ran_out: &Cell<bool>,
    format: ImageFormat,
    limits: Limits,
) -> Result<Decoded, Failure> {
    // What the general decoder refuses or reads wrong.
    #[cfg(feature = "formats")]
    match format {
        ImageFormat::Jpeg => {
            if let Some(inks) = jpeg::inks(bytes)? {
                return Ok(inks);
            }
        }
        ImageFormat::Tiff => return tiff::read(bytes, ran_out, limits),
        ImageFormat::Ico => return ico::read(bytes, ran_out, limits),
        ImageFormat::Dds => return dds::read(bytes, ran_out, limits),
        _ => {}
    }
    general(bytes, ran_out, format, limits)
}

/// The samples by the decoder that the crate `image` has for the format.
fn general(
    bytes: &[u8],
    ran_out: &Cell<bool>,
    format: ImageFormat,
    limits: Limits,
) -> Result<Decoded, Failure> {
    let mut allowed = ::image::Limits::no_limits();
    allowed.max_alloc = Some(limits.max_bytes);
    let mut reader = ImageReader::with_format(Supply::new(bytes, ran_out), format);
    reader.limits(allowed.clone());
    let mut decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    check_size(width, height, limits)?;
    allowed.reserve(decoder.total_bytes())?;
    decoder.set_limits(allowed)?;
    // A picture with damaged metadata can still be used.
    let orientation = decoder
        .orientation()
        .unwrap_or(::image::metadata::Orientation::NoTransforms);
    let icc = decoder.icc_profile().ok().flatten();
    let coding = match format {
        ImageFormat::Png => png::coding(bytes, icc),
        _ => icc.map(Coding::Icc),
    };
    let mut picture = DynamicImage::from_decoder(decoder)?;
    picture.apply_orientation(orientation);
    Ok(Decoded {
        picture,
        #[cfg(feature = "formats")]
        is_ink: false,
        coding,
        has_more: header::has_more(bytes, format),
    })
}

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
            let kind = match e.kind() {
                UnsupportedErrorKind::GenericFeature(kind) => kind.clone(),
                _ => e.to_string(),
            };
            format!(
                "this kind of {} is not read ({kind}): save it as an ordinary PNG, for example with magick IN OUT.png",
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

impl<'a> Supply<'a> {
    fn new(bytes: &'a [u8], ran_out: &'a Cell<bool>) -> Self {
        let inner = Cursor::new(bytes);
        Self { inner, ran_out }
    }
}

impl Read for Supply<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        // A read of no bytes into a buffer with room is how a reader meets the end.
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

/// Floats of any file: NaN becomes 0, and a value beyond the range its nearer end.
fn floats(picture: &DynamicImage, samples: &[f32], format: ImageFormat) -> Result<(Image, usize)> {
    // Radiance stores light; all else stores encoded values.
    let is_linear = format == ImageFormat::Hdr;
    let level = |v: f32| match v.clamp(0.0, 1.0) {
        v if v.is_nan() => 0.0,
        v if is_linear => super::encoded(v),
        v => v,
    };
    let is_clipped = |v: &&f32| !(0.0..=1.0).contains(*v);
    let clipped = samples.iter().filter(is_clipped).count();
    let rows = packed(picture, samples);
    let image = rows::sampled(rows.width, rows.height, rows.channels, |x, y, c| {
        level(samples[y * rows.stride + x * rows.channels + c])
    })?;
    Ok((image, clipped))
}

fn packed<'a, T>(picture: &DynamicImage, samples: &'a [T]) -> Rows<'a, T> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let channels = usize::from(picture.color().channel_count());
    Rows::packed(width, height, channels, samples)
}

#[cfg(test)]
mod tests;
