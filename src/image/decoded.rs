//! Output of the decoders: samples, their meaning, and remarks on changes and omissions in reading them.

use std::fmt;

#[cfg(feature = "formats")]
use ::image::ImageFormat;
#[cfg(feature = "formats")]
use ::image::error::{DecodingError, ImageFormatHint, UnsupportedError, UnsupportedErrorKind};
use ::image::{DynamicImage, ImageError};

use crate::error::Error;

/// The samples of a picture file, upright.
pub(super) struct Decoded {
    pub(super) picture: DynamicImage,
    /// The four channels are amounts of cyan, magenta, yellow and black, not red, green, blue and alpha.
    #[cfg(feature = "formats")]
    pub(super) is_ink: bool,
    /// The colours that the samples encode, if the file says so.
    pub(super) coding: Option<Coding>,
    /// Further frames or pages follow.
    pub(super) has_more: bool,
}

#[cfg(feature = "formats")]
impl Decoded {
    /// Samples without further information in the file.
    pub(super) fn plain(picture: DynamicImage) -> Self {
        Self {
            picture,
            is_ink: false,
            coding: None,
            has_more: false,
        }
    }
}

/// The colours that samples encode.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Coding {
    /// An ICC profile.
    Icc(Vec<u8>),
    /// Code points of ITU-T H.273, for the primaries and for the transfer function.
    Cicp(u8, u8),
    /// Light as a power of samples, and where they stand: white, red, green and blue, x and y of each.
    Gamma {
        /// The power that encodes light, as `gAMA` has it; `None` is the curve of sRGB.
        gamma: Option<f64>,
        /// `None` for the chromaticities of sRGB.
        chromaticities: Option<[f64; 8]>,
    },
}

/// Something that a picture file holds and the [`Image`](super::Image) read from it does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remark {
    /// The colours were converted to sRGB from the colours of the file's profile.
    Converted,
    /// The file's colour profile was not used, for this reason; its colours were taken for sRGB.
    ProfileIgnored(&'static str),
    /// Amounts of cyan, magenta, yellow and black became colours without a profile.
    Inks,
    /// So many samples were below 0, above 1 or no numbers, and became 0 or 1.
    Clipped(usize),
    /// Frames or pages follow the first one.
    FirstOfSeveral,
    /// Every pixel is fully transparent.
    Transparent,
}

impl Remark {
    /// True if colours may be off, or nothing is there: what a user should hear of unasked.
    pub fn is_warning(&self) -> bool {
        matches!(
            self,
            Self::ProfileIgnored(_) | Self::Inks | Self::Transparent
        )
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Converted => {
                f.write_str("colours were converted to sRGB from those that the file states")
            }
            Self::ProfileIgnored(why) => write!(
                f,
                "the colour profile of the file is {why} and was ignored: colours may be off"
            ),
            Self::Inks => f.write_str(
                "the file is CMYK without a profile: colours are those of ideal inks and may be off",
            ),
            Self::Clipped(samples) => {
                write!(
                    f,
                    "{samples} samples beyond the range of 0 to 1 were clipped"
                )
            }
            Self::Transparent => {
                f.write_str("every pixel of the picture is transparent: there is nothing to draw")
            }
            Self::FirstOfSeveral => f.write_str("the first frame was read, and others were not"),
        }
    }
}

/// Why a decoder gives nothing.
pub(super) enum Failure {
    /// A message of ours.
    Ours(Error),
    /// One that is still to be explained.
    Theirs(ImageError),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Ours(error)
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        Self::Theirs(error)
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::Theirs(ImageError::IoError(error))
    }
}

/// A failure on a kind of this format that is not read.
#[cfg(feature = "formats")]
pub(super) fn unsupported(format: ImageFormat, kind: impl Into<String>) -> Failure {
    let kind = UnsupportedErrorKind::GenericFeature(kind.into());
    let hint = ImageFormatHint::Exact(format);
    ImageError::Unsupported(UnsupportedError::from_format_and_kind(hint, kind)).into()
}

/// A failure on a file that contradicts itself.
#[cfg(feature = "formats")]
pub(super) fn damaged(
    format: ImageFormat,
    cause: impl Into<Box<dyn std::error::Error + Send + Sync>>,
) -> Failure {
    let hint = ImageFormatHint::Exact(format);
    ImageError::Decoding(DecodingError::new(hint, cause)).into()
}
