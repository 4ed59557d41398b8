//! The options of a fit, as JSON.

use serde_json::Value as Json;
use strokefit::fit::{self, Config, OPTIONS, Refusal, Value};
use strokefit::{Error, ErrorKind, Result};

/// Configuration of the fit, and the drawing to go on from.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Options {
    /// The configuration of the fit.
    pub config: Config,
    /// The text of an SVG to go on from.
    pub base: Option<String>,
    /// True if the strokes of the base stay as they are.
    pub freeze_base: bool,
}

impl Options {
    /// Reads an object of options; what it lacks, and what is `null`, is as by default. The keys are the long names of the
    /// command line's options, in camel case where they have two words.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when a key or its value is none of those; the message names both.
    pub fn read(json: &str) -> Result<Self> {
        let entries: serde_json::Map<String, Json> = serde_json::from_str(json).map_err(|e| {
            refusal(format!(
                "the options are no object ({e}): give {{strokes: 500}}"
            ))
        })?;
        let mut options = fit::Options::default();
        let (mut base, mut freeze_base) = (None, false);
        for (key, json) in entries.iter().filter(|(_, json)| !json.is_null()) {
            let value = value(json);
            let set = match key.as_str() {
                "base" => value.text().map(|text| base = Some(text.to_owned())),
                "freezeBase" => value.switch().map(|on| freeze_base = on),
                _ => options.set(key, value),
            };
            set.map_err(|refused| match refused {
                Refusal::Unknown => refusal(format!(
                    "no option is called {key}: give {OPTIONS}, base or freezeBase"
                )),
                _ => refused.of(key, format_args!("{key} is {json}")),
            })?;
        }
        Ok(Self {
            config: options.config,
            base,
            freeze_base,
        })
    }
}

fn value(json: &Json) -> Value<'_> {
    match json {
        Json::Bool(on) => Value::Switch(*on),
        Json::String(text) => Value::Text(text),
        Json::Number(number) => match (number.as_i128(), number.as_f64()) {
            (Some(whole), _) => Value::Whole(whole),
            (None, Some(number)) => Value::Number(number),
            (None, None) => Value::Other,
        },
        Json::Null | Json::Array(_) | Json::Object(_) => Value::Other,
    }
}

fn refusal(message: String) -> Error {
    Error::new(ErrorKind::Config, message)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use strokefit::fit::{Budget, Colors, Preset};

    fn refused(json: &str) -> String {
        Options::read(json).unwrap_err().to_string()
    }

    #[test]
    fn nothing_means_the_defaults() {
        for json in ["{}", r#"{"strokes": null, "preset": null}"#] {
            assert_eq!(Options::read(json).unwrap(), Options::default());
        }
    }

    #[test]
    fn options_of_every_kind_arrive() {
        let json = r#"{
            "strokes": 500, "psnr": 32, "time": 1.5, "preset": "draft", "polish": false, "colors": "8",
            "base": "<svg/>", "freezeBase": true
        }"#;
        let mut expected = Options {
            base: Some("<svg/>".into()),
            freeze_base: true,
            ..Options::default()
        };
        expected.config.budget = Budget {
            strokes: Some(500),
            psnr_db: Some(32.0),
            time: Some(Duration::from_millis(1500)),
            ..Budget::default()
        };
        expected.config.preset = Preset::Draft;
        expected.config.polish = false;
        expected.config.colors = Colors::AtMost(8);
        assert_eq!(Options::read(json).unwrap(), expected);
    }

    #[test]
    fn what_is_wrong_is_named_with_the_remedy() {
        for (json, words) in [
            ("[]", ["no object", "give {strokes: 500}"]),
            (r#"{"strkes": 5}"#, ["called strkes", "give strokes, "]),
            (r#"{"strokes": 0}"#, ["strokes is 0", "from 1 to 900000"]),
            (r#"{"strokes": "5"}"#, ["strokes is \"5\"", "whole number"]),
            (r#"{"bytes": 1.5}"#, ["bytes is 1.5", "1 or more"]),
            (r#"{"time": -1}"#, ["time is -1", "seconds"]),
            (
                r#"{"preset": "drft"}"#,
                ["preset: 'drft'", "draft, balanced or best"],
            ),
            (r#"{"opaque": 1}"#, ["opaque is 1", "true or false"]),
            (r#"{"precision": 300}"#, ["precision is 300", "0 to 6"]),
            (r#"{"width": "9"}"#, ["width: '9'", "120mm"]),
        ] {
            let error = refused(json);
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }
}
