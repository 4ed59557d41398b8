//! Damage of pictures before they are drawn.

use std::fmt::{Display, Formatter};
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use strokefit::{Error, ErrorKind};

/// Damage of a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Damage {
    /// Nothing.
    #[default]
    Clean,
    /// It went through a JPEG of this quality, 1 to 100.
    Jpeg(u8),
    /// Gaussian noise of this standard deviation, in levels of 255, was added to each channel.
    Noise(u8),
    /// Its edges lost their antialiasing, as in pictures of 1 bit.
    Aliased,
    /// It was dithered to the 216 colours that browsers once had, as GIFs were.
    Dithered,
    /// It was halved, and enlarged to its size again.
    Enlarged,
    /// It was printed on paper and photographed in uneven light.
    Photographed,
}

impl Damage {
    /// A clean picture, and all that it is put through to see what is left.
    pub const ALL: [Self; 12] = [
        Self::Clean,
        Self::Aliased,
        Self::Jpeg(90),
        Self::Jpeg(75),
        Self::Jpeg(50),
        Self::Jpeg(30),
        Self::Noise(4),
        Self::Noise(8),
        Self::Noise(16),
        Self::Dithered,
        Self::Enlarged,
        Self::Photographed,
    ];

    /// Part of a file's name: empty, `-jpeg75`, `-noise8`.
    pub fn suffix(self) -> String {
        match self {
            Self::Clean => String::new(),
            damage => format!("-{damage}"),
        }
    }

    /// A picture in words, by its longer side: `96 px, JPEG 75`.
    pub(super) fn of(self, side_px: usize) -> String {
        let picture = format!("{side_px} px");
        self.words()
            .map_or_else(|| picture.clone(), |damage| format!("{picture}, {damage}"))
    }

    /// The damage in words; `None` if there is none.
    pub(super) fn words(self) -> Option<String> {
        match self {
            Self::Clean => None,
            Self::Jpeg(quality) => Some(format!("JPEG {quality}")),
            Self::Noise(levels) => Some(format!("noise {levels}")),
            Self::Aliased => Some("no antialiasing".into()),
            Self::Dithered => Some("dithered".into()),
            Self::Enlarged => Some("enlarged 2 ×".into()),
            Self::Photographed => Some("photographed".into()),
        }
    }
}

impl Display for Damage {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Clean => write!(f, "clean"),
            Self::Jpeg(quality) => write!(f, "jpeg{quality}"),
            Self::Noise(levels) => write!(f, "noise{levels}"),
            Self::Aliased => write!(f, "aliased"),
            Self::Dithered => write!(f, "dithered"),
            Self::Enlarged => write!(f, "enlarged"),
            Self::Photographed => write!(f, "photographed"),
        }
    }
}

impl FromStr for Damage {
    type Err = Error;

    fn from_str(word: &str) -> Result<Self, Error> {
        let number = |start: &str| word.strip_prefix(start)?.parse::<u8>().ok();
        let jpeg = || number("jpeg").filter(|quality| (1..=100).contains(quality));
        let damage = match word {
            "clean" => Some(Self::Clean),
            "aliased" => Some(Self::Aliased),
            "dithered" => Some(Self::Dithered),
            "enlarged" => Some(Self::Enlarged),
            "photographed" => Some(Self::Photographed),
            _ => jpeg().map(Self::Jpeg).or(number("noise").map(Self::Noise)),
        };
        damage.ok_or_else(|| {
            let message = format!(
                "'{word}' is no damage: give clean, jpeg1 to jpeg100, noise0 to noise255, aliased, dithered, enlarged, or photographed"
            );
            Error::new(ErrorKind::Config, message)
        })
    }
}

impl From<Damage> for String {
    fn from(damage: Damage) -> Self {
        damage.to_string()
    }
}

impl TryFrom<String> for Damage {
    type Error = Error;

    fn try_from(word: String) -> Result<Self, Error> {
        word.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damages_are_read_as_they_are_written() {
        for damage in Damage::ALL {
            assert_eq!(damage.to_string().parse::<Damage>().unwrap(), damage);
        }
        for word in ["", "jpeg", "jpeg0", "jpeg101", "noise", "noise256", "grey"] {
            assert!(word.parse::<Damage>().is_err(), "{word}");
        }
    }
}
