//! Options of a fit, from a dictionary of Python's. `None` is an option's default.

use std::ops::RangeInclusive;
use std::str::FromStr;
use std::time::Duration;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use strokefit::fit::{Budget, Colors, Config, Execution, MAX_STROKES};
use strokefit::scene::{MAX_POINTS, MAX_PRECISION};
use strokefit::svg::WriteOptions;

use crate::failure::Failure;

/// More threads than any machine has cores only waste memory.
const MAX_THREADS: usize = 1024;

/// The options by their names.
pub(crate) struct Options<'a, 'py>(&'a Bound<'py, PyDict>);

impl<'a, 'py> Options<'a, 'py> {
    pub(crate) fn new(options: &'a Bound<'py, PyDict>) -> Self {
        Self(options)
    }

    /// What to fit.
    pub(crate) fn config(&self) -> PyResult<Config> {
        let standard = Config::default();
        Ok(Config {
            budget: self.budget()?,
            quality: self.get("quality")?,
            preset: self.word("preset")?.unwrap_or_default(),
            progressive: self.flag("progressive")?,
            look: self.word("look")?,
            opaque: self.flag("opaque")?,
            points: self.whole("points", 2..=MAX_POINTS)?,
            stages: self.whole("stages", 1..=MAX_STROKES)?,
            polish: self.get("polish")?.unwrap_or(standard.polish),
            colors: self.colors()?,
            pens: self.word("pens")?,
            file: self.file()?,
            background: self.word("background")?.unwrap_or_default(),
            seed: self.seed()?,
            ..standard
        })
    }

    /// How to run.
    pub(crate) fn execution(&self) -> PyResult<Execution> {
        Ok(Execution {
            threads: self.whole("threads", 1..=MAX_THREADS)?,
            ..Execution::default()
        })
    }

    fn budget(&self) -> PyResult<Budget> {
        let time = self.get("time")?.map(|seconds: f64| {
            let span = Duration::try_from_secs_f64(seconds).ok();
            span.filter(|span| !span.is_zero())
                .ok_or_else(|| refusal("time", seconds, "seconds above 0, such as 10 or 0.5"))
        });
        let psnr_db: Option<f64> = self.get("psnr")?;
        if let Some(db) = psnr_db.filter(|db| !(*db > 0.0 && *db <= 100.0)) {
            return Err(refusal(
                "psnr",
                db,
                "decibels from above 0 to 100, such as 32",
            ));
        }
        Ok(Budget {
            strokes: self.whole("strokes", 1..=MAX_STROKES)?,
            psnr_db,
            bytes: self.whole("bytes", 1..=usize::MAX)?,
            time: time.transpose()?,
        })
    }

    fn colors(&self) -> PyResult<Colors> {
        let most = self.whole("colors", 1..=Colors::MAX)?;
        let palette: Option<String> = self.get("palette")?;
        Ok(match (most, palette) {
            (None, None) => Colors::Free,
            (Some(most), None) => Colors::AtMost(most),
            (None, Some(text)) => Colors::palette(&text).map_err(Failure::Library)?,
            (Some(_), Some(_)) => {
                let message = "colors and palette exclude each other: give one of them";
                return Err(PyValueError::new_err(message));
            }
        })
    }

    fn file(&self) -> PyResult<WriteOptions> {
        let standard = WriteOptions::default();
        let precision = self.whole("precision", 0..=usize::from(MAX_PRECISION))?;
        Ok(WriteOptions {
            precision: precision.map_or(standard.precision, |digits| digits as u8),
            form: self.word("form")?.unwrap_or_default(),
            group: self.word("group")?.unwrap_or_default(),
            order: self.word("order")?.unwrap_or_default(),
            width: self.word("width")?,
        })
    }

    /// All 64 bits are seeds.
    fn seed(&self) -> PyResult<u64> {
        self.integer("seed", "a whole number from 0 to 18446744073709551615")
            .map(Option::unwrap_or_default)
    }

    fn flag(&self, name: &str) -> PyResult<bool> {
        self.get(name).map(Option::unwrap_or_default)
    }

    /// What the text of an option says.
    fn word<T: FromStr<Err = strokefit::Error>>(&self, name: &str) -> PyResult<Option<T>> {
        let text: Option<String> = self.get(name)?;
        let value = text.map(|text| text.parse::<T>().map_err(|error| error.within(name)));
        Ok(value.transpose().map_err(Failure::Library)?)
    }

    fn whole(&self, name: &str, range: RangeInclusive<usize>) -> PyResult<Option<usize>> {
        let right = match *range.end() {
            usize::MAX => format!("a whole number of {} or more", range.start()),
            end => format!("a whole number from {} to {end}", range.start()),
        };
        let value = self.integer(name, &right)?;
        match value.filter(|value| !range.contains(value)) {
            Some(value) => Err(refusal(name, value, &right)),
            None => Ok(value),
        }
    }

    /// A number that fits its type; `right` says which do.
    fn integer<T>(&self, name: &str, right: &str) -> PyResult<Option<T>>
    where
        T: for<'v> FromPyObject<'v, 'py, Error = PyErr>,
    {
        let Some(value) = self.item(name)? else {
            return Ok(None);
        };
        match value.extract() {
            Ok(number) => Ok(Some(number)),
            // A negative number, or one too large.
            Err(error) if !error.is_instance_of::<PyTypeError>(self.0.py()) => {
                Err(refusal(name, value, right))
            }
            Err(_) => Err(PyTypeError::new_err(format!(
                "{name}={}: give {right}",
                value.repr()?
            ))),
        }
    }

    fn get<T>(&self, name: &str) -> PyResult<Option<T>>
    where
        T: for<'v> FromPyObject<'v, 'py, Error = PyErr>,
    {
        let Some(value) = self.item(name)? else {
            return Ok(None);
        };
        value.extract().map(Some).map_err(|error: PyErr| {
            PyTypeError::new_err(format!("{name}: {}", error.value(self.0.py())))
        })
    }

    fn item(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(self.0.get_item(name)?.filter(|value| !value.is_none()))
    }
}

fn refusal(name: &str, value: impl std::fmt::Display, right: &str) -> PyErr {
    PyValueError::new_err(format!("{name}={value}: give {right}"))
}
