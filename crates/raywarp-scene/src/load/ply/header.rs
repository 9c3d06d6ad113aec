//! The header: what the body holds, checked against the size of the file before any of it is read.

use std::collections::HashSet;
use std::path::Path;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, Encoding, PropertyType, ScalarType};

use super::super::quote::quote;
use super::super::{LoadError, Place};

/// What the body holds and where it starts.
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Byte offset of the body.
    pub body: usize,
    /// Line number of the first line of the body, from 1.
    pub body_line: usize,
    /// Pictures that comments name, as MeshLab writes them: `comment TextureFile NAME`.
    pub texture_files: Vec<TextureFile>,
    /// Names of properties that an element has before: the first holds.
    pub repeated: Vec<String>,
    pub foreign: Option<Foreign>,
}

/// Lines of the header that are no statements: how many, and the first.
pub(super) struct Foreign {
    pub count: usize,
    pub line: usize,
    pub text: String,
}

/// A picture that a comment names.
pub(super) struct TextureFile {
    pub line: usize,
    pub name: String,
}

/// A table of the body.
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

/// A column of a table.
pub(super) struct Property {
    pub name: String,
    pub kind: PropertyType,
}

impl Header {
    /// Reads the header at the start of a file.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, LoadError> {
        let (text, body) = split(path, bytes)?;
        let texture_files = texture_files(&text);
        let (text, foreign) = without_foreign_lines(&text);
        let (text, repeated) = with_unlike_names(&text);
        let parsed = Parser::<DefaultElement>::new()
            .read_header(&mut Reader::new(text.as_bytes()))
            .map_err(|error| refused(path, &text, &error))?;
        let elements: Vec<Element> = parsed
            .elements
            .into_values()
            .map(|element| Element {
                name: element.name,
                count: element.count,
                properties: element
                    .properties
                    .into_values()
                    .map(|property| Property { name: property.name, kind: property.data_type })
                    .collect(),
            })
            .collect();
        refuse_doubles(path, &text, &elements)?;
        let body_line = text.lines().count() + 1;
        Ok(Self { encoding: parsed.encoding, elements, body, body_line, texture_files, repeated, foreign })
    }

    /// Number of rows of an element; 0 if there is none.
    pub fn count(&self, name: &str) -> usize {
        self.elements.iter().find(|element| element.name == name).map_or(0, |element| element.count)
    }

    /// Compares what the header claims with what the file can hold.
    ///
    /// After this, memory for `count` rows of any element with properties is a bounded multiple of the file's size.
    pub fn check_against_size(&self, path: &Path, file_size: usize) -> Result<(), LoadError> {
        let available = (file_size - self.body) as u128;
        let mut claimed = 0;
        for element in &self.elements {
            let row = element.least_bytes(self.encoding) as u128;
            claimed += row * element.count as u128;
            // The last line of an ascii file may lack its end.
            if claimed > available + u128::from(self.encoding == Encoding::Ascii) {
                return Err(LoadError::TooLarge {
                    path: path.to_owned(),
                    place: Place::File,
                    what: format!(
                        "the header claims {} rows of '{}' of at least {row} bytes each, but {available} bytes follow it",
                        element.count, element.name
                    ),
                    help: "The file is cut off or its header is wrong: write it again.".to_owned(),
                });
            }
        }
        Ok(())
    }
}

impl Element {
    /// Bytes of the shortest possible row: lists are empty; in ascii, a digit and a separator a value.
    fn least_bytes(&self, encoding: Encoding) -> usize {
        match encoding {
            Encoding::Ascii => 2 * self.properties.len(),
            _ => self.properties.iter().map(|property| least_size(&property.kind)).sum(),
        }
    }
}

fn least_size(kind: &PropertyType) -> usize {
    match kind {
        PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size_of_scalar(scalar),
    }
}

