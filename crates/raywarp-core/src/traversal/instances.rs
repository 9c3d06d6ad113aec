//! Any structure for the meshes under a tree of instances, one traversal within the other.
//!
//! Instances are found, and rays brought to them, as in [`two_level`](super::two_level), whose proof holds here too: a hit has
//! the same bits. That one is a single loop, which keeps the threads of a warp together; this one takes any structure. GPUs have
//! no kernels for it: there a k-d tree within a tree takes more than twice the time of one.

use super::bvh2::{Child, Node};
use super::slabs::{descend, Slabs};
use super::two_level::{may_hit, Instance, Place, MAX_UPPER_DEPTH};
use super::{Counter, MeshSpace, Structure, Visitor};
use crate::name::Name;
use crate::ray::Ray;
use crate::stack::{Stack, Storage};
use crate::triangle::{RayShear, Triangle};
use crate::view::View;

/// A structure whose arrays hold those of several meshes one after the other.
pub trait MeshStructure: Structure {
    /// Where the arrays of a mesh are.
    type Part: Copy + Send + Sync;

    /// The structure of one mesh alone.
    fn part(&self, part: &Self::Part) -> Self;
}

/// The structures of all meshes, and where these are placed.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Instances<B: MeshStructure> {
    /// Of all meshes.
    pub meshes: B,
    /// Where each mesh is in it.
    pub parts: View<B::Part>,
    /// The tree over the instances. A leaf links to one of them.
    pub nodes: View<Node>,
    /// Placed meshes; their [roots](Instance::root) link to a part as if it were a node.
    pub instances: View<Instance>,
    /// As of a [`TwoLevel`](super::TwoLevel).
    pub slack: f32,
}

impl<B: MeshStructure> Structure for Instances<B> {
    const NAME: &'static str = const { &Name::of([B::NAME, "_instances", ""]) }.text();
    type Space = MeshSpace;

    #[inline(always)]
    fn traverse(&self, world: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        if !may_hit(world) {
            return;
        }
        let slabs = Slabs::new(world).widened(world.origin.max_abs() * self.slack);
        let mut storage = Storage::<Child, { MAX_UPPER_DEPTH + 1 }>::new();
        let mut stack = Stack::new(&mut storage);
        let mut t_far = world.t_max;
        let mut next = Some(Child::node(0));
        while let Some(child) = next {
            let Some(leaf) = descend(&self.nodes, child, &slabs, t_far, &mut stack, counter) else { return };
            let instance = self.instances.load(leaf.index());
            let ray = Ray { t_max: t_far, ..instance.bring(world) };
            if may_hit(&ray) {
                let mut placed = Placed { place: Place::of(&instance), visitor, t_far };
                self.meshes.part(&self.parts.at(instance.root.index())).traverse(&ray, counter, &mut placed);
                t_far = placed.t_far;
                if t_far < world.t_min {
                    return;
                }
            }
            next = stack.pop();
        }
    }
}

/// Shows triangles of a mesh as those of the scene.
struct Placed<'a, V> {
    place: Place,
    visitor: &'a mut V,
    /// The last answer.
    t_far: f32,
}

impl<V: Visitor> Visitor for Placed<'_, V> {
    const ORDERED: bool = V::ORDERED;
    const ENDS: bool = V::ENDS;

    #[inline(always)]
    fn visit(&mut self, shear: &RayShear, triangle: &Triangle) -> f32 {
        self.t_far = self.visitor.visit(shear, &self.place.put(*triangle));
        self.t_far
    }
}
