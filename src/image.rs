//! Pictures: planar `f32`, sRGB-encoded. This module alone uses the crates `image`, `tiff`, `zune-jpeg`, `moxcms`,
//! `gif` and `png`.
//!
//! It reads PNG, JPEG, WebP, GIF, BMP, TIFF, ICO, QOI, TGA, DDS, Radiance HDR, farbfeld and PNM (the first
//! frame or page), with 8 or 16 bits or floats, grey, colour or CMYK, and applies the orientation given by EXIF. It converts
//! colours to sRGB if a file states others, by an ICC profile or the chunks of a PNG. It keeps alpha;
//! [`Image::flattened`] composites onto a matte.

#[cfg(feature = "animation")]
mod animate;
mod decode;
mod decoded;
mod encode;
mod foreign;
mod formats;
mod header;
mod png;
#[cfg(feature = "formats")]
mod profile;
mod reduce;
mod rows;
#[cfg(feature = "formats")]
mod tone;

use std::borrow::Cow;
use std::fmt;
use std::path::Path;

#[cfg(feature = "animation")]
pub use animate::{AnimationFormat, animated};
pub use decode::Limits;
pub use decoded::Remark;
pub use formats::{FORMATS, Format};
pub(crate) use header::stated_size;
pub(crate) use reduce::Half;
pub use rows::{Rows, Sample};

use crate::error::{Error, ErrorKind, Result};
use crate::math;
use crate::scene::Rgb;

/// A picture: three planes of sRGB-encoded colour 0..1, and alpha where the source had it.
#[derive(Clone, PartialEq)]
pub struct Image {
    /// Width in px, at least 1.
    width: usize,
    /// Height in px, at least 1.
    height: usize,
    /// Red, green and blue, each `width·height` values row by row. Not premultiplied.
    planes: [Vec<f32>; 3],
    /// `width·height` values 0..1, or `None` when every pixel is opaque.
    alpha: Option<Vec<f32>>,
}

impl Image {
    /// An opaque picture of `width × height` px from its red, green and blue planes, row by row.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when a side is 0, a plane does not have `width·height` values, or a value
    /// is not finite.
    pub fn new(width: usize, height: usize, planes: [Vec<f32>; 3]) -> Result<Self> {
        let pixels = width
            .checked_mul(height)
            .filter(|&n| n > 0)
            .ok_or_else(|| {
                let message = format!(
                    "a picture of {width}×{height} has no pixels: give both sides 1 px or more"
                );
                Error::new(ErrorKind::Picture, message)
            })?;
        for plane in &planes {
            check_plane(plane, pixels)?;
        }
        Ok(Self::from_planes(width, height, planes))
    }

    /// The picture that interleaved rows of `u8` (0 to 255), `u16` (0 to 65535) or `f32` (0 to 1) hold.
    ///
    /// ```
    /// use strokefit::image::{Image, Rows};
    ///
    /// // Two rows of one RGB pixel, each row padded to 4 bytes.
    /// let samples = [255_u8, 0, 0, 0, 0, 51, 255, 0];
    /// let rows = Rows { stride: 4, ..Rows::packed(1, 2, 3, &samples) };
    /// let picture = Image::from_rows(rows)?;
    /// assert_eq!(picture.planes()[1], [0.0, 0.2]);
    /// # Ok::<(), strokefit::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when a side is 0, there are no 1 to 4 channels, rows overlap or are too few, or a
    /// float is not finite or far outside 0..1.
    pub fn from_rows<T: Sample>(rows: Rows<'_, T>) -> Result<Self> {
        rows::image(rows)
    }

    /// The picture whose channel `c` of the pixel in column `x` and row `y` is `sample(x, y, c)`: for samples that do
    /// not lie in rows. Samples and channels are as in [`Rows`].
    ///
    /// ```
    /// use strokefit::image::Image;
    ///
    /// let ramp = Image::from_fn(3, 1, 1, |x, _, _| x as f32 / 2.0)?;
    /// assert_eq!(ramp.planes()[2], [0.0, 0.5, 1.0]);
    /// # Ok::<(), strokefit::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Image::from_rows`].
    pub fn from_fn<T: Sample>(
        width: usize,
        height: usize,
        channels: usize,
        sample: impl Fn(usize, usize, usize) -> T,
    ) -> Result<Self> {
        rows::sampled(width, height, channels, sample)
    }

    /// As [`Image::new`] without checks, for callers whose sizes agree by construction.
    pub(crate) fn from_planes(width: usize, height: usize, planes: [Vec<f32>; 3]) -> Self {
        debug_assert!(planes.iter().all(|plane| plane.len() == width * height));
        Self {
            width,
            height,
            planes,
            alpha: None,
        }
    }

