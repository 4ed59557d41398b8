//! Options of a fit, from a dictionary of Python's. `None` is an option's default.

use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use strokefit::fit::{Options, Refusal, Value};

use crate::failure::Failure;

/// Reads the options that the dictionary gives.
pub(crate) fn read(given: &Bound<'_, PyDict>) -> PyResult<Options> {
    let mut options = Options::default();
    for (name, object) in given.iter().filter(|(_, object)| !object.is_none()) {
        let name: String = name.extract()?;
        let text = object.cast::<PyString>().ok();
        let text = text.map(|text| text.to_cow()).transpose()?;
        let value = text.as_deref().map_or_else(|| number(&object), Value::Text);
        if let Err(refusal) = options.set(&name, value) {
            return Err(refused(refusal, &name, value, &object)?);
        }
    }
    Ok(options)
}

/// The value of what is no text.
fn number(object: &Bound<'_, PyAny>) -> Value<'static> {
    if let Ok(on) = object.extract() {
        return Value::Switch(on);
    }
    match object.extract() {
        Ok(whole) => Value::Whole(whole),
        // It has more than 127 bits.
        Err(error) if PyErr::is_instance_of::<PyOverflowError>(&error, object.py()) => {
            Value::Whole(i128::MAX)
        }
        Err(_) => object.extract().map_or(Value::Other, Value::Number),
    }
}

/// The exception of a value of the wrong kind, or of the right kind and out of range.
fn refused(
    refusal: Refusal,
    name: &str,
    value: Value<'_>,
    object: &Bound<'_, PyAny>,
) -> PyResult<PyErr> {
    let is_kind = matches!(refusal, Refusal::Kind(_));
    let shown = match value {
        Value::Number(number) if !is_kind => number.to_string(),
        _ => object.repr()?.to_string(),
    };
    let error = refusal.of(name, format_args!("{name}={shown}"));
    Ok(match is_kind {
        true => PyTypeError::new_err(error.to_string()),
        false => Failure::Library(error).into(),
    })
}
