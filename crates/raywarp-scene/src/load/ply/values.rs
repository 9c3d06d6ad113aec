//! The values of the body one after the other, from text or from bytes.

use ply_rs_bw::ply::ScalarType;

use super::super::quote::quote;
use super::super::Place;
use super::header::size_of_scalar;

/// Why a value could not be read.
pub(super) struct Fault {
    pub place: Place,
    pub read: String,
    pub expected: String,
}

/// A stream of numbers in rows.
pub(super) trait Values {
    /// Moves to the next row.
    fn start_row(&mut self) -> Result<(), Fault>;
    /// The next number of the row. All types of PLY fit into an `f64`.
    fn next(&mut self, kind: &ScalarType) -> Result<f64, Fault>;
    /// Leaves the row, with what is left of it.
    fn end_row(&mut self);
    /// Where the next value starts.
    fn place(&self) -> Place;
    /// The most values of a kind that can follow.
    fn room_for(&self, kind: &ScalarType) -> usize;
    /// The rows that were left with values in them, and the line of the first.
    fn surplus(&self) -> Surplus;
}

/// Rows with more values than the header declares.
#[derive(Clone, Copy, Default)]
pub(super) struct Surplus {
    pub rows: usize,
    pub first_line: usize,
}

/// Text, one row a line.
pub(super) struct Text<'a> {
    /// What follows the current line.
    rest: &'a [u8],
    row: &'a [u8],
    row_length: usize,
    line: usize,
    surplus: Surplus,
}

impl<'a> Text<'a> {
    /// Starts before the first line, which has the given number.
    pub fn new(body: &'a [u8], line: usize) -> Self {
        Self { rest: body, row: &[], row_length: 0, line: line - 1, surplus: Surplus::default() }
    }
}

impl Values for Text<'_> {
    fn start_row(&mut self) -> Result<(), Fault> {
        while !self.rest.is_empty() {
            let length = self.rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(self.rest.len());
            let (row, rest) = self.rest.split_at(length);
            self.rest = rest.strip_prefix(b"\r\n").unwrap_or(rest.get(1..).unwrap_or_default());
            self.line += 1;
            if !row.trim_ascii().is_empty() {
                (self.row, self.row_length) = (row, row.len());
                return Ok(());
            }
        }
        Err(Fault { place: Place::File, read: "the file ends".to_owned(), expected: "another line".to_owned() })
    }

    fn next(&mut self, _kind: &ScalarType) -> Result<f64, Fault> {
        let start = self.row.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(self.row.len());
        self.row = &self.row[start..];
        let place = self.place();
        let length = self.row.iter().position(u8::is_ascii_whitespace).unwrap_or(self.row.len());
        let (word, rest) = self.row.split_at(length);
        let expected = || "a number".to_owned();
        if word.is_empty() {
            return Err(Fault { place, read: "the line ends".to_owned(), expected: expected() });
        }
        self.row = rest;
        number(word).ok_or_else(|| Fault { place, read: quote(word), expected: expected() })
    }

    fn end_row(&mut self) {
        if self.row.trim_ascii().is_empty() {
            return;
        }
        if self.surplus.rows == 0 {
            self.surplus.first_line = self.line;
        }
        self.surplus.rows += 1;
    }

    fn place(&self) -> Place {
        Place::Line(self.line, self.row_length - self.row.len() + 1)
    }

    fn room_for(&self, _kind: &ScalarType) -> usize {
        self.row.len() / 2
    }

    fn surplus(&self) -> Surplus {
        self.surplus
    }
}

/// A decimal number; also the spellings of NaN and infinity of the C libraries, as NaN (`1.#QNAN`, `-nan(ind)`).
fn number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    let spelt_by_c = || text.contains('#') || text.starts_with("nan(") || text.starts_with("-nan(");
    text.parse().ok().or_else(|| spelt_by_c().then_some(f64::NAN))
}

/// Bytes, rows without gaps.
pub(super) struct Bytes<'a, const BIG_ENDIAN: bool> {
    file: &'a [u8],
    position: usize,
}

impl<'a, const BIG_ENDIAN: bool> Bytes<'a, BIG_ENDIAN> {
    /// Starts at an offset into the file.
    pub fn new(file: &'a [u8], position: usize) -> Self {
        Self { file, position }
    }

    #[inline(always)]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        match self.file.get(self.position..).and_then(|rest| rest.first_chunk::<N>()) {
            Some(bytes) => {
                self.position += N;
                let mut bytes = *bytes;
                if BIG_ENDIAN {
                    bytes.reverse();
                }
                Ok(bytes)
            }
            None => Err(self.ends(N)),
        }
    }

    #[cold]
    fn ends(&self, wanted: usize) -> Fault {
        Fault {
            place: self.place(),
            read: format!("the file ends after {} bytes", self.file.len()),
            expected: format!("{wanted} more bytes"),
        }
    }
}

impl<const BIG_ENDIAN: bool> Values for Bytes<'_, BIG_ENDIAN> {
    fn start_row(&mut self) -> Result<(), Fault> {
        Ok(())
    }

    #[inline(always)]
    fn next(&mut self, kind: &ScalarType) -> Result<f64, Fault> {
        Ok(match kind {
            ScalarType::Char => f64::from(i8::from_le_bytes(self.take()?)),
            ScalarType::UChar => f64::from(u8::from_le_bytes(self.take()?)),
            ScalarType::Short => f64::from(i16::from_le_bytes(self.take()?)),
            ScalarType::UShort => f64::from(u16::from_le_bytes(self.take()?)),
            ScalarType::Int => f64::from(i32::from_le_bytes(self.take()?)),
            ScalarType::UInt => f64::from(u32::from_le_bytes(self.take()?)),
            ScalarType::Float => f64::from(f32::from_le_bytes(self.take()?)),
            ScalarType::Double => f64::from_le_bytes(self.take()?),
        })
    }

    fn end_row(&mut self) {}

    fn place(&self) -> Place {
        Place::Byte(self.position as u64)
    }

    fn room_for(&self, kind: &ScalarType) -> usize {
        (self.file.len() - self.position) / size_of_scalar(kind)
    }

    fn surplus(&self) -> Surplus {
        Surplus::default()
    }
}
