//! Options by name: the command line, the page, Node and Python set a [`Config`] and an [`Execution`] here.

use std::fmt;
use std::ops::{Bound, RangeBounds};
use std::str::FromStr;
use std::time::Duration;

use super::{Colors, Config, Execution, MAX_STROKES};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::{MAX_POINTS, MAX_PRECISION};

/// The names of all options, for a message.
pub const OPTIONS: &str = "strokes, psnr, bytes, time, quality, preset, marks, progressive, literal, look, opaque, coverage, points, stages, polish, \
    background, seed, colors, palette, pens, form, group, order, precision, width, threads, simd";

/// Most worker threads: more than any machine has cores only waste memory.
pub const MAX_THREADS: usize = 1024;

/// Configuration of a fit and settings of its run, set by name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Configuration of the fit.
    pub config: Config,
    /// Settings of the run.
    pub execution: Execution,
}

/// The value of an option.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value<'a> {
    /// A value of any kind as it is written on a command line.
    Written(&'a str),
    /// True or false.
    Switch(bool),
    /// A whole number.
    Whole(i128),
    /// A number that may have decimals.
    Number(f64),
    /// A text that is no number.
    Text(&'a str),
    /// A value that no option has, such as a list.
    Other,
}

/// The reason why an option cannot have a value.
#[derive(Debug)]
pub enum Refusal {
    /// No option has this name.
    Unknown,
    /// The value is of another kind than the option's; this would be right.
    Kind(String),
    /// The value is out of range; this would be right.
    Range(String),
    /// The error names the value and the remedy.
    Value(Error),
}

impl Options {
    /// Sets the option `name`, one of [`OPTIONS`].
    ///
    /// # Errors
    /// A [`Refusal`] when there is no such option, or its value is none of its values.
    pub fn set(&mut self, name: &str, value: Value<'_>) -> Result<(), Refusal> {
        let Self { config, execution } = self;
        let (budget, file) = (&mut config.budget, &mut config.file);
        match name {
            "strokes" => budget.strokes = Some(value.whole(1..=MAX_STROKES)?),
            "psnr" => budget.psnr_db = Some(value.decibels()?),
            "bytes" => budget.bytes = Some(value.bytes()?),
            "time" => budget.time = Some(value.seconds()?),
            "quality" => config.quality = Some(value.number("a number from 0 to 60", |_| true)?),
            "preset" => config.preset = value.word()?,
            "progressive" => config.progressive = value.switch()?,
            "marks" => config.marks = value.word()?,
            "literal" => config.literal = value.switch()?,
            "look" => config.look = Some(value.word()?),
            "opaque" => config.opaque = value.switch()?,
            "coverage" => config.coverage = value.word()?,
            "points" => config.points = Some(value.whole(2..=MAX_POINTS)?),
            "stages" => config.stages = Some(value.whole(1..=MAX_STROKES)?),
            "polish" => config.polish = value.switch()?,
            "background" => config.background = value.word()?,
            "seed" => config.seed = value.whole(0..=u64::MAX)?,
            "colors" => config.set_colors(value.colors()?)?,
            "palette" => config.set_colors(value.palette()?)?,
            "pens" => config.pens = Some(value.word()?),
            "form" => file.form = value.word()?,
            "group" => file.group = value.word()?,
            "order" => file.order = value.word()?,
            "precision" => file.precision = value.whole(0..=MAX_PRECISION)?,
            "width" => file.width = Some(value.word()?),
            "threads" => execution.threads = Some(value.whole(1..=MAX_THREADS)?),
            "simd" => execution.simd = value.word()?,
            _ => return Err(Refusal::Unknown),
        }
        Ok(())
    }
}

impl Config {
    /// Sets the colours, which two options do.
    fn set_colors(&mut self, colors: Colors) -> Result<(), Refusal> {
        if self.colors != Colors::Free {
            let message = "colors and palette exclude each other: give one of them";
            return Err(Error::new(ErrorKind::Config, message).into());
        }
        self.colors = colors;
        Ok(())
    }
}

impl<'a> Value<'a> {
    /// A whole number of this range.
    ///
    /// # Errors
    /// A [`Refusal`] when it is none of those.
    pub fn whole<N>(self, range: impl RangeBounds<N>) -> Result<N, Refusal>
    where
        N: PartialOrd + fmt::Display + FromStr + TryFrom<i128>,
    {
        let right = || match (range.start_bound(), range.end_bound()) {
            (Bound::Included(least), Bound::Included(most)) => {
                format!("a whole number from {least} to {most}")
            }
            (Bound::Included(least), _) => format!("a whole number of {least} or more"),
            _ => "a whole number".into(),
        };
        let number = match self {
            Self::Written(text) => text.parse().ok().filter(|_| !text.starts_with('+')),
            Self::Whole(number) => N::try_from(number).ok(),
            _ => return Err(Refusal::Kind(right())),
        };
        let number = number.filter(|number| range.contains(number));
        number.ok_or_else(|| Refusal::Range(right()))
    }

    /// A number that is `valid`; `right` says which are.
    ///
    /// # Errors
    /// A [`Refusal`] when it is not.
    pub fn number(self, right: &str, valid: impl Fn(f64) -> bool) -> Result<f64, Refusal> {
        let number = match self {
            Self::Written(text) => text.parse().ok(),
            Self::Whole(number) => Some(number as f64),
            Self::Number(number) => Some(number),
            _ => return Err(Refusal::Kind(right.into())),
        };
        let number = number.filter(|number| valid(*number));
        number.ok_or_else(|| Refusal::Range(right.into()))
    }

    /// Seconds above 0.
    ///
    /// # Errors
    /// A [`Refusal`] when it is none of those.
    pub fn seconds(self) -> Result<Duration, Refusal> {
        let span = |seconds| Duration::try_from_secs_f64(seconds).unwrap_or_default();
        let right = "seconds above 0, such as 10 or 0.5";
        self.number(right, |seconds| !span(seconds).is_zero())
            .map(span)
    }

    fn decibels(self) -> Result<f64, Refusal> {
        let right = "decibels from above 0 to 100, such as 32";
        self.number(right, |db| db > 0.0 && db <= 100.0)
    }

    /// A number of bytes; on a command line it may have a unit: `20000`, `20kB`, `1.5MB`, `64KiB`.
    fn bytes(self) -> Result<usize, Refusal> {
        let Self::Written(text) = self else {
            return self.whole(1..);
        };
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
        let right = "bytes, 1 or more, such as 20000, 20kB, 1.5MB or 64KiB";
        let bytes = bytes.filter(is_valid).map(|bytes| bytes as usize);
        bytes.ok_or_else(|| Refusal::Range(right.into()))
    }

    /// A number of colours, or a text that says which.
    fn colors(self) -> Result<Colors, Refusal> {
        match self {
            Self::Text(_) => self.word(),
            _ => self.whole(1..=Colors::MAX).map(Colors::AtMost),
        }
    }

    fn palette(self) -> Result<Colors, Refusal> {
        Ok(Colors::palette(self.text()?)?)
    }

    fn word<T: FromStr<Err = Error>>(self) -> Result<T, Refusal> {
        Ok(self.text()?.parse::<T>()?)
    }

    /// A text.
    ///
    /// # Errors
    /// A [`Refusal`] when it is of another kind.
    pub fn text(self) -> Result<&'a str, Refusal> {
        match self {
            Self::Written(text) | Self::Text(text) => Ok(text),
            _ => Err(Refusal::Kind("a text".into())),
        }
    }

    /// True or false.
    ///
    /// # Errors
    /// A [`Refusal`] when it is of another kind.
    pub fn switch(self) -> Result<bool, Refusal> {
        match self {
            Self::Switch(on) => Ok(on),
            _ => Err(Refusal::Kind("true or false".into())),
        }
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self::Value(error)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => f.write_str("no option has this name"),
            Self::Kind(right) | Self::Range(right) => write!(f, "give {right}"),
            Self::Value(error) => write!(f, "{error}"),
        }
    }
}

