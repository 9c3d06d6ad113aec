//! Structures in the memory of a device: their arrays, and what kernels are given of them.

use raywarp_core::math::Vec3;
use raywarp_core::traversal::{self, bvh2, bvh2_quantized, bvh8f, kdtree, QuantizedBvh2, Structure};
use raywarp_core::triangle::Triangle;
use raywarp_device::kernels::Views;

use super::boxes::{self, TreeBox};
use super::kdtree::KdTree;
use super::two_level::{TwoLevel, UpperTree};
use super::{brute, bvh2_dual};
use crate::device::{Buffer, Device, DeviceError};

/// What traversal reads, in buffers of a device. Whatever implements this is traced by every kernel of queries: raywarp's own
/// structures, and those of others on a device that was opened [with their kernels](Device::open_with).
///
/// # Safety
/// The views point into buffers that this owns, and the indices in those are in range.
pub unsafe trait Resident: Send + Sync + 'static {
    /// As kernels traverse it that look for one hit of a ray.
    type Short: Structure + 'static;
    /// As kernels traverse it that are long without it: those that shade, or look at all hits.
    type Long: Structure + 'static;

    /// For [`Short`](Self::Short) kernels.
    fn short(&self) -> Self::Short;

    /// For [`Long`](Self::Long) kernels.
    fn long(&self) -> Self::Long;

    /// The tree as [persistent threads](raywarp_core::persistent) traverse it, where they can.
    fn persistent(&self) -> Option<QuantizedBvh2> {
        None
    }
}

/// A structure that pictures are traced through as well.
///
/// # Safety
/// As for [`Resident`].
pub unsafe trait Rendered: Resident {
    /// Its boxes down to a level, see [`Accel::boxes`](super::Accel::boxes). Nodes are read back from the device, as they are
    /// now.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError>;
}

macro_rules! resident {
    ($($name:ident: $view:ty, $self:ident => $body:expr;)*) => {$(
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
    )*};
}

resident! {
    ResidentBrute: traversal::Brute, list => traversal::Brute { triangles: list.triangles.view() };
    ResidentKd: traversal::KdTree, tree => tree.view();
    ResidentBvh2: traversal::Bvh2, tree => tree.view();
    ResidentBvh8f: traversal::Bvh8f, tree => {
        traversal::Bvh8f { nodes: tree.nodes.view(), blocks: tree.blocks.view() }
    };
    ResidentTwoLevel: traversal::TwoLevel, tree => traversal::TwoLevel {
        nodes: tree.nodes.view(),
        triangles: tree.triangles.view(),
        instances: tree.instances.view(),
        slack: tree.slack,
    };
}

/// A list of triangles on a device.
pub struct ResidentBrute {
    triangles: Buffer<Triangle>,
}

impl ResidentBrute {
    /// Copies it there.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, list: &brute::Brute) -> Result<Self, DeviceError> {
        Ok(Self { triangles: device.upload(list.triangles())? })
    }
}

// SAFETY: as above.
unsafe impl Rendered for ResidentBrute {
    fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        Ok(boxes::of_list(&self.triangles.items()?, level))
    }
}

/// A k-d tree on a device.
pub struct ResidentKd {
    nodes: Buffer<kdtree::Node>,
    references: Buffer<u32>,
    triangles: Buffer<Triangle>,
    bounds: [Vec3; 2],
}

impl ResidentKd {
    /// Copies it there.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, tree: &KdTree) -> Result<Self, DeviceError> {
        Ok(Self {
            nodes: device.upload(tree.nodes())?,
            references: device.upload(tree.references())?,
            triangles: device.upload(tree.triangles())?,
            bounds: tree.bounds(),
        })
    }

    fn view(&self) -> traversal::KdTree {
        let [low, high] = self.bounds;
        let (nodes, references, triangles) = (self.nodes.view(), self.references.view(), self.triangles.view());
        traversal::KdTree { nodes, references, triangles, low, high }
    }
}

// SAFETY: as above.
unsafe impl Rendered for ResidentKd {
    fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        Ok(boxes::of_cells(&self.nodes.items()?, self.bounds, level))
    }
}

/// A binary hierarchy of boxes on a device: the one that can follow what moves.
pub struct ResidentBvh2 {
    pub(crate) nodes: Buffer<bvh2::Node>,
    pub(crate) triangles: Buffer<Triangle>,
    pub(crate) reach: Vec3,
}

