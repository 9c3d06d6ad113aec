//! Primitives to meshes.

use std::rc::Rc;

use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Accessor, Index};

use super::super::{repair, LoadError};
use super::accessor::Elements;
use super::{material, topology, Reader};
use crate::Mesh;

/// A primitive that was read.
#[derive(Clone, Copy)]
pub(super) struct Part {
    /// Index in the scene's meshes.
    pub mesh: usize,
    /// Its material, which is not the mesh's own where primitives share their geometry.
    pub material: u32,
}

/// What the geometry of a primitive is made from: accessors of attributes, accessor of indices, mode.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct Geometry {
    attributes: [Option<usize>; 5],
    indices: Option<usize>,
    mode: u8,
}

/// Bytes of a vertex with all attributes, and of a triangle with its material.
const VERTEX_BYTES: usize = 64;
const TRIANGLE_BYTES: usize = 16;

/// All primitives of a glTF mesh that have triangles.
pub(super) fn read(reader: &mut Reader, index: usize) -> Result<Rc<[Part]>, LoadError> {
    if let Some(parts) = reader.cache.meshes.get(&index) {
        return Ok(parts.clone());
    }
    let root = reader.root;
    let mesh = root.meshes.get(index).ok_or_else(|| {
        let expected = format!("an index below {}, the number of meshes", root.meshes.len());
        reader.origin.broken(format!("a node uses meshes[{index}]"), expected)
    })?;
    let place_in_file = format!("meshes[{index}]");
    let name = mesh.name.as_deref().unwrap_or(&place_in_file);
    let mut parts = Vec::new();
    for (place, primitive) in mesh.primitives.iter().enumerate() {
        let owner = format!("meshes[{index}].primitives[{place}]");
        parts.extend(read_primitive(reader, primitive, &owner, name)?);
    }
    let parts: Rc<[Part]> = parts.into();
    reader.cache.meshes.insert(index, parts.clone());
    Ok(parts)
}

fn read_primitive(
    reader: &mut Reader,
    primitive: &Primitive,
    owner: &str,
    name: &str,
) -> Result<Option<Part>, LoadError> {
    let Checked::Valid(mode) = primitive.mode else {
        return Err(reader.origin.broken(format!("{owner} has a wrong mode"), "0 to 6"));
    };
    if matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
        reader.warn("points and lines are left out")?;
        return Ok(None);
    }
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
    let Some(positions) = attribute(Semantic::Positions) else {
        reader.warn("primitives without positions are left out")?;
        return Ok(None);
    };
    let material = material::read(reader, primitive.material.map(|index| index.value()))?;
    let attributes =
        [Semantic::Normals, Semantic::Tangents, Semantic::TexCoords(material.texture_set), Semantic::Colors(0)]
            .map(attribute);
    let geometry = Geometry {
        attributes: [Some(positions), attributes[0], attributes[1], attributes[2], attributes[3]]
            .map(|accessor| accessor.map(|index| index.value())),
        indices: primitive.indices.map(|index| index.value()),
        mode: mode as u8,
    };
    if let Some(&mesh) = reader.cache.geometry.get(&geometry) {
        return Ok(Some(Part { mesh, material: material.index }));
    }
    let mut mesh = build(reader, owner, mode, primitive.indices, positions, attributes)?;
    mesh.name = reader.copy_name(name)?;
    mesh.materials = vec![material.index; mesh.triangles.len()];
    reader.dropped.triangles += repair::drop_non_finite(&mut mesh);
    let place = reader.scene.meshes.len();
    reader.scene.meshes.push(mesh);
    reader.cache.geometry.insert(geometry, place);
    Ok(Some(Part { mesh: place, material: material.index }))
}

