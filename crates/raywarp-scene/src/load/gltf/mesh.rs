//! Primitives to meshes.

use std::rc::Rc;

use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Accessor, Index};

use super::super::{repair, LoadError};
use super::attributes::{self, Used};
use super::material::Sets;
use super::phong::at_most;
use super::pose::Pose;
use super::{material, topology, Reader};
use crate::Mesh;

/// A primitive that was read.
#[derive(Clone, Copy)]
pub(super) struct Part {
    /// Index in the scene's meshes.
    pub mesh: usize,
    /// Its material, which is not the mesh's own where primitives share their geometry.
    pub material: u32,
    /// Joints have placed it: it is in world space.
    pub is_placed: bool,
}

/// What the geometry of a primitive is made from: accessors of attributes, accessor of indices, mode.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct Geometry {
    attributes: [Option<usize>; 6],
    indices: Option<usize>,
    mode: u8,
}

/// Bytes of a vertex with all attributes, and of a triangle with its material.
const VERTEX_BYTES: usize = 72;
const TRIANGLE_BYTES: usize = 16;

/// All primitives of a glTF mesh that have triangles, in a pose.
pub(super) fn read(reader: &mut Reader, index: usize, pose: Pose) -> Result<Rc<[Part]>, LoadError> {
    let key = (index, pose);
    if let Some(parts) = reader.cache.meshes.get(&key) {
        return Ok(parts.clone());
    }
    let pose = &key.1;
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
        parts.extend(read_primitive(reader, primitive, pose, &owner, name)?);
    }
    let parts: Rc<[Part]> = parts.into();
    reader.cache.meshes.insert(key, parts.clone());
    Ok(parts)
}

fn read_primitive(
    reader: &mut Reader,
    primitive: &Primitive,
    pose: &Pose,
    owner: &str,
    name: &str,
) -> Result<Option<Part>, LoadError> {
    let Some(mode) = mode(reader, primitive, owner)? else { return Ok(None) };
    let material = material::read(reader, primitive.material.map(|index| index.value()))?;
    let Some(accessors) = Accessors::of(primitive, material.sets) else {
        reader.dropped.without_positions += 1;
        return Ok(None);
    };
    let deforms = pose.deforms(primitive);
    let geometry = accessors.geometry(mode);
    if let Some(&mesh) = reader.cache.geometry.get(&geometry).filter(|_| !deforms) {
        return Ok(Some(Part { mesh, material: material.index, is_placed: false }));
    }
    let (mut mesh, used, count) = build(reader, owner, mode, accessors)?;
    let is_placed = deforms && pose.apply(reader, owner, primitive, &used, count, &mut mesh)?;
    mesh.name = reader.copy_name(name)?;
    mesh.materials = vec![material.index; mesh.triangles.len()];
    reader.dropped.triangles += repair::drop_non_finite(&mut mesh);
    let place = reader.scene.meshes.len();
    reader.scene.meshes.push(mesh);
    if !deforms {
        reader.cache.geometry.insert(geometry, place);
    }
    Ok(Some(Part { mesh: place, material: material.index, is_placed }))
}

/// How indices make triangles; none for points and lines, which are counted.
fn mode(reader: &mut Reader, primitive: &Primitive, owner: &str) -> Result<Option<Mode>, LoadError> {
    let Checked::Valid(mode) = primitive.mode else {
        return Err(reader.origin.broken(format!("{owner} has a wrong mode"), "0 to 6"));
    };
    if matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
        reader.dropped.points_and_lines += 1;
        return Ok(None);
    }
    // What Draco decodes to are triangles, whatever they were.
    let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
    let is_decoded =
        positions.is_some_and(|positions| reader.buffers.decoded.accessors.contains_key(&positions.value()));
    Ok(Some(if is_decoded { Mode::Triangles } else { mode }))
}

/// What a primitive is made from.
struct Accessors {
    positions: Index<Accessor>,
    normals: Option<Index<Accessor>>,
    tangents: Option<Index<Accessor>>,
    /// As a material reads them.
    uvs: [Option<Index<Accessor>>; 2],
    colors: Option<Index<Accessor>>,
    indices: Option<Index<Accessor>>,
}

impl Accessors {
    /// `None` for a primitive without positions.
    fn of(primitive: &Primitive, sets: Sets) -> Option<Self> {
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        Some(Self {
            positions: attribute(Semantic::Positions)?,
            normals: attribute(Semantic::Normals),
            tangents: attribute(Semantic::Tangents),
            uvs: sets.map(|set| attribute(Semantic::TexCoords(set?))),
            colors: attribute(Semantic::Colors(0)),
            indices: primitive.indices,
        })
    }

    fn geometry(&self, mode: Mode) -> Geometry {
        let [uvs, second_uvs] = self.uvs;
        let attributes = [Some(self.positions), self.normals, self.tangents, uvs, second_uvs, self.colors];
        Geometry {
            attributes: attributes.map(|accessor| accessor.map(|index| index.value())),
            indices: self.indices.map(|index| index.value()),
            mode: mode as u8,
        }
    }
}

/// Everything of a mesh but its name and materials, as modelled; which vertices it has of how many.
fn build(reader: &mut Reader, owner: &str, mode: Mode, accessors: Accessors) -> Result<(Mesh, Used, usize), LoadError> {
    let positions = attributes::read(reader, owner, accessors.positions, None, 3..=3)?;
    let count = positions.count;
    let mut optional = |accessor: Option<Index<Accessor>>, lanes| {
        accessor.map(|accessor| attributes::read(reader, owner, accessor, Some(count), lanes)).transpose()
    };
    let normals = optional(accessors.normals, 3..=3)?;
    let tangents = optional(accessors.tangents, 4..=4)?;
    let uvs = optional(accessors.uvs[0], 2..=2)?;
    let second_uvs = optional(accessors.uvs[1], 2..=2)?;
    let colors = optional(accessors.colors, 3..=4)?;

    let mut indices = attributes::read_indices(reader, owner, accessors.indices, count)?;
    let used = Used::compact(&mut indices, count);
    reader.budget.take(reader.origin, indices.len(), TRIANGLE_BYTES)?;
    reader.budget.take(reader.origin, used.len(), VERTEX_BYTES)?;
    let mesh = Mesh {
        positions: used.gather(Some(&positions), |elements, v| elements.floats(v, [0.0; 3])),
        normals: used.gather(normals.as_ref(), |elements, v| repair::unit_or_zero(elements.floats(v, [0.0; 3]))),
        tangents: used.gather(tangents.as_ref(), |elements, v| unit_tangent(elements.floats(v, [0.0; 4]))),
        uvs: used.gather(uvs.as_ref(), |elements, v| v_up(elements.floats(v, [0.0; 2]))),
        second_uvs: used.gather(second_uvs.as_ref(), |elements, v| v_up(elements.floats(v, [0.0; 2]))),
        colors: used.gather(colors.as_ref(), |elements, v| color(elements.floats(v, [1.0; 4]))),
        triangles: topology::triangles(mode, &indices).unwrap_or_default(),
        ..Mesh::default()
    };
    Ok((mesh, used, count))
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

/// From 0 to 1, as glTF asks for COLOR_0.
fn color(channels: [f32; 4]) -> [f32; 4] {
    channels.map(|channel| at_most(1.0, channel))
}
