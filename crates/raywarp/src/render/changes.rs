//! Changes to a scene that is on its device: lights, materials and places of instances, without a new tree.

use raywarp_core::math::Vec3;
use raywarp_core::refit::{Refit, Reshape};
use raywarp_core::surface;
use raywarp_core::traversal::bvh2::Node;
use raywarp_device::kernels::Views;

use super::flatten::{self, Flat};
use super::lighting::Lighting;
use super::{materials, RenderError, Structure, Tracer};
use crate::accel::{drop_degenerate, ResidentBvh2, TreeBox};
use crate::device::{Buffer, Device};
use crate::scene::{Image, Instance, Material, Scene};
use crate::Triangle;

/// The triangles of a scene in world space that can be hit, with other instances and materials than its own: what
/// [`Structure::build`] arranges.
///
/// # Errors
/// [`RenderError::Scene`] for an index out of range.
pub fn world_triangles(
    scene: &Scene,
    instances: &[Instance],
    materials: &[Material],
) -> Result<Vec<Triangle>, RenderError> {
    Ok(drop_degenerate(Flat::with(scene, instances, materials)?.triangles).0)
}

impl Tracer {
    /// Traces through another structure from now on, of the same triangles; returns the one before.
    pub fn replace(&mut self, structure: Structure) -> Structure {
        (self.report.tree, self.levels) = (structure.stats, None);
        std::mem::replace(&mut self.structure, structure)
    }

    /// Launches in blocks of so many columns and rows from now on, or of the usual shape.
    ///
    /// # Errors
    /// As for [`Device::with_block`](crate::device::Device::with_block).
    pub fn set_block(&mut self, block: Option<[u32; 2]>) -> Result<(), RenderError> {
        self.device = self.device.with_block(block)?;
        Ok(())
    }

    /// Which structure is traced.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// The boxes of the structure down to a level, as they are after all moves: see [`Structure::boxes`].
    ///
    /// # Errors
    /// [`RenderError`] where the device fails.
    pub fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, RenderError> {
        self.structure.boxes(level)
    }

    /// Takes over the lights, the background and the ambient light of a scene; nothing else of it is looked at but
    /// whether materials glow. Returns whether that is all: `false` if the ambient light was built in and is the scene's
    /// own now, or the other way round. Materials reflect these by colours of their own, so they must be set again.
    pub fn set_lights(&mut self, scene: &Scene) -> bool {
        let before = std::mem::replace(&mut self.lighting, Lighting::of(scene));
        self.path.forget();
        before.whose_ambient == self.lighting.whose_ambient
    }

    /// Takes over materials, as many as there were, with the scene's own images. Returns whether that is all: `false` if
    /// the structure must be built anew, as it knows which triangles let light through, and is none that can be changed.
    ///
    /// # Errors
    /// [`RenderError`] for another number of materials, or where the device fails.
    pub fn set_materials(&mut self, materials: &[Material], images: &[Image]) -> Result<bool, RenderError> {
        if materials.len() != self.flags.len() {
            return Err(RenderError::Scene { mesh: "the changed scene".to_owned(), part: "the number of materials" });
        }
        let surfaces = materials::ready(materials, images, self.lighting.whose_ambient);
        self.scene.set_materials(&self.device, &surfaces)?;
        self.path.set_surfaces(&surfaces);
        let flags: Vec<u32> = materials.iter().map(flatten::flags_of).collect();
        if flags == self.flags {
            return Ok(true);
        }
        self.flags = flags;
        self.reshape([0, u32::MAX])
    }

    /// Moves an instance to where `instances`, the scene's own but for transforms, has it. Returns whether that is all:
    /// `false` if a new tracer must be made, because the structure is in world space and no `bvh2`, or the instance is in
    /// world space and the rest is not.
    ///
    /// In world space boxes are refitted: the picture is that of a new tree, which is worth building once the instance rests.
    ///
    /// # Errors
    /// [`RenderError`] for an instance that the scene does not have, or where the device fails.
    pub fn move_instance(&mut self, scene: &Scene, instances: &[Instance], index: usize) -> Result<bool, RenderError> {
        let missing = || RenderError::Scene { mesh: format!("instance {index}"), part: "the index" };
        if self.structure.has_instances() {
            return self.set_transforms(instances, &[index]);
        }
        let instance = instances.get(index).ok_or_else(missing)?;
        let vertices = self.vertices.get(index).ok_or_else(missing)?.clone();
        let mesh = flatten::check_instance(scene, instance)?;
        if mesh.positions.len() != vertices.len() {
            return Err(RenderError::Scene { mesh: format!("instance {index}"), part: "the number of vertices" });
        }
        let Some(tree) = self.structure.resident_mut::<ResidentBvh2>() else { return Ok(false) };
        let mut flat = Flat::default();
        flat.place(mesh, instance);
        self.scene.move_vertices(vertices.start, &flat)?;
        let placed = &mut self.instances[index];
        placed.flags = surface::IN_WORLD | flatten::handedness(instance);
        self.scene.set_instance(index, *placed)?;
        self.path.forget();
        // Rounding errors are bounded by the farthest box: a bound too large is safe.
        let far = |v: &Vec3| [v.x, v.y, v.z].map(|x| (x.abs() * (1.0 + 1e-6)).next_up());
        let reach = tree.reach.to_array();
        tree.reach = flat.positions.iter().map(far).fold(reach, |a, b| [0, 1, 2].map(|i| a[i].max(b[i]))).into();
        self.reshape([index as u32, index as u32 + 1])
    }

