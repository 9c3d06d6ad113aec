//! Instances in the memory of a device, for structures that are traversed one mesh after the other.

use raywarp_core::traversal::bvh2::{Child, Node};
use raywarp_core::traversal::two_level::Instance;
use raywarp_core::traversal::{Instances, MeshStructure};
use raywarp_core::view::View;
use raywarp_device::kernels::Views;

use super::two_level::{TwoLevel, UpperTree};
use crate::device::{Buffer, Device, DeviceError};

/// Where meshes are placed, and the tree over that.
pub(super) struct Placements {
    nodes: Buffer<Node>,
    instances: Buffer<Instance>,
    root: Child,
    slack: f32,
}

impl Placements {
    /// Of one mesh, in world space.
    pub fn in_world(device: &Device) -> Result<Self, DeviceError> {
        let (nodes, instances) = (device.upload(&[])?, device.upload(&[Instance::IDENTITY])?);
        Ok(Self { nodes, instances, root: Child::leaf(0, 1), slack: 0.0 })
    }

    /// As in a structure of two levels.
    pub fn of(device: &Device, tree: &TwoLevel) -> Result<Self, DeviceError> {
        let placed = |instance: &Instance| Instance { root: Child::node(tree.part_of(instance)), ..*instance };
        let instances: Vec<Instance> = tree.instances().iter().map(placed).collect();
        let (nodes, instances) = (device.upload(&tree.nodes()[..tree.upper_nodes()])?, device.upload(&instances)?);
        Ok(Self { nodes, instances, root: Child::node(0), slack: tree.slack })
    }

    /// Takes over where instances are now.
    pub fn set(&mut self, upper: &UpperTree) -> Result<(), DeviceError> {
        let placed = |(instance, root): (&Instance, Child)| Instance { root, ..*instance };
        let roots = self.instances.to_vec()?.into_iter().map(|instance| instance.root);
        let instances: Vec<Instance> = upper.instances().iter().zip(roots).map(placed).collect();
        self.instances.write(0, &instances)?;
        self.nodes.write(0, &upper.nodes())?;
        self.slack = upper.slack();
        Ok(())
    }

    /// As kernels traverse them, with the structures of the meshes.
    pub fn view<B: MeshStructure>(&self, meshes: B, parts: View<B::Part>) -> Instances<B> {
        let (nodes, instances) = (self.nodes.view(), self.instances.view());
        Instances { meshes, parts, nodes, instances, root: self.root, slack: self.slack }
    }
}
