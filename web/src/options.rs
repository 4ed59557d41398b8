//! The options of a fit, as JSON.

use std::time::Duration;

use serde_json::Value;
use strokefit::fit::{Config, MAX_STROKES};
use strokefit::scene::MAX_POINTS;
use strokefit::{Error, ErrorKind, Result};

/// What to draw, and what to go on from.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Options {
    /// The configuration of the fit.
    pub config: Config,
    /// The text of an SVG to go on from.
    pub base: Option<String>,
    /// Whether the strokes of the base stay as they are.
    pub freeze_base: bool,
}

impl Options {
    /// Reads an object of options; what it lacks, and what is `null`, is as by default. The keys are the long names of the
    /// command line's options, in camel case where they have two words.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when a key or its value is none of those; the message names both.
    pub fn read(json: &str) -> Result<Self> {
        let entries: serde_json::Map<String, Value> = serde_json::from_str(json).map_err(|e| {
            refusal(format!(
                "the options are no object ({e}): give {{strokes: 500}}"
            ))
        })?;
        let mut options = Self::default();
        for (key, value) in entries.iter().filter(|(_, value)| !value.is_null()) {
            options.set(key, value)?;
        }
        Ok(options)
    }

    fn set(&mut self, key: &str, value: &Value) -> Result<()> {
        let entry = Entry { key, value };
        let config = &mut self.config;
        match key {
            "strokes" => config.budget.strokes = Some(entry.whole(MAX_STROKES)?),
            "psnr" => config.budget.psnr_db = Some(entry.number()?),
            "bytes" => config.budget.bytes = Some(entry.whole(usize::MAX)?),
            "time" => config.budget.time = Some(entry.seconds()?),
            "quality" => config.quality = Some(entry.number()?),
            "preset" => config.preset = entry.word()?,
            "progressive" => config.progressive = entry.switch()?,
            "look" => config.look = Some(entry.word()?),
            "opaque" => config.opaque = entry.switch()?,
            "coverage" => config.coverage = entry.word()?,
            "points" => config.points = Some(entry.whole(MAX_POINTS)?),
            "stages" => config.stages = Some(entry.whole(MAX_STROKES)?),
            "polish" => config.polish = entry.switch()?,
            "background" => config.background = entry.word()?,
            "seed" => config.seed = entry.natural()?,
            "colors" => config.colors = entry.word()?,
            "pens" => config.pens = Some(entry.word()?),
            "form" => config.file.form = entry.word()?,
            "group" => config.file.group = entry.word()?,
            "order" => config.file.order = entry.word()?,
            "precision" => config.file.precision = entry.decimals()?,
            "width" => config.file.width = Some(entry.word()?),
            "base" => self.base = Some(entry.text()?.to_owned()),
            "freezeBase" => self.freeze_base = entry.switch()?,
            _ => return Err(entry.unknown()),
        }
        Ok(())
    }
}

/// One option.
struct Entry<'a> {
    key: &'a str,
    value: &'a Value,
}

impl Entry<'_> {
    /// Text that the library reads.
    fn word<T: std::str::FromStr<Err = Error>>(&self) -> Result<T> {
        self.text()?.parse().map_err(|e: Error| e.within(self.key))
    }

    fn text(&self) -> Result<&str> {
        self.value.as_str().ok_or_else(|| self.wrong("a text"))
    }

    fn switch(&self) -> Result<bool> {
        self.value
            .as_bool()
            .ok_or_else(|| self.wrong("true or false"))
    }

    fn number(&self) -> Result<f64> {
        self.value.as_f64().ok_or_else(|| self.wrong("a number"))
    }

    fn seconds(&self) -> Result<Duration> {
        let duration = Duration::try_from_secs_f64(self.number()?);
        duration.map_err(|_| self.wrong("seconds above 0"))
    }

    fn natural(&self) -> Result<u64> {
        let whole = self.value.as_u64();
        whole.ok_or_else(|| self.wrong("a whole number of 0 or more"))
    }

    fn decimals(&self) -> Result<u8> {
        u8::try_from(self.natural()?).map_err(|_| self.wrong("0 to 6"))
    }

    /// A whole number from 1 to `most`.
    fn whole(&self, most: usize) -> Result<usize> {
        let whole = self.value.as_u64().and_then(|n| usize::try_from(n).ok());
        whole.filter(|n| (1..=most).contains(n)).ok_or_else(|| {
            self.wrong(&match most {
                usize::MAX => "a whole number of 1 or more".into(),
                most => format!("a whole number from 1 to {most}"),
            })
        })
    }

    fn wrong(&self, right: &str) -> Error {
        refusal(format!("{} is {}: give {right}", self.key, self.value))
    }

    fn unknown(&self) -> Error {
        refusal(format!(
            "no option is called {}: give strokes, psnr, bytes, time, quality, preset, progressive, look, opaque, coverage, \
             points, stages, polish, background, seed, colors, pens, form, group, order, precision, width, base or freezeBase",
            self.key
        ))
    }
}

fn refusal(message: String) -> Error {
    Error::new(ErrorKind::Config, message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use strokefit::fit::{Background, Colors, Preset};
    use strokefit::svg::{Form, Group, Order};

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
    fn every_option_arrives() {
        let json = r##"{
            "strokes": 500, "psnr": 32, "bytes": 9000, "time": 1.5, "quality": 25, "preset": "draft", "progressive": true,
            "look": "exact", "opaque": true, "coverage": "sigmoid", "points": 6, "stages": 3, "polish": false, "background": "#ff0000", "seed": 7,
            "colors": "8", "pens": "2,3", "form": "smallest", "group": "color", "order": "travel", "precision": 1, "width": "120mm", "base": "<svg/>",
            "freezeBase": true
        }"##;
        let options = Options::read(json).unwrap();
        let Config { budget, file, .. } = &options.config;
        assert_eq!(
            (budget.strokes, budget.psnr_db, budget.bytes),
            (Some(500), Some(32.0), Some(9000))
        );
        assert_eq!(budget.time, Some(Duration::from_millis(1500)));
        assert_eq!(
            (file.form, file.group, file.order, file.precision),
            (Form::Smallest, Group::Color, Order::Travel, 1)
        );
        assert_eq!(file.width, Some("120mm".parse().unwrap()));
        let expected = Config {
            budget: *budget,
            quality: Some(25.0),
            preset: Preset::Draft,
            progressive: true,
            look: Some(strokefit::fit::ErrorWeighting::Exact),
            opaque: true,
            coverage: "sigmoid".parse().unwrap(),
            points: Some(6),
            stages: Some(3),
            polish: false,
            colors: Colors::AtMost(8),
            pens: Some("2,3".parse().unwrap()),
            file: *file,
            background: Background::Color([1.0, 0.0, 0.0]),
            seed: 7,
            recipe: None,
        };
        assert_eq!(options.config, expected);
        assert_eq!(
            (options.base.as_deref(), options.freeze_base),
            (Some("<svg/>"), true)
        );
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
