//! Skins: joints and their matrices, and which of them move a vertex.

use std::rc::Rc;

use ::gltf::json::mesh::{Primitive, Semantic};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Accessor, Index};
use glam::{DAffine3, DMat3, DVec3};

use super::super::LoadError;
use super::attributes::{self, Used};
use super::{nodes, Reader};
use crate::deform::Influences;
use crate::Transform;

/// Joints of one JOINTS attribute.
const JOINTS_A_SET: usize = 4;

/// Whether joints move a primitive at all: where a mesh has a skin and a primitive no joints, its node places it.
pub(super) fn is_skinned(primitive: &Primitive) -> bool {
    set(primitive, 0).is_some()
}

fn set(primitive: &Primitive, index: u32) -> Option<[Index<Accessor>; 2]> {
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
    Some([attribute(Semantic::Joints(index))?, attribute(Semantic::Weights(index))?])
}

/// Which joints of a skin move the used vertices of a primitive.
pub(super) fn influences(
    reader: &mut Reader,
    skin: usize,
    owner: &str,
    primitive: &Primitive,
    used: &Used,
    count: usize,
) -> Result<Influences, LoadError> {
    let accessors: Vec<_> = (0..).map_while(|index| set(primitive, index)).collect();
    let per_vertex = JOINTS_A_SET * accessors.len();
    reader.budget.take(reader.origin, used.len(), 8 * per_vertex)?;
    let mut influences = Influences {
        per_vertex,
        joints: vec![0; used.len() * per_vertex],
        weights: vec![0.0; used.len() * per_vertex],
    };
    for (set, [joints, weights]) in accessors.into_iter().enumerate() {
        let joints = attributes::read(reader, owner, joints, Some(count), 4..=4)?;
        let weights = attributes::read(reader, owner, weights, Some(count), 4..=4)?;
        let joints = used.gather(Some(&joints), |elements, vertex| elements.integers::<JOINTS_A_SET>(vertex));
        let weights = used.gather(Some(&weights), |elements, vertex| elements.floats(vertex, [0.0; JOINTS_A_SET]));
        for (vertex, (joints, weights)) in joints.into_iter().zip(weights).enumerate() {
            let place = vertex * per_vertex + set * JOINTS_A_SET;
            influences.joints[place..][..JOINTS_A_SET].copy_from_slice(&joints);
            influences.weights[place..][..JOINTS_A_SET].copy_from_slice(&weights.map(usable));
        }
    }
    check(reader, skin, owner, &influences)?;
    Ok(influences)
}

/// A weight; nothing where it is none.
fn usable(weight: f32) -> f32 {
    if weight > 0.0 && weight.is_finite() {
        weight
    } else {
        0.0
    }
}

/// Every joint that counts is one of the skin's; the first of a vertex counts where it has no weights.
fn check(reader: &Reader, skin: usize, owner: &str, influences: &Influences) -> Result<(), LoadError> {
    let joints = reader.root.skins.get(skin).map_or(0, |skin| skin.joints.len());
    let counts = |place: usize| influences.weights[place] != 0.0 || place.is_multiple_of(influences.per_vertex);
    let wrong =
        (0..influences.joints.len()).find(|&place| influences.joints[place] as usize >= joints && counts(place));
    match wrong {
        None => Ok(()),
        Some(place) => {
            let read = format!("{owner} uses joint {} of skins[{skin}]", influences.joints[place]);
            Err(reader.origin.broken(read, format!("one below {joints}, the number of its joints")))
        }
    }
}

/// The matrices of a skin's joints, from the space of the mesh to the world: where a joint is, after the inverse of where
/// it was when the mesh was bound to it. The node of the mesh has no say in it.
pub(super) fn joints(reader: &mut Reader, index: usize) -> Result<Rc<[Transform]>, LoadError> {
    if let Some(joints) = reader.cache.skins.get(&index) {
        return Ok(joints.clone());
    }
    let (origin, root) = (reader.origin, reader.root);
    let skin = root.skins.get(index).ok_or_else(|| {
        let expected = format!("an index below {}, the number of skins", root.skins.len());
        origin.broken(format!("a node uses skins[{index}]"), expected)
    })?;
    let inverses = inverse_bind_matrices(reader, index, skin.inverse_bind_matrices, skin.joints.len())?;
    let worlds = nodes::worlds(reader)?;
    let joint = |(place, node): (usize, &Index<::gltf::json::Node>)| {
        let world = worlds.get(node.value()).ok_or_else(|| {
            let expected = format!("an index below {}, the number of nodes", worlds.len());
            origin.broken(format!("skins[{index}] uses nodes[{}]", node.value()), expected)
        })?;
        Ok(nodes::narrow(*world * inverses.get(place).copied().unwrap_or(DAffine3::IDENTITY)))
    };
    let joints: Rc<[Transform]> = skin.joints.iter().enumerate().map(joint).collect::<Result<_, LoadError>>()?;
    reader.cache.skins.insert(index, joints.clone());
    Ok(joints)
}

/// One a joint, or none at all.
fn inverse_bind_matrices(
    reader: &mut Reader,
    skin: usize,
    accessor: Option<Index<Accessor>>,
    joints: usize,
) -> Result<Vec<DAffine3>, LoadError> {
    let Some(accessor) = accessor else { return Ok(Vec::new()) };
    let owner = format!("skins[{skin}]");
    let elements = attributes::read(reader, &owner, accessor, None, 16..=16)?;
    if elements.count < joints {
        let read = format!("{}, used by {owner}, has {} elements", elements.name, elements.count);
        return Err(reader.origin.broken(read, format!("{joints}, one for each joint")));
    }
    reader.budget.take(reader.origin, joints, std::mem::size_of::<DAffine3>())?;
    Ok((0..joints).map(|place| affine(elements.floats(place, [0.0; 16]))).collect())
}

/// Of a matrix in columns; the fourth row of an affine map is known.
fn affine(matrix: [f32; 16]) -> DAffine3 {
    let column = |first: usize| DVec3::from_array(std::array::from_fn(|row| f64::from(matrix[first + row])));
    DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(4), column(8)), column(12))
}
