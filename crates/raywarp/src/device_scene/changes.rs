//! Changes to a scene that is on its device: lights, materials and places of instances, without a new tree.

use raywarp_core::refit::Reshape;
use raywarp_core::surface;
use raywarp_device::kernels::Views;

use super::flatten::{self, Flat};
use super::lighting::Lighting;
use super::{Appearance, DeviceScene, SceneError, Structure};
use crate::accel::{drop_degenerate, Refitting};
use crate::device::Device;
use crate::scene::{Image, Instance, Material, Mesh, Scene, Transform};
use crate::Triangle;

/// The triangles of a scene in world space that can be hit, with other instances and materials than its own: what
/// [`Structure::build`] arranges.
///
/// # Errors
/// [`SceneError::Part`] for an index out of range.
pub fn world_triangles(
    scene: &Scene,
    instances: &[Instance],
    materials: &[Material],
) -> Result<Vec<Triangle>, SceneError> {
    Ok(drop_degenerate(Flat::with(scene, instances, materials)?.triangles).0)
}

impl DeviceScene {
    /// Traces through another structure from now on, of the same triangles; returns the one before.
    pub fn replace(&mut self, structure: Structure) -> Structure {
        self.report.tree = structure.stats;
        if let Some(appearance) = &mut self.appearance {
            appearance.refitting = None;
        }
        std::mem::replace(&mut self.structure, structure)
    }

    /// Takes over the lights, the background and the ambient light of a scene; nothing else of it is looked at but
    /// whether materials glow. Returns whether that is all: `false` if the ambient light was built in and is the scene's
    /// own now, or the other way round. Materials reflect these by colours of their own, so they must be set again.
    /// Where the scene is for queries alone, there is nothing to do.
    pub fn set_lights(&mut self, scene: &Scene) -> bool {
        let Some(appearance) = &mut self.appearance else { return true };
        let before = std::mem::replace(&mut appearance.lighting, Lighting::of(scene));
        appearance.path.forget();
        before.whose_ambient == appearance.lighting.whose_ambient
    }

    /// Takes over materials, as many as there were, with the scene's own images. Returns whether that is all: `false` if
    /// the structure must be built anew, as it knows which triangles let light through, and is none that can be changed.
    ///
    /// # Errors
    /// [`SceneError`] for another number of materials, for a scene that is for queries alone, or where the device fails.
    pub fn set_materials(&mut self, materials: &[Material], images: &[Image]) -> Result<bool, SceneError> {
        let appearance = self.appearance.as_mut().ok_or(SceneError::GeometryAlone)?;
        if materials.len() != appearance.flags.len() {
            return Err(SceneError::Part { mesh: "the changed scene".to_owned(), part: "the number of materials" });
        }
        let surfaces = super::materials::ready(materials, images, appearance.lighting.whose_ambient);
        appearance.resident.set_materials(&self.device, &surfaces)?;
        appearance.path.set_surfaces(&surfaces);
        let flags: Vec<u32> = materials.iter().map(flatten::flags_of).collect();
        if flags == appearance.flags {
            return Ok(true);
        }
        appearance.flags = flags;
        reshape(&self.device, &mut self.structure, appearance, [0, u32::MAX])
    }

