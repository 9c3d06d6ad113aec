//! Two levels of binary hierarchies: one over placed meshes, and one for each mesh, however often it is placed.
//!
//! A ray goes through the upper tree in the world. Where it meets an instance it is brought to the space of the mesh and
//! goes through the mesh's tree there; its direction is not normalised, so `t` is the same in both. Both trees share one
//! array of nodes, one loop and one stack, on which a link of its own marks the way back to the world.
//!
//! # No hit is lost
//! A mesh's tree sees a ray with a rounded origin o' and direction d', and finds what brute force finds along exactly
//! this ray: all triangles of an instance see the same one, so the mesh stays watertight. What is left to show is that
//! the upper tree lets the ray through. With the matrix M and the shift c of the instance, three fused steps a component
//! make o' + t d' differ from M x + c, where x = o + t d is the point in the world, by at most
//! `e = 3u (|M| (|o| + t |d|) + |c|)`, u = 2^-24. As `t |d| <= |x| + |o|`, the point of the world that the mesh's point
//! stands for is off x by at most `|L| e <= 3u K (2 |o| + |x|) + 3u |L| |c|`, with L the exact inverse of M and
//! `K = |L| |M|`. An instance's box holds its share of that, what depends on |o| is [`TwoLevel::slack`]; both with
//! a third to spare for their own rounding. Components that underflow, in directions below 2^-100, are
//! excepted; a direction below 2^-126, in the world or in an instance, hits nothing.

use super::bvh2::{Child, Node, MAX_DEPTH, MAX_INDEX, MAX_LEAF};
use super::slabs::{descend, Slabs};
use super::{Counter, MeshSpace, Structure, Visitor};
use crate::arch;
use crate::math::{vec3, Vec3};
use crate::ray::{Ray, MISS};
use crate::stack::{Stack, Storage};
use crate::triangle::{flags, RayShear, Triangle};
use crate::view::View;

/// Levels that the upper tree may have; a mesh's tree may have [`MAX_DEPTH`].
pub const MAX_UPPER_DEPTH: usize = 32;

/// Bit of [`Instance::flags`]: these are triangles in world space, of several instances of the scene, and say of which.
pub const BAKED: u32 = 1 << 30;

/// A mesh in the world.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// World to mesh: each row is a row of the matrix, then the shift.
    pub rows: [[f32; 4]; 3],
    /// Root of the mesh's tree.
    pub root: Child,
    /// Index of the instance in the scene.
    pub index: u32,
    /// Which of [`Triangle::flags`] stay as the mesh has them.
    pub keep: u32,
    /// Flags of every triangle, and [`BAKED`].
    pub flags: u32,
}

/// The trees. Node 0 is the root of the upper one; there always is one, and an instance.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TwoLevel {
    /// Inner nodes of all trees. A leaf of the upper tree links to one instance.
    pub nodes: View<Node>,
    /// Triangles of all meshes, in the order of the leaves; primitives count from 0 in each mesh.
    pub triangles: View<Triangle>,
    /// Placed meshes.
    pub instances: View<Instance>,
    /// How much larger the upper tree's boxes are to a ray, in units of its origin's largest component.
    pub slack: f32,
}

/// Lies below all that a ray put aside within an instance. No leaf of triangles is like it: there are at most
/// [`MAX_INDEX`].
const RETURN: Child = Child::leaf(MAX_INDEX, MAX_LEAF);

impl Structure for TwoLevel {
    const NAME: &'static str = "two_level";
    type Space = MeshSpace;

    #[inline(always)]
    fn traverse(&self, world: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        if !may_hit(world) {
            return;
        }
        let mut slabs = self.upper(world);
        let mut storage = Storage::<Child, { MAX_UPPER_DEPTH + 1 + MAX_DEPTH }>::new();
        let mut stack = Stack::new(&mut storage);
        let mut place = Place::WORLD;
        let mut shear = RayShear::new(world);
        let mut t_far = world.t_max;
        let mut next = Some(Child::node(0));
        while let Some(child) = next {
            let Some(leaf) = descend(&self.nodes, child, &slabs, t_far, &mut stack, counter) else { return };
            if leaf == RETURN {
                (place, slabs) = (Place::WORLD, self.upper(world));
            } else if place.is_world() {
                let instance = self.instances.load(leaf.index());
                let ray = instance.bring(world);
                if may_hit(&ray) {
                    shear = RayShear::new(&ray);
                    (place, slabs) = (Place::of(&instance), Slabs::new(&ray));
                    stack.push(RETURN);
                    next = Some(instance.root);
                    continue;
                }
            } else {
                for index in leaf.index()..leaf.index() + leaf.count() {
                    counter.triangle();
                    t_far = visitor.visit(&shear, &place.put(self.triangles.load(index)));
                    if t_far < world.t_min {
                        return;
                    }
                }
            }
            next = stack.pop();
        }
    }
}

/// Whether the ray is finite and leads anywhere. One that does not would be let into every box there is, and into those
/// of a mesh again and again: with a thousand million triangles a single NaN would be a hang.
#[inline(always)]
pub(super) fn may_hit(ray: &Ray) -> bool {
    // NaN and infinity times zero are NaN.
    ray.origin.dot(Vec3::ZERO) + ray.direction.dot(Vec3::ZERO) == 0.0 && ray.direction.max_abs() >= f32::MIN_POSITIVE
}

impl TwoLevel {
    /// The ray as the upper tree sees it.
    #[inline(always)]
    fn upper(&self, world: &Ray) -> Slabs {
        Slabs::new(world).widened(world.origin.max_abs() * self.slack)
    }
}

impl Instance {
    /// Leaves every ray and every triangle as it is; of the tree at node 0.
    pub const IDENTITY: Self = Self {
        rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
        root: Child::node(0),
        index: 0,
        keep: flags::CUTOUT | flags::TRANSPARENT,
        flags: BAKED,
    };

    /// Whether its triangles are in world space, and say of which instance they are.
    pub fn is_baked(&self) -> bool {
        self.flags & BAKED != 0
    }

    /// A ray of the world in the space of the mesh.
    #[inline(always)]
    pub fn bring(&self, world: &Ray) -> Ray {
        let (o, d) = (world.origin, world.direction);
        let point = |[x, y, z, shift]: [f32; 4]| arch::fma(x, o.x, arch::fma(y, o.y, arch::fma(z, o.z, shift)));
        let vector = |[x, y, z, _]: [f32; 4]| arch::fma(x, d.x, arch::fma(y, d.y, z * d.z));
        let [a, b, c] = self.rows;
        Ray { origin: vec3(point(a), point(b), point(c)), direction: vec3(vector(a), vector(b), vector(c)), ..*world }
    }
}

/// Where a ray is, and what that means for a triangle.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// Of the instance; [`MISS`] in the world.
    index: u32,
    keep: u32,
    flags: u32,
}

impl Place {
    const WORLD: Self = Self { index: MISS, keep: 0, flags: 0 };

    #[inline(always)]
    pub fn of(instance: &Instance) -> Self {
        Self { index: instance.index, keep: instance.keep, flags: instance.flags }
    }

    #[inline(always)]
    fn is_world(&self) -> bool {
        self.index == MISS
    }

    /// A triangle of the mesh as one of the scene.
    #[inline(always)]
    pub fn put(&self, triangle: Triangle) -> Triangle {
        Triangle {
            flags: triangle.flags & self.keep | self.flags & !BAKED,
            instance: if self.flags & BAKED != 0 { triangle.instance } else { self.index },
            ..triangle
        }
    }
}

const _: () = assert!(core::mem::size_of::<Instance>() == 64);
