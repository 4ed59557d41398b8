//! Values of options: numbers and choices of a few words.

use std::fmt::Display;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use strokefit::fit::{MAX_STROKES, MAX_THREADS};

/// One of the values, by the words that they are read from and written as, each with its help.
pub(super) fn one_of<T, const N: usize>(
    values: [(T, &'static str); N],
) -> impl TypedValueParser<Value = T>
where
    T: Clone + Display + FromStr<Err = strokefit::Error> + Send + Sync + 'static,
{
    let words = values.map(|(value, help)| PossibleValue::new(value.to_string()).help(help));
    PossibleValuesParser::new(words).try_map(|word| word.parse::<T>())
}

/// Longest side of a picture of a known drawing, px; it is rendered at four times that.
const MAX_SIDE: usize = 2048;

/// A number of strokes, iterations or frames.
pub(super) fn count(text: &str) -> Result<usize, String> {
    whole(text, MAX_STROKES)
}

/// A number of threads.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    whole(text, MAX_THREADS)
}

/// The longer side of a picture, px.
pub(super) fn side(text: &str) -> Result<u16, String> {
    whole(text, MAX_SIDE).and_then(|px| u16::try_from(px).map_err(|e| e.to_string()))
}

fn whole(text: &str, most: usize) -> Result<usize, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (1..=most).contains(number));
    number.ok_or_else(|| format!("give a whole number from 1 to {most}"))
}
