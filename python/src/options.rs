//! Options of a fit, from a dictionary of Python's. `None` is an option's default.

use std::error::Error;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Map, Number, Value};
use strokefit::fit::Options;

/// Reads the options that the dictionary gives.
pub(crate) fn read(given: &Bound<'_, PyDict>) -> PyResult<Options> {
    let mut options = Map::new();
    for (name, object) in given.iter().filter(|(_, object)| !object.is_none()) {
        let name: String = name.extract()?;
        let value = value(&name, &object)?;
        options.insert(name, value);
    }
    Options::from_json(options).map_err(|error| {
        let is_type = |cause: &dyn Error| cause.to_string().starts_with("invalid type");
        match error.source().is_some_and(is_type) {
            true => PyTypeError::new_err(error.to_string()),
            false => PyValueError::new_err(error.to_string()),
        }
    })
}

fn value(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(on) = object.extract::<bool>() {
        return Ok(on.into());
    }
    if let Ok(text) = object.extract::<String>() {
        return Ok(text.into());
    }
    if let Ok(whole) = object.extract::<i128>() {
        let number = Number::from_i128(whole).map(Value::Number);
        let large = || PyValueError::new_err(format!("{name} is {whole}: give a smaller number"));
        return number.ok_or_else(large);
    }
    let number = object.extract::<f64>().map_err(|_| {
        let message = format!("{name} is {object}: give a number, a text, True or False");
        PyTypeError::new_err(message)
    })?;
    let finite = Number::from_f64(number).map(Value::Number);
    finite.ok_or_else(|| PyValueError::new_err(format!("{name} is {number}: give a finite number")))
}