/// Everything of a mesh but its name and materials.
fn build(
    reader: &mut Reader,
    owner: &str,
    mode: Mode,
    indices: Option<Index<Accessor>>,
    positions: Index<Accessor>,
    [normals, tangents, uvs, colors]: [Option<Index<Accessor>>; 4],
) -> Result<Mesh, LoadError> {
    let positions = attribute(reader, owner, positions, None, 3..=3)?;
    let count = Some(positions.count);
    let mut optional = |accessor: Option<Index<Accessor>>, lanes| {
        accessor.map(|accessor| attribute(reader, owner, accessor, count, lanes)).transpose()
    };
    let normals = optional(normals, 3..=3)?;
    let tangents = optional(tangents, 4..=4)?;
    let uvs = optional(uvs, 2..=2)?;
    let colors = optional(colors, 3..=4)?;

    let mut indices = read_indices(reader, owner, indices, positions.count)?;
    let used = compact(&mut indices, positions.count);
    reader.budget.take(reader.origin, indices.len(), TRIANGLE_BYTES)?;
    reader.budget.take(reader.origin, used.len(), VERTEX_BYTES)?;
    Ok(Mesh {
        positions: used.gather(Some(&positions), |elements, v| elements.floats(v, [0.0; 3])),
        normals: used.gather(normals.as_ref(), |elements, v| repair::unit_or_zero(elements.floats(v, [0.0; 3]))),
        tangents: used.gather(tangents.as_ref(), |elements, v| unit_tangent(elements.floats(v, [0.0; 4]))),
        uvs: used.gather(uvs.as_ref(), |elements, v| v_up(elements.floats(v, [0.0; 2]))),
        colors: used.gather(colors.as_ref(), |elements, v| color(elements.floats(v, [1.0; 4]))),
        triangles: topology::triangles(mode, &indices).unwrap_or_default(),
        ..Mesh::default()
    })
}

/// A vertex attribute: as many elements as there are positions, and of the right width.
fn attribute<'a>(
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
fn read_indices(
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
    let elements = attribute(reader, owner, accessor, None, 1..=1)?;
    if elements.component == ::gltf::json::accessor::ComponentType::F32 {
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
enum Used {
    All(usize),
    Some(Vec<u32>),
}

impl Used {
    fn len(&self) -> usize {
        match self {
            Self::All(count) => *count,
            Self::Some(vertices) => vertices.len(),
        }
    }

    /// An attribute of the kept vertices; empty where the primitive lacks it.
    fn gather<T>(&self, elements: Option<&Elements>, value: impl Fn(&Elements, usize) -> T) -> Vec<T> {
        match (self, elements) {
            (_, None) => Vec::new(),
            (Self::All(count), Some(elements)) => (0..*count).map(|vertex| value(elements, vertex)).collect(),
            (Self::Some(used), Some(elements)) => used.iter().map(|&v| value(elements, v as usize)).collect(),
        }
    }
}

/// Leaves out the vertices that indices do not use, where there must be such.
///
/// Exporters put the vertices of many primitives into one accessor; a copy of it for each would grow by the square.
fn compact(indices: &mut [u32], vertex_count: usize) -> Used {
    if indices.len() >= vertex_count {
        return Used::All(vertex_count);
    }
    let mut used = indices.to_vec();
    used.sort_unstable();
    used.dedup();
    for index in indices {
        *index = used.partition_point(|vertex| vertex < index) as u32;
    }
    Used::Some(used)
}

fn v_up([u, v]: [f32; 2]) -> [f32; 2] {
    match u.is_finite() && v.is_finite() {
        true => [u, 1.0 - v],
        false => [0.0; 2],
    }
}

fn unit_tangent([x, y, z, sign]: [f32; 4]) -> [f32; 4] {
    let [x, y, z] = repair::unit_or_zero([x, y, z]);
    [x, y, z, if sign < 0.0 { -1.0 } else { 1.0 }]
}

fn color([red, green, blue, alpha]: [f32; 4]) -> [f32; 4] {
    // `max` turns NaN into 0.
    [red.max(0.0), green.max(0.0), blue.max(0.0), alpha.max(0.0)].map(|channel| channel.min(f32::MAX))
}
