//! A hierarchy of eight boxes a node, compressed to 80 bytes (after Ylitie, Karras and Laine 2017).

use super::grid::{half, Grid, GridRay};
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::ray::Ray;
use raywarp_core::stack::{Stack, Storage};
use raywarp_core::traversal::{Counter, Structure, Visitor, WorldSpace};
use raywarp_core::triangle::{RayShear, Triangle};
use raywarp_core::view::View;

/// Levels that a tree may have: the builder keeps to it and `validate` checks it, so the stack cannot overflow.
pub const MAX_DEPTH: usize = 32;

/// Most triangles of a leaf.
pub const MAX_LEAF: u32 = 3;

/// A node: 80 bytes, read as five 128-bit words. Its children are in eight slots, some of which may be empty.
///
/// Child nodes follow each other in the order of their slots, and so do the triangles of all leaves of a node. Boxes hold
/// what is below them with the margin of [`bvh2::Node`](raywarp_core::traversal::bvh2::Node).
///
/// A child that a ray from octant `o` should visit first is in slot `o`, where bit `i` of an octant says that the direction
/// is negative on axis `i`; the others follow by how many, and which, bits differ.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Where plane 0 of each axis is.
    pub origin: Vec3,
    /// In the low bytes the biased exponents of the distances between planes, by axis, each from 1 to 254. In the high
    /// byte the slots that hold nodes.
    pub exponents: u32,
    /// Index of the first child node.
    pub nodes: u32,
    /// Index of the first triangle.
    pub triangles: u32,
    /// A byte a slot, see [`Slot`].
    pub slots: [u32; 2],
    /// Low planes: by axis, then a byte a slot.
    pub low: [[u32; 2]; 3],
    /// High planes.
    pub high: [[u32; 2]; 3],
}

/// What is in a slot, as a byte: where its hits go in a word of 24 bits of triangles and eight of nodes, which is also the
/// order of visits, and how many bits they are.
pub struct Slot;

impl Slot {
    /// Nothing.
    pub const EMPTY: u8 = 0;

    /// A node in slot `slot`: one bit, of the upper eight.
    pub const fn node(slot: u8) -> u8 {
        (1 << 5) | (24 + slot)
    }

    /// `count` triangles, 1 to [`MAX_LEAF`], from the `first` of the node on, at most 21: as many bits.
    pub const fn leaf(first: u8, count: u8) -> u8 {
        ((1 << count) - 1) << 5 | first
    }
}

/// The tree. Node 0 is the root; there always is one.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bvh8 {
    /// Inner nodes.
    pub nodes: View<Node>,
    /// Triangles in the order of the leaves.
    pub triangles: View<Triangle>,
}

/// Child nodes of one node that wait to be visited.
#[repr(C, align(8))]
#[derive(Clone, Copy)]
struct Group {
    /// Index of the first child, entered or not.
    nodes: u32,
    /// In the high byte, those to be visited, the nearest one highest. In the low byte, which slots hold nodes.
    slots: u32,
}

impl Group {
    /// Of the root alone.
    const ROOT: Self = Self { nodes: 0, slots: 1 << 31 };

    #[inline(always)]
    fn is_empty(self) -> bool {
        self.slots >> 24 == 0
    }

    /// The index of the nearest one, and those that are left.
    #[inline(always)]
    fn take(self, octant: u32) -> (u32, Self) {
        let bit = 31 - self.slots.leading_zeros();
        let slot = (bit ^ octant) & 7;
        let before = self.slots & ((1 << slot) - 1);
        (self.nodes + before.count_ones(), Self { slots: self.slots & !(1 << bit), ..self })
    }
}

impl Structure for Bvh8 {
    const NAME: &'static str = "bvh8";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        let grid_ray = GridRay::new(ray);
        let octant = grid_ray.octant();
        let shear = RayShear::new(ray);
        let mut storage = Storage::<Group, MAX_DEPTH>::new();
        let mut stack = Stack::new(&mut storage);
        let mut t_far = ray.t_max;
        let mut group = Group::ROOT;
        loop {
            let (index, rest) = group.take(octant);
            if !rest.is_empty() {
                stack.push(rest);
            }
            counter.node();
            let node = self.nodes.load(index);
            let entered = node.entered(&grid_ray, octant, t_far);
            let mut triangles = entered & 0x00ff_ffff;
            while triangles != 0 {
                counter.triangle();
                let index = node.triangles + triangles.trailing_zeros();
                triangles &= triangles - 1;
                t_far = visitor.visit(&shear, &self.triangles.load(index));
                if t_far < ray.t_min {
                    return;
                }
            }
            group = Group { nodes: node.nodes, slots: entered & 0xff00_0000 | node.exponents >> 24 };
            if group.is_empty() {
                group = match stack.pop() {
                    Some(group) => group,
                    None => return,
                };
            }
        }
    }
}

impl Node {
    /// Which children the ray enters before `t_far`: triangles in the low bits, nodes by their turn in the high byte.
    #[inline(always)]
    fn entered(&self, ray: &GridRay, octant: u32, t_far: f32) -> u32 {
        let power = |shift: u32| f32::from_bits((self.exponents >> shift & 0xff) << 23);
        let grid = ray.grid(self.origin, vec3(power(0), power(8), power(16)));
        let (near, far) = ray.sides(self.low, self.high);
        entered_of_four(self.slots[0], octant, &grid, half::<0>(near), half::<0>(far), t_far)
            | entered_of_four(self.slots[1], octant, &grid, half::<1>(near), half::<1>(far), t_far)
    }
}

/// Of four slots, all bytes of a word at once (after Ylitie, Karras and Laine).
#[inline(always)]
fn entered_of_four(slots: u32, octant: u32, grid: &Grid, near: [u32; 3], far: [u32; 3], t_far: f32) -> u32 {
    // Only of a node are bits 3 and 4 of the place both set: its turn depends on the octant.
    let nodes = (slots & slots << 1) >> 4 & 0x0101_0101;
    let places = (slots ^ (nodes * octant)) & 0x1f1f_1f1f;
    let bits = slots >> 5 & 0x0707_0707;
    bits_of::<0>(grid.enter::<0>(near, far, t_far), bits, places)
        | bits_of::<1>(grid.enter::<1>(near, far, t_far), bits, places)
        | bits_of::<2>(grid.enter::<2>(near, far, t_far), bits, places)
        | bits_of::<3>(grid.enter::<3>(near, far, t_far), bits, places)
}

/// Those of byte `INDEX`, at its place, where the ray enters.
#[inline(always)]
fn bits_of<const INDEX: u32>(entered: Option<f32>, bits: u32, places: u32) -> u32 {
    let bits = (bits >> (8 * INDEX) & 0xff) << (places >> (8 * INDEX) & 0x1f);
    if entered.is_some() {
        bits
    } else {
        0
    }
}

const _: () = assert!(core::mem::size_of::<Node>() == 80);
