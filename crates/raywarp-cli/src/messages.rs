//! Words for people go to standard error, results to standard output.

use std::io::{self, Write};
use std::path::Path;

use raywarp::accel::Dropped;
use raywarp::device::Device;
use raywarp::scene::load::quote;
use raywarp::write;
use serde::Serialize;

use crate::failure::{Context, Failure, Result};

/// A line, or several, on standard error. Where nobody can read it, nothing is lost. Names come from files: what a terminal
/// would obey is taken out.
pub fn line(lines: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", printable(lines));
}

/// Lines without anything else that a terminal would obey.
fn printable(lines: &str) -> String {
    lines.split('\n').map(quote::printable).collect::<Vec<_>>().join("\n")
}

/// A path for a terminal, whatever bytes are in it.
pub fn path(path: &Path) -> String {
    text(&path.to_string_lossy())
}

/// An output for people.
pub fn output_name(path: &Path) -> String {
    text(&write::name(path, "standard output"))
}

/// Text of a file for a terminal, on one line.
pub fn text(text: &str) -> String {
    quote::printable(text).into_owned()
}

/// What is worth knowing of a scene's files, a line each.
pub fn notes<T: std::fmt::Display>(notes: &[T]) {
    notes.iter().for_each(|note| line(&format!("note: {note}")));
}

/// Most warnings that are shown one by one.
const SHOWN_WARNINGS: usize = 20;

/// Warnings, a line each, and how many more there are.
pub fn warnings<T: std::fmt::Display>(warnings: &[T]) {
    for warning in warnings.iter().take(SHOWN_WARNINGS) {
        line(&format!("warning: {warning}"));
    }
    if warnings.len() > SHOWN_WARNINGS {
        line(&format!("warning: and {} more of {}", warnings.len() - SHOWN_WARNINGS, warnings.len()));
    }
}

/// A warning for each reason why triangles are left out.
pub fn dropped(dropped: &Dropped) {
    if dropped.without_area > 0 {
        line(&format!("warning: triangles without area, {} of them, are dropped", dropped.without_area));
    }
    if dropped.not_finite > 0 {
        line(&format!("warning: triangles that are not finite, {} of them, are dropped", dropped.not_finite));
    }
}

/// Why a CPU stands in for a GPU, if it does.
pub fn fallback(device: &Device) {
    if let Some(reason) = device.fallback() {
        line(&format!("note: tracing on the CPU: {}", Failure::from(reason.clone())));
    }
}

/// Text on standard output.
///
/// # Errors
/// Where it cannot be written; a reader that has gone is told apart by [`Exit`](crate::failure::Exit).
pub fn out(bytes: &[u8]) -> io::Result<()> {
    let mut output = io::stdout().lock();
    output.write_all(bytes)?;
    output.flush()
}

/// Results on standard output: an object in JSON, or lines for people.
///
/// # Errors
/// As [`out`].
pub fn results<T: Serialize>(results: &T, json: bool, lines: impl FnOnce() -> String) -> Result<()> {
    let text = if json { escaped(&serde_json::to_string_pretty(results)?) + "\n" } else { printable(&lines()) };
    out(text.as_bytes()).context("cannot write the results")
}

/// JSON whose strings hold no orders to a terminal either.
fn escaped(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for c in json.chars() {
        match quote::garbles(c) && c != '\n' {
            true => text.push_str(&format!("\\u{:04x}", u32::from(c))),
            false => text.push(c),
        }
    }
    text
}

/// So many of something, one of which is a `thing`.
pub fn count(number: u32, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// Bytes for people.
pub fn bytes(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
    let mut size = bytes as f64 / 1024.0;
    let mut unit = 0;
    while size >= 1024.0 && unit + 1 < UNITS.len() {
        size /= 1024.0;
        unit += 1;
    }
    if bytes < 1024 {
        format!("{bytes} bytes")
    } else {
        format!("{size:.1} {}", UNITS[unit])
    }
}

/// A duration for people.
pub fn seconds(seconds: f64) -> String {
    if seconds < 1.0 {
        format!("{:.1} ms", 1e3 * seconds)
    } else {
        format!("{seconds:.2} s")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_file_gives_orders_to_the_terminal() {
        let name = "a\u{1b}[2Jb\u{9b}c\u{202e}d\u{7}";
        assert_eq!(text(name), "a\u{fffd}[2Jb\u{fffd}c\u{fffd}d\u{fffd}");
        assert_eq!(printable("first\nsecond\r"), "first\nsecond\u{fffd}");
        let json = escaped(&serde_json::to_string_pretty(&[name]).unwrap());
        assert!(json.chars().all(|c| c == '\n' || !quote::garbles(c)), "{json:?}");
        assert_eq!(serde_json::from_str::<Vec<String>>(&json).unwrap(), [name]);
    }
}
