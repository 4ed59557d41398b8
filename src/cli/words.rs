//! Options whose values are a few words.

use std::fmt::Display;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// One of the values, by the words that they are read from and written as, each with its help.
pub fn one_of<T, const N: usize>(values: [(T, &'static str); N]) -> impl TypedValueParser<Value = T>
where
    T: Clone + Display + FromStr<Err = strokefit::Error> + Send + Sync + 'static,
{
    one_of_or_former(values, &[])
}

/// As [`one_of`], and for words of former versions says what `T` has to say of them.
pub(super) fn one_of_or_former<T, const N: usize>(
    values: [(T, &'static str); N],
    former: &[&'static str],
) -> impl TypedValueParser<Value = T>
where
    T: Clone + Display + FromStr<Err = strokefit::Error> + Send + Sync + 'static,
{
    let words = values.map(|(value, help)| PossibleValue::new(value.to_string()).help(help));
    let former = former
        .iter()
        .map(|word| PossibleValue::new(*word).hide(true));
    let words: Vec<_> = words.into_iter().chain(former).collect();
    PossibleValuesParser::new(words).try_map(|word| word.parse::<T>())
}
