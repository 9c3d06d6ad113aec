//! A hierarchy of eight boxes a node, quantised, with a link for each child: one cache line of a GPU.

use super::grid::{half, later, GridRay};
use raywarp_core::arch;
use raywarp_core::math::Vec3;
use raywarp_core::ray::Ray;
use raywarp_core::stack::{Stack, Storage};
use raywarp_core::traversal::bvh2::Child;
use raywarp_core::traversal::{Counter, Structure, Visitor, WorldSpace};
use raywarp_core::triangle::{RayShear, Triangle};
use raywarp_core::view::View;

/// Levels that a tree may have: the builder keeps to it and `validate` checks it, so the stack cannot overflow.
pub const MAX_DEPTH: usize = 32;

/// A node: 128 bytes. Its boxes are five 128-bit words; the link of a child is read when it is visited.
#[repr(C, align(128))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Of the children.
    pub boxes: Boxes,
    /// Where the children are.
    pub children: [Child; 8],
    /// Makes 128 bytes.
    pub unused: [u32; 4],
}

/// The boxes of eight children, which hold what is below them with the margin of [`bvh2::Node`](raywarp_core::traversal::bvh2::Node).
///
/// Children that do not exist have inverted boxes (low plane 255, high plane 0), which only rays whose distances overflow
/// enter. For those their links are to some triangle all the same.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boxes {
    /// Where plane 0 of each axis is.
    pub origin: Vec3,
    /// Makes 16 bytes.
    pub unused: u32,
    /// Distance between planes by axis, a normal positive number.
    pub spacing: Vec3,
    /// Makes 32 bytes.
    pub unused_too: u32,
    /// Low planes: by axis, then a byte a slot.
    pub low: [[u32; 2]; 3],
    /// High planes.
    pub high: [[u32; 2]; 3],
}

/// The tree. Node 0 is the root; there always is one.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bvh8w {
    /// Inner nodes.
    pub nodes: View<Node>,
    /// Triangles in the order of the leaves.
    pub triangles: View<Triangle>,
}

/// A child that waits: its distance, see [`key`], its node, and the slot there in the low bits of the former.
#[repr(C, align(8))]
#[derive(Clone, Copy)]
struct Entry {
    key: u32,
    node: u32,
}

impl Structure for Bvh8w {
    const NAME: &'static str = "bvh8w";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        let grid_ray = GridRay::new(ray);
        let shear = RayShear::new(ray);
        let mut storage = Storage::<Entry, { 7 * MAX_DEPTH }>::new();
        let mut stack = Stack::new(&mut storage);
        let mut t_far = ray.t_max;
        let mut next = Child::node(0);
        loop {
            let nearest = if next.is_leaf() {
                for index in next.index()..next.index() + next.count() {
                    counter.triangle();
                    t_far = visitor.visit(&shear, &self.triangles.load(index));
                    if t_far < ray.t_min {
                        return;
                    }
                }
                Entry { key: NOT_ENTERED, node: 0 }
            } else {
                counter.node();
                let node = next.index();
                let [nearest, others @ ..] =
                    sorted(self.nodes.load_part(node, |node| &node.boxes).keys(&grid_ray, t_far));
                push(&mut stack, others, node);
                Entry { key: nearest, node }
            };
            let entry = if nearest.key != NOT_ENTERED {
                nearest
            } else {
                match pop(&mut stack, t_far) {
                    Some(entry) => entry,
                    None => return,
                }
            };
            next = self.nodes.item(entry.node).children[(entry.key & 7) as usize];
        }
    }
}

/// Keys of child nodes that are not entered come after all others.
const NOT_ENTERED: u32 = u32::MAX;

/// A distance as a number that sorts like it, rounded towards earlier, with a slot in the three low bits. Zero stands for
/// all distances below it too.
#[inline(always)]
fn key<const SLOT: u32>(entered: Option<f32>) -> u32 {
    match entered {
        Some(t) => arch::max(t, 0.0).to_bits() & !7 | SLOT,
        None => NOT_ENTERED,
    }
}

/// Puts the children of a node aside, sorted from near to far.
#[inline(always)]
fn push<const N: usize>(stack: &mut Stack<'_, Entry, N>, keys: [u32; 7], node: u32) {
    for key in keys.into_iter().rev() {
        if key != NOT_ENTERED {
            stack.push(Entry { key, node });
        }
    }
}

/// The nearest child that still matters.
#[inline(always)]
fn pop<const N: usize>(stack: &mut Stack<'_, Entry, N>, t_far: f32) -> Option<Entry> {
    let reach = later(t_far);
    loop {
        let entry = stack.pop()?;
        let t = f32::from_bits(entry.key & !7);
        if t <= reach || t == 0.0 {
            return Some(entry);
        }
    }
}

impl Boxes {
    /// A key for each slot.
    #[inline(always)]
    fn keys(&self, ray: &GridRay, t_far: f32) -> [u32; 8] {
        let grid = ray.grid(self.origin, self.spacing);
        let (near, far) = ray.sides(self.low, self.high);
        let (near, far) = ([half::<0>(near), half::<1>(near)], [half::<0>(far), half::<1>(far)]);
        [
            key::<0>(grid.enter::<0>(near[0], far[0], t_far)),
            key::<1>(grid.enter::<1>(near[0], far[0], t_far)),
            key::<2>(grid.enter::<2>(near[0], far[0], t_far)),
            key::<3>(grid.enter::<3>(near[0], far[0], t_far)),
            key::<4>(grid.enter::<0>(near[1], far[1], t_far)),
            key::<5>(grid.enter::<1>(near[1], far[1], t_far)),
            key::<6>(grid.enter::<2>(near[1], far[1], t_far)),
            key::<7>(grid.enter::<3>(near[1], far[1], t_far)),
        ]
    }
}

/// Batcher's network: 19 exchanges in six steps, without branches.
#[inline(always)]
fn sorted([a, b, c, d, e, f, g, h]: [u32; 8]) -> [u32; 8] {
    let ((a, b), (c, d), (e, f), (g, h)) = (pair(a, b), pair(c, d), pair(e, f), pair(g, h));
    let ((a, c), (b, d), (e, g), (f, h)) = (pair(a, c), pair(b, d), pair(e, g), pair(f, h));
    let ((b, c), (f, g), (a, e), (d, h)) = (pair(b, c), pair(f, g), pair(a, e), pair(d, h));
    let ((b, f), (c, g)) = (pair(b, f), pair(c, g));
    let ((b, e), (d, g)) = (pair(b, e), pair(d, g));
    let ((c, e), (d, f)) = (pair(c, e), pair(d, f));
    let (d, e) = pair(d, e);
    [a, b, c, d, e, f, g, h]
}

#[inline(always)]
fn pair(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

const _: () = assert!(core::mem::size_of::<Node>() == 128);
const _: () = assert!(core::mem::size_of::<Boxes>() == 80);

#[cfg(test)]
mod tests {
    use super::*;

    /// A network that sorts all sequences of zeros and ones sorts everything (Knuth).
    #[test]
    fn the_network_sorts() {
        for bits in 0..256u32 {
            let keys = core::array::from_fn(|i| bits >> i & 1);
            assert!(sorted(keys).is_sorted(), "{keys:?}");
        }
    }
}