    /// A picture of one colour.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub fn filled(width: usize, height: usize, color: Rgb) -> Result<Self> {
        let pixels = width.saturating_mul(height);
        Self::new(width, height, color.map(|c| vec![c; pixels]))
    }

    /// This picture with this alpha, `width·height` values 0..1. Alpha that is 1 everywhere is dropped.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when there are not `width·height` values or one is not finite.
    pub fn with_alpha(mut self, alpha: Vec<f32>) -> Result<Self> {
        check_plane(&alpha, self.width * self.height)?;
        // Without a transparent pixel all later steps take the shorter way of opaque pictures.
        self.alpha = alpha.iter().any(|&a| a < 1.0).then_some(alpha);
        Ok(self)
    }

    /// Reads the picture file at `path`, within the default [`Limits`].
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when the file cannot be read, else as [`Image::decode`]; every message
    /// names the file.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        Ok(Self::read_within(path, Limits::default())?.0)
    }

    /// Reads the picture file at `path`, within other limits, with remarks on changes and omissions.
    ///
    /// # Errors
    /// As [`Image::open`].
    pub fn read_within(path: impl AsRef<Path>, limits: Limits) -> Result<(Self, Vec<Remark>)> {
        decode::open(path.as_ref(), limits)
    }

    /// Decodes the bytes of a picture file, and detects the format from the bytes, that of compressed TGA without a footer
    /// from the name. Messages call the file `name`.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when there are no bytes, or they are not a picture, cut short, damaged, of 0×0
    /// px, or beyond `limits`. The limits are checked on the header, before memory is spent.
    pub fn decode(bytes: &[u8], name: &str, limits: Limits) -> Result<Self> {
        Ok(Self::decode_remarking(bytes, name, limits)?.0)
    }

    /// Decodes as [`Image::decode`] does, with remarks on changes and omissions.
    ///
    /// # Errors
    /// As [`Image::decode`].
    pub fn decode_remarking(
        bytes: &[u8],
        name: &str,
        limits: Limits,
    ) -> Result<(Self, Vec<Remark>)> {
        decode::decode(bytes, name, limits).map_err(|error| error.within(name))
    }

    /// The picture as a PNG file: 8-bit RGB, or RGBA where there is alpha.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when a side exceeds the maximum of PNG.
    pub fn encode_png(&self) -> Result<Vec<u8>> {
        encode::png(self)
    }

    /// The picture as a JPEG file of this quality, 1 to 100, its alpha ignored.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] when a side exceeds the maximum of JPEG.
    #[cfg(feature = "cli")]
    pub fn encode_jpeg(&self, quality: u8) -> Result<Vec<u8>> {
        encode::jpeg(self, quality)
    }

    /// Width in px, at least 1.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in px, at least 1.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Red, green and blue, each `width·height` values row by row. Not premultiplied.
    pub fn planes(&self) -> &[Vec<f32>; 3] {
        &self.planes
    }

    /// Returns the planes by value; alpha is dropped.
    pub fn into_planes(self) -> [Vec<f32>; 3] {
        self.planes
    }

    /// `width·height` values 0..1, or `None` when every pixel is opaque.
    pub fn alpha(&self) -> Option<&[f32]> {
        self.alpha.as_deref()
    }

    /// The picture flattened onto `matte`: opaque, composited in encoded values as SVG renderers do.
    #[must_use]
    pub fn flattened(&self, matte: Rgb) -> Self {
        self.on(matte).into_owned()
    }

    /// Flattens as [`Self::flattened`] does, without a copy of a picture that is opaque.
    pub(crate) fn on(&self, matte: Rgb) -> Cow<'_, Self> {
        let Some(alpha) = &self.alpha else {
            return Cow::Borrowed(self);
        };
        let mut planes = self.planes.clone();
        for (plane, matte) in planes.iter_mut().zip(matte) {
            for (value, &a) in plane.iter_mut().zip(alpha) {
                // Source-over with the encoded values, C = M + α(c − M).
                *value = matte + a * (*value - matte);
            }
        }
        Cow::Owned(Self::from_planes(self.width, self.height, planes))
    }

    /// The upper left `width × height` px, without alpha. `None` if the picture is smaller or a side
    /// is 0.
    pub fn cropped(&self, width: usize, height: usize) -> Option<Self> {
        if width > self.width || height > self.height || width == 0 || height == 0 {
            return None;
        }
        let cut = |plane: &Vec<f32>| {
            let rows = plane.chunks(self.width).take(height);
            rows.flat_map(|row| &row[..width]).copied().collect()
        };
        let planes = self.planes.each_ref().map(cut);
        Some(Self::from_planes(width, height, planes))
    }

    /// The colours as interleaved 8-bit RGB, row by row, each value rounded to the nearest of
    /// 0..=255. Alpha is ignored: [flatten](Self::flattened) first.
    pub fn to_rgb8(&self) -> Vec<u8> {
        let [red, green, blue] = &self.planes;
        let pixels = red.iter().zip(green).zip(blue);
        let mut rgb = vec![0; 3 * red.len()];
        for (bytes, ((&r, &g), &b)) in rgb.chunks_exact_mut(3).zip(pixels) {
            bytes.copy_from_slice(&[r, g, b].map(level));
        }
        rgb
    }
}

/// Omits the values, which would hide everything else.
impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Image")
            .field("width", &self.width)
            .field("height", &self.height)
            .field("alpha", &self.alpha.is_some())
            .finish_non_exhaustive()
    }
}

