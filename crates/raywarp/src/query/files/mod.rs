//! Rays and answers in files, for NumPy and for spreadsheets.
//!
//! [`RayReader`] reads rays piece by piece from `.npy` and CSV, [`AnswerWriter`] collects answers and writes them as
//! `.npz`, `.npy` or CSV. Neither holds a whole batch in memory, but for an array in Fortran order.

mod answers;
mod csv;
mod error;
mod fortran;
mod kinds;
mod npy;
mod reader;

pub use answers::{AnswerWriter, Answers};
pub use error::{At, RayFileError};
pub use kinds::{Format, Mode, UnknownFormat, UnknownMode};
pub use reader::RayReader;

#[cfg(test)]
mod tests;
