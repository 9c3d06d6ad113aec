//! The command line program.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Does what the words of a command line ask, the first of which is the program's name; returns what the shell is told.
#[pyfunction]
pub fn run(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| raywarp_cli::run(words))
}
