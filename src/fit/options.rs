//! Options by name: the page, Node and Python hand them over as an object of JSON.

use serde::Deserialize;
use serde_json::{Map, Value};

use super::{Config, Execution};
use crate::error::{Error, Result};

/// The names of all options.
pub const OPTIONS: [&str; 29] = [
    "strokes",
    "psnr",
    "bytes",
    "time",
    "quality",
    "preset",
    "marks",
    "progressive",
    "literal",
    "paper",
    "blurs",
    "look",
    "opaque",
    "coverage",
    "points",
    "stages",
    "polish",
    "background",
    "seed",
    "colors",
    "palette",
    "pens",
    "form",
    "group",
    "order",
    "precision",
    "width",
    "threads",
    "simd",
];

/// Configuration of a fit and settings of its run.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct Options {
    /// Configuration of the fit.
    #[serde(flatten)]
    pub config: Config,
    /// Settings of the run.
    #[serde(flatten)]
    pub execution: Execution,
}

impl Options {
    /// Reads an object of [`OPTIONS`]; what it lacks, and what is `null`, is as by default.
    ///
    /// # Errors
    /// [`ErrorKind::Config`](crate::ErrorKind::Config) when there is no such option, or a value is none of its values. The message names both. The cause
    /// is an error of `serde_json` if the value is of the wrong type.
    pub fn from_json(mut given: Map<String, Value>) -> Result<Self> {
        given.retain(|_, value| !value.is_null());
        if let Some(name) = given.keys().find(|name| !OPTIONS.contains(&name.as_str())) {
            return Err(Error::config(format!(
                "no option is called {name}: give {}",
                OPTIONS.join(", ")
            )));
        }
        let options = read(given.clone()).map_err(|_| wrong(given))?;
        options.config.check_ranges()?;
        options.execution.check()?;
        Ok(options)
    }
}

fn read(given: Map<String, Value>) -> serde_json::Result<Options> {
    Options::deserialize(Value::Object(given))
}

/// The error of options that cannot be read together. Serde names no option; the one to blame cannot be read alone either.
fn wrong(given: Map<String, Value>) -> Error {
    for (name, value) in given {
        let setting = format!("{name} is {value}");
        if let Err(cause) = read(Map::from_iter([(name, value)])) {
            return Error::config(format!("{setting}: {}", remedy(&cause))).caused_by(cause);
        }
    }
    Error::config("colors and palette exclude each other: give one of them")
}

/// What would be right in place of a value of another type.
fn remedy(error: &serde_json::Error) -> String {
    let message = error.to_string();
    match message.rsplit_once(", expected ") {
        Some((_, "a boolean")) => "give true or false".into(),
        Some((_, "a string")) => "give a text".into(),
        Some((_, "f64")) => "give a number".into(),
        Some((_, "u8")) => format!("give a whole number from 0 to {}", u8::MAX),
        Some((_, "usize" | "u64")) => "give a whole number of 0 or more".into(),
        _ => message,
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::fit::{Budget, Colors, Preset};

    fn options(json: &str) -> Result<Options, String> {
        Options::from_json(serde_json::from_str(json).unwrap()).map_err(|error| error.to_string())
    }

    #[test]
    fn nothing_means_the_defaults() {
        for json in ["{}", r#"{"strokes": null, "preset": null}"#] {
            assert_eq!(options(json).unwrap(), Options::default());
        }
    }

    #[test]
    fn every_name_is_that_of_an_option() {
        for name in OPTIONS {
            let refused = options(&format!(r#"{{"{name}": {{}}}}"#)).unwrap_err();
            assert!(
                refused.starts_with(&format!("{name} is {{}}: give ")),
                "{refused}"
            );
        }
    }

    #[test]
    fn options_of_every_kind_arrive() {
        let read = options(
            r#"{
            "strokes": 500, "psnr": 32, "time": 1.5, "bytes": 20000, "preset": "draft", "polish": false, "colors": "8",
            "seed": 18446744073709551615, "simd": "sse4.2", "threads": 2
        }"#,
        );
        let mut expected = Options::default();
        expected.config.budget = Budget {
            strokes: Some(500),
            psnr_db: Some(32.0),
            time: Some(Duration::from_millis(1500)),
            bytes: Some(20_000),
        };
        expected.config.preset = Preset::Draft;
        expected.config.polish = false;
        expected.config.colors = Colors::AtMost(8);
        expected.config.seed = u64::MAX;
        expected.execution.simd = crate::fit::Simd::Sse42;
        expected.execution.threads = Some(2);
        assert_eq!(read.unwrap(), expected);
        let two = options(r##"{"palette": "#ff0000,#000000"}"##).unwrap();
        assert!(matches!(two.config.colors, Colors::Palette(colors) if colors.len() == 2));
    }

    #[test]
    fn what_is_wrong_is_named_with_the_remedy() {
        for (json, words) in [
            (r#"{"strkes": 5}"#, ["called strkes", "give strokes, "]),
            (r#"{"strokes": 0}"#, ["strokes is 0", "from 1 to 900000"]),
            (r#"{"strokes": -1}"#, ["strokes is -1", "0 or more"]),
            (r#"{"strokes": "5"}"#, ["strokes is \"5\"", "whole number"]),
            (r#"{"bytes": 1.5}"#, ["bytes is 1.5", "whole number"]),
            (r#"{"psnr": -3}"#, ["psnr is -3", "decibels"]),
            (r#"{"quality": 99}"#, ["quality is 99", "0 to 60"]),
            (r#"{"time": -1}"#, ["time is -1", "seconds"]),
            (
                r#"{"preset": "drft"}"#,
                ["preset is \"drft\"", "draft, balanced or best"],
            ),
            (r#"{"opaque": 1}"#, ["opaque is 1", "true or false"]),
            (r#"{"precision": 7}"#, ["precision is 7", "0 to 6"]),
            (r#"{"points": 1}"#, ["points is 1", "2 to 65535"]),
            (r#"{"stages": 0}"#, ["stages is 0", "whole number"]),
            (r#"{"colors": 0}"#, ["colors is 0", "1 to 4096"]),
            (r#"{"threads": 0}"#, ["threads is 0", "1 to 1024"]),
            (r#"{"width": "9"}"#, ["width is \"9\"", "120mm"]),
            (
                r##"{"colors": 3, "palette": "#ff0000"}"##,
                ["colors and palette", "one of them"],
            ),
        ] {
            let error = options(json).unwrap_err();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }
}
