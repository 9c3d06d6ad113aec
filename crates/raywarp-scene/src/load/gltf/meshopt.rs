//! EXT_meshopt_compression and KHR_meshopt_compression: views compressed by meshoptimizer's codecs.

use std::collections::HashMap;

use ::gltf::json::buffer::View as JsonView;
use ::gltf::json::{Root, Value};
use meshoptimizer_rs::codec;
use meshoptimizer_rs::{Error, Limits, Workspace};

use super::super::quote::quote;
use super::super::LoadError;
use super::budget::Budget;
use super::buffers::Buffers;
use super::decoded::fenced;
use super::origin::Origin;

const NAMES: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// Whether a buffer only stands in for the bytes that its views are decoded to.
pub(super) fn is_fallback(buffer: &::gltf::json::Buffer) -> bool {
    let Some(extensions) = &buffer.extensions else { return false };
    let fallback = |name: &&str| extensions.others.get(*name).and_then(|extension| extension.get("fallback"));
    NAMES.iter().filter_map(fallback).any(|fallback| fallback.as_bool() == Some(true))
}

/// Decodes every view that is compressed.
pub(super) fn decode_views(
    origin: Origin,
    root: &Root,
    buffers: &Buffers,
    budget: &mut Budget,
) -> Result<HashMap<usize, Vec<u8>>, LoadError> {
    let mut decoded = HashMap::new();
    for (index, view) in root.buffer_views.iter().enumerate() {
        if let Some(extension) = extension(view) {
            let owner = format!("bufferViews[{index}]");
            let stream = Stream::read(origin, &owner, extension)?;
            decoded.insert(index, stream.decode(origin, &owner, buffers, budget)?);
        }
    }
    Ok(decoded)
}

fn extension(view: &JsonView) -> Option<&Value> {
    let others = &view.extensions.as_ref()?.others;
    NAMES.iter().find_map(|name| others.get(*name))
}

/// What the extension says of a view.
struct Stream<'a> {
    buffer: usize,
    start: u64,
    length: u64,
    stride: usize,
    count: usize,
    mode: &'a str,
    filter: &'a str,
}

impl<'a> Stream<'a> {
    fn read(origin: Origin, owner: &str, extension: &'a Value) -> Result<Self, LoadError> {
        let number = |key: &str, usual: Option<u64>| {
            let value = extension.get(key).map_or(usual, Value::as_u64);
            value.ok_or_else(|| {
                origin.broken(format!("the meshopt compression of {owner} has a wrong {key}"), "a number")
            })
        };
        let size = |key: &str, usual| {
            let value = number(key, usual)?;
            usize::try_from(value).map_err(|_| origin.too_large(format!("{owner} has a {key} of {value}")))
        };
        let text =
            |key: &str, usual: &'a str| extension.get(key).map_or(usual, |value| value.as_str().unwrap_or_default());
        Ok(Self {
            buffer: size("buffer", None)?,
            start: number("byteOffset", Some(0))?,
            length: number("byteLength", None)?,
            stride: size("byteStride", None)?,
            count: size("count", None)?,
            mode: text("mode", ""),
            filter: text("filter", "NONE"),
        })
    }

    fn decode(
        &self,
        origin: Origin,
        owner: &str,
        buffers: &Buffers,
        budget: &mut Budget,
    ) -> Result<Vec<u8>, LoadError> {
        let source = buffers.part(origin, owner, self.buffer, self.start, self.length)?;
        budget.take_decoded(origin, self.count, self.stride)?;
        let limits = Limits { max_bytes: self.count.saturating_mul(self.stride), ..Limits::default() };
        fenced(|| self.unpack(source, &mut Workspace::new(limits)).map_err(|error| error.to_string())).map_err(
            |reason| {
                let (mode, filter) = (quote(self.mode.as_bytes()), quote(self.filter.as_bytes()));
                let read = format!("{owner} cannot be decoded: {reason}");
                let (count, stride) = (self.count, self.stride);
                origin
                    .broken(read, format!("{count} elements of {stride} bytes compressed by meshopt, {mode} {filter}"))
            },
        )
    }

    fn unpack(&self, source: &[u8], workspace: &mut Workspace) -> Result<Vec<u8>, Error> {
        let (count, stride) = (self.count, self.stride);
        let mut bytes = match self.mode {
            "ATTRIBUTES" => codec::decode_vertex_buffer(count, stride, source, workspace)?,
            "TRIANGLES" => codec::decode_index_buffer(count, stride, source, workspace)?,
            "INDICES" => codec::decode_index_sequence(count, stride, source, workspace)?,
            _ => return Err(Error::InvalidParameter),
        };
        match self.filter {
            "NONE" => {}
            "OCTAHEDRAL" => codec::decode_filter_oct(&mut bytes, count, stride, workspace)?,
            "QUATERNION" => codec::decode_filter_quat(&mut bytes, count, stride, workspace)?,
            "EXPONENTIAL" => codec::decode_filter_exp(&mut bytes, count, stride, workspace)?,
            "COLOR" => codec::decode_filter_color(&mut bytes, count, stride, workspace)?,
            _ => return Err(Error::InvalidParameter),
        }
        Ok(bytes)
    }
}
