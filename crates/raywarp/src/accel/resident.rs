//! A structure in the memory of a device.

use raywarp_kernels::math::Vec3;
use raywarp_kernels::traverse::{self, bvh2, bvh4, bvh8, bvh8f, bvh8w, compact, kdtree};
use raywarp_kernels::triangle::Triangle;

use super::instanced::Instanced;
use super::kdtree::KdTree;
use super::Accel;
use crate::backend::{Buffer, Device, DeviceError};

/// What traversal reads, on a device.
pub(crate) enum Resident {
    Brute {
        triangles: Buffer<Triangle>,
    },
    Staged {
        triangles: Buffer<Triangle>,
    },
    Kd(ResidentKd),
    KdTrail(ResidentKd),
    Bvh2 {
        nodes: Buffer<bvh2::Node>,
        triangles: Buffer<Triangle>,
        reach: Vec3,
    },
    Bvh2c {
        nodes: Buffer<compact::Node>,
        triangles: Buffer<Triangle>,
        grid: compact::Grid,
    },
    Bvh {
        full: Buffer<bvh2::Node>,
        small: Buffer<compact::Node>,
        triangles: Buffer<Triangle>,
        reach: Vec3,
        grid: compact::Grid,
    },
    Bvh4 {
        nodes: Buffer<bvh4::Node>,
        triangles: Buffer<Triangle>,
    },
    Bvh8 {
        nodes: Buffer<bvh8::Node>,
        triangles: Buffer<Triangle>,
    },
    Bvh8w {
        nodes: Buffer<bvh8w::Node>,
        triangles: Buffer<Triangle>,
    },
    Bvh8f {
        nodes: Buffer<bvh8f::Node>,
        blocks: Buffer<bvh8f::Block>,
    },
}

/// Evaluates an expression with the structure's view under a name, once for each kind. `both` says how a tree in two
/// layouts is traversed: as [`Octants`](raywarp_kernels::traverse::Octants), which is a long kernel, or by its small nodes.
/// Queries may also ask a [pool](raywarp_kernels::pool).
macro_rules! with_structure {
    ($resident:expr, $structure:ident => $body:expr) => {
        $crate::accel::with_structure!($resident, $structure, both => both, $body)
    };
    ($resident:expr, $structure:ident, $both:ident => $view:expr, $body:expr) => {
        match $resident {
            $crate::accel::Resident::Brute { triangles } => {
                let $structure = raywarp_kernels::traverse::Brute { triangles: triangles.view() };
                $body
            }
            $crate::accel::Resident::Staged { triangles } => {
                let $structure = raywarp_kernels::traverse::Staged { triangles: triangles.view() };
                $body
            }
            $crate::accel::Resident::Kd(tree) => {
                let $structure = tree.view();
                $body
            }
            $crate::accel::Resident::KdTrail(tree) => {
                let $structure = raywarp_kernels::traverse::KdTrail { tree: tree.view() };
                $body
            }
            $crate::accel::Resident::Bvh2 { nodes, triangles, reach } => {
                let (nodes, triangles) = (nodes.view(), triangles.view());
                let $structure = raywarp_kernels::traverse::Bvh2 { nodes, triangles, reach: *reach };
                $body
            }
            $crate::accel::Resident::Bvh2c { nodes, triangles, grid } => {
                let (nodes, triangles) = (nodes.view(), triangles.view());
                let $structure = raywarp_kernels::traverse::Compact { nodes, triangles, grid: *grid };
                $body
            }
            $crate::accel::Resident::Bvh { full, small, triangles, reach, grid } => {
                let triangles = triangles.view();
                let $both = raywarp_kernels::traverse::Octants {
                    full: raywarp_kernels::traverse::Bvh2 { nodes: full.view(), triangles, reach: *reach },
                    compact: raywarp_kernels::traverse::Compact { nodes: small.view(), triangles, grid: *grid },
                };
                let $structure = $view;
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
            Accel::Staged(list) => Self::Staged { triangles: device.upload(&list.triangles)? },
            Accel::Kd(tree) | Accel::KdSah(tree) => Self::Kd(ResidentKd::upload(device, tree)?),
            Accel::KdTrail(tree) => Self::KdTrail(ResidentKd::upload(device, tree)?),
            Accel::Bvh2(tree) => Self::Bvh2 {
                nodes: device.upload(&tree.nodes)?,
                triangles: device.upload(&tree.triangles)?,
                reach: tree.reach(),
            },
            Accel::Bvh2c(tree) => Self::Bvh2c {
                nodes: device.upload(&tree.nodes)?,
                triangles: device.upload(&tree.triangles)?,
                grid: tree.grid,
            },
            Accel::Bvh(tree) => Self::Bvh {
                full: device.upload(&tree.full.nodes)?,
                small: device.upload(&tree.nodes)?,
                triangles: device.upload(tree.triangles())?,
                reach: tree.full.reach(),
                grid: tree.grid,
            },
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

/// A k-d tree on a device, however it is traversed.
pub(crate) struct ResidentKd {
    pub nodes: Buffer<kdtree::Node>,
    references: Buffer<u32>,
    triangles: Buffer<Triangle>,
    /// Low and high corner of everything.
    pub bounds: [Vec3; 2],
}

impl ResidentKd {
    fn upload(device: &Device, tree: &KdTree) -> Result<Self, DeviceError> {
        Ok(Self {
            nodes: device.upload(&tree.nodes)?,
            references: device.upload(&tree.references)?,
            triangles: device.upload(&tree.triangles)?,
            bounds: tree.bounds(),
        })
    }

    pub fn view(&self) -> traverse::KdTree {
        let [low, high] = self.bounds;
        traverse::KdTree {
            nodes: self.nodes.view(),
            references: self.references.view(),
            triangles: self.triangles.view(),
            low,
            high,
        }
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
        $crate::accel::with_any_structure!($resident, $structure, both => both, $body)
    };
    ($resident:expr, $structure:ident, $both:ident => $view:expr, $body:expr) => {
        match $resident {
            $crate::accel::AnyResident::One(resident) => {
                $crate::accel::with_structure!(resident, $structure, $both => $view, $body)
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
