//! Rays as text: a line a ray, numbers with commas.

use std::io::{BufRead, Read};

use super::error::{At, Trouble};
use crate::scene::load::quote::quote;
use crate::{Ray, Vec3};

/// Longest line, in bytes: eight numbers with every digit they could have.
const MAX_LINE: u64 = 1 << 16;

/// Reads lines of 6 numbers (origin, direction) or 8 (origin, t_min, direction, t_max), between commas, semicolons or
/// spaces.
///
/// A first line without any number is a head. Empty lines, and lines that begin with `#`, are skipped.
pub struct Lines<R> {
    input: R,
    line: u64,
    text: Vec<u8>,
    /// Of every ray, once there was one.
    columns: Option<usize>,
    /// Whether a line was read that is not skipped.
    begun: bool,
}

impl<R: BufRead> Lines<R> {
    pub fn new(input: R) -> Self {
        Self { input, line: 0, text: Vec::new(), columns: None, begun: false }
    }

    /// Adds at most so many rays.
    pub fn read(&mut self, most: usize, rays: &mut Vec<Ray>) -> Result<(), Trouble> {
        let end = rays.len() + most;
        while rays.len() < end && self.next_line()? {
            rays.extend(self.ray()?);
        }
        Ok(())
    }

    /// Whether there is another line; it is in `text` then.
    fn next_line(&mut self) -> Result<bool, Trouble> {
        self.text.clear();
        self.line += 1;
        self.input.by_ref().take(MAX_LINE).read_until(b'\n', &mut self.text)?;
        if self.text.len() as u64 == MAX_LINE {
            let what = format!("more than {MAX_LINE} bytes in a line; expected 6 or 8 numbers");
            return Err(Trouble::flaw(At::Line(self.line), what));
        }
        Ok(!self.text.is_empty())
    }

    /// The ray of a line; none for a line to skip.
    fn ray(&mut self) -> Result<Option<Ray>, Trouble> {
        let text = without_mark(&self.text).trim_ascii();
        if text.is_empty() || text.starts_with(b"#") {
            return Ok(None);
        }
        let is_first = !std::mem::replace(&mut self.begun, true);
        if is_first && fields(text).all(|field| parse(field).is_none()) {
            return Ok(None);
        }
        let mut numbers = [0.0; 8];
        let mut columns = 0;
        for field in fields(text) {
            columns += 1;
            let Some(number) = parse(field) else {
                let what = format!("{} is no number", quote(field.trim_ascii()));
                return Err(Trouble::flaw(At::Column(self.line, columns), what));
            };
            if let Some(place) = numbers.get_mut(columns - 1) {
                *place = number;
            }
        }
        let expected = *self.columns.get_or_insert(columns);
        let flaw = |what: String| Err(Trouble::flaw(At::Line(self.line), what));
        match (columns == expected, columns) {
            (false, _) => flaw(format!("{columns} numbers; expected {expected}, as in the lines before")),
            (true, 6 | 8) => Ok(Some(ray(&numbers[..columns]))),
            _ => flaw(format!(
                "{columns} numbers; expected 6 (origin, direction) or 8 (origin, t_min, direction, t_max)"
            )),
        }
    }
}

/// The text after the byte order mark that spreadsheets write.
fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)
}

/// Between commas, or semicolons where there are none, or else spaces.
fn fields(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let separator = [b',', b';'].into_iter().find(|separator| text.contains(separator));
    let is_separator = move |byte: &u8| separator.map_or(byte.is_ascii_whitespace(), |separator| *byte == separator);
    // A run of spaces is one.
    text.split(is_separator).filter(move |field| separator.is_some() || !field.is_empty())
}

fn parse(field: &[u8]) -> Option<f32> {
    std::str::from_utf8(field).ok()?.trim().parse().ok()
}

/// From 6 or 8 numbers.
pub fn ray(numbers: &[f32]) -> Ray {
    match *numbers {
        [x, y, z, dx, dy, dz] => Ray::new(Vec3::new(x, y, z), Vec3::new(dx, dy, dz)),
        [x, y, z, t_min, dx, dy, dz, t_max] => {
            Ray { origin: Vec3::new(x, y, z), t_min, direction: Vec3::new(dx, dy, dz), t_max }
        }
        // Callers count. No numbers are no ray.
        _ => Ray::new(Vec3::ZERO, Vec3::ZERO),
    }
}
