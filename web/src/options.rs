//! The options of a fit, as JSON.

use serde_json::{Map, Value};
use strokefit::fit::{self, Config};
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
    /// command line's options, and those of the base.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when a key or its value is none of those; the message names both.
    pub fn read(json: &str) -> Result<Self> {
        let mut given: Map<String, Value> = serde_json::from_str(json).map_err(|e| {
            refusal(format!(
                "the options are no object ({e}): give {{strokes: 500}}"
            ))
        })?;
        let base = match given.remove("base") {
            None | Some(Value::Null) => None,
            Some(Value::String(text)) => Some(text),
            Some(other) => return Err(refusal(format!("base is {other}: give a text"))),
        };
        let freeze_base = match given.remove("freezeBase") {
            None | Some(Value::Null) => false,
            Some(Value::Bool(on)) => on,
            Some(other) => {
                return Err(refusal(format!(
                    "freezeBase is {other}: give true or false"
                )));
            }
        };
        let config = fit::Options::from_json(given)?.config;
        Ok(Self {
            config,
            base,
            freeze_base,
        })
    }
}

fn refusal(message: String) -> Error {
    Error::new(ErrorKind::Config, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_means_the_defaults() {
        for json in ["{}", r#"{"strokes": null, "base": null}"#] {
            assert_eq!(Options::read(json).unwrap(), Options::default());
        }
    }

    #[test]
    fn options_and_the_base_arrive() {
        let json = r#"{"strokes": 500, "base": "<svg/>", "freezeBase": true}"#;
        let mut expected = Options {
            base: Some("<svg/>".into()),
            freeze_base: true,
            ..Options::default()
        };
        expected.config.budget.strokes = Some(500);
        assert_eq!(Options::read(json).unwrap(), expected);
    }

    #[test]
    fn what_is_wrong_is_named_with_the_remedy() {
        for (json, words) in [
            ("[]", ["no object", "give {strokes: 500}"]),
            (r#"{"base": 5}"#, ["base is 5", "a text"]),
            (r#"{"freezeBase": 1}"#, ["freezeBase is 1", "true or false"]),
            (r#"{"strkes": 5}"#, ["called strkes", "give strokes, "]),
            (r#"{"strokes": 0}"#, ["strokes is 0", "from 1 to 900000"]),
        ] {
            let error = Options::read(json).unwrap_err().to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }
}
