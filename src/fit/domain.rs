//! Values of options that are more than a number: ranges, bytes with a unit, seconds.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::time::Duration;

use serde::{Deserialize, Deserializer, de};

use crate::error::{Error, Result};

/// Refuses a whole number that is out of its range.
pub(super) fn within<N: Display + PartialOrd>(
    name: &str,
    number: Option<N>,
    range: RangeInclusive<N>,
) -> Result<()> {
    let (least, most) = (range.start(), range.end());
    let right = format!("a whole number from {least} to {most}");
    allowed(name, number, &right, |number| range.contains(number))
}

/// Refuses a value that is not `valid`; `right` says which are.
pub(super) fn allowed<V: Display>(
    name: &str,
    value: Option<V>,
    right: &str,
    valid: impl FnOnce(&V) -> bool,
) -> Result<()> {
    match value.filter(|value| !valid(value)) {
        Some(value) => Err(Error::config(format!("{name} is {value}: give {right}"))),
        None => Ok(()),
    }
}

/// Seconds above 0.
///
/// # Errors
/// The remedy when the text is none of those.
pub fn seconds(text: &str) -> Result<Duration, String> {
    let span = text.parse().ok().and_then(span);
    span.ok_or_else(|| format!("give {SECONDS}"))
}

/// Seconds that options of time may have.
pub(super) const SECONDS: &str = "seconds above 0, such as 10 or 0.5";

fn span(seconds: f64) -> Option<Duration> {
    let span = Duration::try_from_secs_f64(seconds).ok();
    span.filter(|span| !span.is_zero())
}

/// Seconds in JSON.
pub(super) fn time<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Duration>, D::Error> {
    let remedy = || de::Error::custom(format_args!("give {SECONDS}"));
    span(f64::deserialize(from)?).map(Some).ok_or_else(remedy)
}

/// A number of bytes with or without a unit: `20000`, `20kB`, `1.5MB`, `64KiB`.
#[cfg(feature = "cli")]
pub(super) fn bytes(text: &str) -> Result<usize, &'static str> {
    let digits = text.find(|c: char| !(c.is_ascii_digit() || c == '.'));
    let (number, unit) = text.split_at(digits.unwrap_or(text.len()));
    let factor = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "b" => Some(1.0),
        "k" | "kb" => Some(1e3),
        "kib" => Some(1024.0),
        "m" | "mb" => Some(1e6),
        "mib" => Some(1024.0 * 1024.0),
        _ => None,
    };
    let is_exact = factor != Some(1.0) || !number.contains('.');
    // Beyond this limit, numbers of this type are not all whole.
    let is_valid = |bytes: &f64| is_exact && (1.0..(1_u64 << 53) as f64).contains(bytes);
    let bytes = factor.and_then(|factor| Some(number.parse::<f64>().ok()? * factor));
    let bytes = bytes.filter(is_valid).map(|bytes| bytes as usize);
    bytes.ok_or("give bytes, 1 or more, such as 20000, 20kB, 1.5MB or 64KiB")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(feature = "cli")]
    fn bytes_may_have_a_unit() {
        for (text, value) in [
            ("20000", 20_000),
            ("20kB", 20_000),
            ("20 KB", 20_000),
            ("1.5MB", 1_500_000),
            ("64KiB", 65_536),
            ("7b", 7),
        ] {
            assert_eq!(bytes(text), Ok(value), "{text}");
        }
        for text in [
            "",
            "0",
            "-1",
            "+3",
            "1.5",
            "x",
            "kB",
            "1.5B",
            "1e3",
            "-2kB",
            "0.0001kB",
            "9GB",
            "99999999999999MB",
        ] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }

    #[test]
    fn seconds_are_above_0() {
        assert_eq!(seconds("0.5"), Ok(Duration::from_millis(500)));
        for text in ["NaN", "inf", "-1", "0", "1e-300", "1e400", ""] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
