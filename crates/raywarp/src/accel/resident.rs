//! A structure in the memory of a device.

use raywarp_kernels::math::Vec3;
use raywarp_kernels::traverse::{self, bvh2, kdtree};
use raywarp_kernels::triangle::Triangle;

use super::instanced::Instanced;
use super::Accel;
use crate::backend::{Buffer, Device, DeviceError};

/// What traversal reads, on a device.
pub(crate) enum Resident {
    Brute { triangles: Buffer<Triangle> },
    Kd { nodes: Buffer<kdtree::Node>, references: Buffer<u32>, triangles: Buffer<Triangle>, low: Vec3, high: Vec3 },
    Bvh { nodes: Buffer<bvh2::Node>, triangles: Buffer<Triangle> },
}

/// Evaluates an expression with the structure's view under a name, once for each kind.
macro_rules! with_structure {
    ($resident:expr, $structure:ident => $body:expr) => {
        match $resident {
            $crate::accel::Resident::Brute { triangles } => {
                let $structure = raywarp_kernels::traverse::Brute { triangles: triangles.view() };
                $body
            }
            $crate::accel::Resident::Kd { nodes, references, triangles, low, high } => {
                let $structure = raywarp_kernels::traverse::KdTree {
                    nodes: nodes.view(),
                    references: references.view(),
                    triangles: triangles.view(),
                    low: *low,
                    high: *high,
                };
                $body
            }
            $crate::accel::Resident::Bvh { nodes, triangles } => {
                let $structure = raywarp_kernels::traverse::Bvh2 { nodes: nodes.view(), triangles: triangles.view() };
                $body
            }
        }
    };
}

pub(crate) use with_structure;

impl Resident {
    pub fn upload(device: &Device, tree: &Accel) -> Result<Self, DeviceError> {
        Ok(match tree {
            Accel::Brute(list) => Self::Brute { triangles: device.upload(&list.triangles)? },
            Accel::Kd(tree) => Self::Kd {
                nodes: device.upload(&tree.nodes)?,
                references: device.upload(&tree.references)?,
                triangles: device.upload(&tree.triangles)?,
                low: tree.low,
                high: tree.high,
            },
            Accel::Bvh(tree) => {
                Self::Bvh { nodes: device.upload(&tree.nodes)?, triangles: device.upload(&tree.triangles)? }
            }
        })
    }
}

/// One level or two. What shades a picture knows one; queries take either.
pub(crate) enum AnyResident {
    One(Resident),
    Two(ResidentInstanced),
}

/// As [`with_structure`], with the view of either.
macro_rules! with_any_structure {
    ($resident:expr, $structure:ident => $body:expr) => {
        match $resident {
            $crate::accel::AnyResident::One(resident) => {
                $crate::accel::with_structure!(resident, $structure => $body)
            }
            $crate::accel::AnyResident::Two(resident) => {
                let $structure = resident.view();
                $body
            }
        }
    };
}

pub(crate) use with_any_structure;

/// Two levels on a device.
pub(crate) struct ResidentInstanced {
    nodes: Buffer<bvh2::Node>,
    triangles: Buffer<Triangle>,
    instances: Buffer<traverse::instanced::Instance>,
    slack: f32,
}

impl ResidentInstanced {
    pub fn upload(device: &Device, tree: &Instanced) -> Result<Self, DeviceError> {
        device.reserve(tree.stats().bytes as u64, "the instances and their meshes")?;
        Ok(Self {
            nodes: device.upload(&tree.nodes)?,
            triangles: device.upload(&tree.triangles)?,
            instances: device.upload(&tree.instances)?,
            slack: tree.slack,
        })
    }

    pub fn view(&self) -> traverse::Instanced {
        traverse::Instanced {
            nodes: self.nodes.view(),
            triangles: self.triangles.view(),
            instances: self.instances.view(),
            slack: self.slack,
        }
    }
}
