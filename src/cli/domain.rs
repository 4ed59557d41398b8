//! Values of options that the library does not know. Each error says what would be right; clap adds the value
//! and the option's name.

use std::time::Duration;

use strokefit::fit::{Refusal, Value};

type Parsed<T> = Result<T, String>;

pub(super) fn pixels(text: &str) -> Parsed<u64> {
    told(Value::Written(text).whole(1..))
}

pub(super) fn seconds(text: &str) -> Parsed<Duration> {
    told(Value::Written(text).seconds())
}

pub(super) fn scale(text: &str) -> Parsed<f64> {
    let right = "a factor above 0, such as 2 or 0.5";
    told(Value::Written(text).number(right, |factor| factor.is_finite() && factor > 0.0))
}

fn told<T>(parsed: Result<T, Refusal>) -> Parsed<T> {
    parsed.map_err(|refusal| refusal.to_string())
}
