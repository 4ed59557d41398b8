//! Pictures as Python hands them over: a path, the bytes of a file, or an array.

use std::path::PathBuf;

use numpy::{Element, PyArray3, PyArrayMethods, PyReadonlyArray3};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use strokefit::image::{Image, Limits, Remark, Rows, Sample};
use strokefit::{Error, ErrorKind};

use crate::failure::{Failure, expect_memory};

/// A picture, which is read if it is not an array.
pub(crate) enum Picture {
    Path(PathBuf),
    Bytes(PyBackedBytes),
    /// Taken from an array while Python's lock kept others from writing to it.
    Image(Image),
}

impl Picture {
    /// From `str`, `bytes`, or an array of height × width × channels.
    pub(crate) fn of(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(bytes) = object.extract() {
            return Ok(Self::Bytes(bytes));
        }
        if let Ok(path) = object.extract() {
            return Ok(Self::Path(path));
        }
        let image = array::<u8>(object)
            .or_else(|| array::<u16>(object))
            .or_else(|| array::<f32>(object))
            .or_else(|| borrowed(object).map(|view| strided(&view?, |v: f64| v as f32)));
        match image {
            Some(image) => Ok(Self::Image(image?)),
            None => Err(PyTypeError::new_err(
                "not an array of height × width × channels, of uint8, uint16, float32 or float64",
            )),
        }
    }

    /// The path; empty if there is none.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Path(path) => path.display().to_string(),
            Self::Bytes(_) | Self::Image(_) => String::new(),
        }
    }

    /// Reads it, and says what was changed or left out.
    pub(crate) fn read(self) -> Result<(Image, Vec<Remark>), Failure> {
        let limits = Limits::default();
        Ok(match self {
            Self::Path(path) => Image::read_within(path, limits)?,
            Self::Bytes(bytes) => Image::decode_remarking(&bytes, "the picture", limits)?,
            Self::Image(image) => (image, Vec::new()),
        })
    }
}

/// The picture that an array of `T` holds; `None` for other objects. Its samples are read where they lie.
fn array<T: Sample + Element>(object: &Bound<'_, PyAny>) -> Option<Result<Image, Failure>> {
    let view = match borrowed(object)? {
        Ok(view) => view,
        Err(failure) => return Some(Err(failure)),
    };
    let [height, width, channels] = shape(&view);
    // In the order of the axes: NumPy also calls columns contiguous that lie one after the other.
    let image = match view.as_array().as_slice() {
        Some(samples) => Image::from_rows(Rows::packed(width, height, channels, samples)),
        None => return Some(strided(&view, |sample: T| sample)),
    };
    Some(image.map_err(Failure::Library))
}

/// The picture that an array with any strides holds.
fn strided<T: Element + Copy, S: Sample>(
    array: &PyReadonlyArray3<'_, T>,
    sample: impl Fn(T) -> S,
) -> Result<Image, Failure> {
    let [height, width, channels] = shape(array);
    let view = array.as_array();
    Ok(Image::from_fn(width, height, channels, |x, y, c| {
        sample(view[[y, x, c]])
    })?)
}

/// The array of `T` that an object is, once there is memory for its planes; `None` for other objects.
fn borrowed<'py, T: Element>(
    object: &Bound<'py, PyAny>,
) -> Option<Result<PyReadonlyArray3<'py, T>, Failure>> {
    /// Three planes of `f32` and alpha, bytes per pixel.
    const PLANES: usize = 16;
    let array = object.cast::<PyArray3<T>>().ok()?;
    let Ok(view) = array.try_readonly() else {
        let message = "the array is being written to: wait until that is done";
        return Some(Err(Error::new(ErrorKind::Picture, message).into()));
    };
    let [height, width, _] = shape(&view);
    let bytes = PLANES.saturating_mul(width).saturating_mul(height);
    Some(expect_memory(bytes as u64, width, height).map(|()| view))
}

fn shape<T: Element>(array: &PyReadonlyArray3<'_, T>) -> [usize; 3] {
    let (height, width, channels) = array.as_array().dim();
    [height, width, channels]
}