/// The nearest of 0..=255 to a value of 0..1.
pub(crate) fn level(value: f32) -> u8 {
    // `as` saturates, so values beyond 0..1 become the nearer end.
    (value * 255.0 + 0.5) as u8
}

/// Light of 0..1 as sRGB encodes it.
fn encoded(light: f32) -> f32 {
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * math::powf(light, 1.0 / 2.4) - 0.055
    }
}

fn check_plane(plane: &[f32], pixels: usize) -> Result<()> {
    if plane.len() != pixels {
        let message = format!("a plane has {} values for {pixels} pixels", plane.len());
        return Err(Error::new(ErrorKind::Picture, message));
    }
    match plane.iter().position(|v| !v.is_finite()) {
        Some(i) => {
            let message = format!(
                "the picture's value {i} is {}, not a number from 0 to 1",
                plane[i]
            );
            Err(Error::new(ErrorKind::Picture, message))
        }
        None => Ok(()),
    }
}

/// The pixels to the left and right of pixel `i`, above and below, in a picture of `count` pixels, row by row.
pub(crate) fn beside(i: usize, width: usize, count: usize) -> impl Iterator<Item = usize> {
    let x = i % width;
    // Pixels are counted row by row, so a row's first pixel follows the last of the row before and is no neighbour of it.
    let left = (x > 0).then(|| i - 1);
    let right = (x + 1 < width).then_some(i + 1);
    let above = i.checked_sub(width);
    let below = Some(i + width).filter(|&k| k < count);
    [left, right, above, below].into_iter().flatten()
}

/// A set of pixels and all that join it, in a picture of `count` pixels: `joins` is asked of pixels and those beside them, and
/// says yes once for each that is to be added.
pub(crate) fn flooded(
    mut set: Vec<usize>,
    [width, count]: [usize; 2],
    mut joins: impl FnMut(usize, usize) -> bool,
) -> Vec<usize> {
    let mut next = 0;
    while let Some(&i) = set.get(next) {
        next += 1;
        set.extend(beside(i, width, count).filter(|&k| joins(i, k)));
    }
    set
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_without_pixels_cannot_be_made() {
        let error = Image::new(0, 3, Default::default()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Picture);
        assert!(error.to_string().contains("0×3"), "{error}");
    }

    #[test]
    fn planes_of_the_wrong_length_or_not_finite_are_refused() {
        assert!(Image::new(2, 1, [vec![0.0; 2], vec![0.0; 2], vec![0.0; 1]]).is_err());
        let error = Image::new(1, 1, [vec![0.0], vec![f32::NAN], vec![0.0]]).unwrap_err();
        assert!(error.to_string().contains("NaN"), "{error}");
    }

    #[test]
    fn alpha_of_one_everywhere_is_left_out() {
        let image = Image::filled(2, 1, [0.5; 3]).unwrap();
        assert_eq!(
            image.clone().with_alpha(vec![1.0; 2]).unwrap().alpha(),
            None
        );
        assert_eq!(
            image.with_alpha(vec![1.0, 0.5]).unwrap().alpha(),
            Some(&[1.0, 0.5][..])
        );
    }

    #[test]
    fn cropping_keeps_the_upper_left() {
        let plane: Vec<f32> = (0..6_u8).map(f32::from).collect();
        let image = Image::new(3, 2, [plane.clone(), plane.clone(), plane]).unwrap();
        assert_eq!(
            image.cropped(2, 2).unwrap().planes()[2],
            [0.0, 1.0, 3.0, 4.0]
        );
        assert_eq!(image.cropped(3, 2), Some(image.clone()));
        assert!(image.cropped(4, 1).is_none() && image.cropped(0, 1).is_none());
    }

    #[test]
    fn flattening_mixes_with_the_ground_in_encoded_values() {
        let image = Image::filled(3, 1, [1.0, 0.0, 0.5]).unwrap();
        let flat = image
            .with_alpha(vec![0.0, 0.5, 1.0])
            .unwrap()
            .flattened([1.0; 3]);
        assert_eq!(flat.planes()[0], [1.0, 1.0, 1.0]);
        assert_eq!(flat.planes()[1], [1.0, 0.5, 0.0]);
        assert_eq!(flat.planes()[2], [1.0, 0.75, 0.5]);
        assert_eq!(flat.alpha(), None);
    }

    #[test]
    fn every_byte_survives_the_way_to_float_and_back() {
        let ramp: Vec<f32> = (0..=255u8).map(|v| f32::from(v) / 255.0).collect();
        let image = Image::new(256, 1, [ramp.clone(), ramp.clone(), ramp]).unwrap();
        let bytes: Vec<u8> = (0..=255u8).flat_map(|v| [v; 3]).collect();
        assert_eq!(image.to_rgb8(), bytes);
    }

    #[test]
    fn values_beyond_the_range_saturate() {
        let image = Image::new(2, 1, [vec![-1.0, 2.0], vec![0.0; 2], vec![0.0; 2]]).unwrap();
        assert_eq!(image.to_rgb8(), [0, 0, 0, 255, 0, 0]);
    }
}
