//! Accessors: typed, checked random access to the elements in a buffer.

use ::gltf::json::accessor::{self, ComponentType, Type};
use ::gltf::json::validation::Checked;
use ::gltf::json::Index;

use super::super::LoadError;
use super::buffers::{Buffers, View};
use super::decoded::Attribute;
use super::origin::Origin;

/// The elements of an accessor. Every element below `count` lies inside its buffer.
pub(super) struct Elements<'a> {
    /// Its name in messages.
    pub name: String,
    pub count: usize,
    /// Components an element, 1 to 4, or 16.
    pub lanes: usize,
    pub component: ComponentType,
    normalized: bool,
    /// Zeros where there is none.
    base: Option<Span<'a>>,
    sparse: Option<Sparse<'a>>,
}

/// Elements at equal distances.
struct Span<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Span<'a> {
    fn element(&self, index: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..]
    }
}

/// Elements that replace some of the base.
struct Sparse<'a> {
    /// Increasing.
    indices: Vec<u32>,
    values: Span<'a>,
}

impl<'a> Elements<'a> {
    /// Checks an accessor for the JSON object that is named `owner` in messages.
    pub fn new(
        origin: Origin,
        buffers: &'a Buffers,
        accessors: &[accessor::Accessor],
        index: Index<accessor::Accessor>,
        owner: &str,
    ) -> Result<Self, LoadError> {
        let name = format!("accessors[{}]", index.value());
        let accessor = accessors.get(index.value()).ok_or_else(|| {
            let expected = format!("an index below {}, the number of accessors", accessors.len());
            origin.broken(format!("{owner} uses {name}"), expected)
        })?;
        if let Some(attribute) = buffers.decoded.accessors.get(&index.value()) {
            return Ok(Self::decoded(name, accessor.normalized, attribute));
        }
        let component = match &accessor.component_type {
            Checked::Valid(component) => component.0,
            Checked::Invalid => return Err(origin.broken(format!("{name} has a wrong componentType"), "5120 to 5126")),
        };
        let lanes = lanes(&accessor.type_).ok_or_else(|| {
            origin.broken(format!("{name}, used by {owner}, has a wrong type"), "SCALAR, VEC2, VEC3, VEC4 or MAT4")
        })?;
        let count = whole(origin, &name, accessor.count.0)?;
        let size = lanes * component.size();
        let offset = accessor.byte_offset.unwrap_or_default().0;
        // Zeros cost nothing in the file and nothing here: whoever copies elements takes room for them.
        let view = accessor.buffer_view.map(|view| buffers.view(origin, &name, view)).transpose()?;
        let base = view.map(|view| span(origin, &name, view, offset, count, size)).transpose()?;
        let sparse = match &accessor.sparse {
            Some(sparse) => Some(read_sparse(origin, &name, buffers, sparse, count, size)?),
            None => None,
        };
        Ok(Self { name, count, lanes, component, normalized: accessor.normalized, base, sparse })
    }

    /// Of an accessor that was compressed. What the JSON says of it is not needed, but for how integers are meant.
    fn decoded(name: String, normalized: bool, attribute: &'a Attribute) -> Self {
        let Attribute { bytes, count, lanes, component } = attribute;
        let base = Some(Span { bytes, stride: lanes * component.size() });
        Self { name, count: *count, lanes: *lanes, component: *component, normalized, base, sparse: None }
    }

    /// Elements that had to be read to make this.
    pub fn sparse_count(&self) -> usize {
        self.sparse.as_ref().map_or(0, |sparse| sparse.indices.len())
    }

    /// The bytes of an element; `None` for zeros.
    fn element(&self, index: usize) -> Option<&'a [u8]> {
        if let Some(sparse) = &self.sparse {
            if let Ok(place) = sparse.indices.binary_search(&(index as u32)) {
                return Some(sparse.values.element(place));
            }
        }
        self.base.as_ref().map(|base| base.element(index))
    }

    /// The element at an index below `count` as floating point; lanes that it lacks are taken from `fill`.
    pub fn floats<const N: usize>(&self, index: usize, fill: [f32; N]) -> [f32; N] {
        let Some(bytes) = self.element(index) else {
            return std::array::from_fn(|lane| self.or_zero(lane, fill[lane]));
        };
        let size = self.component.size();
        std::array::from_fn(|lane| match lane < self.lanes {
            true => number(&bytes[lane * size..], self.component, self.normalized),
            false => fill[lane],
        })
    }

    fn or_zero(&self, lane: usize, fill: f32) -> f32 {
        if lane < self.lanes {
            0.0
        } else {
            fill
        }
    }

    /// The first lane of the element at an index below `count` as an unsigned integer.
    pub fn integer(&self, index: usize) -> u32 {
        self.integers::<1>(index)[0]
    }

    /// The element at an index below `count` as unsigned integers; lanes that it lacks are 0.
    pub fn integers<const N: usize>(&self, index: usize) -> [u32; N] {
        let Some(bytes) = self.element(index) else { return [0; N] };
        let size = self.component.size();
        std::array::from_fn(|lane| match lane < self.lanes {
            true => unsigned(&bytes[lane * size..], self.component),
            false => 0,
        })
    }
}

