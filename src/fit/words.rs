//! Options of a fit as text, for the command line and for bindings.
//!
//! Every error names the value and says what would be right.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, de};

use super::{Background, Colors, ErrorWeighting, Preset};
use crate::error::{Error, Result};
use crate::scene::{Marks, color, quantum};
use crate::svg::opaque_color;
use crate::words::{from_text, short, words};

words!(Preset, "a preset": Draft = "draft", Balanced = "balanced", Best = "best");

words!(Marks, "a kind of marks": Auto = "auto", Strokes = "strokes", Areas = "areas");

words!(ErrorWeighting, "a look": Eye = "eye", Exact = "exact");

from_text!(Background);

impl fmt::Display for Background {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::None => f.write_str("none"),
            Self::Color(rgb) => write_color(f, rgb.map(quantum)),
        }
    }
}

impl FromStr for Background {
    type Err = Error;

    /// `auto`, `none`, `#rrggbb`, `#rgb` or the name of a colour, such as `white`.
    fn from_str(text: &str) -> Result<Self> {
        let unknown = || {
            Error::config(format!(
                "'{}' is not a background: give auto, none or a colour such as #ffffff",
                short(text)
            ))
        };
        match text {
            "auto" => Ok(Self::Auto),
            "none" => Ok(Self::None),
            _ => opaque_color(text)
                .map(|rgb| Self::Color(color(rgb)))
                .ok_or_else(unknown),
        }
    }
}

/// The first line of a GIMP palette.
const GIMP: &str = "GIMP Palette";

impl Colors {
    /// Most colours that can be asked for; more are as good as any.
    pub const MAX: usize = 4096;

    /// The palette that `text` is: colours `#rrggbb`, `#rgb` or names such as `red` with commas between, or one a line, or a GIMP palette.
    /// A colour that comes twice counts once.
    ///
    /// # Errors
    /// [`ErrorKind::Config`](crate::ErrorKind::Config) when there is not a colour or more than 4,096, or one is written in another way.
    pub fn palette(text: &str) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        let is_gimp = text.starts_with(GIMP);
        let has_lines = is_gimp || text.trim().lines().count() > 1;
        let (separator, right) = match (is_gimp, has_lines) {
            (true, _) => ('\n', "three levels of 0 to 255"),
            (_, true) => ('\n', "#rrggbb"),
            _ => (',', "#rrggbb,#rrggbb,..."),
        };
        let may_be_empty = has_lines || text.trim().is_empty();
        let mut palette = Vec::new();
        for (i, word) in text.split(separator).map(str::trim).enumerate() {
            // A GIMP palette has a head and comments.
            let is_head =
                |word: &str| word.starts_with(GIMP) || word.starts_with('#') || word.contains(':');
            if may_be_empty && word.is_empty() || is_gimp && is_head(word) {
                continue;
            }
            let color = if is_gimp {
                levels(word)
            } else {
                opaque_color(word)
            };
            let color = color.ok_or_else(|| {
                let place = match has_lines {
                    true => format!("line {}: ", i + 1),
                    false => String::new(),
                };
                let word = short(word);
                Error::config(format!("{place}'{word}' is not a colour: give {right}"))
            })?;
            if !palette.contains(&color) {
                palette.push(color);
            }
            if palette.len() > Self::MAX {
                let message = format!(
                    "the palette has more than {} colours: give fewer",
                    Self::MAX
                );
                return Err(Error::config(message));
            }
        }
        if palette.is_empty() {
            return Err(Error::config("the palette has no colour: give one or more"));
        }
        Ok(Self::Palette(palette))
    }
}

/// The first three numbers of a line of a GIMP palette; a name may follow.
fn levels(line: &str) -> Option<[u8; 3]> {
    let mut words = line.split_ascii_whitespace().map(|word| word.parse().ok());
    Some([words.next()??, words.next()??, words.next()??])
}

impl fmt::Display for Colors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Free => f.write_str("free"),
            Self::AtMost(most) => write!(f, "{most}"),
            Self::Palette(palette) => palette.iter().enumerate().try_for_each(|(i, &color)| {
                f.write_str(if i > 0 { "," } else { "" })?;
                write_color(f, color)
            }),
        }
    }
}

impl FromStr for Colors {
    type Err = Error;

