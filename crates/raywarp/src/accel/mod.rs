//! Building what finds the triangles along a ray.
//!
//! The way of a triangle: [`drop_degenerate`] drops what can never be hit, [`Accel::build`] picks a builder ([`brute`] keeps the
//! list, [`kdtree_median`] builds a [`kdtree`], [`bvh2_build`] a [`bvh2`], of which [`bvh2_quantized`], [`bvh2_dual`] and [`bvh8f`] are other
//! layouts), [`Accel::validate`] proves that traversal will neither miss a triangle nor leave the
//! arrays, [`Accel::stats`] says how good the tree is.
//!
//! Where meshes are placed many times, [`two_level`] keeps each once, with a tree over the placements.
//!
//! A fast [`bvh2`] is built by [`hploc`], on a device or here. One of quality goes through a binary tree with one triangle a leaf: built from the top, with spatial splits
//! where they pay, made better by reinsertion, and collapsed.
//!
//! The structures are those of [`traversal`], owned by the host. Traced on the CPU or copied to a
//! device as they are ([`Resident`]), they give the same hits: those of brute force. Structures of others join by the same trait.

mod binary;
mod bins;
#[doc(hidden)]
pub mod bounds;
#[doc(hidden)]
pub mod boxes;
pub mod brute;
pub mod bvh2;
pub mod bvh2_build;
pub mod bvh2_dual;
pub mod bvh2_quantized;
pub mod bvh8f;
pub mod cache;
#[doc(hidden)]
pub mod clip;
#[doc(hidden)]
pub mod collapse;
mod cover;
mod error;
pub mod hploc;
pub mod kdtree;
#[doc(hidden)]
pub mod kdtree_arrays;
pub mod kdtree_median;
mod kind;
mod leaves;
mod refitting;
mod reinsertion;
mod resident;
mod resident_instances;
mod spatial;
mod stats;
mod topdown;
mod triangles;
pub mod two_level;
mod view;
#[doc(hidden)]
pub mod wide;

use std::borrow::Cow;

use raywarp_core::ray::{Hit, Ray};
use raywarp_core::traversal::{closest, occlusion, Counter, Occlusion};
use raywarp_core::triangle::Triangle;

pub use crate::scene::settings::{AccelKind, Quality, UnknownKind, UnknownQuality};
pub use boxes::{TreeBox, MAX_BOXES};
pub use error::{BuildError, Invalid};
pub(crate) use kind::{check_device, check_instances};
pub use kind::{fastest_on, Build};
#[doc(no_inline)]
pub use raywarp_core::traversal;
pub(crate) use refitting::{Movable, Refitting};
pub use resident::{
    Rendered, Resident, ResidentBrute, ResidentBvh2, ResidentBvh8f, ResidentDual, ResidentKd, ResidentTwoLevel,
};
pub use resident_instances::{ResidentKdTrees, ResidentLists};
pub use stats::{TreeStats, NODE_COST, TRIANGLE_COST};
#[doc(hidden)]
pub use triangles::is_finite;
pub use triangles::{drop_degenerate, Dropped, Unhittable};
pub use view::Borrowed;

/// A structure that holds the triangles of a scene, whichever it is.
#[derive(Clone, Debug)]
pub enum Accel {
    /// No structure.
    Brute(brute::Brute),
    /// The paper's k-d tree.
    Kd(kdtree::KdTree),
    /// A binary hierarchy of boxes.
    Bvh2(bvh2::Bvh2),
    /// The same in nodes of two sizes.
    Bvh(bvh2_dual::DualBvh2),
    /// Eight boxes a node in full precision.
    Bvh8f(bvh8f::Bvh8f),
}

