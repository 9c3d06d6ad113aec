//! Kernels that move triangles within a tree that stays: vertices first, then the boxes from the leaves up, a level a
//! launch. Boxes come out as the builders make them, so hits are those of a new tree, found a little later.

use crate::kernels::Thread;
use crate::math::Vec3;
use crate::surface::{Instance, Primitive};
use crate::traversal::bvh2::Node;
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

/// Gives the nodes of one level the boxes of what is below them now, one thread a node.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Refit {
    /// Of the tree, read and written. Those of deeper levels are done.
    pub nodes: ViewMut<Node>,
    /// In the order of the leaves.
    pub triangles: View<Triangle>,
    /// Nodes by level.
    pub order: View<u32>,
    /// This level's first place in `order`, and the one after its last.
    pub level: [u32; 2],
}

impl Refit {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.level[1] - self.level[0] {
            return;
        }
        let index = self.order.at(self.level[0] + thread.x);
        // SAFETY: each node is once in `order`.
        let Some(mut node) = (unsafe { self.nodes.get(index) }) else { return };
        for side in 0..2 {
            if node.has_child(side) {
                (node.low[side], node.high[side]) = self.bounds(&node, side);
            }
        }
        // SAFETY: as above.
        unsafe { self.nodes.set(index, node) };
    }

    #[inline(always)]
    fn bounds(&self, node: &Node, side: usize) -> (Vec3, Vec3) {
        let child = node.children[side];
        let (mut low, mut high) = (Vec3::splat(f32::MAX), Vec3::splat(-f32::MAX));
        if child.is_leaf() {
            for i in child.index()..child.index() + child.count() {
                let (a, b) = self.triangles.load(i).bounds();
                (low, high) = (low.min(a), high.max(b));
            }
            return (low, high);
        }
        // SAFETY: a node has one parent, whose thread this is, and its own level is done.
        let Some(below) = (unsafe { self.nodes.get(child.index()) }) else { return (low, high) };
        for side in 0..2 {
            if below.has_child(side) {
                (low, high) = (low.min(below.low[side]), high.max(below.high[side]));
            }
        }
        (low, high)
    }
}
