//! A binary hierarchy of boxes in the memory of a device.

use raywarp_core::traversal::bvh2_quantized::Grid;
use raywarp_core::traversal::{bvh2, bvh2_quantized};

use super::NodeSizes;
use crate::accel::bvh2::Bvh2;
use crate::accel::bvh2_quantized::{compress, grid};
use crate::accel::{BuildError, TreeStats};
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
    pub(super) fn of_host(
        device: &Device,
        tree: &Bvh2,
        sizes: NodeSizes,
        stats: TreeStats,
    ) -> Result<Self, DeviceError> {
        device.reserve(Self::bytes(tree.nodes.len(), tree.triangles.len(), sizes), "the tree")?;
        let grid = grid(&tree.bounds());
        let small = if sizes == NodeSizes::Both { compress(&tree.nodes, &grid) } else { Vec::new() };
        Ok(Self {
            full: device.upload(&tree.nodes)?,
            small: device.upload(&small)?,
            triangles: device.upload(&tree.triangles)?,
            grid,
            reach: tree.reach(),
            stats,
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
    pub(crate) fn download(self, build_seconds: f64) -> Result<Bvh2, BuildError> {
        Ok(Bvh2 { nodes: self.full.download()?, triangles: self.triangles.download()?, build_seconds })
    }
}
