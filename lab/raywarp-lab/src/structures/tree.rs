//! A structure over triangles, whichever it is.

use std::borrow::Cow;

use raywarp::accel::brute::Brute;
use raywarp::accel::bvh2::Bvh2;
use raywarp::accel::bvh2_quantized::QuantizedBvh2;
use raywarp::accel::kdtree::KdTree;
use raywarp::accel::{
    self, boxes, bvh2_build, Accel, Borrowed, BuildError, Invalid, Quality, ResidentBrute, ResidentKd, TreeBox,
    TreeStats,
};
use raywarp::device::{Device, DeviceError};
use raywarp::device_scene::{SceneError, Structure};
use raywarp::query::{sampled, RayCaster, Tests};
use raywarp::{Hit, Ray, Triangle};
use raywarp_core::traversal::{closest, occlusion, Counter, Occlusion, START};
use raywarp_core::view::Plain;
use raywarp_lab_core::structures as kernels;

use super::resident::{ResidentQuantized, ResidentStaged, ResidentTrail, ResidentWide};
use super::{bvh4, bvh8, bvh8w, kdtree_sah, lend, Build, StructureKind};

/// A structure on this machine.
#[derive(Clone, Debug)]
pub enum Tree {
    /// One that raywarp renders with.
    Product(Accel),
    /// Every triangle, staged.
    Staged(Brute),
    /// The k-d tree of the surface area heuristic, traversed by a stack.
    KdSah(KdTree),
    /// The same tree, traversed by restarts.
    KdTrail(KdTree),
    /// Two boxes a node, on a grid.
    Bvh2c(QuantizedBvh2),
    /// Four boxes a node, quantised.
    Bvh4(bvh4::Bvh4),
    /// Eight boxes a node, compressed.
    Bvh8(bvh8::Bvh8),
    /// Eight boxes a node, quantised, with a link each.
    Bvh8w(bvh8w::Bvh8w),
}

/// A k-d tree for tracing on this machine, by restarts.
pub fn trail(tree: &KdTree) -> Borrowed<'_, kernels::KdTrail> {
    // SAFETY: the view goes no further than into the one that is returned, which borrows the tree.
    unsafe { Borrowed::of(kernels::KdTrail { tree: tree.view().get() }) }
}

fn staged(list: &Brute) -> Borrowed<'_, kernels::Staged> {
    // SAFETY: the list is borrowed as long.
    unsafe { Borrowed::of(kernels::Staged { triangles: lend(list.triangles()) }) }
}

/// Evaluates an expression with what traverses a tree on this machine, but for those of the product.
macro_rules! with_view {
    ($tree:expr, $accel:ident => $of_product:expr, $view:ident => $body:expr) => {
        match $tree {
            Tree::Product($accel) => $of_product,
            Tree::Staged(list) => {
                let $view = &staged(list);
                $body
            }
            Tree::KdSah(tree) => {
                let $view = &tree.view();
                $body
            }
            Tree::KdTrail(tree) => {
                let $view = &trail(tree);
                $body
            }
            Tree::Bvh2c(tree) => {
                let $view = &tree.view();
                $body
            }
            Tree::Bvh4(tree) => {
                let $view = &tree.view();
                $body
            }
            Tree::Bvh8(tree) => {
                let $view = &tree.view();
                $body
            }
            Tree::Bvh8w(tree) => {
                let $view = &tree.view();
                $body
            }
        }
    };
}