    /// `free`, a number of colours, or a palette as [`Colors::palette`] takes it.
    fn from_str(text: &str) -> Result<Self> {
        if text == "free" {
            return Ok(Self::Free);
        }
        if !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit()) {
            let count = text.parse().ok();
            let count = count.filter(|count| (1..=Self::MAX).contains(count));
            return count.map(Self::AtMost).ok_or_else(|| {
                Error::config(format!(
                    "{} colours cannot be drawn with: give 1 to {}",
                    short(text),
                    Self::MAX
                ))
            });
        }
        Self::palette(text)
    }
}

/// A number of colours, or a text as `FromStr` takes it.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "give a whole number from 1 to 4096, or colours as a text"
)]
enum Given {
    Count(usize),
    Text(String),
}

impl<'de> Deserialize<'de> for Colors {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        match Given::deserialize(from)? {
            Given::Count(most) => Ok(Self::AtMost(most)),
            Given::Text(text) => text.parse().map_err(de::Error::custom),
        }
    }
}

fn write_color(f: &mut fmt::Formatter<'_>, [r, g, b]: [u8; 3]) -> fmt::Result {
    write!(f, "#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn red_and_ink() -> Colors {
        Colors::Palette(vec![[255, 0, 0], [16, 32, 48]])
    }

    fn message<T: FromStr<Err = Error> + fmt::Debug>(text: &str) -> String {
        text.parse::<T>().unwrap_err().to_string()
    }

    #[test]
    fn every_word_is_read_as_it_is_written() {
        for preset in Preset::ALL {
            assert_eq!(preset.to_string().parse::<Preset>().unwrap(), preset);
        }
        let green = Background::Color([0.0, 1.0, 0.0]);
        for background in [Background::Auto, Background::None, green] {
            let word = background.to_string();
            assert_eq!(word.parse::<Background>().unwrap(), background);
        }
        for colors in [Colors::Free, Colors::AtMost(8), red_and_ink()] {
            assert_eq!(colors.to_string().parse::<Colors>().unwrap(), colors);
        }
    }

    #[test]
    fn lists_lines_and_gimp_palettes_say_the_same() {
        let gimp = "GIMP Palette\nName: two\nColumns: 2\n#\n255   0   0\tRed\n 16  32  48\n";
        for text in [
            "#ff0000,#102030, #FF0000",
            "#ff0000\n\n#102030\r\n",
            "\u{feff}#ff0000\n#102030",
            gimp,
        ] {
            assert_eq!(Colors::palette(text).unwrap(), red_and_ink(), "{text}");
        }
        let red = Colors::Palette(vec![[255, 0, 0]]);
        assert_eq!(Colors::palette("#ff0000\n").unwrap(), red);
    }

    #[test]
    fn colours_may_be_short_or_named() {
        let background = |text: &str| text.parse::<Background>().unwrap().to_string();
        assert_eq!(background("white"), "#ffffff");
        assert_eq!(background("Red"), "#ff0000");
        assert_eq!(background("#1fA"), "#11ffaa");
        assert_eq!(Colors::palette("red,#102030").unwrap(), red_and_ink());
    }

    #[test]
    fn what_is_no_palette_is_refused_with_its_place() {
        for (text, words) in [
            ("#ff0000,#12", "'#12' is not a colour"),
            ("no-such-file", "'no-such-file' is not a colour"),
            ("#ff0000\nrot", "line 2: 'rot'"),
            ("GIMP Palette\n300 0 0", "line 2: '300 0 0'"),
            ("GIMP Palette\n#\n", "no colour"),
            ("", "no colour"),
            (" \n", "no colour"),
        ] {
            let error = Colors::palette(text).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn errors_name_the_value_and_the_remedy() {
        let drft = message::<Preset>("drft");
        assert!(drft.contains("'drft'") && drft.contains("draft, balanced or best"));
        for text in [
            "", "#ffff", "whitish", "#gggggg", "#+12345", "ffffff", "#", "#+12",
        ] {
            let error = message::<Background>(text);
            assert!(error.contains(&format!("'{text}'")) && error.contains("auto, none"));
        }
        for text in ["0", "4097", "99999999999999999999999"] {
            assert!(message::<Colors>(text).contains("give 1 to 4096"));
        }
    }
}