impl Refusal {
    /// The error of the option `name`. `setting` is the option with its value, as the caller writes them.
    pub fn of(self, name: &str, setting: impl fmt::Display) -> Error {
        match self {
            Self::Value(error) => error.within(name),
            _ => Error::new(ErrorKind::Config, format!("{setting}: {self}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(name: &str, value: Value<'_>) -> Result<Options, String> {
        let mut options = Options::default();
        let set = options.set(name, value);
        set.map(|()| options).map_err(|refusal| refusal.to_string())
    }

    fn written(name: &str, text: &str) -> Result<Options, String> {
        set(name, Value::Written(text))
    }

    #[test]
    fn every_name_is_that_of_an_option() {
        for name in OPTIONS.split(", ") {
            let refusal = Options::default().set(name, Value::Other).unwrap_err();
            assert!(matches!(refusal, Refusal::Kind(_)), "{name}: {refusal}");
        }
        let refusal = Options::default().set("strkes", Value::Whole(1));
        assert!(matches!(refusal, Err(Refusal::Unknown)));
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "0", "-1", "+3", "1.5", "x", "99999999999999999999999"] {
            for name in ["strokes", "bytes", "threads", "colors", "points", "stages"] {
                assert!(written(name, text).is_err(), "{name} {text}");
            }
        }
        for text in ["NaN", "inf", "-1", "0", "1e400", ""] {
            assert!(
                written("psnr", text).is_err() && written("time", text).is_err(),
                "{text}"
            );
        }
        for text in [
            "kB",
            "1.5B",
            "1e3",
            "-2kB",
            "0.0001kB",
            "9GB",
            "99999999999999MB",
        ] {
            assert!(written("bytes", text).is_err(), "{text}");
        }
        assert!(written("precision", "7").is_err() && written("precision", "-1").is_err());
    }

    #[test]
    fn sense_is_understood() {
        let budget = |name, text| written(name, text).unwrap().config.budget;
        assert_eq!(budget("strokes", "900000").strokes, Some(900_000));
        for (text, value) in [
            ("20000", 20_000),
            ("20kB", 20_000),
            ("20 KB", 20_000),
            ("1.5MB", 1_500_000),
            ("64KiB", 65_536),
            ("7b", 7),
        ] {
            assert_eq!(budget("bytes", text).bytes, Some(value), "{text}");
        }
        assert_eq!(budget("psnr", "32.5").psnr_db, Some(32.5));
        assert_eq!(budget("time", "0.5").time, Some(Duration::from_millis(500)));
        let seed = u64::MAX.to_string();
        assert_eq!(written("seed", &seed).unwrap().config.seed, u64::MAX);
    }

    #[test]
    fn values_are_of_their_kind() {
        assert!(set("psnr", Value::Whole(32)).is_ok() && set("psnr", Value::Number(32.0)).is_ok());
        for (name, value, right) in [
            (
                "strokes",
                Value::Number(5.0),
                "give a whole number from 1 to 900000",
            ),
            (
                "strokes",
                Value::Text("5"),
                "give a whole number from 1 to 900000",
            ),
            ("bytes", Value::Other, "give a whole number of 1 or more"),
            ("opaque", Value::Whole(1), "give true or false"),
            ("preset", Value::Switch(true), "give a text"),
        ] {
            assert_eq!(set(name, value).unwrap_err(), right);
        }
    }

    #[test]
    fn colors_are_a_number_or_a_palette() {
        let mut options = set("colors", Value::Whole(8)).unwrap();
        assert_eq!(options.config.colors, Colors::AtMost(8));
        let refusal = options.set("palette", Value::Text("#ff0000")).unwrap_err();
        assert!(refusal.to_string().contains("give one of them"));
    }
}
