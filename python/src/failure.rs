//! Why there is no result, and the exception that says so.

use std::error::Error as _;
use std::io;

use pyo3::PyErr;
use pyo3::exceptions::{
    PyFileNotFoundError, PyIsADirectoryError, PyMemoryError, PyOSError, PyPermissionError,
    PyRuntimeError, PyValueError,
};
use strokefit::{Error, ErrorKind};

/// Why there is no result.
pub(crate) enum Failure {
    /// The library says why.
    Library(Error),
    /// There is not as much memory as is needed.
    Memory(String),
    /// A panic, with its message.
    Panic(String),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Library(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Library(error) => exception(&error),
            Failure::Memory(message) => PyMemoryError::new_err(message),
            Failure::Panic(message) => PyRuntimeError::new_err(format!(
                "strokefit has a fault: {message}: please report it"
            )),
        }
    }
}

fn exception(error: &Error) -> PyErr {
    let message = error.to_string();
    match error.kind() {
        ErrorKind::Config | ErrorKind::Picture | ErrorKind::Svg => PyValueError::new_err(message),
        ErrorKind::Io => {
            let cause = error.source().and_then(|cause| cause.downcast_ref());
            match cause.map(io::Error::kind) {
                Some(io::ErrorKind::NotFound) => PyFileNotFoundError::new_err(message),
                Some(io::ErrorKind::PermissionDenied) => PyPermissionError::new_err(message),
                Some(io::ErrorKind::IsADirectory) => PyIsADirectoryError::new_err(message),
                _ => PyOSError::new_err(message),
            }
        }
        _ => PyRuntimeError::new_err(message),
    }
}

/// Fails where the system does not give `bytes` of memory for a picture of `width × height` px. Without this, Rust
/// would end the process when the memory is used up.
pub(crate) fn expect_memory(bytes: u64, width: usize, height: usize) -> Result<(), Failure> {
    let count = usize::try_from(bytes).unwrap_or(usize::MAX);
    Vec::<u8>::new().try_reserve_exact(count).map_err(|_| {
        Failure::Memory(format!(
            "a drawing of {width}×{height} px takes about {} MiB of memory, more than there is: scale the picture down",
            bytes >> 20
        ))
    })
}