impl Tree {
    /// Arranges triangles.
    ///
    /// # Errors
    /// More triangles than an index of the structure can tell apart.
    pub fn build(what: impl Into<Build>, triangles: Vec<Triangle>) -> Result<Self, BuildError> {
        let Build { kind, quality } = what.into();
        let binary = |triangles| bvh2_build::build(triangles, quality);
        Ok(match kind {
            StructureKind::Product(kind) => {
                Self::Product(Accel::build(accel::Build { kind, quality, cached: false }, triangles)?)
            }
            StructureKind::Staged => Self::Staged(Brute::new(triangles)?),
            StructureKind::KdSah => Self::KdSah(kdtree_sah::build(triangles)?),
            StructureKind::KdTrail => Self::KdTrail(kdtree_sah::build(triangles)?),
            StructureKind::Bvh2c => Self::Bvh2c(QuantizedBvh2::new(binary(triangles)?)),
            StructureKind::Bvh4 => Self::Bvh4(bvh4::Bvh4::from_bvh2(&binary(triangles)?)),
            StructureKind::Bvh8 => Self::Bvh8(bvh8::Bvh8::from_bvh2(&binary(triangles)?)),
            StructureKind::Bvh8w => Self::Bvh8w(bvh8w::Bvh8w::from_bvh2(&binary(triangles)?)),
        })
    }

    /// A hierarchy of boxes in the layout of `kind`; for kinds that are none, as it is.
    ///
    /// # Errors
    /// More triangles than an index of the layout can tell apart.
    pub fn laid_out(kind: StructureKind, tree: Bvh2) -> Result<Self, BuildError> {
        Ok(match kind {
            StructureKind::Product(kind) => Self::Product(Accel::laid_out(kind, tree)?),
            StructureKind::Bvh2c => Self::Bvh2c(QuantizedBvh2::new(tree)),
            StructureKind::Bvh4 => Self::Bvh4(bvh4::Bvh4::from_bvh2(&tree)),
            StructureKind::Bvh8 => Self::Bvh8(bvh8::Bvh8::from_bvh2(&tree)),
            StructureKind::Bvh8w => Self::Bvh8w(bvh8w::Bvh8w::from_bvh2(&tree)),
            StructureKind::Staged | StructureKind::KdSah | StructureKind::KdTrail => Self::Product(Accel::Bvh2(tree)),
        })
    }

    /// Which structure this is.
    pub fn kind(&self) -> StructureKind {
        match self {
            Self::Product(accel) => StructureKind::Product(accel.kind()),
            Self::Staged(_) => StructureKind::Staged,
            Self::KdSah(_) => StructureKind::KdSah,
            Self::KdTrail(_) => StructureKind::KdTrail,
            Self::Bvh2c(_) => StructureKind::Bvh2c,
            Self::Bvh4(_) => StructureKind::Bvh4,
            Self::Bvh8(_) => StructureKind::Bvh8,
            Self::Bvh8w(_) => StructureKind::Bvh8w,
        }
    }

