//! Choices among a few words.

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
    };
}

pub(crate) use words;

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
