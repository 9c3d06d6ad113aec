//! What ends the program without a result: a sentence, what to do about it, and what the shell is told.

use std::error::Error;
use std::fmt;

use crate::advice::Advise;
use crate::{messages, serve};

/// What the program's functions give back.
pub type Result<T, E = Failure> = std::result::Result<T, E>;

/// What the shell is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// Whoever read the results has gone: no failure.
    ReaderGone = 0,
    /// A usage or scene error, or a picture that cannot be written.
    Usage = 2,
    /// No such device, or one that fails.
    Device = 3,
}

/// Why the program ends. Every error that has [advice](Advise) turns into one where it is passed on with `?`.
#[derive(Debug)]
pub struct Failure {
    text: String,
    advice: Option<String>,
    exit: Exit,
}

impl Failure {
    /// Of the options or of what they name.
    pub fn new(text: impl fmt::Display) -> Self {
        Self { text: text.to_string(), advice: None, exit: Exit::Usage }
    }

    /// What the shell is told.
    pub fn exit(&self) -> Exit {
        self.exit
    }

    /// The same, as the cause of something else.
    pub fn within(self, what: impl fmt::Display) -> Self {
        Self { text: joined(what.to_string(), &self.text), ..self }
    }

    /// The same with advice, where it has none of its own.
    pub fn advising(self, advice: impl fmt::Display) -> Self {
        Self { advice: self.advice.or_else(|| Some(advice.to_string())), ..self }
    }

    /// Says what went wrong and returns what the shell is told.
    pub fn tell(&self) -> u8 {
        if self.exit != Exit::ReaderGone {
            messages::line(&format!("error: {self}"));
        }
        self.exit as u8
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)?;
        self.advice.as_ref().map_or(Ok(()), |advice| write!(f, "; {advice}"))
    }
}

impl Error for Failure {}

impl<E: Advise> From<E> for Failure {
    fn from(error: E) -> Self {
        let causes = std::iter::successors(error.source(), |&cause| cause.source());
        let text = causes.fold(error.to_string(), |text, cause| joined(text, &cause.to_string()));
        Self { text, advice: error.advice(), exit: error.exit() }
    }
}

/// A sentence with its cause, unless it has quoted that already.
fn joined(text: String, cause: &str) -> String {
    if text.contains(cause) {
        return text;
    }
    format!("{text}: {cause}")
}

/// What was being done when something failed.
pub trait Context<T> {
    /// Puts words before the error's.
    ///
    /// # Errors
    /// That error.
    fn context(self, what: impl fmt::Display) -> Result<T>;

    /// The same with words that are made where they are needed.
    ///
    /// # Errors
    /// That error.
    fn with_context<D: fmt::Display>(self, what: impl FnOnce() -> D) -> Result<T>;
}

impl<T, E: Into<Failure>> Context<T> for std::result::Result<T, E> {
    fn context(self, what: impl fmt::Display) -> Result<T> {
        self.map_err(|error| error.into().within(what))
    }

    fn with_context<D: fmt::Display>(self, what: impl FnOnce() -> D) -> Result<T> {
        self.map_err(|error| error.into().within(what()))
    }
}

impl<T> Context<T> for Option<T> {
    fn context(self, what: impl fmt::Display) -> Result<T> {
        self.ok_or_else(|| Failure::new(what))
    }

    fn with_context<D: fmt::Display>(self, what: impl FnOnce() -> D) -> Result<T> {
        self.ok_or_else(|| Failure::new(what()))
    }
}

/// Ends a function with a usage error of these words.
#[doc(hidden)]
#[macro_export]
macro_rules! fail {
    ($($words:tt)+) => { return Err($crate::failure::Failure::new(format_args!($($words)+))) };
}

/// The same unless something holds.
#[doc(hidden)]
#[macro_export]
macro_rules! ensure {
    ($holds:expr, $($words:tt)+) => {{
        let holds: bool = $holds;
        if !holds {
            $crate::failure::fail!($($words)+)
        }
    }};
}

pub use {ensure, fail};

/// Says what is wrong with the options, or shows the help that they ask for.
pub fn of_options(error: &clap::Error) -> u8 {
    let Some(sentence) = serve::advise(error) else { error.exit() };
    Failure::new(sentence).tell()
}

#[cfg(test)]
mod tests {
    use std::io;

    use super::*;

    #[test]
    fn no_cause_is_said_twice() {
        let fire = || io::Error::other("disk on fire");
        let failure = Failure::from(fire()).within("cannot read a.obj: disk on fire").within("no scene");
        assert_eq!(failure.to_string(), "no scene: cannot read a.obj: disk on fire");
    }

    #[test]
    fn a_reader_that_has_gone_is_no_failure_whatever_was_being_done() {
        let gone: Result<()> = Err(io::Error::from(io::ErrorKind::BrokenPipe)).context("cannot write the results");
        assert_eq!(gone.map_err(|failure| failure.exit()), Err(Exit::ReaderGone));
    }
}
