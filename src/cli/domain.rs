//! Values that options may have. Each parser's error says what would be right; clap adds the value
//! and the option's name.

use std::time::Duration;

use strokefit::fit::{Colors, MAX_STROKES};
use strokefit::scene::{MAX_POINTS, MAX_PRECISION};

/// More threads than any machine has cores only waste memory.
const MAX_THREADS: usize = 1024;

/// Units of sizes, in bytes.
const UNITS: [(&str, usize); 8] = [
    ("", 1),
    ("B", 1),
    ("k", 1000),
    ("kB", 1000),
    ("KiB", 1 << 10),
    ("M", 1_000_000),
    ("MB", 1_000_000),
    ("MiB", 1 << 20),
];

type Parsed<T> = Result<T, String>;

/// A limit on strokes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StrokeLimit {
    /// In the whole drawing.
    Total(usize),
    /// Beyond those that a base brings.
    More(usize),
}

impl StrokeLimit {
    /// Most strokes of a drawing whose base brings `before`.
    pub(super) fn total(self, before: usize) -> usize {
        match self {
            Self::Total(most) => most,
            Self::More(more) => before.saturating_add(more).min(MAX_STROKES),
        }
    }
}

pub(super) fn stroke_limit(text: &str) -> Parsed<StrokeLimit> {
    match text.strip_prefix('+') {
        Some(more) => strokes(more).map(StrokeLimit::More),
        None => strokes(text).map(StrokeLimit::Total),
    }
}

/// A number of strokes.
pub fn strokes(text: &str) -> Parsed<usize> {
    whole(text, 1..=MAX_STROKES)
}

pub(super) fn colors(text: &str) -> Parsed<usize> {
    whole(text, 1..=Colors::MAX)
}

/// A number of bytes, with a unit or without: `20000`, `20kB`, `1.5MB`, `64KiB`.
pub(super) fn bytes(text: &str) -> Parsed<usize> {
    let remedy = "give bytes, 1 or more, such as 20000, 20kB, 1.5MB or 64KiB";
    let digits = text.find(|c: char| !(c.is_ascii_digit() || c == '.'));
    let (number, unit) = text.split_at(digits.unwrap_or(text.len()));
    let factor = UNITS
        .iter()
        .find(|(name, _)| name.eq_ignore_ascii_case(unit.trim()));
    let bytes = match factor {
        Some((_, 1)) => number.parse().ok(),
        Some((_, factor)) => number.parse().ok().and_then(|n: f64| {
            let bytes = n * *factor as f64;
            // Beyond this, numbers of this type are not all whole.
            (bytes < (1_u64 << 53) as f64).then_some(bytes as usize)
        }),
        None => None,
    };
    bytes
        .filter(|bytes| *bytes > 0)
        .ok_or_else(|| remedy.into())
}

/// A number of stages, or of iterations.
pub fn stages(text: &str) -> Parsed<usize> {
    whole(text, 1..=MAX_STROKES)
}

pub(super) fn points(text: &str) -> Parsed<usize> {
    whole(text, 2..=MAX_POINTS)
}

/// A number of threads.
pub fn threads(text: &str) -> Parsed<usize> {
    whole(text, 1..=MAX_THREADS)
}

pub(super) fn pixels(text: &str) -> Parsed<u64> {
    whole(text, 1..=usize::MAX).map(|n| n as u64)
}

pub(super) fn precision(text: &str) -> Parsed<u8> {
    whole(text, 0..=usize::from(MAX_PRECISION)).map(|n| n as u8)
}

pub(super) fn psnr(text: &str) -> Parsed<f64> {
    let remedy = "give decibels from above 0 to 100, such as 32";
    text.parse()
        .ok()
        .filter(|db| *db > 0.0 && *db <= 100.0)
        .ok_or_else(|| remedy.into())
}

pub(super) fn seconds(text: &str) -> Parsed<Duration> {
    let remedy = "give seconds above 0, such as 10 or 0.5";
    let seconds = text.parse().ok().filter(|s| *s > 0.0);
    seconds
        .and_then(|s| Duration::try_from_secs_f64(s).ok())
        .ok_or_else(|| remedy.into())
}

pub(super) fn scale(text: &str) -> Parsed<f64> {
    let remedy = "give a factor above 0, such as 2 or 0.5";
    text.parse()
        .ok()
        .filter(|s: &f64| s.is_finite() && *s > 0.0)
        .ok_or_else(|| remedy.into())
}

fn whole(text: &str, range: std::ops::RangeInclusive<usize>) -> Parsed<usize> {
    let digits = Some(text).filter(|text| !text.starts_with('+'));
    digits
        .and_then(|digits| digits.parse().ok())
        .filter(|n| range.contains(n))
        .ok_or_else(|| match *range.end() {
            usize::MAX => format!("give a whole number of {} or more", range.start()),
            end => format!("give a whole number from {} to {end}", range.start()),
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "0", "-1", "1.5", "x", "99999999999999999999999"] {
            assert!(
                strokes(text).is_err() && bytes(text).is_err() && threads(text).is_err(),
                "{text}"
            );
        }
        for text in ["NaN", "inf", "-1", "0", "1e400", ""] {
            assert!(
                psnr(text).is_err() && seconds(text).is_err() && scale(text).is_err(),
                "{text}"
            );
        }
        for text in ["+", "+0", "++3", "+-3"] {
            assert!(stroke_limit(text).is_err(), "{text}");
        }
        for text in [
            "kB",
            "1.5",
            "1.5B",
            "1e3",
            "-2kB",
            "0.0001kB",
            "9GB",
            "99999999999999MB",
        ] {
            assert!(bytes(text).is_err(), "{text}");
        }
        assert!(precision("7").is_err() && precision("-1").is_err());
    }

    #[test]
    fn sense_is_understood() {
        assert_eq!(strokes("900000"), Ok(900_000));
        assert_eq!(stroke_limit("200"), Ok(StrokeLimit::Total(200)));
        assert_eq!(stroke_limit("+300"), Ok(StrokeLimit::More(300)));
        assert_eq!(StrokeLimit::More(300).total(200), 500);
        assert_eq!(precision("0"), Ok(0));
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
        assert_eq!(psnr("32.5"), Ok(32.5));
        assert_eq!(seconds("0.5"), Ok(Duration::from_millis(500)));
    }
}
