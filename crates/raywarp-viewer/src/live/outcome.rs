//! What a front end has to do for its user.

use super::Export;

/// Something that only the front end can do.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Make a file and keep it: a window writes it beside where it was started and never over another, a browser
    /// downloads it.
    File(Export),
    /// Put a text on the clipboard.
    Copy(String),
    /// Leave.
    Quit,
}