impl Accel {
    /// Arranges triangles. Those that [`drop_degenerate`] would drop are never hit, but would make the tree worse.
    ///
    /// # Errors
    /// More triangles than an index of the structure can tell apart.
    pub fn build(what: impl Into<Build>, triangles: Vec<Triangle>) -> Result<Self, BuildError> {
        let Build { kind, quality, .. } = what.into();
        match kind {
            AccelKind::Brute => Ok(Self::Brute(brute::Brute::new(triangles)?)),
            AccelKind::Kd => Ok(Self::Kd(kdtree_median::build(triangles)?)),
            _ => Self::laid_out(kind, bvh2_build::build(triangles, quality)?),
        }
    }

    /// A hierarchy of boxes in the layout of `kind`; for kinds that are none, as it is.
    ///
    /// # Errors
    /// More triangles than an index of the layout can tell apart.
    pub fn laid_out(kind: AccelKind, tree: bvh2::Bvh2) -> Result<Self, BuildError> {
        Ok(match kind {
            AccelKind::Bvh => Self::Bvh(bvh2_dual::DualBvh2::new(tree)),
            AccelKind::Bvh8f => Self::Bvh8f(bvh8f::Bvh8f::from_bvh2(&tree)?),
            AccelKind::Brute | AccelKind::Kd | AccelKind::Bvh2 => Self::Bvh2(tree),
        })
    }

    /// Which structure this is.
    pub fn kind(&self) -> AccelKind {
        match self {
            Self::Brute(_) => AccelKind::Brute,
            Self::Kd(_) => AccelKind::Kd,
            Self::Bvh2(_) => AccelKind::Bvh2,
            Self::Bvh(_) => AccelKind::Bvh,
            Self::Bvh8f(_) => AccelKind::Bvh8f,
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
            Self::Bvh2(tree) => tree.validate(),
            Self::Bvh(tree) => tree.validate(),
            Self::Bvh8f(tree) => tree.validate(),
        }
    }

    /// Size and quality.
    pub fn stats(&self) -> TreeStats {
        match self {
            Self::Brute(list) => list.stats(),
            Self::Kd(tree) => tree.stats(),
            Self::Bvh2(tree) => tree.stats(),
            Self::Bvh(tree) => tree.stats(),
            Self::Bvh8f(tree) => tree.stats(),
        }
    }

    /// The triangles, in the structure's order: not a list of the scene's. A hierarchy of boxes of high quality repeats
    /// those that spatial splits put in several leaves, see [`TreeStats::duplicates`], and an empty scene may have one
    /// here that no ray hits.
    pub fn triangles(&self) -> Cow<'_, [Triangle]> {
        match self {
            Self::Brute(list) => list.triangles().into(),
            Self::Kd(tree) => tree.triangles().into(),
            Self::Bvh2(tree) => tree.triangles().into(),
            Self::Bvh(tree) => tree.triangles().into(),
            Self::Bvh8f(tree) => tree.triangles().into(),
        }
    }

    /// [`traversal::closest`] on this machine.
    pub fn closest(&self, ray: &Ray, previous: &Hit, counter: &mut impl Counter) -> Hit {
        match self {
            Self::Brute(list) => closest(&list.view(), ray, previous, counter),
            Self::Kd(tree) => closest(&tree.view(), ray, previous, counter),
            Self::Bvh2(tree) => closest(&tree.view(), ray, previous, counter),
            Self::Bvh(tree) => closest(&tree.view(), ray, previous, counter),
            Self::Bvh8f(tree) => closest(&tree.view(), ray, previous, counter),
        }
    }

    /// [`traversal::occlusion`] on this machine.
    pub fn occlusion(&self, ray: &Ray, counter: &mut impl Counter) -> Occlusion {
        match self {
            Self::Brute(list) => occlusion(&list.view(), ray, counter),
            Self::Kd(tree) => occlusion(&tree.view(), ray, counter),
            Self::Bvh2(tree) => occlusion(&tree.view(), ray, counter),
            Self::Bvh(tree) => occlusion(&tree.view(), ray, counter),
            Self::Bvh8f(tree) => occlusion(&tree.view(), ray, counter),
        }
    }
}
