//! What a front end has to do for its user.

/// Something that only the front end can do.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Keep a file under this name: a window writes it beside where it was started and never over another, a browser
    /// downloads it.
    File {
        /// Suggested name, without folders.
        name: String,
        /// Its content.
        content: Vec<u8>,
        /// For the browser: "image/png", "text/plain".
        media_type: &'static str,
    },
    /// Put a text on the clipboard.
    Copy(String),
    /// Leave.
    Quit,
}
