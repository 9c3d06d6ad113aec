//! A binary hierarchy of boxes in the memory of a device.

use raywarp_core::traversal::bvh2_quantized::Grid;
use raywarp_core::traversal::{bvh2, bvh2_quantized};

use super::NodeSizes;
use crate::accel::bvh2::Bvh2;
use crate::accel::bvh2_dual::DualBvh2;
use crate::accel::bvh2_quantized::{compress, grid};
use crate::accel::{Accel, ResidentBvh2, ResidentDual, TreeStats};
use crate::device::{Buffer, Device, DeviceError};
use crate::{Triangle, Vec3};

/// The nodes and the triangles in their order.
pub struct DeviceTree {
    pub(super) full: Buffer<bvh2::Node>,
    /// Empty where they are not wanted.
    pub(super) small: Buffer<bvh2_quantized::Node>,
    pub(super) triangles: Buffer<Triangle>,
    pub(super) grid: Grid,
    pub(super) reach: Vec3,
    pub(super) stats: TreeStats,
}

impl DeviceTree {
    /// What one of so many nodes and triangles takes.
    pub(super) fn bytes(nodes: usize, triangles: usize, sizes: NodeSizes) -> u64 {
        let node =
            size_of::<bvh2::Node>() + if sizes == NodeSizes::Both { size_of::<bvh2_quantized::Node>() } else { 0 };
        (nodes * node + triangles * size_of::<Triangle>()) as u64
    }

    /// Room for one.
    pub(super) fn reserve(
        device: &Device,
        nodes: usize,
        triangles: usize,
        sizes: NodeSizes,
        grid: Grid,
        stats: TreeStats,
    ) -> Result<Self, DeviceError> {
        let small = if sizes == NodeSizes::Both { nodes } else { 0 };
        Ok(Self {
            full: device.zeroed(nodes)?,
            small: device.zeroed(small)?,
            triangles: device.zeroed(triangles)?,
            grid,
            reach: Vec3::ZERO,
            stats,
        })
    }

    /// A tree of the host, copied to the device.
    pub(super) fn of_host(device: &Device, tree: &Bvh2, sizes: NodeSizes) -> Result<Self, DeviceError> {
        let bytes = Self::bytes(tree.nodes.len(), tree.triangles.len(), sizes);
        device.reserve(bytes, "the tree")?;
        let grid = grid(&tree.bounds());
        let small = if sizes == NodeSizes::Both { compress(&tree.nodes, &grid) } else { Vec::new() };
        Ok(Self {
            full: device.upload(&tree.nodes)?,
            small: device.upload(&small)?,
            triangles: device.upload(&tree.triangles)?,
            grid,
            reach: tree.reach(),
            stats: TreeStats { bytes: bytes as usize, ..tree.stats() },
        })
    }

    /// The nodes of 64 bytes.
    pub fn nodes(&self) -> &Buffer<bvh2::Node> {
        &self.full
    }

    /// The nodes of 32 bytes, if they were wanted, and the grid that their boxes are on.
    pub fn small_nodes(&self) -> (&Buffer<bvh2_quantized::Node>, Grid) {
        (&self.small, self.grid)
    }

    /// The triangles in the order of the leaves.
    pub fn triangles(&self) -> &Buffer<Triangle> {
        &self.triangles
    }

    /// Size and quality, without the time that it took.
    pub fn stats(&self) -> TreeStats {
        self.stats
    }

    /// Brings it to the host.
    pub(crate) fn download(self, build_seconds: f64) -> Result<Bvh2, DeviceError> {
        Ok(Bvh2 { nodes: self.full.download()?, triangles: self.triangles.download()?, build_seconds })
    }

    /// A copy of it on the host.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn to_host(&self) -> Result<Accel, DeviceError> {
        let (nodes, triangles) = (self.full.to_vec()?, self.triangles.to_vec()?);
        let full = Bvh2 { nodes, triangles, build_seconds: self.stats.build_seconds };
        if self.small.is_empty() {
            return Ok(Accel::Bvh2(full));
        }
        Ok(Accel::Bvh(DualBvh2 { full, nodes: self.small.to_vec()?, grid: self.grid }))
    }
}

impl From<DeviceTree> for ResidentBvh2 {
    fn from(tree: DeviceTree) -> Self {
        Self { nodes: tree.full, triangles: tree.triangles, reach: tree.reach }
    }
}

impl From<DeviceTree> for ResidentDual {
    fn from(tree: DeviceTree) -> Self {
        let DeviceTree { full: nodes, small, triangles, grid, reach, .. } = tree;
        Self { full: ResidentBvh2 { nodes, triangles, reach }, small, grid }
    }
}