    /// The same of several: where meshes are placed by instances, the tree over them is made anew once.
    ///
    /// # Errors
    /// As for [`move_instance`](Self::move_instance).
    pub fn move_instances(
        &mut self,
        scene: &Scene,
        instances: &[Instance],
        moved: &[usize],
    ) -> Result<bool, RenderError> {
        if self.structure.has_instances() {
            return self.set_transforms(instances, moved);
        }
        for &index in moved {
            if !self.move_instance(scene, instances, index)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn set_transforms(&mut self, instances: &[Instance], moved: &[usize]) -> Result<bool, RenderError> {
        let known = self.instances.len().min(instances.len());
        if let Some(index) = moved.iter().find(|&&index| index >= known) {
            return Err(RenderError::Scene { mesh: format!("instance {index}"), part: "the index" });
        }
        let transforms: Vec<_> = moved.iter().map(|&index| (index, &instances[index].transform)).collect();
        if !self.structure.set_transforms(&transforms)? {
            return Ok(false);
        }
        for &index in moved {
            let placed = &mut self.instances[index];
            *placed = flatten::placed(&instances[index], placed.first_primitive);
        }
        self.scene.set_instances(&self.instances)?;
        self.path.forget();
        Ok(true)
    }

    /// Brings the tree's triangles of some instances up to date, and all boxes.
    fn reshape(&mut self, moved: [u32; 2]) -> Result<bool, RenderError> {
        let Some(ResidentBvh2 { nodes, triangles, .. }) = self.structure.resident_mut() else { return Ok(false) };
        let flags = self.device.upload(&self.flags)?;
        let reshape = Reshape {
            instances: self.scene.instances(),
            primitives: self.scene.primitives(),
            positions: self.scene.positions(),
            flags: flags.view(),
            moved,
            triangles: triangles.view_mut(),
        };
        let levels = match &self.levels {
            Some(levels) => levels,
            None => self.levels.insert(NodesByDepth::of(&self.device, nodes)?),
        };
        // SAFETY: the buffers belong to this tracer and are borrowed while this waits; the builder checked the links.
        unsafe { self.device.launch(&reshape, [triangles.len(), 1]) }?;
        for &level in levels.ranges.iter().rev() {
            let (triangles, order) = (triangles.view(), levels.order.view());
            let refit = Refit { nodes: nodes.view_mut(), triangles, order, level };
            // SAFETY: as above; each node is once in the order, and deeper levels are done.
            unsafe { self.device.launch(&refit, [level[1] - level[0], 1]) }?;
        }
        Ok(true)
    }
}

/// The nodes of a tree by their distance from the root.
pub(super) struct NodesByDepth {
    order: Buffer<u32>,
    /// Places in `order`, from the root down.
    ranges: Vec<[u32; 2]>,
}

impl NodesByDepth {
    fn of(device: &Device, nodes: &Buffer<Node>) -> Result<Self, RenderError> {
        let nodes = nodes.to_vec()?;
        let (mut order, mut ranges) = (vec![0], vec![[0, 1]]);
        while let Some([first, end]) = ranges.last().copied().filter(|[first, end]| first < end) {
            for place in first..end {
                let node: &Node = &nodes[order[place as usize] as usize];
                let inner = (0..2).filter(|&side| node.has_child(side) && !node.children[side].is_leaf());
                order.extend(inner.map(|side| node.children[side].index()));
            }
            ranges.push([end, order.len() as u32]);
        }
        ranges.pop();
        Ok(Self { order: device.upload(&order)?, ranges })
    }
}
