//! From the bytes of a `.gltf` or `.glb` file to its JSON and its binary chunk.

use ::gltf::json::{Error, Root, Value};
use serde::Deserialize;

use super::super::quote::{file_name, quote};
use super::super::{LoadError, Place, Sources};
use super::origin::Origin;
use super::{extensions, mended};

/// The two halves of a glTF file.
pub(super) struct Parts<'a> {
    pub json: &'a [u8],
    /// Byte offset of the JSON in a GLB; `None` in a file that is JSON itself.
    json_start: Option<usize>,
    pub binary: Option<&'a [u8]>,
}

const JSON_CHUNK: &[u8; 4] = b"JSON";
const BINARY_CHUNK: &[u8; 4] = b"BIN\0";

/// Tells GLB from JSON by its first bytes and takes it apart.
pub(super) fn split<'a>(origin: Origin, bytes: &'a [u8]) -> Result<Parts<'a>, LoadError> {
    if !bytes.starts_with(b"glTF") {
        let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        return Ok(Parts { json, json_start: None, binary: None });
    }
    let version = word(origin, bytes, 4)?;
    if version != 2 {
        return Err(origin.broken_at(Place::Byte(4), format!("GLB version {version}"), "version 2"));
    }
    let length = word(origin, bytes, 8)? as usize;
    if length > bytes.len() || length < 12 {
        let read = format!("a length of {length} bytes in a file of {}", bytes.len());
        return Err(origin.broken_at(Place::Byte(8), read, "the length of the file"));
    }
    split_chunks(origin, &bytes[..length])
}

/// The first chunk is JSON, the next may be binary; others are for extensions.
fn split_chunks<'a>(origin: Origin, bytes: &'a [u8]) -> Result<Parts<'a>, LoadError> {
    let (kind, json, end) = chunk(origin, bytes, 12)?;
    if kind != JSON_CHUNK {
        return Err(origin.broken_at(Place::Byte(16), "the first chunk is not JSON", "a chunk of type 'JSON'"));
    }
    let mut parts = Parts { json, json_start: Some(20), binary: None };
    if end < bytes.len() {
        let (kind, data, _) = chunk(origin, bytes, end)?;
        parts.binary = (kind == BINARY_CHUNK).then_some(data);
    }
    Ok(parts)
}

/// Type and data of the chunk at an offset, and where the next one starts.
fn chunk<'a>(origin: Origin, bytes: &'a [u8], start: usize) -> Result<(&'a [u8], &'a [u8], usize), LoadError> {
    let length = word(origin, bytes, start)? as usize;
    let rest = bytes.get(start + 4..).unwrap_or_default();
    if rest.len() < 4 || rest.len() - 4 < length {
        let read = format!("a chunk of {length} bytes, {} before the end", rest.len().saturating_sub(4));
        return Err(origin.broken_at(Place::Byte(start as u64), read, "a chunk that ends with the file or before"));
    }
    let (kind, data) = rest.split_at(4);
    Ok((kind, &data[..length], start + 8 + length))
}

fn word(origin: Origin, bytes: &[u8], start: usize) -> Result<u32, LoadError> {
    match bytes.get(start..).and_then(|rest| rest.first_chunk()) {
        Some(word) => Ok(u32::from_le_bytes(*word)),
        None => {
            let read = format!("the file ends after {} bytes", bytes.len());
            Err(origin.broken_at(Place::Byte(start as u64), read, "a whole GLB header"))
        }
    }
}

/// What decides whether the rest can be read at all.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Head {
    asset: Asset,
    #[serde(default)]
    extensions_used: Vec<String>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
struct Asset {
    /// A string, in glTF 1 at times a number.
    version: Value,
}

/// Parses the JSON. Extensions come first: they change what the rest may look like.
pub(super) fn parse(origin: Origin, parts: &Parts, sources: &mut Sources) -> Result<Root, LoadError> {
    let failed = |error: Error| broken_json(origin, parts, &error);
    let head: Head = mended::parse(parts.json).map_err(failed)?;
    check_version(origin, &head.asset.version)?;
    extensions::check(origin, &head.extensions_used, &head.extensions_required, sources)?;
    mended::parse(parts.json).map_err(failed)
}

fn check_version(origin: Origin, version: &Value) -> Result<(), LoadError> {
    let read = match version {
        Value::String(version) if version.starts_with("2.") => return Ok(()),
        Value::String(version) => quote(version.as_bytes()),
        Value::Number(version) => version.to_string(),
        _ => "of another type than a string".to_owned(),
    };
    Err(origin.broken(format!("asset.version {read}"), "version 2.0"))
}

fn broken_json(origin: Origin, parts: &Parts, error: &Error) -> LoadError {
    let (line, column) = (error.line().max(1), error.column().max(1));
    let place = match parts.json_start {
        None => Place::Line(line, column),
        Some(start) => Place::Byte((start + line_start(parts.json, line) + column - 1) as u64),
    };
    let mut message = error.to_string();
    message.truncate(message.rfind(" at line ").unwrap_or(message.len()));
    // It may repeat a string of the file.
    origin.broken_at(place, file_name(&message), "the JSON of glTF 2.0")
}

fn line_start(text: &[u8], line: usize) -> usize {
    let ends = text.iter().enumerate().filter(|(_, &byte)| byte == b'\n').map(|(place, _)| place + 1);
    std::iter::once(0).chain(ends).nth(line - 1).unwrap_or(0)
}
