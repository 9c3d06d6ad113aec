//! A hierarchy of four boxes a node, quantised to 64 bytes.

use super::grid::{later, GridRay};
use raywarp_core::arch;
use raywarp_core::math::Vec3;
use raywarp_core::ray::Ray;
use raywarp_core::stack::{Stack, Storage};
use raywarp_core::traversal::bvh2::Child;
use raywarp_core::traversal::{Counter, Structure, Visitor, WorldSpace};
use raywarp_core::triangle::{RayShear, Triangle};
use raywarp_core::view::View;

/// Levels that a tree may have: the builder keeps to it and `validate` checks it, so the stack cannot overflow.
pub const MAX_DEPTH: usize = 40;

/// A node: 64 bytes, read as four 128-bit words.
///
/// Children that do not exist come last and have inverted boxes (low plane 255, high plane 0), which only rays whose
/// distances overflow enter. For those their links are to some triangle all the same. Boxes hold what is below them with
/// the margin of [`bvh2::Node`](raywarp_core::traversal::bvh2::Node).
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Where plane 0 of each axis is.
    pub origin: Vec3,
    /// Distance between planes by axis, a normal positive number.
    pub spacing: Vec3,
    /// Low planes: by axis, then a byte a child.
    pub low: [u32; 3],
    /// High planes.
    pub high: [u32; 3],
    /// Where the children are.
    pub children: [Child; 4],
}

/// The tree. Node 0 is the root; there always is one.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bvh4 {
    /// Inner nodes.
    pub nodes: View<Node>,
    /// Triangles in the order of the leaves.
    pub triangles: View<Triangle>,
}

/// A child and where the ray enters it; infinitely far where it does not.
#[repr(C, align(8))]
#[derive(Clone, Copy)]
struct Entry {
    t: f32,
    child: Child,
}

impl Structure for Bvh4 {
    const NAME: &'static str = "bvh4";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        let grid_ray = GridRay::new(ray);
        let shear = RayShear::new(ray);
        let mut storage = Storage::<Entry, { 3 * MAX_DEPTH }>::new();
        let mut stack = Stack::new(&mut storage);
        let mut t_far = ray.t_max;
        let mut next = Child::node(0);
        loop {
            while !next.is_leaf() {
                counter.node();
                let [first, second, third, fourth] = self.nodes.load(next.index()).entered(&grid_ray, t_far);
                for entry in [fourth, third, second] {
                    if entry.t < f32::INFINITY {
                        stack.push(entry);
                    }
                }
                next = if first.t < f32::INFINITY {
                    first.child
                } else {
                    match pop(&mut stack, t_far) {
                        Some(child) => child,
                        None => return,
                    }
                };
            }
            for index in next.index()..next.index() + next.count() {
                counter.triangle();
                t_far = visitor.visit(&shear, &self.triangles.load(index));
                if t_far < ray.t_min {
                    return;
                }
            }
            next = match pop(&mut stack, t_far) {
                Some(child) => child,
                None => return,
            };
        }
    }
}

/// The nearest child that still matters.
#[inline(always)]
fn pop<const N: usize>(stack: &mut Stack<'_, Entry, N>, t_far: f32) -> Option<Child> {
    loop {
        let entry = stack.pop()?;
        if entry.t <= later(t_far) {
            return Some(entry.child);
        }
    }
}

impl Node {
    /// All children, nearest first, those that the ray does not enter before `t_far` last.
    #[inline(always)]
    fn entered(&self, ray: &GridRay, t_far: f32) -> [Entry; 4] {
        let grid = ray.grid(self.origin, self.spacing);
        let (near, far) = ray.sides(self.low, self.high);
        // What is entered beyond all numbers is entered all the same.
        let entry = |t: Option<f32>, child| Entry { t: t.map_or(f32::INFINITY, |t| arch::min(t, f32::MAX)), child };
        let [a, b, c, d] = self.children;
        let (a, b) = sorted(entry(grid.enter::<0>(near, far, t_far), a), entry(grid.enter::<1>(near, far, t_far), b));
        let (c, d) = sorted(entry(grid.enter::<2>(near, far, t_far), c), entry(grid.enter::<3>(near, far, t_far), d));
        let ((a, c), (b, d)) = (sorted(a, c), sorted(b, d));
        let (b, c) = sorted(b, c);
        [a, b, c, d]
    }
}

#[inline(always)]
fn sorted(a: Entry, b: Entry) -> (Entry, Entry) {
    let swap = b.t < a.t;
    let (near, far) = if swap { (b.child, a.child) } else { (a.child, b.child) };
    (Entry { t: arch::min(a.t, b.t), child: near }, Entry { t: arch::max(a.t, b.t), child: far })
}

const _: () = assert!(core::mem::size_of::<Node>() == 64);
