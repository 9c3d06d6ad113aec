//! Two levels: meshes with a tree each, and a tree over their placements.
//!
//! The way of a mesh: [`build`] bakes what gains nothing from being shared (`bake`), builds one tree for each mesh that
//! is left, works out each instance's inverse and its box with what rounding can do to it (`place`), arranges those boxes
//! (`upper`), and `join`s all trees in one array. What comes out answers as the same scene brought to world space would,
//! primitive by primitive, but for the rounding of a transform: see [`raywarp_core::traversal::two_level`].

mod bake;
mod build;
mod join;
mod place;
mod upper;
mod upper_tree;
mod validate;

use std::ops::Range;

use raywarp_core::ray::{Hit, Ray};
use raywarp_core::traversal;
use raywarp_core::traversal::bvh2::Node;
use raywarp_core::traversal::two_level::Instance;
use raywarp_core::traversal::{closest, occlusion, Counter, Occlusion};
use raywarp_core::triangle::Triangle;

use super::kdtree::KdTree;
use super::view::{lend, Borrowed};
use super::{kdtree_median, BuildError, Dropped, TreeStats};
use crate::scene::Transform;

pub use build::{build, Plan};
pub(crate) use upper_tree::UpperTree;

/// A mesh put into the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Index of the mesh.
    pub mesh: usize,
    /// Mesh space to world space.
    pub transform: Transform,
    /// Index of the instance in the scene, below 2^32 - 1.
    pub instance: u32,
    /// [`raywarp_core::triangle::flags`] of every triangle, in place of the mesh's own.
    pub flags: Option<u32>,
}

/// The trees.
#[derive(Clone, Debug)]
pub struct TwoLevel {
    pub(crate) nodes: Vec<Node>,
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) instances: Vec<Instance>,
    pub(crate) slack: f32,
    /// Of the meshes' trees, in their order in the arrays.
    parts: Vec<Part>,
    stats: InstancedStats,
}

/// Where the tree of a mesh lies: from here to where the next begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part {
    /// First node, the root.
    node: u32,
    /// First triangle.
    triangle: u32,
}

/// What there is, and what it takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct InstancedStats {
    /// Placements that the upper tree holds. All baked ones are one instance.
    pub instances: usize,
    /// Placements that were brought to world space.
    pub baked: usize,
    /// Trees below the upper one.
    pub meshes: usize,
    /// Triangles in memory.
    pub triangles: usize,
    /// Triangles in the world: those of every placement.
    pub seen: u64,
    /// Triangles of the world that no ray can hit.
    pub dropped: Dropped,
    /// Inner nodes on the longest way through the upper tree.
    pub upper_depth: usize,
    /// Memory of all arrays that traversal reads.
    pub bytes: usize,
    /// Time that the build took.
    pub build_seconds: f64,
}

impl TwoLevel {
    /// Inner nodes of all trees; 0 is the root of the upper one.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// How many of them are the upper tree's: the first.
    pub(crate) fn upper_nodes(&self) -> usize {
        self.parts.first().map_or(0, |part| part.node as usize)
    }

    /// Which of the meshes' trees an instance is of.
    pub(crate) fn part_of(&self, instance: &Instance) -> u32 {
        self.parts.partition_point(|part| part.node < instance.root.index()) as u32
    }

    /// The paper's tree over each mesh.
    pub(crate) fn kd_trees(&self) -> Result<Vec<KdTree>, BuildError> {
        self.meshes().map(|mesh| kdtree_median::build(self.triangles[mesh].to_vec())).collect()
    }

    /// The triangles of each mesh, in the order of its leaves.
    pub(crate) fn meshes(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let first = |part: &Part| part.triangle as usize;
        let ends = self.parts.iter().skip(1).map(first).chain([self.triangles.len()]);
        self.parts.iter().zip(ends).map(move |(part, end)| first(part)..end)
    }

    /// Of all meshes, in the order of the leaves.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// Placed meshes, in the order in which they were given; the baked ones are the first.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// Size of it all.
    pub fn stats(&self) -> InstancedStats {
        self.stats
    }

    /// Size and quality as of one tree: a ray goes on from an instance's leaf to the mesh's tree.
    pub fn tree_stats(&self) -> TreeStats {
        let mesh = |part: &Part| {
            let mut stats = TreeStats::default();
            stats.add_nodes(&self.nodes, part.node, |stats, leaf, _, area| stats.leaf(leaf.count() as usize, area));
            stats
        };
        let meshes: Vec<TreeStats> = self.parts.iter().map(mesh).collect();
        let mut all = TreeStats {
            nodes: self.nodes.len(),
            leaves: meshes.iter().map(|mesh| mesh.leaves).sum(),
            references: self.triangles.len(),
            largest_leaf: meshes.iter().map(|mesh| mesh.largest_leaf).max().unwrap_or(0),
            bytes: self.stats.bytes,
            build_seconds: self.stats.build_seconds,
            ..TreeStats::default()
        };
        all.add_nodes(&self.nodes, 0, |all, leaf, above, area| {
            let instance = self.instances.get(leaf.index() as usize);
            let Some(mesh) = instance.and_then(|instance| meshes.get(self.part_of(instance) as usize)) else { return };
            all.depth = all.depth.max(above + mesh.depth);
            all.sah_cost += area * mesh.sah_cost;
        });
        all
    }

    /// For tracing on this machine.
    pub fn view(&self) -> Borrowed<'_, traversal::TwoLevel> {
        Borrowed::new(traversal::TwoLevel {
            nodes: lend(&self.nodes),
            triangles: lend(&self.triangles),
            instances: lend(&self.instances),
            slack: self.slack,
        })
    }

    /// [`raywarp_core::traversal::closest`] on this machine.
    pub fn closest(&self, ray: &Ray, previous: &Hit, counter: &mut impl Counter) -> Hit {
        closest(&self.view(), ray, previous, counter)
    }

    /// [`raywarp_core::traversal::occlusion`] on this machine.
    pub fn occlusion(&self, ray: &Ray, counter: &mut impl Counter) -> Occlusion {
        occlusion(&self.view(), ray, counter)
    }
}