fn lanes(kind: &Checked<Type>) -> Option<usize> {
    match kind {
        Checked::Valid(Type::Scalar) => Some(1),
        Checked::Valid(Type::Vec2) => Some(2),
        Checked::Valid(Type::Vec3) => Some(3),
        Checked::Valid(Type::Vec4) => Some(4),
        // Columns of all other matrices may be padded; nothing here reads one.
        Checked::Valid(Type::Mat4) => Some(16),
        _ => None,
    }
}

fn whole(origin: Origin, name: &str, count: u64) -> Result<usize, LoadError> {
    // Vertices are counted by u32 all over raywarp, u32::MAX standing for none.
    match usize::try_from(count) {
        Ok(count) if count < u32::MAX as usize => Ok(count),
        _ => Err(origin.too_large(format!("{name} claims {count} elements, and {} is the limit", u32::MAX - 1))),
    }
}

/// The part of a view that `count` elements from an offset take.
fn span<'a>(
    origin: Origin,
    name: &str,
    view: View<'a>,
    offset: u64,
    count: usize,
    size: usize,
) -> Result<Span<'a>, LoadError> {
    let stride = view.stride.unwrap_or(size);
    let needed = match count {
        0 => Some(0),
        count => (count - 1).checked_mul(stride).and_then(|bytes| bytes.checked_add(size)),
    };
    let bytes = usize::try_from(offset).ok().and_then(|offset| view.bytes.get(offset..));
    match (bytes, needed) {
        (Some(bytes), Some(needed)) if bytes.len() >= needed => Ok(Span { bytes, stride }),
        _ => {
            let read = format!("{name} has {count} elements of {size} bytes, {stride} apart, from byte {offset}");
            Err(origin.broken(read, format!("a part of its view of {} bytes", view.bytes.len())))
        }
    }
}

fn read_sparse<'a>(
    origin: Origin,
    name: &str,
    buffers: &'a Buffers,
    sparse: &accessor::sparse::Sparse,
    count: usize,
    size: usize,
) -> Result<Sparse<'a>, LoadError> {
    let replaced = whole(origin, name, sparse.count.0)?;
    let component = match &sparse.indices.component_type {
        Checked::Valid(component) => component.0,
        Checked::Invalid => {
            return Err(origin.broken(format!("the sparse indices of {name} have a wrong type"), "5121, 5123 or 5125"))
        }
    };
    let packed = |view| View { stride: None, ..view };
    let places = packed(buffers.view(origin, name, sparse.indices.buffer_view)?);
    let places = span(origin, name, places, sparse.indices.byte_offset.0, replaced, component.size())?;
    let values = packed(buffers.view(origin, name, sparse.values.buffer_view)?);
    let values = span(origin, name, values, sparse.values.byte_offset.0, replaced, size)?;
    let indices: Vec<u32> = (0..replaced).map(|index| unsigned(places.element(index), component)).collect();
    let increasing = indices.windows(2).all(|pair| pair[0] < pair[1]);
    if !increasing || indices.last().is_some_and(|&last| last as usize >= count) {
        let expected = format!("increasing indices below {count}");
        return Err(origin.broken(format!("the sparse indices of {name} are out of order or of range"), expected));
    }
    Ok(Sparse { indices, values })
}

/// The first component in some bytes, which are long enough.
fn number(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let (value, one) = match component {
        ComponentType::F32 => return f32::from_le_bytes(first(bytes)),
        ComponentType::I8 => (f32::from(i8::from_le_bytes(first(bytes))), 127.0),
        ComponentType::U8 => (f32::from(bytes[0]), 255.0),
        ComponentType::I16 => (f32::from(i16::from_le_bytes(first(bytes))), 32_767.0),
        ComponentType::U16 => (f32::from(u16::from_le_bytes(first(bytes))), 65_535.0),
        ComponentType::U32 => (u32::from_le_bytes(first(bytes)) as f32, u32::MAX as f32),
    };
    match normalized {
        true => (value / one).max(-1.0),
        false => value,
    }
}

fn unsigned(bytes: &[u8], component: ComponentType) -> u32 {
    match component.size() {
        1 => u32::from(bytes[0]),
        2 => u32::from(u16::from_le_bytes(first(bytes))),
        _ => u32::from_le_bytes(first(bytes)),
    }
}

fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
    std::array::from_fn(|place| bytes[place])
}
