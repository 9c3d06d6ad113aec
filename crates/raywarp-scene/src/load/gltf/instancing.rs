//! EXT_mesh_gpu_instancing: many placements of one node's mesh.

use ::gltf::json::scene::Node;
use ::gltf::json::{Index, Value};
use glam::DAffine3;

use super::super::LoadError;
use super::accessor::Elements;
use super::nodes::placement;
use super::Reader;

/// The placements relative to the node; `None` for a node that is not instanced.
pub(super) fn read(reader: &mut Reader, index: usize, node: &Node) -> Result<Option<Vec<DAffine3>>, LoadError> {
    let extension = node.extensions.as_ref().and_then(|extensions| extensions.others.get("EXT_mesh_gpu_instancing"));
    let Some(attributes) = extension.and_then(|extension| extension.get("attributes")) else { return Ok(None) };
    let owner = format!("nodes[{index}].extensions.EXT_mesh_gpu_instancing");
    let translation = attribute(reader, &owner, attributes, "TRANSLATION", 3)?;
    let rotation = attribute(reader, &owner, attributes, "ROTATION", 4)?;
    let scale = attribute(reader, &owner, attributes, "SCALE", 3)?;
    let counts: Vec<usize> = [&translation, &rotation, &scale].into_iter().flatten().map(|e| e.count).collect();
    let Some(&count) = counts.first() else { return Ok(None) };
    if counts.iter().any(|&other| other != count) {
        return Err(reader.origin.broken(format!("{owner} has attributes of {counts:?} elements"), "equal numbers"));
    }
    reader.budget.take(reader.origin, count, std::mem::size_of::<DAffine3>())?;
    let place = |instance| {
        placement(
            translation.as_ref().map_or([0.0; 3], |elements| elements.floats(instance, [0.0; 3])),
            rotation.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |elements| elements.floats(instance, [0.0; 4])),
            scale.as_ref().map_or([1.0; 3], |elements| elements.floats(instance, [1.0; 3])),
        )
    };
    Ok(Some((0..count).map(place).collect()))
}

fn attribute<'a>(
    reader: &mut Reader<'a>,
    owner: &str,
    attributes: &Value,
    name: &str,
    lanes: usize,
) -> Result<Option<Elements<'a>>, LoadError> {
    let Some(value) = attributes.get(name) else { return Ok(None) };
    let origin = reader.origin;
    let index = value.as_u64().and_then(|index| u32::try_from(index).ok());
    let index = index.ok_or_else(|| origin.broken(format!("{owner} has a wrong {name}"), "an accessor's index"))?;
    let elements = Elements::new(origin, reader.buffers, &reader.root.accessors, Index::new(index), owner)?;
    reader.budget.take(origin, elements.sparse_count(), 4)?;
    if elements.lanes != lanes {
        let read = format!("{}, the {name} of {owner}, has {} components", elements.name, elements.lanes);
        return Err(origin.broken(read, format!("{lanes}")));
    }
    Ok(Some(elements))
}
