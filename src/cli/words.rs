//! Options whose values are a few words.

use std::fmt::Display;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// One of the values, by the words that they are read from and written as, each with its help.
pub fn one_of<T, const N: usize>(values: [(T, &'static str); N]) -> impl TypedValueParser<Value = T>
where
    T: Clone + Display + FromStr<Err = strokefit::Error> + Send + Sync + 'static,
{
    let words = values.map(|(value, help)| PossibleValue::new(value.to_string()).help(help));
    PossibleValuesParser::new(words).try_map(|word| word.parse::<T>())
}
