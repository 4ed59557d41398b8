//! Output of the decoders: samples, and their meaning.

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
