//! The bytes behind buffers and buffer views.

use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

use ::gltf::json::{buffer, Index, Root};

use super::super::{LoadError, Sources};
use super::decoded::Decoded;
use super::meshopt;
use super::origin::Origin;
use super::uri::{resolve, Resource};

/// All buffers of a file, each as long as it claims at least, but for those that have no bytes anywhere.
pub(super) struct Buffers<'a> {
    list: Vec<Data<'a>>,
    views: &'a [buffer::View],
    /// What is read instead of views and accessors that are compressed.
    pub decoded: Decoded,
}

enum Data<'a> {
    Chunk(&'a [u8]),
    Owned(Vec<u8>),
    /// Several buffers may name one file.
    File(Rc<Vec<u8>>),
    /// There are none: an error for whoever reads them.
    Nowhere,
}

impl Data<'_> {
    fn bytes(&self) -> &[u8] {
        match self {
            Self::Chunk(bytes) => bytes,
            Self::Owned(bytes) => bytes,
            Self::File(bytes) => bytes,
            Self::Nowhere => &[],
        }
    }
}

/// A part of a buffer.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub bytes: &'a [u8],
    /// Bytes from one element to the next, if stated.
    pub stride: Option<usize>,
}

impl<'a> Buffers<'a> {
    /// Reads every buffer that has bytes; the first one without a URI is the binary chunk.
    pub fn load(
        origin: Origin,
        root: &'a Root,
        chunk: Option<&'a [u8]>,
        sources: &mut Sources,
    ) -> Result<Self, LoadError> {
        let mut files = HashMap::new();
        let mut list = Vec::new();
        for (index, buffer) in root.buffers.iter().enumerate() {
            let name = format!("buffers[{index}]");
            let data = match &buffer.uri {
                _ if meshopt::is_fallback(buffer) => Data::Nowhere,
                Some(uri) => read(origin, &name, uri, sources, &mut files)?,
                None => chunk.filter(|_| index == 0).map_or(Data::Nowhere, Data::Chunk),
            };
            let (has, claims) = (data.bytes().len(), buffer.byte_length.0);
            if (has as u64) < claims && !matches!(data, Data::Nowhere) {
                return Err(origin.broken(format!("{name} has {has} bytes"), format!("its byteLength of {claims}")));
            }
            list.push(data);
        }
        Ok(Self { list, views: &root.buffer_views, decoded: Decoded::default() })
    }

    /// Bytes of all buffers together, shared files once.
    pub fn total_bytes(&self) -> usize {
        let share = |data: &Data| match data {
            Data::File(bytes) => bytes.len() / Rc::strong_count(bytes).max(1),
            other => other.bytes().len(),
        };
        self.list.iter().map(share).sum()
    }

    /// The bytes of a view, for the JSON object that is named `owner` in messages.
    pub fn view(&self, origin: Origin, owner: &str, index: Index<buffer::View>) -> Result<View<'_>, LoadError> {
        let index = index.value();
        let missing = || {
            origin.broken(
                format!("{owner} uses bufferViews[{index}]"),
                format!("an index below {}, the number of views", self.views.len()),
            )
        };
        let view = self.views.get(index).ok_or_else(missing)?;
        // 0 is not allowed and means none where it is written.
        let stride = view.byte_stride.map(|stride| stride.0).filter(|&stride| stride > 0);
        if let Some(bytes) = self.decoded.views.get(&index) {
            return Ok(View { bytes, stride });
        }
        let name = format!("bufferViews[{index}]");
        let (start, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let bytes = self.part(origin, &name, view.buffer.value(), start, length)?;
        Ok(View { bytes, stride })
    }

    /// Bytes of a buffer, for the JSON object that is named `owner` in messages.
    pub fn part(
        &self,
        origin: Origin,
        owner: &str,
        buffer: usize,
        start: u64,
        length: u64,
    ) -> Result<&[u8], LoadError> {
        let data = self.list.get(buffer).ok_or_else(|| {
            let expected = format!("an index below {}, the number of buffers", self.list.len());
            origin.broken(format!("{owner} uses buffers[{buffer}]"), expected)
        })?;
        if let Data::Nowhere = data {
            let expected = "a uri, or the first buffer of a GLB with a binary chunk";
            return Err(origin.broken(format!("buffers[{buffer}], which {owner} reads, has no uri"), expected));
        }
        range(data.bytes(), start, length).ok_or_else(|| {
            let read = format!("{owner} has {length} bytes from byte {start}");
            origin.broken(read, format!("a part of the {} bytes of buffers[{buffer}]", data.bytes().len()))
        })
    }
}

fn range(bytes: &[u8], start: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(start).ok()?;
    let end = start.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(start..end)
}

fn read<'a>(
    origin: Origin,
    name: &str,
    uri: &str,
    sources: &mut Sources,
    files: &mut HashMap<PathBuf, Rc<Vec<u8>>>,
) -> Result<Data<'a>, LoadError> {
    let path = match resolve(origin, name, uri)? {
        Resource::Bytes(bytes) => return Ok(Data::Owned(bytes)),
        Resource::File(path) => path,
    };
    if let Some(bytes) = files.get(&path) {
        return Ok(Data::File(bytes.clone()));
    }
    let bytes = Rc::new(sources.bytes(&path)?);
    files.insert(path, bytes.clone());
    Ok(Data::File(bytes))
}
