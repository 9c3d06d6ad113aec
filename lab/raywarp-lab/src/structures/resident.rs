//! The laboratory's structures in the memory of a device.

use raywarp::accel::boxes;
use raywarp::accel::bvh2_quantized::QuantizedBvh2;
use raywarp::accel::{Rendered, Resident, ResidentBrute, ResidentKd, TreeBox};
use raywarp::device::{Buffer, Device, DeviceError};
use raywarp::Triangle;
use raywarp_core::traversal::{self, bvh2_quantized};
use raywarp_core::view::Plain;
use raywarp_lab_core::structures::{self as kernels, bvh4, bvh8, bvh8w};

use raywarp_device::kernels::Views;

/// A list on a device, to be staged.
pub struct ResidentStaged(pub ResidentBrute);

/// A k-d tree on a device, to be traversed by restarts.
pub struct ResidentTrail(pub ResidentKd);

/// A binary hierarchy of boxes on a grid, on a device.
pub struct ResidentQuantized {
    nodes: Buffer<bvh2_quantized::Node>,
    triangles: Buffer<Triangle>,
    grid: bvh2_quantized::Grid,
}

impl ResidentQuantized {
    /// Copies it there.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, tree: &QuantizedBvh2) -> Result<Self, DeviceError> {
        let (nodes, triangles) = (device.upload(tree.nodes())?, device.upload(tree.triangles())?);
        Ok(Self { nodes, triangles, grid: *tree.grid() })
    }
}

/// A hierarchy of boxes with many children a node, on a device.
pub struct ResidentWide<N: Plain> {
    nodes: Buffer<N>,
    triangles: Buffer<Triangle>,
}

impl<N: Plain> ResidentWide<N> {
    /// Copies it there.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, nodes: &[N], triangles: &[Triangle]) -> Result<Self, DeviceError> {
        Ok(Self { nodes: device.upload(nodes)?, triangles: device.upload(triangles)? })
    }
}

macro_rules! resident {
    ($($name:ty: $view:ty, $self:ident => $body:expr, $level:ident => $boxes:expr;)*) => {$(
        // SAFETY: the buffers are its own, and the builders keep indices in range.
        unsafe impl Resident for $name {
            type Short = $view;
            type Long = $view;

            fn short(&self) -> $view {
                let $self = self;
                $body
            }

            fn long(&self) -> $view {
                self.short()
            }
        }

        // SAFETY: as above.
        unsafe impl Rendered for $name {
            fn boxes(&self, $level: u32) -> Result<Vec<TreeBox>, DeviceError> {
                let $self = self;
                $boxes
            }
        }
    )*};
}

resident! {
    ResidentStaged: kernels::Staged, list => kernels::Staged { triangles: list.0.short().triangles },
        level => list.0.boxes(level);
    ResidentTrail: kernels::KdTrail, tree => kernels::KdTrail { tree: tree.0.short() },
        level => tree.0.boxes(level);
    ResidentQuantized: traversal::QuantizedBvh2,
        tree => traversal::QuantizedBvh2 { nodes: tree.nodes.view(), triangles: tree.triangles.view(), grid: tree.grid },
        level => Ok(boxes::of_compact(&tree.nodes.items()?, &tree.grid, level));
    ResidentWide<bvh4::Node>: kernels::Bvh4,
        tree => kernels::Bvh4 { nodes: tree.nodes.view(), triangles: tree.triangles.view() },
        level => Ok(boxes::of_wide(&tree.nodes.items()?, level, super::bvh4::told));
    ResidentWide<bvh8::Node>: kernels::Bvh8,
        tree => kernels::Bvh8 { nodes: tree.nodes.view(), triangles: tree.triangles.view() },
        level => Ok(boxes::of_wide(&tree.nodes.items()?, level, |node| super::bvh8::told(node).unwrap_or_default()));
    ResidentWide<bvh8w::Node>: kernels::Bvh8w,
        tree => kernels::Bvh8w { nodes: tree.nodes.view(), triangles: tree.triangles.view() },
        level => Ok(boxes::of_wide(&tree.nodes.items()?, level, super::bvh8w::told));
}