    /// See [`Accel::validate`].
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Product(accel) => accel.validate(),
            Self::Staged(_) => Ok(()),
            Self::KdSah(tree) | Self::KdTrail(tree) => tree.validate(),
            Self::Bvh2c(tree) => tree.validate(),
            Self::Bvh4(tree) => tree.validate(),
            Self::Bvh8(tree) => tree.validate(),
            Self::Bvh8w(tree) => tree.validate(),
        }
    }

    /// Size and quality.
    pub fn stats(&self) -> TreeStats {
        match self {
            Self::Product(accel) => accel.stats(),
            Self::Staged(list) => list.stats(),
            Self::KdSah(tree) | Self::KdTrail(tree) => tree.stats(),
            Self::Bvh2c(tree) => tree.stats(),
            Self::Bvh4(tree) => tree.stats(),
            Self::Bvh8(tree) => tree.stats(),
            Self::Bvh8w(tree) => tree.stats(),
        }
    }

    /// See [`Accel::triangles`].
    pub fn triangles(&self) -> Cow<'_, [Triangle]> {
        match self {
            Self::Product(accel) => accel.triangles(),
            Self::Staged(list) => list.triangles().into(),
            Self::KdSah(tree) | Self::KdTrail(tree) => tree.triangles().into(),
            Self::Bvh2c(tree) => tree.triangles().into(),
            Self::Bvh4(tree) => tree.triangles().into(),
            Self::Bvh8(tree) => tree.triangles().into(),
            Self::Bvh8w(tree) => tree.triangles().into(),
        }
    }

    /// See [`Accel::boxes`].
    pub fn boxes(&self, level: u32) -> Vec<TreeBox> {
        match self {
            Self::Product(accel) => accel.boxes(level),
            Self::Staged(list) => boxes::of_list(list.triangles(), level),
            Self::KdSah(tree) | Self::KdTrail(tree) => boxes::of_cells(tree.nodes(), tree.bounds(), level),
            Self::Bvh2c(tree) => boxes::of_compact(tree.nodes(), tree.grid(), level),
            Self::Bvh4(tree) => boxes::of_wide(tree.nodes(), level, bvh4::told),
            Self::Bvh8(tree) => boxes::of_wide(tree.nodes(), level, |node| bvh8::told(node).unwrap_or_default()),
            Self::Bvh8w(tree) => boxes::of_wide(tree.nodes(), level, bvh8w::told),
        }
    }

    /// [`raywarp_core::traversal::closest`] on this machine.
    pub fn closest(&self, ray: &Ray, previous: &Hit, counter: &mut impl Counter) -> Hit {
        with_view!(self, accel => accel.closest(ray, previous, counter), view => closest(view, ray, previous, counter))
    }

    /// [`raywarp_core::traversal::occlusion`] on this machine.
    pub fn occlusion(&self, ray: &Ray, counter: &mut impl Counter) -> Occlusion {
        with_view!(self, accel => accel.occlusion(ray, counter), view => occlusion(view, ray, counter))
    }

    /// Nodes and triangles of a sample of rays, see [`raywarp::query::tests`].
    pub fn tests(&self, rays: &[Ray], any_hit: bool, most: usize) -> Vec<Tests> {
        sampled(rays, most, |ray, tests| match any_hit {
            true => drop(self.occlusion(ray, tests)),
            false => drop(self.closest(ray, &START, tests)),
        })
    }

    /// On a device, to be asked about rays.
    ///
    /// # Errors
    /// The device has no room for it, or no kernels.
    pub fn caster(&self, device: &Device) -> Result<RayCaster, SceneError> {
        Ok(RayCaster::of_structure(self.structure(Quality::default(), device)?, device))
    }

    /// On a device, for pictures; what a tracer of that device is to trace.
    ///
    /// # Errors
    /// The device has no room for it, or no kernels.
    pub fn structure(&self, quality: Quality, device: &Device) -> Result<Structure, SceneError> {
        let stats = self.stats();
        device.reserve(stats.bytes as u64, "the structure")?;
        // SAFETY: each is uploaded to this very device, of which the tracer is.
        unsafe {
            Ok(match self {
                Self::Product(accel) => Structure::of(accel, quality, device)?,
                Self::Staged(list) => Structure::of_resident(staged_on(device, list)?, quality, stats),
                Self::KdSah(tree) => Structure::of_resident(ResidentKd::upload(device, tree)?, quality, stats),
                Self::KdTrail(tree) => Structure::of_resident(trail_on(device, tree)?, quality, stats),
                Self::Bvh2c(tree) => Structure::of_resident(ResidentQuantized::upload(device, tree)?, quality, stats),
                Self::Bvh4(tree) => {
                    Structure::of_resident(wide(device, tree.nodes(), tree.triangles())?, quality, stats)
                }
                Self::Bvh8(tree) => {
                    Structure::of_resident(wide(device, tree.nodes(), tree.triangles())?, quality, stats)
                }
                Self::Bvh8w(tree) => {
                    Structure::of_resident(wide(device, tree.nodes(), tree.triangles())?, quality, stats)
                }
            })
        }
    }
}

fn staged_on(device: &Device, list: &Brute) -> Result<ResidentStaged, DeviceError> {
    ResidentBrute::upload(device, list).map(ResidentStaged)
}

fn trail_on(device: &Device, tree: &KdTree) -> Result<ResidentTrail, DeviceError> {
    ResidentKd::upload(device, tree).map(ResidentTrail)
}

fn wide<N: Plain>(device: &Device, nodes: &[N], triangles: &[Triangle]) -> Result<ResidentWide<N>, DeviceError> {
    ResidentWide::upload(device, nodes, triangles)
}
