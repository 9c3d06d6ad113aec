//! Heads of NumPy's `.npy` files (NEP 1): read with care, written plainly.
//!
//! The head is a dictionary in Python's notation. General readers of that notation recurse as deep as the text nests;
//! this one knows the three keys that there are.

use std::io::{ErrorKind, Read};

use super::error::{At, Trouble};
use crate::scene::load::quote::quote;

/// What a `.npy` file begins with.
pub const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Longest dictionary: NumPy itself refuses longer ones unless told to trust them.
const MAX_HEAD: usize = 1 << 16;

/// What a file says of its array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Head {
    /// Type of the items, such as `<f4`.
    pub descr: String,
    /// Whether the first index runs fastest.
    pub fortran_order: bool,
    /// Length of each axis.
    pub shape: Vec<u64>,
    /// Bytes before the data.
    pub len: u64,
}

impl Head {
    /// Reads up to the first byte of the data.
    pub fn read(input: &mut impl Read) -> Result<Self, Trouble> {
        let mut fixed = [0; 8];
        fill(input, &mut fixed, 0)?;
        if fixed[..6] != *MAGIC {
            let what = format!("{} is not how a .npy file begins; write it with numpy.save", quote(&fixed[..6]));
            return Err(Trouble::flaw(At::Byte(0), what));
        }
        let (len, start) = match fixed[6] {
            1 => {
                let mut len = [0; 2];
                fill(input, &mut len, 8)?;
                (usize::from(u16::from_le_bytes(len)), 10)
            }
            2 | 3 => {
                let mut len = [0; 4];
                fill(input, &mut len, 8)?;
                (u32::from_le_bytes(len) as usize, 12)
            }
            version => {
                let what = format!("version {version} of .npy is not known; expected 1, 2 or 3");
                return Err(Trouble::flaw(At::Byte(6), what));
            }
        };
        if len > MAX_HEAD {
            let what = format!("a head of {len} bytes; expected at most {MAX_HEAD}");
            return Err(Trouble::flaw(At::Byte(8), what));
        }
        let mut text = vec![0; len];
        fill(input, &mut text, start)?;
        let mut head = Dictionary { text: &text, at: 0, start }.read()?;
        head.len = start + len as u64;
        Ok(head)
    }

    /// The head of a file with such items, padded so that the data begin at a multiple of 64 bytes.
    pub fn write(descr: &str, shape: &[u64]) -> Vec<u8> {
        let axes: String = shape.iter().map(|axis| format!("{axis}, ")).collect();
        // A single axis keeps its comma, as in Python.
        let axes = if shape.len() == 1 { axes.trim_end() } else { axes.trim_end_matches(", ") };
        let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({axes}), }}");
        let len = (10 + text.len() + 1).next_multiple_of(64) - 10;
        text = format!("{text:<0$}\n", len - 1);
        // Twenty axes are not 64 KiB.
        [MAGIC as &[u8], &[1, 0], &(len as u16).to_le_bytes(), text.as_bytes()].concat()
    }
}

/// Fills `bytes`, which lie at `at`.
fn fill(input: &mut impl Read, bytes: &mut [u8], at: u64) -> Result<(), Trouble> {
    input.read_exact(bytes).map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => {
            Trouble::flaw(At::Byte(at), format!("the file ends within the {} bytes of its head here", bytes.len()))
        }
        _ => error.into(),
    })
}

/// A reader of the dictionary.
struct Dictionary<'a> {
    text: &'a [u8],
    at: usize,
    /// Bytes before the text.
    start: u64,
}

impl<'a> Dictionary<'a> {
    fn read(mut self) -> Result<Head, Trouble> {
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        self.expect(b'{')?;
        while !self.take(b'}') {
            let key = self.string()?;
            self.expect(b':')?;
            match key {
                b"descr" => descr = Some(self.descr()?),
                b"fortran_order" => fortran_order = Some(self.boolean()?),
                b"shape" => shape = Some(self.shape()?),
                _ => return Err(self.flaw(&format!("the key {}; expected descr, fortran_order, shape", quote(key)))),
            }
            if !self.take(b',') {
                self.expect(b'}')?;
                break;
            }
        }
        match (descr, fortran_order, shape) {
            (Some(descr), Some(fortran_order), Some(shape)) => Ok(Head { descr, fortran_order, shape, len: 0 }),
            _ => Err(self.flaw("the end of the head; expected descr, fortran_order and shape before it")),
        }
    }

    fn descr(&mut self) -> Result<String, Trouble> {
        if self.peek() == Some(b'[') {
            return Err(self.flaw(
                "a type with fields; expected plain float32 (numpy.lib.recfunctions has \
                                  structured_to_unstructured)",
            ));
        }
        Ok(String::from_utf8_lossy(self.string()?).into_owned())
    }

    fn boolean(&mut self) -> Result<bool, Trouble> {
        for (word, value) in [(b"True" as &[u8], true), (b"False", false)] {
            self.peek();
            if self.text[self.at..].starts_with(word) {
                self.at += word.len();
                return Ok(value);
            }
        }
        Err(self.unexpected("True or False"))
    }

