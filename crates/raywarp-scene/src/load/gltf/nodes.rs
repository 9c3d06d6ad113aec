//! The node tree: instances, cameras and lights in world space.

use std::rc::Rc;

use ::gltf::json::scene::Node;
use ::gltf::json::Root;
use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::super::LoadError;
use super::pose::Pose;
use super::{cameras, instancing, lights, mesh, Reader};
use crate::{Instance, Transform};

/// Walks the nodes of the file's scene, children after their parents, in the order of the file.
pub(super) fn read(reader: &mut Reader) -> Result<(), LoadError> {
    let mut visited = vec![false; reader.root.nodes.len()];
    // A stack instead of recursion: the depth of the tree is the file's choice.
    let mut stack: Vec<(usize, DAffine3)> = Vec::new();
    stack.extend(roots(reader)?.into_iter().rev().map(|index| (index, DAffine3::IDENTITY)));
    while let Some((index, parent)) = stack.pop() {
        let nodes = &reader.root.nodes;
        let node = nodes.get(index).ok_or_else(|| {
            let expected = format!("an index below {}, the number of nodes", nodes.len());
            reader.origin.broken(format!("nodes[{index}] is a child or a root"), expected)
        })?;
        if std::mem::replace(&mut visited[index], true) {
            let read = format!("nodes[{index}] is reached twice");
            return Err(reader.origin.broken(read, "a tree, where every node has one parent"));
        }
        let world = parent * local(node);
        read_node(reader, index, node, world)?;
        let children = node.children.as_deref().unwrap_or_default();
        stack.extend(children.iter().rev().map(|child| (child.value(), world)));
    }
    reader.rounding.tell_of_places(reader.origin.path, &reader.scene, reader.sources);
    if reader.scene.instances.iter().all(|instance| reader.scene.meshes[instance.mesh].triangles.is_empty()) {
        reader.warn("the scene has no triangles: there is nothing to see")?;
    }
    Ok(())
}

/// The roots of the scene that the file opens with, else the first; without scenes, all nodes that are nobody's child.
fn roots(reader: &Reader) -> Result<Vec<usize>, LoadError> {
    let root = reader.root;
    let index = root.scene.map_or(0, |scene| scene.value());
    if let Some(scene) = root.scenes.get(index) {
        return Ok(scene.nodes.iter().map(|node| node.value()).collect());
    }
    if root.scene.is_some() {
        let expected = format!("an index below {}, the number of scenes", root.scenes.len());
        return Err(reader.origin.broken(format!("scene is {index}"), expected));
    }
    Ok(tops(root))
}

/// The nodes that are nobody's child.
fn tops(root: &Root) -> Vec<usize> {
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().filter_map(|node| node.children.as_ref()).flatten() {
        if let Some(flag) = is_child.get_mut(child.value()) {
            *flag = true;
        }
    }
    (0..root.nodes.len()).filter(|&node| !is_child[node]).collect()
}

/// Where every node is in the world, whether the scene shows it or not: joints need not be shown. Nodes that descend
/// from themselves are nowhere, and stay at the origin.
pub(super) fn worlds(reader: &mut Reader) -> Result<Rc<[DAffine3]>, LoadError> {
    if let Some(worlds) = &reader.cache.worlds {
        return Ok(worlds.clone());
    }
    let nodes = &reader.root.nodes;
    reader.budget.take(reader.origin, nodes.len(), std::mem::size_of::<DAffine3>())?;
    let mut worlds = vec![None; nodes.len()];
    let mut stack: Vec<_> = tops(reader.root).into_iter().map(|node| (node, DAffine3::IDENTITY)).collect();
    while let Some((index, parent)) = stack.pop() {
        let Some(node) = nodes.get(index).filter(|_| worlds[index].is_none()) else { continue };
        let world = parent * local(node);
        worlds[index] = Some(world);
        stack.extend(node.children.iter().flatten().map(|child| (child.value(), world)));
    }
    let worlds: Rc<[_]> = worlds.into_iter().map(Option::unwrap_or_default).collect();
    reader.cache.worlds = Some(worlds.clone());
    Ok(worlds)
}

