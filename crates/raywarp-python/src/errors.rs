//! Errors of the libraries as exceptions of Python: the same sentences, by the class that Python has for their kind.

use std::io;

use pyo3::exceptions::{
    PyFileNotFoundError, PyMemoryError, PyOSError, PyPermissionError, PyRuntimeError, PyValueError,
};
use pyo3::PyErr;
use raywarp::device::DeviceError as Failure;
use raywarp::query::QueryError;
use raywarp::scene::LoadError;

pyo3::create_exception!(
    raywarp,
    DeviceError,
    PyRuntimeError,
    "A device that is not there, or that failed. The text says which and why."
);

/// Of a device.
pub fn of_device(error: &Failure) -> PyErr {
    let text = error.to_string();
    match error {
        Failure::Memory { .. } => PyMemoryError::new_err(text),
        Failure::TooMany { .. } | Failure::Range { .. } => PyValueError::new_err(text),
        _ => DeviceError::new_err(text),
    }
}

/// Of a query, or of the structure that it needs.
pub fn of_query(error: &QueryError) -> PyErr {
    match error {
        QueryError::Device(error) => of_device(error),
        other => PyValueError::new_err(other.to_string()),
    }
}

/// Of a scene's files.
pub fn of_load(error: &LoadError) -> PyErr {
    let text = error.to_string();
    match innermost(error) {
        LoadError::Io { source, .. } => match source.kind() {
            io::ErrorKind::NotFound => PyFileNotFoundError::new_err(text),
            io::ErrorKind::PermissionDenied => PyPermissionError::new_err(text),
            _ => PyOSError::new_err(text),
        },
        LoadError::Memory { .. } => PyMemoryError::new_err(text),
        _ => PyValueError::new_err(text),
    }
}

/// What is wrong with the file that others name.
fn innermost(error: &LoadError) -> &LoadError {
    match error {
        LoadError::Named { error, .. } => innermost(error),
        error => error,
    }
}