    fn shape(&mut self) -> Result<Vec<u64>, Trouble> {
        let mut shape = Vec::new();
        self.expect(b'(')?;
        while !self.take(b')') {
            shape.push(self.number()?);
            if !self.take(b',') {
                self.expect(b')')?;
                break;
            }
        }
        Ok(shape)
    }

    fn number(&mut self) -> Result<u64, Trouble> {
        self.peek();
        let digits = self.text[self.at..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let text = std::str::from_utf8(&self.text[self.at..self.at + digits]).unwrap_or_default();
        let Ok(number) = text.parse() else { return Err(self.unexpected("a length below 2^64")) };
        self.at += digits;
        // As Python 2 wrote it.
        self.take(b'L');
        Ok(number)
    }

    fn string(&mut self) -> Result<&'a [u8], Trouble> {
        let Some(quotes @ (b'\'' | b'"')) = self.peek() else { return Err(self.unexpected("a word in quotes")) };
        let rest = &self.text[self.at + 1..];
        let Some(len) = rest.iter().position(|&byte| byte == quotes) else {
            return Err(self.flaw("quotes that do not end"));
        };
        self.at += len + 2;
        Ok(&rest[..len])
    }

    /// The next byte that is no space.
    fn peek(&mut self) -> Option<u8> {
        while self.text.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }

    fn take(&mut self, wanted: u8) -> bool {
        let found = self.peek() == Some(wanted);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, wanted: u8) -> Result<(), Trouble> {
        if self.take(wanted) {
            return Ok(());
        }
        Err(self.unexpected(&format!("'{}'", wanted as char)))
    }

    fn unexpected(&self, expected: &str) -> Trouble {
        let found = &self.text[self.at..];
        let found = found.split(|byte| b",:\n".contains(byte)).next().unwrap_or_default();
        self.flaw(&format!("{} in the head; expected {expected}", quote(found)))
    }

    fn flaw(&self, what: &str) -> Trouble {
        Trouble::flaw(At::Byte(self.start + self.at as u64), what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of version 1 with this dictionary.
    fn file(dictionary: &str) -> Vec<u8> {
        let len = dictionary.len() as u16;
        [MAGIC as &[u8], &[1, 0], &len.to_le_bytes(), dictionary.as_bytes()].concat()
    }

    fn said(bytes: &[u8]) -> String {
        match Head::read(&mut &bytes[..]) {
            Ok(head) => format!("{head:?}"),
            Err(trouble) => trouble.in_file("a.npy").to_string(),
        }
    }

    #[test]
    fn what_is_written_is_read() {
        for shape in [vec![], vec![7], vec![1 << 40, 2], vec![2, 3, 4]] {
            let bytes = Head::write("<f4", &shape);
            assert!(bytes.len().is_multiple_of(64) && bytes.ends_with(b"\n"));
            let head = Head { descr: "<f4".into(), fortran_order: false, shape, len: bytes.len() as u64 };
            assert_eq!(said(&bytes), format!("{head:?}"));
        }
        assert!(String::from_utf8_lossy(&Head::write("|b1", &[5])).contains("'shape': (5,), }"));
        assert!(String::from_utf8_lossy(&Head::write("|b1", &[])).contains("'shape': (), }"));
    }

    #[test]
    fn other_spellings_are_read() {
        let text = r#"{"shape" : ( 5L ,6 ) ,'fortran_order':True,"descr":">f8"}  "#;
        let head = Head { descr: ">f8".into(), fortran_order: true, shape: vec![5, 6], len: 10 + text.len() as u64 };
        assert_eq!(said(&file(text)), format!("{head:?}"));
        let mut second = file(text);
        second.splice(6..10, [2, 0].into_iter().chain((text.len() as u32).to_le_bytes()));
        assert_eq!(said(&second), format!("{:?}", Head { len: head.len + 2, ..head }));
    }

    #[test]
    fn flaws_are_named_with_their_place() {
        for (bytes, sentence) in [
            (b"".to_vec(), "byte 0: the file ends within the 8 bytes"),
            (b"\x93NUMPY\x01\x00\x10".to_vec(), "byte 8: the file ends"),
            (b"PK\x03\x04abcd".to_vec(), "is not how a .npy file begins"),
            (b"\x93NUMPY\x09\x00\x10\x00".to_vec(), "byte 6: version 9"),
            (b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec(), "byte 8: a head of 4294967295 bytes"),
            (file("{'descr': '<f4', 'fortran_order': False, }"), "expected descr, fortran_order and shape"),
            (file("{'descr': [('x', '<f4')], }"), "byte 20: a type with fields"),
            (file("{'shape': (3, -1), }"), "byte 24: '-1)' in the head; expected a length"),
            (file("{'shape': (99999999999999999999,), }"), "expected a length below 2^64"),
            (file("{'shape': (3"), "'' in the head; expected ')'"),
            (file("{'descr': '<f4"), "byte 20: quotes that do not end"),
            (file("{'fortran_order': Maybe}"), "'Maybe}' in the head; expected True or False"),
            (file("{'color': 1}"), "the key 'color'"),
            (file(""), "expected '{'"),
            (file(&"(".repeat(60_000)), "expected '{'"),
        ] {
            let said = said(&bytes);
            assert!(said.starts_with("a.npy: byte ") && said.contains(sentence), "{said}");
        }
    }
}
