//! Building what finds the triangles along a ray.
//!
//! The way of a triangle: [`sift`] drops what can never be hit, [`Accel::build`] picks a builder ([`brute`] keeps the
//! list, [`kdtree_median`] builds a [`kdtree`], [`bvh2_build`] a [`bvh2`]), [`Accel::validate`] proves that traversal
//! will neither miss a triangle nor leave the arrays, [`Accel::stats`] says how good the tree is.
//!
//! A [`bvh2`] of quality goes through a binary tree with one triangle a leaf: built from the top, with spatial splits
//! where they pay, made better by reinsertion, and collapsed.
//!
//! The structures are those of [`raywarp_kernels::traverse`], owned by the host. Traced on the CPU or copied to a
//! device as they are, they give the same hits: those of brute force.

mod binary;
mod bins;
mod bounds;
pub mod brute;
pub mod bvh2;
pub mod bvh2_binned;
pub mod bvh2_build;
pub mod cache;
mod clip;
mod collapse;
mod cover;
mod error;
pub mod kdtree;
pub mod kdtree_median;
mod kind;
mod quality;
mod reinsertion;
mod resident;
mod spatial;
mod stats;
mod topdown;
mod triangles;
mod view;

use raywarp_kernels::ray::{Hit, Ray};
use raywarp_kernels::traverse::{closest, occlusion, Counter, Occlusion};
use raywarp_kernels::triangle::Triangle;

pub use error::{BuildError, Invalid};
pub use kind::{AccelKind, UnknownKind};
pub use quality::{Build, Quality, UnknownQuality};
pub(crate) use resident::{with_structure, Resident};
pub use stats::{TreeStats, NODE_COST, TRIANGLE_COST};
pub use triangles::{sift, Dropped};
pub use view::Borrowed;

/// A structure that holds the triangles of a scene, whichever it is.
#[derive(Clone, Debug)]
pub enum Accel {
    /// No structure.
    Brute(brute::Brute),
    /// The paper's k-d tree.
    Kd(kdtree::KdTree),
    /// A binary hierarchy of boxes.
    Bvh(bvh2::Bvh2),
}

impl Accel {
    /// Arranges triangles. Those that [`sift`] would drop are never hit, but would make the tree worse.
    ///
    /// # Errors
    /// More triangles than an index of the structure can tell apart.
    pub fn build(what: impl Into<Build>, triangles: Vec<Triangle>) -> Result<Self, BuildError> {
        let Build { kind, quality } = what.into();
        Ok(match kind {
            AccelKind::Brute => Self::Brute(brute::Brute::new(triangles)?),
            AccelKind::Kd => Self::Kd(kdtree_median::build(triangles)?),
            AccelKind::Bvh => Self::Bvh(bvh2_build::build(triangles, quality)?),
        })
    }

    /// Which structure this is.
    pub fn kind(&self) -> AccelKind {
        match self {
            Self::Brute(_) => AccelKind::Brute,
            Self::Kd(_) => AccelKind::Kd,
            Self::Bvh(_) => AccelKind::Bvh,
        }
    }

    /// Whether a traversal ends, stays within the arrays and meets every triangle that a ray may hit.
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Brute(_) => Ok(()),
            Self::Kd(tree) => tree.validate(),
            Self::Bvh(tree) => tree.validate(),
        }
    }

    /// Size and quality.
    pub fn stats(&self) -> TreeStats {
        match self {
            Self::Brute(list) => list.stats(),
            Self::Kd(tree) => tree.stats(),
            Self::Bvh(tree) => tree.stats(),
        }
    }

    /// The triangles, in the structure's order: not a list of the scene's. A hierarchy of boxes of high quality repeats
    /// those that spatial splits put in several leaves, see [`TreeStats::duplicates`], and an empty scene may have one
    /// here that no ray hits.
    pub fn triangles(&self) -> &[Triangle] {
        match self {
            Self::Brute(list) => list.triangles(),
            Self::Kd(tree) => tree.triangles(),
            Self::Bvh(tree) => tree.triangles(),
        }
    }

    /// [`raywarp_kernels::traverse::closest`] on this machine.
    pub fn closest(&self, ray: &Ray, previous: &Hit, counter: &mut impl Counter) -> Hit {
        match self {
            Self::Brute(list) => closest(&list.view(), ray, previous, counter),
            Self::Kd(tree) => closest(&tree.view(), ray, previous, counter),
            Self::Bvh(tree) => closest(&tree.view(), ray, previous, counter),
        }
    }

    /// [`raywarp_kernels::traverse::occlusion`] on this machine.
    pub fn occlusion(&self, ray: &Ray, counter: &mut impl Counter) -> Occlusion {
        match self {
            Self::Brute(list) => occlusion(&list.view(), ray, counter),
            Self::Kd(tree) => occlusion(&tree.view(), ray, counter),
            Self::Bvh(tree) => occlusion(&tree.view(), ray, counter),
        }
    }
}
