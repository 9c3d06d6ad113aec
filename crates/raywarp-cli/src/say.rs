//! Words for people go to standard error, results to standard output.

use std::io::{self, Write};

use raywarp::accel::Dropped;
use raywarp::backend::Device;
use raywarp::scene::load::quote;

/// Lines on standard error. Where nobody can read them, nothing is lost.
pub fn line(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", printable(text));
}

/// Lines without anything else that a terminal would obey: names come from files.
pub fn printable(text: &str) -> String {
    text.split('\n').map(quote::printable).collect::<Vec<_>>().join("\n")
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
        line(&format!("note: tracing on the CPU: {reason}"));
    }
}

/// Text on standard output.
///
/// # Errors
/// Where it cannot be written; a reader that has gone is told apart by [`exit_code`](crate::failure::exit_code).
pub fn out(bytes: &[u8]) -> io::Result<()> {
    let mut output = io::stdout().lock();
    output.write_all(bytes)?;
    output.flush()
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
