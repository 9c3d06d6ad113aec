//! A structure in the memory of a device.

use raywarp_kernels::math::Vec3;
use raywarp_kernels::traverse::{bvh2, bvh4, bvh8, bvh8f, bvh8w, kdtree};
use raywarp_kernels::triangle::Triangle;

use super::Accel;
use crate::backend::{Buffer, Device, DeviceError};

/// What traversal reads, on a device.
pub(crate) enum Resident {
    Brute { triangles: Buffer<Triangle> },
    Kd { nodes: Buffer<kdtree::Node>, references: Buffer<u32>, triangles: Buffer<Triangle>, low: Vec3, high: Vec3 },
    Bvh { nodes: Buffer<bvh2::Node>, triangles: Buffer<Triangle> },
    Bvh4 { nodes: Buffer<bvh4::Node>, triangles: Buffer<Triangle> },
    Bvh8 { nodes: Buffer<bvh8::Node>, triangles: Buffer<Triangle> },
    Bvh8w { nodes: Buffer<bvh8w::Node>, triangles: Buffer<Triangle> },
    Bvh8f { nodes: Buffer<bvh8f::Node>, blocks: Buffer<bvh8f::Block> },
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
            $crate::accel::Resident::Bvh4 { nodes, triangles } => {
                let $structure = raywarp_kernels::traverse::Bvh4 { nodes: nodes.view(), triangles: triangles.view() };
                $body
            }
            $crate::accel::Resident::Bvh8 { nodes, triangles } => {
                let $structure = raywarp_kernels::traverse::Bvh8 { nodes: nodes.view(), triangles: triangles.view() };
                $body
            }
            $crate::accel::Resident::Bvh8w { nodes, triangles } => {
                let $structure = raywarp_kernels::traverse::Bvh8w { nodes: nodes.view(), triangles: triangles.view() };
                $body
            }
            $crate::accel::Resident::Bvh8f { nodes, blocks } => {
                let $structure = raywarp_kernels::traverse::Bvh8f { nodes: nodes.view(), blocks: blocks.view() };
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
            Accel::Bvh4(tree) => {
                Self::Bvh4 { nodes: device.upload(&tree.nodes)?, triangles: device.upload(&tree.triangles)? }
            }
            Accel::Bvh8(tree) => {
                Self::Bvh8 { nodes: device.upload(&tree.nodes)?, triangles: device.upload(&tree.triangles)? }
            }
            Accel::Bvh8w(tree) => {
                Self::Bvh8w { nodes: device.upload(&tree.nodes)?, triangles: device.upload(&tree.triangles)? }
            }
            Accel::Bvh8f(tree) => {
                Self::Bvh8f { nodes: device.upload(&tree.nodes)?, blocks: device.upload(&tree.blocks)? }
            }
        })
    }
}
