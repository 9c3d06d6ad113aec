//! URIs of buffers and pictures: data inside the JSON, or a file beside it.

use std::path::PathBuf;

use super::super::quote::quote;
use super::super::{LoadError, Place};
use super::origin::Origin;

/// No system has longer relative paths that anyone would write; messages repeat them.
const LONGEST_NAME: usize = 1024;

/// What a URI stands for.
pub(super) enum Resource {
    /// The bytes of a `data:` URI.
    Bytes(Vec<u8>),
    /// A file, its path relative to the glTF file resolved.
    File(PathBuf),
}

/// Decodes a URI of the JSON object that is named `owner` in messages.
pub(super) fn resolve(origin: Origin, owner: &str, uri: &str) -> Result<Resource, LoadError> {
    if let Some(data) = uri.strip_prefix("data:") {
        return decode_data(origin, owner, data).map(Resource::Bytes);
    }
    if let Some(scheme) = scheme(uri) {
        return Err(LoadError::Unsupported {
            path: origin.path.to_owned(),
            place: Place::File,
            what: format!("the scheme {} in the URI of {owner}", quote(scheme.as_bytes())),
            help: "Put the file beside the glTF file and name it by a relative path.".to_owned(),
        });
    }
    if uri.len() > LONGEST_NAME {
        let expected = format!("a path of at most {LONGEST_NAME}");
        return Err(origin.broken(format!("{owner} has a URI of {} bytes", uri.len()), expected));
    }
    let decoded = percent_decoded(uri.as_bytes());
    let relative = String::from_utf8_lossy(&decoded).into_owned();
    let folder = origin.path.parent().unwrap_or("".as_ref());
    Ok(Resource::File(folder.join(relative)))
}

/// The part before the colon. A single letter is a Windows drive.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let valid = scheme.len() > 1
        && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
        && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
    valid.then_some(scheme)
}

/// What follows `data:`; RFC 2397.
fn decode_data(origin: Origin, owner: &str, data: &str) -> Result<Vec<u8>, LoadError> {
    let Some((kind, payload)) = data.split_once(',') else {
        let read = format!("{owner} has the URI {}", quote(format!("data:{data}").as_bytes()));
        return Err(origin.broken(read, "a comma between the type and the data"));
    };
    if !kind.ends_with(";base64") {
        return Ok(percent_decoded(payload.as_bytes()));
    }
    base64(payload.as_bytes()).map_err(|place| {
        let read = format!("{owner} has {} at character {place} of its data", quote(&payload.as_bytes()[place..][..1]));
        origin.broken(read, "base64")
    })
}

/// `%20` to a space, and so on; a percent sign without two hexadecimal digits stays.
fn percent_decoded(text: &[u8]) -> Vec<u8> {
    let mut decoded = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some((&byte, after)) = rest.split_first() {
        let code = (byte == b'%').then(|| after.get(..2).and_then(hexadecimal)).flatten();
        decoded.push(code.unwrap_or(byte));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    decoded
}

fn hexadecimal(digits: &[u8]) -> Option<u8> {
    digits.iter().try_fold(0, |value, &digit| Some(value * 16 + (digit as char).to_digit(16)? as u8))
}

/// RFC 4648 with either alphabet; line ends and missing padding are forgiven. Fails with the offset of a wrong byte.
fn base64(text: &[u8]) -> Result<Vec<u8>, usize> {
    let mut decoded = Vec::with_capacity(text.len() / 4 * 3 + 2);
    let (mut bits, mut count) = (0u32, 0);
    for (place, &byte) in text.iter().enumerate() {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' => break,
            b' ' | b'\t' | b'\r' | b'\n' => continue,
            _ => return Err(place),
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            decoded.push((bits >> count) as u8);
        }
    }
    Ok(decoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_rfc() {
        for (plain, code) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(code.as_bytes()), Ok(plain.as_bytes().to_vec()));
        }
        assert_eq!(base64(b"Zm9\nvYg"), Ok(b"foob".to_vec()));
        assert_eq!(base64(b"+/-_"), Ok(vec![0xfb, 0xff, 0xbf]));
        assert_eq!(base64(b"Zm9v!"), Err(4));
    }

    #[test]
    fn percent_codes_are_decoded() {
        assert_eq!(percent_decoded(b"a%20b%C3%BC%zz%4"), "a bü%zz%4".as_bytes());
    }

    #[test]
    fn schemes_are_told_from_drives() {
        assert_eq!(scheme("https://x"), Some("https"));
        assert_eq!(scheme("c:/x.bin"), None);
        assert_eq!(scheme("a b:c"), None);
    }
}
