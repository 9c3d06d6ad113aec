//! Vertex attributes and indices of a primitive, and which of its vertices it uses.

use ::gltf::json::accessor::ComponentType;
use ::gltf::json::{Accessor, Index};

use super::super::LoadError;
use super::accessor::Elements;
use super::Reader;

/// A vertex attribute: as many elements as there are positions, and of the right width.
pub(super) fn read<'a>(
    reader: &mut Reader<'a>,
    owner: &str,
    accessor: Index<Accessor>,
    count: Option<usize>,
    lanes: std::ops::RangeInclusive<usize>,
) -> Result<Elements<'a>, LoadError> {
    let elements = Elements::new(reader.origin, reader.buffers, &reader.root.accessors, accessor, owner)?;
    reader.budget.take(reader.origin, elements.sparse_count(), 4)?;
    if !lanes.contains(&elements.lanes) {
        let read = format!("{}, used by {owner}, has {} components", elements.name, elements.lanes);
        return Err(reader.origin.broken(read, format!("{}", lanes.end())));
    }
    match count {
        Some(count) if count != elements.count => {
            let read = format!("{}, used by {owner}, has {} elements", elements.name, elements.count);
            Err(reader.origin.broken(read, format!("{count}, one for each position")))
        }
        _ => Ok(elements),
    }
}

/// The indices of a primitive, all below the number of vertices; without an accessor, all vertices in order.
pub(super) fn read_indices(
    reader: &mut Reader,
    owner: &str,
    accessor: Option<Index<Accessor>>,
    vertex_count: usize,
) -> Result<Vec<u32>, LoadError> {
    let origin = reader.origin;
    let Some(accessor) = accessor else {
        reader.budget.take(origin, vertex_count, 4)?;
        return Ok((0..vertex_count as u32).collect());
    };
    let elements = read(reader, owner, accessor, None, 1..=1)?;
    if elements.component == ComponentType::F32 {
        return Err(
            origin.broken(format!("{}, the indices of {owner}, are floats", elements.name), "unsigned integers")
        );
    }
    reader.budget.take(origin, elements.count, 4)?;
    let indices: Vec<u32> = (0..elements.count).map(|place| elements.integer(place)).collect();
    match indices.iter().position(|&index| index as usize >= vertex_count) {
        None => Ok(indices),
        Some(place) => {
            let read = format!("index {} at place {place} of {owner}", indices[place]);
            Err(origin.broken(read, format!("an index below {vertex_count}, the number of positions")))
        }
    }
}

/// The vertices that a mesh keeps, in order.
pub(super) enum Used {
    All(usize),
    Some(Vec<u32>),
}

impl Used {
    /// Leaves out the vertices that indices do not use, where there must be such.
    ///
    /// Exporters put the vertices of many primitives into one accessor; a copy of it for each would grow by the square.
    pub fn compact(indices: &mut [u32], vertex_count: usize) -> Self {
        if indices.len() >= vertex_count {
            return Self::All(vertex_count);
        }
        let mut used = indices.to_vec();
        used.sort_unstable();
        used.dedup();
        for index in indices {
            *index = used.partition_point(|vertex| vertex < index) as u32;
        }
        Self::Some(used)
    }

    pub fn len(&self) -> usize {
        match self {
            Self::All(count) => *count,
            Self::Some(vertices) => vertices.len(),
        }
    }

    /// An attribute of the kept vertices; empty where the primitive lacks it.
    pub fn gather<T>(&self, elements: Option<&Elements>, value: impl Fn(&Elements, usize) -> T) -> Vec<T> {
        match (self, elements) {
            (_, None) => Vec::new(),
            (Self::All(count), Some(elements)) => (0..*count).map(|vertex| value(elements, vertex)).collect(),
            (Self::Some(used), Some(elements)) => used.iter().map(|&v| value(elements, v as usize)).collect(),
        }
    }
}
