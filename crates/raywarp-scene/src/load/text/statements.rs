//! Lines into statements and statements into fields, without copying; every field knows its line and column.

use std::path::Path;

use crate::load::quote::quote;
use crate::load::{LoadError, Place};

/// The statements of a file, in order. Comments and empty lines are left out; a backslash at the end of a line joins
/// the next one. Lines end with LF, CR LF or CR. The text ends where nothing but padding follows (see [`unpadded`]).
pub(crate) struct Statements<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Statements<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { bytes: unpadded(bytes), at, line: 1 }
    }

    /// Moves behind the end of the line and returns where it ends.
    fn pass_line(&mut self) -> usize {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r').unwrap_or(rest.len());
        let end = self.at + length;
        let terminator = if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
        self.at = (end + terminator).min(self.bytes.len());
        self.line += 1;
        end
    }

    fn pass_statement(&mut self) -> usize {
        loop {
            let end = self.pass_line();
            if !self.bytes[..end].ends_with(b"\\") || self.at == self.bytes.len() {
                return end;
            }
        }
    }
}

/// A text without what DOS and CP/M leave behind it: a line that begins with Ctrl-Z ends it, and so do Ctrl-Z and NULs
/// behind which is nothing else. A file of nothing but these stays as it is, for it is no text at all.
pub(crate) fn unpadded(bytes: &[u8]) -> &[u8] {
    let ends = |&(at, &byte): &(usize, &u8)| byte == END_OF_TEXT && (at == 0 || matches!(bytes[at - 1], b'\n' | b'\r'));
    let end = bytes.iter().enumerate().find(ends).map_or(bytes.len(), |(at, _)| at);
    let is_padding = |byte: &&u8| matches!(**byte, 0 | END_OF_TEXT | b'\n' | b'\r' | b' ');
    let padding = bytes[..end].iter().rev().take_while(is_padding).count();
    match bytes[end - padding..end].iter().any(|&byte| matches!(byte, 0 | END_OF_TEXT)) {
        true if end > padding => &bytes[..end - padding],
        true => bytes,
        false => &bytes[..end],
    }
}

/// Ctrl-Z.
const END_OF_TEXT: u8 = 0x1a;

impl<'a> Iterator for Statements<'a> {
    type Item = Statement<'a>;

    fn next(&mut self) -> Option<Statement<'a>> {
        while self.at < self.bytes.len() {
            let (start, line) = (self.at, self.line);
            let first = self.bytes[start..].iter().position(|&byte| byte != b' ' && byte != b'\t');
            // A comment may end with a backslash, as in a Windows path, without swallowing the next line.
            if first.is_some_and(|first| self.bytes[start + first] == b'#') {
                self.pass_line();
                continue;
            }
            let end = self.pass_statement();
            let statement = Statement::new(&self.bytes[start..end], line);
            if !statement.keyword.is_empty() {
                return Some(statement);
            }
        }
        None
    }
}

/// A keyword and what follows.
#[derive(Clone, Copy)]
pub(crate) struct Statement<'a> {
    /// Line of its first byte, from 1.
    pub line: usize,
    /// First field.
    pub keyword: &'a [u8],
    bytes: &'a [u8],
    /// Where in `bytes` the keyword ends.
    after_keyword: usize,
}

impl<'a> Statement<'a> {
    fn new(bytes: &'a [u8], line: usize) -> Self {
        let mut fields = Fields { bytes, at: 0 };
        let keyword = fields.next().map_or(&b""[..], |field| field.bytes);
        Self { line, keyword, bytes, after_keyword: fields.at }
    }

    /// The keyword with its place.
    pub fn first(&self) -> Field<'a> {
        Field { bytes: self.keyword, offset: self.after_keyword - self.keyword.len() }
    }

    /// What follows the keyword, up to a comment.
    #[inline]
    pub fn fields(&self) -> Fields<'a> {
        Fields { bytes: self.bytes, at: self.after_keyword }
    }

    /// All that follows the keyword as one text: names may hold blanks and `#`.
    pub fn text(&self) -> String {
        self.text_from(self.after_keyword, self.bytes.len())
    }

    /// The text between two offsets, without the blanks at its ends.
    pub fn text_from(&self, start: usize, end: usize) -> String {
        let text = String::from_utf8_lossy(&self.bytes[start..end]);
        text.replace("\\\r\n", " ").replace("\\\n", " ").replace("\\\r", " ").trim().to_owned()
    }

    /// Where its last line ends.
    pub fn end(&self) -> usize {
        self.bytes.len()
    }

    /// Where a byte of the statement lies in the file.
    pub fn place(&self, offset: usize) -> Place {
        let (mut line, mut start) = (self.line, 0);
        for (index, &byte) in self.bytes[..offset].iter().enumerate() {
            let line_feed_follows = self.bytes.get(index + 1) == Some(&b'\n');
            if byte == b'\n' || (byte == b'\r' && !line_feed_follows) {
                line += 1;
                start = index + 1;
            }
        }
        let is_first_of_character = |byte: &&u8| **byte & 0xc0 != 0x80;
        Place::Line(line, 1 + self.bytes[start..offset].iter().filter(is_first_of_character).count())
    }

    /// An error at a field, or at the end of the statement where something is missing.
    pub fn error(&self, path: &Path, at: Option<Field>, read: String, expected: &str, help: &str) -> LoadError {
        let end = self.bytes.trim_ascii_end().len();
        LoadError::Syntax {
            path: path.to_owned(),
            place: self.place(at.map_or(end, |field| field.offset)),
            read,
            expected: expected.to_owned(),
            help: help.to_owned(),
        }
    }

    /// The statement in quotes.
    pub fn quoted(&self) -> String {
        quote(self.bytes.trim_ascii())
    }
}

