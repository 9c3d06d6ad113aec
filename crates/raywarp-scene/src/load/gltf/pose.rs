//! The pose that a node gives its mesh: a skin, and the weights of morph targets.

use ::gltf::json::mesh::{MorphTarget as JsonTarget, Primitive};
use ::gltf::json::scene::Node;
use ::gltf::json::{Accessor, Index};

use super::super::LoadError;
use super::attributes::{self, Used};
use super::{skin, Reader};
use crate::deform::{self, MorphTarget};
use crate::Mesh;

/// What a mesh is read with; nodes of one pose share it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Pose {
    /// Index of the skin.
    pub skin: Option<usize>,
    /// Weights of the targets, as bits. Those that are missing are 0.
    weights: Vec<u32>,
}

impl Pose {
    /// Of a node with a mesh: the node's weights come before the mesh's.
    pub fn of(reader: &mut Reader, node: &Node, mesh: usize) -> Result<Self, LoadError> {
        let skin = node.skin.map(|skin| skin.value());
        let Some(mesh) = reader.root.meshes.get(mesh) else { return Ok(Self { skin, weights: Vec::new() }) };
        let has_targets = mesh.primitives.iter().any(|primitive| primitive.targets.is_some());
        let weights = node.weights.as_ref().or(mesh.weights.as_ref()).filter(|_| has_targets);
        let weights = weights.map_or(&[][..], Vec::as_slice);
        reader.budget.take(reader.origin, weights.len(), 4)?;
        Ok(Self { skin, weights: weights.iter().map(|weight| weight.to_bits()).collect() })
    }

    fn weight(&self, target: usize) -> f32 {
        let weight = self.weights.get(target).map_or(0.0, |&bits| f32::from_bits(bits));
        if weight.is_finite() {
            weight
        } else {
            0.0
        }
    }

    /// Whether a primitive is in another shape than its attributes say.
    pub fn deforms(&self, primitive: &Primitive) -> bool {
        let targets = primitive.targets.as_ref().map_or(0, Vec::len);
        (0..targets).any(|target| self.weight(target) != 0.0) || (self.skin.is_some() && skin::is_skinned(primitive))
    }

    /// Brings the used vertices of a primitive into the pose. Returns whether its joints have placed it in the world.
    pub fn apply(
        &self,
        reader: &mut Reader,
        owner: &str,
        primitive: &Primitive,
        used: &Used,
        count: usize,
        mesh: &mut Mesh,
    ) -> Result<bool, LoadError> {
        self.morph(reader, owner, primitive, used, count, mesh)?;
        match self.skin {
            Some(index) if skin::is_skinned(primitive) => {
                let joints = skin::joints(reader, index)?;
                let influences = skin::influences(reader, index, owner, primitive, used, count)?;
                deform::skin(mesh, &influences, &joints);
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    fn morph(
        &self,
        reader: &mut Reader,
        owner: &str,
        primitive: &Primitive,
        used: &Used,
        count: usize,
        mesh: &mut Mesh,
    ) -> Result<(), LoadError> {
        let mut targets = Vec::new();
        for (place, target) in primitive.targets.iter().flatten().enumerate() {
            let weight = self.weight(place);
            if weight != 0.0 {
                targets.push((weight, read_target(reader, &format!("{owner}.targets[{place}]"), target, used, count)?));
            }
        }
        if !targets.is_empty() {
            deform::morph(mesh, &targets);
        }
        Ok(())
    }
}

fn read_target(
    reader: &mut Reader,
    owner: &str,
    target: &JsonTarget,
    used: &Used,
    count: usize,
) -> Result<MorphTarget, LoadError> {
    let mut read = |accessor: Option<Index<Accessor>>| -> Result<Vec<[f32; 3]>, LoadError> {
        let Some(accessor) = accessor else { return Ok(Vec::new()) };
        let elements = attributes::read(reader, owner, accessor, Some(count), 3..=3)?;
        reader.budget.take(reader.origin, used.len(), std::mem::size_of::<[f32; 3]>())?;
        Ok(used.gather(Some(&elements), |elements, vertex| elements.floats(vertex, [0.0; 3])))
    };
    Ok(MorphTarget {
        positions: read(target.positions)?,
        normals: read(target.normals)?,
        tangents: read(target.tangents)?,
    })
}
