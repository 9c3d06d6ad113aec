//! Instances in memory, for structures that are traversed one mesh after the other: brute force and the k-d tree, on CPUs.

use raywarp_core::math::Vec3;
use raywarp_core::traversal::bvh2::{Child, Node};
use raywarp_core::traversal::kdtree::KdPart;
use raywarp_core::traversal::two_level::Instance;
use raywarp_core::traversal::{self, kdtree, Instances, MeshStructure};
use raywarp_core::view::View;
use raywarp_device::kernels::Views;

use super::boxes::{self, TreeBox};
use super::kdtree::KdTree;
use super::two_level::{TwoLevel, UpperTree};
use super::{Rendered, Resident};
use crate::device::{Buffer, Device, DeviceError};
use crate::Triangle;

/// Where meshes are placed, and the tree over that.
struct Placements {
    nodes: Buffer<Node>,
    instances: Buffer<Instance>,
    slack: f32,
}

impl Placements {
    /// As in a structure of two levels.
    fn of(device: &Device, tree: &TwoLevel) -> Result<Self, DeviceError> {
        let instances = rooted(tree.instances(), tree.instances().iter().map(|instance| tree.part_of(instance)));
        let (nodes, instances) = (device.upload(&tree.nodes()[..tree.upper_nodes()])?, device.upload(&instances)?);
        Ok(Self { nodes, instances, slack: tree.slack })
    }

    /// Takes over where instances are now.
    fn set(&mut self, upper: &UpperTree) -> Result<(), DeviceError> {
        self.instances.write(0, &rooted(upper.instances(), upper.meshes().iter().copied()))?;
        self.nodes.write(0, &upper.nodes())?;
        self.slack = upper.slack();
        Ok(())
    }

    /// Those of the tree over the instances.
    fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        Ok(boxes::of_bvh2(&self.nodes.items()?, level))
    }

    /// As kernels traverse them, with the structures of the meshes.
    fn view<B: MeshStructure>(&self, meshes: B, parts: View<B::Part>) -> Instances<B> {
        let (nodes, instances) = (self.nodes.view(), self.instances.view());
        Instances { meshes, parts, nodes, instances, slack: self.slack }
    }
}

/// Instances whose roots are their meshes' indices: a structure of each has its arrays by them.
fn rooted(instances: &[Instance], meshes: impl Iterator<Item = u32>) -> Vec<Instance> {
    instances.iter().zip(meshes).map(|(instance, mesh)| Instance { root: Child::node(mesh), ..*instance }).collect()
}

/// Lists of triangles, one a mesh.
pub struct ResidentLists {
    triangles: Buffer<Triangle>,
    parts: Buffer<[u32; 2]>,
    placements: Placements,
}

impl ResidentLists {
    /// Those of a structure of two levels, without the trees of its meshes.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, tree: &TwoLevel) -> Result<Self, DeviceError> {
        let parts: Vec<_> = tree.meshes().map(|part| [part.start as u32, part.len() as u32]).collect();
        Ok(Self {
            triangles: device.upload(tree.triangles())?,
            parts: device.upload(&parts)?,
            placements: Placements::of(device, tree)?,
        })
    }

    /// Takes over where instances are now.
    pub(crate) fn set_instances(&mut self, upper: &UpperTree) -> Result<(), DeviceError> {
        self.placements.set(upper)
    }
}

/// K-d trees, one a mesh.
pub struct ResidentKdTrees {
    nodes: Buffer<kdtree::Node>,
    references: Buffer<u32>,
    triangles: Buffer<Triangle>,
    parts: Buffer<KdPart>,
    placements: Placements,
}

impl ResidentKdTrees {
    /// Of the meshes of a structure of two levels, in their order.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, tree: &TwoLevel, trees: &[KdTree]) -> Result<Self, DeviceError> {
        let (mut nodes, mut references, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        let add = |tree: &KdTree| {
            let [low, high] = tree.bounds();
            KdPart {
                nodes: append(&mut nodes, tree.nodes()),
                references: append(&mut references, tree.references()),
                triangles: append(&mut triangles, tree.triangles()),
                low,
                high,
            }
        };
        let parts: Vec<_> = trees.iter().map(add).collect();
        Ok(Self {
            nodes: device.upload(&nodes)?,
            references: device.upload(&references)?,
            triangles: device.upload(&triangles)?,
            parts: device.upload(&parts)?,
            placements: Placements::of(device, tree)?,
        })
    }

    /// Takes over where instances are now.
    pub(crate) fn set_instances(&mut self, upper: &UpperTree) -> Result<(), DeviceError> {
        self.placements.set(upper)
    }
}

/// Adds items at the end of others; where they begin there, and how many they are.
fn append<T: Copy>(all: &mut Vec<T>, items: &[T]) -> [u32; 2] {
    let first = all.len() as u32;
    all.extend_from_slice(items);
    [first, items.len() as u32]
}

// SAFETY: the buffers are its own, and the builders keep indices in range.
unsafe impl Resident for ResidentLists {
    type Short = Instances<traversal::Brute>;
    type Long = Self::Short;

    fn short(&self) -> Self::Short {
        self.placements.view(traversal::Brute { triangles: self.triangles.view() }, self.parts.view())
    }

    fn long(&self) -> Self::Long {
        self.short()
    }
}

// SAFETY: as above.
unsafe impl Resident for ResidentKdTrees {
    type Short = Instances<traversal::KdTree>;
    type Long = Self::Short;

    fn short(&self) -> Self::Short {
        // What counts are the bounds of each part.
        let (low, high) = (Vec3::ZERO, Vec3::ZERO);
        let (nodes, references, triangles) = (self.nodes.view(), self.references.view(), self.triangles.view());
        self.placements.view(traversal::KdTree { nodes, references, triangles, low, high }, self.parts.view())
    }

    fn long(&self) -> Self::Long {
        self.short()
    }
}

// SAFETY: as above.
unsafe impl Rendered for ResidentLists {
    fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        self.placements.boxes(level)
    }
}

// SAFETY: as above.
unsafe impl Rendered for ResidentKdTrees {
    fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        self.placements.boxes(level)
    }
}