/// A word between blanks.
#[derive(Clone, Copy)]
pub(crate) struct Field<'a> {
    pub bytes: &'a [u8],
    /// Where it starts in its statement.
    pub offset: usize,
}

impl Field<'_> {
    pub fn end(&self) -> usize {
        self.offset + self.bytes.len()
    }

    pub fn quoted(&self) -> String {
        quote(self.bytes)
    }
}

/// The fields of a statement, up to a comment.
#[derive(Clone)]
pub(crate) struct Fields<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Fields<'_> {
    /// The blank at an offset: white space, or a backslash that joins two lines.
    #[inline]
    fn is_blank(&self, at: usize) -> bool {
        match self.bytes[at] {
            b' ' | b'\t'..=b'\r' => true,
            b'\\' => matches!(self.bytes.get(at + 1), None | Some(b'\n' | b'\r')),
            _ => false,
        }
    }
}

impl<'a> Iterator for Fields<'a> {
    type Item = Field<'a>;

    #[inline]
    fn next(&mut self) -> Option<Field<'a>> {
        let length = self.bytes.len();
        let mut start = self.at;
        while start < length && self.is_blank(start) {
            start += 1;
        }
        let mut end = start;
        while end < length && !self.is_blank(end) {
            end += 1;
        }
        self.at = end;
        let bytes = &self.bytes[start..end];
        // The rest of a line after a blank and a hash is a comment.
        if bytes.starts_with(b"#") {
            self.at = length;
            return None;
        }
        (!bytes.is_empty()).then_some(Field { bytes, offset: start })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<(usize, Vec<String>)> {
        let words = |statement: Statement| {
            let keyword = String::from_utf8_lossy(statement.keyword).into_owned();
            let fields = statement.fields().map(|field| String::from_utf8_lossy(field.bytes).into_owned());
            (statement.line, std::iter::once(keyword).chain(fields).collect())
        };
        Statements::new(text.as_bytes()).map(words).collect()
    }

    fn words(line: usize, text: &str) -> (usize, Vec<String>) {
        (line, text.split(' ').map(str::to_owned).collect())
    }

    #[test]
    fn lines_end_in_three_ways() {
        for text in ["v 1\n\nf 2", "v 1\r\n\r\nf 2\r\n", "v 1\r\rf 2\r"] {
            assert_eq!(read(text), [words(1, "v 1"), words(3, "f 2")], "{text:?}");
        }
    }

    #[test]
    fn comments_are_left_out() {
        assert_eq!(read("# C:\\a\\\n  # b\nv 1 # c\nusemtl a#b"), [words(3, "v 1"), words(4, "usemtl a#b")]);
    }

    #[test]
    fn a_byte_order_mark_is_left_out() {
        assert_eq!(read("\u{feff}v 1"), [words(1, "v 1")]);
    }

    #[test]
    fn the_text_ends_at_ctrl_z_and_at_nuls_behind_which_is_nothing() {
        for end in ["\u{1a}", "\u{1a}\u{1a}\r\n", "\0\0\0", "\0\u{1a}\0\n"] {
            assert_eq!(read(&format!("v 1\n{end}")), [words(1, "v 1")], "{end:?}");
            assert_eq!(read(&format!("v 1{end}")), [words(1, "v 1")], "{end:?}");
        }
        assert_eq!(read("v 1\n\u{1a}v 2\nv 3"), [words(1, "v 1")]);
        assert_eq!(read("v\0 \u{1a}1\nv"), [words(1, "v\0 \u{1a}1"), words(2, "v")]);
        assert_eq!(unpadded(b"\0\0"), b"\0\0");
    }

    #[test]
    fn a_backslash_joins_lines() {
        for text in ["f 1\\\n 2 \\\n3\nv 4", "f 1\\\r\n2\\\r\n3\r\nv 4"] {
            assert_eq!(read(text), [words(1, "f 1 2 3"), words(4, "v 4")], "{text:?}");
        }
        assert_eq!(read("f 1 \\"), [words(1, "f 1")]);
        assert_eq!(read("\\\n\\\nv 1"), [words(1, "v 1")]);
    }

    #[test]
    fn places_count_joined_lines_and_characters() {
        let text = "v 1\nfü 10 \\\r\n 20 \\\n  30";
        let statement = Statements::new(text.as_bytes()).nth(1).unwrap();
        let places: Vec<_> = statement.fields().map(|field| statement.place(field.offset)).collect();
        assert_eq!(places, [Place::Line(2, 4), Place::Line(3, 2), Place::Line(4, 3)]);
    }

    #[test]
    fn texts_keep_blanks_and_hashes_inside() {
        let text = |text: &str| Statements::new(text.as_bytes()).next().unwrap().text();
        assert_eq!(text("g  a  b #1 \r\n"), "a  b #1");
        assert_eq!(text("g a\\\r\nb\\\nc"), "a b c");
        assert_eq!(text("g C:\\a\\b\\"), "C:\\a\\b\\");
        assert_eq!(text("g"), "");
    }
}
