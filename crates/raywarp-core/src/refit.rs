//! Kernels that move triangles within a tree that stays: vertices first, then the boxes from the leaves up, in one launch.
//! Boxes come out as the builders make them, so hits are those of a new tree, found a little later.

use crate::arch;
use crate::build::bounds::Bounds;
use crate::build::quantize::quantize;
use crate::kernels::Thread;
use crate::math::Vec3;
use crate::surface::{Instance, Primitive};
use crate::traversal::bvh2::Node;
use crate::traversal::bvh2_quantized::{self, Grid};
use crate::triangle::Triangle;
use crate::view::{View, ViewMut};

/// Gives triangles of some instances the corners and flags that these have now, one thread a triangle of the tree.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Reshape {
    /// Of the scene.
    pub instances: View<Instance>,
    /// Of the scene.
    pub primitives: View<Primitive>,
    /// Of the scene, in world space.
    pub positions: View<Vec3>,
    /// Of the triangles of each material.
    pub flags: View<u32>,
    /// The first instance that changed, and the one after the last.
    pub moved: [u32; 2],
    /// Of the tree, read and written.
    pub triangles: ViewMut<Triangle>,
}

impl Reshape {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        // SAFETY: one thread a triangle.
        let Some(old) = (unsafe { self.triangles.get(thread.x) }) else { return };
        if old.instance < self.moved[0] || old.instance >= self.moved[1] {
            return;
        }
        let first = self.instances.item(old.instance).first_primitive;
        let primitive = self.primitives.load(first + old.primitive);
        let [v0, v1, v2] = primitive.vertices.map(|vertex| self.positions.at(vertex));
        let flags = self.flags.at(primitive.material);
        // SAFETY: as above.
        unsafe { self.triangles.set(thread.x, Triangle { v0, v1, v2, flags, ..old }) };
    }
}

/// Tells each node which one is above it, one thread a node.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FindParents {
    /// Of the tree.
    pub nodes: View<Node>,
    /// Twice the index of the node above, plus the side; that of the root is not written.
    pub parents: ViewMut<u32>,
}

impl FindParents {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.nodes.len() {
            return;
        }
        let node = self.nodes.item(thread.x);
        for side in 0..2 {
            if has_node(node, side) {
                // SAFETY: a node has one parent.
                unsafe { self.parents.set(node.children[side].index(), 2 * thread.x + side as u32) };
            }
        }
    }
}

/// Gives all nodes the boxes of what is below them now, one thread a node.
///
/// Who is the last to come to a node, of its own thread and those of the nodes below, goes on to the one above. Boxes are
/// maxima and minima, and sums are made in the order of the sides, so the bits do not depend on who that is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Refit {
    /// Of the tree, read and written.
    pub nodes: ViewMut<Node>,
    /// The same on a grid, written; none where there are none.
    pub small: ViewMut<bvh2_quantized::Node>,
    /// Around all triangles as they are now.
    pub grid: Grid,
    /// In the order of the leaves.
    pub triangles: View<Triangle>,
    /// Of [`FindParents`].
    pub parents: View<u32>,
    /// Who has come to each node; zeros before and after.
    pub arrivals: ViewMut<u32>,
    /// Half the areas of the boxes below each node, added up; written.
    pub areas: ViewMut<f32>,
}

impl Refit {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.nodes.len() {
            return;
        }
        let mut index = thread.x;
        self.leaves(index);
        while self.is_last(index) {
            // SAFETY: all who write to it have come; an item of the array.
            let node = unsafe { arch::load_coherent(self.nodes.shared(index)) };
            let bounds = self.finish(index, &node);
            if index == 0 {
                return;
            }
            let above = self.parents.at(index);
            self.set_box(above / 2, above as usize % 2, &bounds);
            index = above / 2;
        }
    }

    /// Boxes of the children that are leaves.
    #[inline(always)]
    fn leaves(&self, index: u32) {
        let node = self.nodes.shared(index);
        for side in 0..2 {
            // SAFETY: links stay as they are.
            let child = unsafe { (*node).children[side] };
            // SAFETY: the box of a leaf is this thread's; that of a node is not read.
            if !child.is_leaf() || !unsafe { is_box((*node).low[side], (*node).high[side]) } {
                continue;
            }
            let mut bounds = Bounds::of(&self.triangles.load(child.index()));
            for i in child.index() + 1..child.index() + child.count() {
                bounds = bounds.join(&Bounds::of(&self.triangles.load(i)));
            }
            self.set_box(index, side, &bounds);
        }
    }

    /// Comes to a node, after its own thread or a child of it is done; whether all others have come before.
    #[inline(always)]
    fn is_last(&self, index: u32) -> bool {
        // SAFETY: links stay as they are.
        let children = unsafe { (*self.nodes.shared(index)).children };
        let others = !children[0].is_leaf() as u32 + !children[1].is_leaf() as u32;
        let arrivals = self.arrivals.shared(index);
        // SAFETY: nothing else touches the numbers of arrivals.
        let last = unsafe { arch::arrive(arrivals) } == others;
        if last {
            // SAFETY: nobody comes any more.
            unsafe { arrivals.write(0) };
        }
        last
    }

    /// Writes what depends on both boxes of a node; the box around it.
    #[inline(always)]
    fn finish(&self, index: u32, node: &Node) -> Bounds {
        if !self.small.is_empty() {
            // SAFETY: one thread is the last at a node.
            unsafe { self.small.set(index, quantize(node, &self.grid)) };
        }
        let (mut around, mut area) = (Bounds { low: Vec3::splat(f32::MAX), high: Vec3::splat(-f32::MAX) }, 0.0);
        for side in 0..2 {
            if node.has_child(side) {
                let bounds = Bounds { low: node.low[side], high: node.high[side] };
                around = around.join(&bounds);
                area += bounds.half_area();
            }
            if has_node(node, side) {
                // SAFETY: written by who was the last there, before it came here.
                area += f32::from_bits(unsafe {
                    arch::load_word_coherent(self.areas.shared(node.children[side].index()) as *const u32)
                });
            }
        }
        // SAFETY: as above.
        unsafe { self.areas.set(index, area) };
        around
    }

    #[inline(always)]
    fn set_box(&self, index: u32, side: usize, bounds: &Bounds) {
        let node = self.nodes.shared(index);
        // SAFETY: a side is written by one thread: the node's own, or the last one at the child.
        unsafe {
            (&raw mut (*node).low[side]).write(bounds.low);
            (&raw mut (*node).high[side]).write(bounds.high);
        }
    }
}

/// Whether there is a child with these corners.
#[inline(always)]
fn is_box(low: Vec3, high: Vec3) -> bool {
    low.x <= high.x && low.y <= high.y && low.z <= high.z
}

/// Whether the child on a side is a node.
#[inline(always)]
fn has_node(node: &Node, side: usize) -> bool {
    !node.children[side].is_leaf()
}