/// A node's place relative to its parent.
fn local(node: &Node) -> DAffine3 {
    if let Some(matrix) = node.matrix {
        // Column-major; the fourth row of an affine map is known.
        let column = |first: usize| DVec3::from_array(std::array::from_fn(|row| f64::from(matrix[first + row])));
        return DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(4), column(8)), column(12));
    }
    placement(node.translation.unwrap_or_default(), node.rotation.unwrap_or_default().0, node.scale.unwrap_or([1.0; 3]))
}

/// Scale, then rotation by a quaternion (x, y, z, w), then translation.
pub(super) fn placement(translation: [f32; 3], rotation: [f32; 4], scale: [f32; 3]) -> DAffine3 {
    let wide = |vector: [f32; 3]| DVec3::from_array(vector.map(f64::from));
    let rotation = DQuat::from_array(rotation.map(f64::from));
    // Rounded quaternions are a little long or short, wrong ones may have no length at all.
    let length = rotation.length();
    let rotation = if length > 0.0 && length.is_finite() { rotation / length } else { DQuat::IDENTITY };
    DAffine3::from_scale_rotation_translation(wide(scale), rotation, wide(translation))
}

fn read_node(reader: &mut Reader, index: usize, node: &Node, world: DAffine3) -> Result<(), LoadError> {
    let name = node.name.as_deref();
    if let Some(mesh) = node.mesh {
        add_instances(reader, index, node, mesh.value(), world)?;
    }
    if let Some(camera) = node.camera {
        cameras::read(reader, camera.value(), name, world)?;
    }
    if let Some(light) = node.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref()) {
        lights::read(reader, light.light.value(), name, world)?;
    }
    Ok(())
}

fn add_instances(
    reader: &mut Reader,
    index: usize,
    node: &Node,
    mesh: usize,
    world: DAffine3,
) -> Result<(), LoadError> {
    let pose = Pose::of(reader, node, mesh)?;
    let parts = mesh::read(reader, mesh, pose)?;
    let mesh_name = reader.root.meshes.get(mesh).and_then(|mesh| mesh.name.as_deref());
    let place_in_file = format!("nodes[{index}]");
    let name = node.name.as_deref().or(mesh_name).unwrap_or(&place_in_file);
    let placements = match instancing::read(reader, index, node)? {
        Some(placements) => placements.into_iter().map(|placement| world * placement).collect(),
        None => vec![world],
    };
    for (place, world) in placements.into_iter().enumerate() {
        let transform = narrow(world);
        for x in world.translation.to_array() {
            reader.rounding.round(x);
        }
        let is_finite = transform.columns.iter().flatten().chain(&transform.translation).all(|value| value.is_finite());
        if !is_finite && parts.iter().any(|part| !part.is_placed) {
            reader.dropped.instances += 1;
        }
        for part in parts.iter().filter(|part| if part.is_placed { place == 0 } else { is_finite }) {
            let transform = if part.is_placed { Transform::IDENTITY } else { transform };
            reader.budget.take(reader.origin, 1, std::mem::size_of::<Instance>())?;
            let name = reader.copy_name(name)?;
            let own = reader.scene.meshes[part.mesh].materials.first().copied();
            let material = own.filter(|&own| own != part.material).map(|_| part.material);
            reader.scene.instances.push(Instance { name, mesh: part.mesh, transform, material });
        }
    }
    Ok(())
}

/// In single precision.
pub(super) fn narrow(world: DAffine3) -> Transform {
    Transform {
        columns: world.matrix3.to_cols_array_2d().map(|column| column.map(|value| value as f32)),
        translation: world.translation.to_array().map(|value| value as f32),
    }
}
