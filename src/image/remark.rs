//! Remarks: changes and omissions in reading a picture.

use std::fmt;

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