impl ResidentBvh2 {
    /// Copies it there.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, tree: &super::bvh2::Bvh2) -> Result<Self, DeviceError> {
        let (nodes, triangles) = (device.upload(tree.nodes())?, device.upload(tree.triangles())?);
        Ok(Self { nodes, triangles, reach: tree.reach() })
    }

    fn view(&self) -> traversal::Bvh2 {
        traversal::Bvh2 { nodes: self.nodes.view(), triangles: self.triangles.view(), reach: self.reach }
    }
}

// SAFETY: as above.
unsafe impl Rendered for ResidentBvh2 {
    fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        Ok(boxes::of_bvh2(&self.nodes.items()?, level))
    }
}

/// Both kinds of nodes over the same triangles.
pub struct ResidentDual {
    pub(super) full: ResidentBvh2,
    pub(super) small: Buffer<bvh2_quantized::Node>,
    pub(super) grid: bvh2_quantized::Grid,
}

impl ResidentDual {
    /// Copies it there.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, tree: &bvh2_dual::DualBvh2) -> Result<Self, DeviceError> {
        let (full, small) = (ResidentBvh2::upload(device, &tree.full)?, device.upload(&tree.nodes)?);
        Ok(Self { full, small, grid: tree.grid })
    }

    fn small(&self) -> QuantizedBvh2 {
        QuantizedBvh2 { nodes: self.small.view(), triangles: self.full.triangles.view(), grid: self.grid }
    }
}

// SAFETY: the buffers are its own, and the builders keep indices in range.
unsafe impl Resident for ResidentDual {
    type Short = traversal::DualBvh2;
    type Long = traversal::Bvh2;

    fn short(&self) -> traversal::DualBvh2 {
        traversal::DualBvh2 { full: self.full.view(), quantized: self.small() }
    }

    fn long(&self) -> traversal::Bvh2 {
        self.full.view()
    }

    fn persistent(&self) -> Option<QuantizedBvh2> {
        Some(self.small())
    }
}

// SAFETY: as above.
unsafe impl Rendered for ResidentDual {
    fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        self.full.boxes(level)
    }
}

/// Eight boxes a node in full precision, on a device.
pub struct ResidentBvh8f {
    nodes: Buffer<bvh8f::Node>,
    blocks: Buffer<bvh8f::Block>,
}

impl ResidentBvh8f {
    /// Copies it there.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, tree: &super::bvh8f::Bvh8f) -> Result<Self, DeviceError> {
        Ok(Self { nodes: device.upload(tree.nodes())?, blocks: device.upload(tree.blocks())? })
    }
}

// SAFETY: as above.
unsafe impl Rendered for ResidentBvh8f {
    fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        Ok(boxes::of_wide(&self.nodes.items()?, level, super::bvh8f::told))
    }
}

// SAFETY: as above.
unsafe impl Rendered for ResidentTwoLevel {
    fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        // Those of meshes are in spaces of their own: an instance's box is told as a leaf.
        Ok(boxes::of_bvh2(&self.nodes.to_vec()?[..self.upper], level))
    }
}

/// Two levels on a device.
pub struct ResidentTwoLevel {
    nodes: Buffer<bvh2::Node>,
    triangles: Buffer<Triangle>,
    instances: Buffer<traversal::two_level::Instance>,
    slack: f32,
    /// Nodes of the upper tree.
    upper: usize,
}

impl ResidentTwoLevel {
    /// Takes over where instances are now.
    pub(crate) fn set_instances(&mut self, upper: &UpperTree) -> Result<(), DeviceError> {
        self.nodes.write(0, &upper.nodes())?;
        self.instances.write(0, upper.instances())?;
        self.slack = upper.slack();
        Ok(())
    }

    /// Copies them there.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, tree: &TwoLevel) -> Result<Self, DeviceError> {
        device.reserve(tree.stats().bytes as u64, "the instances and their meshes")?;
        Ok(Self {
            nodes: device.upload(&tree.nodes)?,
            triangles: device.upload(&tree.triangles)?,
            instances: device.upload(&tree.instances)?,
            slack: tree.slack,
            upper: tree.upper_nodes(),
        })
    }
}