/// Bytes of a value in a binary file.
pub(super) fn size_of_scalar(kind: &ScalarType) -> usize {
    match kind {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// The header's text with plain line ends, and the byte offset of the body.
fn split(path: &Path, bytes: &[u8]) -> Result<(String, usize), LoadError> {
    let mut text = String::new();
    let mut start = 0;
    while start < bytes.len() {
        let rest = &bytes[start..];
        let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
        let line = &rest[..length];
        start += length + if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
        if text.is_empty() && line.trim_ascii_end() != b"ply" {
            break;
        }
        // Comments in old encodings are no reason to refuse a file, nor are blanks; lines keep their numbers.
        let line = String::from_utf8_lossy(line);
        text.push_str(if line.trim().is_empty() { "comment" } else { line.trim() });
        text.push('\n');
        if line.trim() == "end_header" {
            return Ok((text, start.min(bytes.len())));
        }
    }
    let (place, read, expected) = match text.is_empty() {
        true => (Place::Byte(0), "the first line is not 'ply'".to_owned(), "the first line of every PLY file"),
        false => (Place::File, "the header has no end".to_owned(), "a line 'end_header'"),
    };
    Err(LoadError::Syntax {
        path: path.to_owned(),
        place,
        read,
        expected: expected.to_owned(),
        help: "Check that this is a whole PLY file.".to_owned(),
    })
}

fn texture_files(text: &str) -> Vec<TextureFile> {
    let name_of = |line: &str| {
        let (keyword, name) = line.strip_prefix("comment")?.trim_start().split_once(char::is_whitespace)?;
        keyword.eq_ignore_ascii_case("TextureFile").then(|| name.trim().trim_matches('"').to_owned())
    };
    let lines = text.lines().enumerate();
    lines.filter_map(|(at, line)| Some(TextureFile { line: at + 1, name: name_of(line)? })).collect()
}

/// The header with a comment in place of each line that is no statement, and those lines.
fn without_foreign_lines(text: &str) -> (String, Option<Foreign>) {
    const KEYWORDS: [&str; 7] = ["ply", "format", "comment", "obj_info", "element", "property", "end_header"];
    let (mut kept, mut foreign) = (String::with_capacity(text.len()), None::<Foreign>);
    for (at, line) in text.lines().enumerate() {
        let is_statement = line.split_ascii_whitespace().next().is_some_and(|word| KEYWORDS.contains(&word));
        if !is_statement {
            foreign.get_or_insert_with(|| Foreign { count: 0, line: at + 1, text: line.to_owned() }).count += 1;
        }
        kept.push_str(if is_statement { line } else { "comment" });
        kept.push('\n');
    }
    (kept, foreign)
}

/// The header with a name of its own for each property that has the name of one before, such as padding, which the parser
/// takes for the same; and those names.
fn with_unlike_names(text: &str) -> (String, Vec<String>) {
    let (mut unlike, mut repeated, mut seen) = (String::with_capacity(text.len()), Vec::new(), HashSet::new());
    for (at, line) in text.lines().enumerate() {
        let mut words = line.split_ascii_whitespace();
        match (words.next(), words.last()) {
            (Some("element"), _) => seen.clear(),
            (Some("property"), Some(name)) if !seen.insert(name) => {
                repeated.push(name.to_owned());
                unlike.push_str(&format!("{line}_again_in_line_{}\n", at + 1));
                continue;
            }
            _ => {}
        }
        unlike.push_str(line);
        unlike.push('\n');
    }
    (unlike, repeated)
}

fn refused(path: &Path, text: &str, error: &ParseError) -> LoadError {
    let line = error.line().filter(|&line| line > 0);
    let read = match line.and_then(|line| text.lines().nth(line - 1)) {
        Some(content) => quote(content.as_bytes()),
        None => "the header is incomplete".to_owned(),
    };
    LoadError::Syntax {
        path: path.to_owned(),
        place: line.map_or(Place::File, |line| Place::Line(line, 1)),
        read,
        expected: "'format <encoding> 1.0', then 'element <name> <count>' and 'property <type> <name>' lines"
            .to_owned(),
        help: "Correct the header.".to_owned(),
    }
}

/// The parser's maps keep the last of two definitions of a name, which would shift all that follows.
fn refuse_doubles(path: &Path, text: &str, elements: &[Element]) -> Result<(), LoadError> {
    let stated =
        |keyword: &str| text.lines().filter(|line| line.split_ascii_whitespace().next() == Some(keyword)).count();
    let properties: usize = elements.iter().map(|element| element.properties.len()).sum();
    if stated("element") == elements.len() && stated("property") == properties {
        return Ok(());
    }
    Err(LoadError::Syntax {
        path: path.to_owned(),
        place: Place::File,
        read: "the header defines an element twice".to_owned(),
        expected: "every name once".to_owned(),
        help: "Correct the header.".to_owned(),
    })
}
