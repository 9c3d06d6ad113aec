//! Builds a binary hierarchy of boxes where it will be traced: [H-PLOC](raywarp_core::build), on every device alike.
//!
//! The same kernels run on a GPU and on the CPU, and give the same nodes and the same order of triangles to the bit.

mod device_tree;
mod launches;
mod scratch;

use raywarp_core::build::bounds::Bounds;
use raywarp_core::build::node::Node;
use raywarp_core::build::survey::Findings;
use raywarp_core::traversal::bvh2::{MAX_DEPTH, MAX_INDEX};

use super::{bvh2_build, BuildError, Dropped, Quality, TreeStats};
use crate::device::{Buffer, Device};
use crate::Triangle;
pub use device_tree::DeviceTree;
use scratch::Scratch;

/// Builds trees over triangles on a device, one after the other in the same memory.
///
/// ```
/// use raywarp::accel::hploc::{NodeSizes, TreeBuilder};
/// use raywarp::device::{Device, DeviceChoice};
/// use raywarp::{Triangle, Vec3};
///
/// let device = Device::open(DeviceChoice::Auto)?;
/// let corner = |x, y| Vec3::new(x, y, 0.0);
/// let at = |i: u32| Triangle::new(corner(i as f32, 0.0), corner(i as f32 + 1.0, 0.0), corner(i as f32, 1.0), i, 0);
/// let triangles = device.upload(&(0..1000).map(at).collect::<Vec<_>>())?;
///
/// let mut builder = TreeBuilder::new(&device, 1000)?;
/// let built = builder.build(&triangles, NodeSizes::Both)?;
/// assert_eq!(built.tree.triangles().len(), 1000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct TreeBuilder {
    device: Device,
    scratch: Scratch,
}

/// Which nodes of a tree are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeSizes {
    /// Those of 64 bytes.
    Full,
    /// Those of 32 bytes beside them.
    Both,
}

/// A tree, and what became of the triangles on the way.
pub struct Built {
    /// The tree.
    pub tree: DeviceTree,
    /// Triangles in it: those that can be hit.
    pub triangles: usize,
    /// Those that cannot.
    pub dropped: Dropped,
    /// Low and high corner of all triangles that can be hit; both zero where there are none.
    pub bounds: [[f32; 3]; 2],
    /// Levels that the tree would have had, where that is more than traversal's stack holds: it is then the host's tree of
    /// medium quality.
    pub too_deep: Option<usize>,
}

impl Built {
    /// What there is to say about how the tree came about, as a sentence without the full stop.
    pub(crate) fn warning(&self) -> Option<String> {
        let depth = self.too_deep?;
        Some(format!(
            "the fast tree would have {depth} levels, more than the {MAX_DEPTH} that traversal's stack holds: the tree is one \
             of medium quality"
        ))
    }
}

impl TreeBuilder {
    /// For up to `capacity` triangles. The memory that builds need is taken here, that of a tree when it is built.
    ///
    /// # Errors
    /// [`BuildError`] for more triangles than an index can tell apart, or where the device has no room.
    pub fn new(device: &Device, capacity: usize) -> Result<Self, BuildError> {
        BuildError::check(capacity, MAX_INDEX)?;
        device.reserve(Scratch::bytes(capacity), "building the tree")?;
        let device = device.with_block(None)?;
        let scratch = Scratch::new(&device, capacity)?;
        Ok(Self { device, scratch })
    }

    /// Builds a tree over the triangles that can be hit. The result depends on the triangles and their order alone.
    ///
    /// All is enqueued; the host waits once in between, to know how many nodes there will be. A tree that is deeper than
    /// traversal's stack is built on the host instead.
    ///
    /// # Errors
    /// [`BuildError`] for more triangles than the capacity, or where the device fails or has no room for the tree.
    pub fn build(&mut self, triangles: &Buffer<Triangle>, sizes: NodeSizes) -> Result<Built, BuildError> {
        let (has, capacity) = (triangles.len() as usize, self.scratch.capacity());
        if has > capacity as usize {
            return Err(BuildError::Capacity { has, capacity });
        }
        self.device.check(triangles, "triangles")?;
        if triangles.is_empty() {
            return self.on_host(triangles, sizes, &Findings::default(), None);
        }
        self.scratch.clear()?;
        launches::merge(&self.device, &mut self.scratch, triangles)?;
        let outcome = self.scratch.outcome()?;
        let (found, root) = &outcome;
        let depth = root.below().height() as usize;
        if found.hittable(triangles.len()) == 0 {
            return self.on_host(triangles, sizes, found, None);
        }
        if depth > MAX_DEPTH {
            return self.on_host(triangles, sizes, found, Some(depth));
        }
        let tree = launches::emit(&self.device, &mut self.scratch, triangles, sizes, &outcome)?;
        Ok(built(tree, found, None))
    }

    /// What there is no kernel for: nothing at all, and what is too deep.
    fn on_host(
        &self,
        triangles: &Buffer<Triangle>,
        sizes: NodeSizes,
        found: &Findings,
        too_deep: Option<usize>,
    ) -> Result<Built, BuildError> {
        let (kept, _) = super::drop_degenerate(triangles.to_vec()?);
        let tree = bvh2_build::build(kept, Quality::Medium)?;
        Ok(built(DeviceTree::of_host(&self.device, &tree, sizes)?, found, too_deep))
    }
}

fn built(tree: DeviceTree, found: &Findings, too_deep: Option<usize>) -> Built {
    let dropped = Dropped { not_finite: found.not_finite as usize, without_area: found.without_area as usize };
    let Bounds { low, high } = found.corners.bounds();
    let (triangles, bounds) = (tree.stats().references, [low.to_array(), high.to_array()]);
    Built { tree, triangles, dropped, bounds, too_deep }
}

/// What a root says of its tree, whose arrays take so many bytes.
fn stats_of(root: &Node, bytes: u64) -> TreeStats {
    let (below, area) = (root.below(), f64::from(root.bounds().half_area()));
    let (nodes, references) = (below.nodes as usize, below.count as usize);
    // Where areas vanish or overflow every box counts as much as the root's.
    let cost = f64::from(below.sah) / area;
    let sah_cost = if cost.is_finite() { cost } else { (nodes + references) as f64 };
    // A root that is one leaf has a node for it.
    let alone = nodes == 0;
    TreeStats {
        nodes: nodes + alone as usize,
        leaves: nodes + 1,
        references,
        duplicates: 0,
        depth: below.height() as usize + alone as usize,
        largest_leaf: below.largest_leaf() as usize,
        sah_cost: sah_cost + f64::from(alone as u8),
        bytes: bytes as usize,
        build_seconds: 0.0,
    }
}

/// The tree over triangles of the host, which those leave that cannot be hit.
///
/// # Errors
/// [`BuildError`] for more triangles than an index can tell apart.
pub(super) fn build_on_host(triangles: Vec<Triangle>) -> Result<super::bvh2::Bvh2, BuildError> {
    let start = std::time::Instant::now();
    let device = Device::open(crate::device::DeviceChoice::Cpu)?;
    let mut builder = TreeBuilder::new(&device, triangles.len())?;
    let built = builder.build(&device.upload(&triangles)?, NodeSizes::Full)?;
    Ok(built.tree.download(start.elapsed().as_secs_f64())?)
}
