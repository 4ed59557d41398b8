//! Choices among a few words, and options that are read from a text.

use std::str::FromStr;

use serde::{Deserialize, Deserializer, de};

use crate::error::{Error, ErrorKind};

/// Lists the values of an enum as `ALL`, and reads and writes them as words. The error of any other text names the kind
/// of choice and its words.
macro_rules! words {
    ($choice:ident, $kind:literal: $($value:ident = $word:literal),+) => {
        impl $choice {
            /// Every value.
            pub const ALL: [Self; [$($word),+].len()] = [$(Self::$value),+];
        }

        impl std::fmt::Display for $choice {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(match self {
                    $(Self::$value => $word),+
                })
            }
        }

        impl std::str::FromStr for $choice {
            type Err = crate::error::Error;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                match text {
                    $($word => Ok(Self::$value),)+
                    _ => Err(crate::words::unknown(text, $kind, &[$($word),+])),
                }
            }
        }

        crate::words::from_text!($choice);
    };
}

/// Lets JSON have a value as the text that `FromStr` reads.
macro_rules! from_text {
    ($($option:ty),+) => {
        $(impl<'de> serde::Deserialize<'de> for $option {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                crate::words::parsed(from)
            }
        })+
    };
}

pub(crate) use {from_text, words};

/// A value of JSON that is a text.
pub(crate) fn parsed<'de, D: Deserializer<'de>, T: FromStr<Err = Error>>(
    from: D,
) -> Result<T, D::Error> {
    let text = String::deserialize(from)?;
    text.parse().map_err(de::Error::custom)
}

/// The beginning of a text, for a message.
pub(crate) fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

/// The error of a text that is none of the words.
pub(crate) fn unknown(text: &str, kind: &str, words: &[&str]) -> Error {
    let short = short(text);
    let words = match words {
        [others @ .., last] => format!("{} or {last}", others.join(", ")),
        [] => String::new(),
    };
    let message = format!("'{short}' is not {kind}: give {words}");
    Error::new(ErrorKind::Config, message)
}