    /// Moves instances to where `instances`, the scene's own but for transforms, has them. Returns whether that is all:
    /// `false` if the scene must be brought to the device anew, because one of them is in world space, or would have to be,
    /// and the structure is none that can be changed there: a `bvh2` and a `bvh` can.
    ///
    /// Where meshes are placed by instances, the tree over them is made anew once. In world space boxes are refitted: the
    /// picture is that of a new tree, which is worth building once the instances rest.
    ///
    /// # Errors
    /// [`SceneError`] for an instance that the scene does not have, or where the device fails.
    pub fn move_instances(
        &mut self,
        scene: &Scene,
        instances: &[Instance],
        moved: &[usize],
    ) -> Result<bool, SceneError> {
        if let Some(&index) = moved.iter().find(|&&index| index >= instances.len()) {
            return Err(no_such_instance(index));
        }
        if self.structure.has_instances() {
            let transforms: Vec<_> = moved.iter().map(|&index| (index, &instances[index].transform)).collect();
            return self.set_transforms(&transforms);
        }
        let Some(appearance) = &mut self.appearance else { return Ok(false) };
        for &index in moved {
            let mesh = flatten::check_instance(scene, &instances[index])?;
            if !move_in_world(&self.device, &mut self.structure, appearance, mesh, (index, &instances[index]))? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// By how much the boxes of a tree in world space have grown since something moved first: the sum of their areas over what
    /// it was. From 1.3 on a new tree is worth its time; nothing where nothing has moved. Waits for the device.
    ///
    /// # Errors
    /// [`SceneError`] where the device fails.
    pub fn growth(&self) -> Result<Option<f64>, SceneError> {
        let refitting = self.appearance.as_ref().and_then(|appearance| appearance.refitting.as_ref());
        Ok(refitting.map(Refitting::growth).transpose()?)
    }

    /// Puts instances elsewhere, mesh to world space, where meshes are placed by instances. Returns whether that is all:
    /// `false`, and nothing has moved, if one is in world space or would have to be, as its transform cannot be inverted.
    ///
    /// # Errors
    /// [`SceneError`] for an instance that the scene does not have, or where the device fails.
    pub fn set_transforms(&mut self, moved: &[(usize, &Transform)]) -> Result<bool, SceneError> {
        let known = self.structure.instances();
        if let Some(&(index, _)) = moved.iter().find(|&&(index, _)| index >= known) {
            return Err(no_such_instance(index));
        }
        if !self.structure.set_transforms(moved)? {
            return Ok(false);
        }
        let Some(appearance) = &mut self.appearance else { return Ok(true) };
        for &(index, transform) in moved {
            flatten::set_transform(&mut appearance.instances[index], transform);
        }
        appearance.resident.set_instances(&appearance.instances)?;
        appearance.path.forget();
        Ok(true)
    }
}

fn no_such_instance(index: usize) -> SceneError {
    SceneError::Part { mesh: format!("instance {index}"), part: "the index" }
}

/// Moves an instance whose vertices are in world space, and refits the boxes.
fn move_in_world(
    device: &Device,
    structure: &mut Structure,
    appearance: &mut Appearance,
    mesh: &Mesh,
    (index, instance): (usize, &Instance),
) -> Result<bool, SceneError> {
    let vertices = appearance.vertices.get(index).ok_or_else(|| no_such_instance(index))?.clone();
    if mesh.positions.len() != vertices.len() {
        return Err(SceneError::Part { mesh: format!("instance {index}"), part: "the number of vertices" });
    }
    let Some(mut tree) = structure.movable() else { return Ok(false) };
    let mut flat = Flat::default();
    flat.place(mesh, instance);
    appearance.resident.move_vertices(vertices.start, &flat)?;
    let placed = &mut appearance.instances[index];
    placed.flags = surface::IN_WORLD | flatten::handedness(&instance.transform);
    appearance.resident.set_instance(index, *placed)?;
    appearance.path.forget();
    tree.include(&flat.positions);
    reshape(device, structure, appearance, [index as u32, index as u32 + 1])
}

/// Brings the tree's triangles of some instances up to date, and all boxes.
fn reshape(
    device: &Device,
    structure: &mut Structure,
    appearance: &mut Appearance,
    moved: [u32; 2],
) -> Result<bool, SceneError> {
    let Some(mut tree) = structure.movable() else { return Ok(false) };
    let refitting = match &mut appearance.refitting {
        Some(refitting) => refitting,
        none => none.insert(Refitting::of(device, &mut tree)?),
    };
    let flags = device.upload(&appearance.flags)?;
    let reshape = Reshape {
        instances: appearance.resident.instances(),
        primitives: appearance.resident.primitives(),
        positions: appearance.resident.positions(),
        flags: flags.view(),
        moved,
        triangles: tree.full.triangles.view_mut(),
    };
    // SAFETY: the buffers belong to the scene and are freed in the order of the device's own stream; the builder checked the
    // links.
    unsafe { device.launch(&reshape, [tree.full.triangles.len(), 1]) }?;
    refitting.refit(device, &mut tree)?;
    Ok(true)
}
