//! A k-d tree in a flat array, traversed with a stack (the paper's structure).

use super::{Counter, MeshStructure, Structure, Visitor, WorldSpace};
use crate::arch;
use crate::math::Vec3;
use crate::ray::Ray;
use crate::stack::{Stack, Storage};
use crate::triangle::{RayShear, Triangle};
use crate::view::View;

/// Levels that a tree may have: builders keep to it and `validate` checks it, so the stack cannot overflow.
pub const MAX_DEPTH: usize = 48;

/// Eight bytes: an inner node or a leaf.
///
/// The two low bits of `link` are the split axis (0 to 2) or 3 for a leaf. The others are, for an inner node, the index
/// of the child below the plane, which the child above follows; for a leaf, its number of references.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node {
    /// Bits of the split plane's coordinate, or index of the leaf's first reference.
    value: u32,
    link: u32,
}

/// Most nodes, and most references of a leaf.
pub const MAX_LINK: u32 = (1 << 30) - 1;

impl Node {
    /// Splits at `plane` on `axis`; `below` and `below + 1` are the children.
    pub const fn inner(axis: u32, plane: f32, below: u32) -> Self {
        Self { value: plane.to_bits(), link: below << 2 | axis }
    }

    /// Holds `count` references from `first` on.
    pub const fn leaf(first: u32, count: u32) -> Self {
        Self { value: first, link: count << 2 | 3 }
    }

    /// Whether this is a leaf.
    #[inline(always)]
    pub const fn is_leaf(self) -> bool {
        self.link & 3 == 3
    }

    /// Split axis of an inner node.
    #[inline(always)]
    pub const fn axis(self) -> u32 {
        self.link & 3
    }

    /// Split plane of an inner node.
    #[inline(always)]
    pub const fn plane(self) -> f32 {
        f32::from_bits(self.value)
    }

    /// Child below the plane of an inner node.
    #[inline(always)]
    pub const fn below(self) -> u32 {
        self.link >> 2
    }

    /// First reference of a leaf.
    #[inline(always)]
    pub const fn first(self) -> u32 {
        self.value
    }

    /// Number of references of a leaf.
    #[inline(always)]
    pub const fn count(self) -> u32 {
        self.link >> 2
    }
}

/// The tree. Node 0 is the root; there always is one.
///
/// A triangle is in every leaf to whose cell any of its points comes closer, on each axis, than the margin that
/// [`Triangle::bounds`] leave: where a ray may be found to hit it. That holds if it is in every leaf whose cell its bounds
/// touch, but it need not be where only its bounds are.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct KdTree {
    /// Inner nodes and leaves.
    pub nodes: View<Node>,
    /// Indices into `triangles`, a run a leaf; a triangle that touches several leaves is in all of them.
    pub references: View<u32>,
    /// In the order of the scene.
    pub triangles: View<Triangle>,
    /// Low corner of the bounds of all triangles, margin included.
    pub low: Vec3,
    /// High corner.
    pub high: Vec3,
}

/// Where the tree of a mesh is among those of all meshes, and its bounds.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KdPart {
    /// First node, and how many.
    pub nodes: [u32; 2],
    /// First reference, and how many.
    pub references: [u32; 2],
    /// First triangle, and how many.
    pub triangles: [u32; 2],
    /// See [`KdTree::low`].
    pub low: Vec3,
    /// See [`KdTree::high`].
    pub high: Vec3,
}

impl MeshStructure for KdTree {
    type Part = KdPart;

    #[inline(always)]
    fn part(&self, part: &KdPart) -> Self {
        let &KdPart { nodes, references, triangles, low, high } = part;
        Self {
            nodes: self.nodes.part(nodes[0], nodes[1]),
            references: self.references.part(references[0], references[1]),
            triangles: self.triangles.part(triangles[0], triangles[1]),
            low,
            high,
        }
    }
}

/// A cell that a ray goes through: its node and the piece of the ray inside it.
#[derive(Clone, Copy)]
pub struct Cell {
    /// Index of the node.
    pub node: u32,
    /// Distance where the ray enters it, or a little less.
    pub first: f32,
    /// Distance where the ray leaves it, or a little more.
    pub last: f32,
}

/// Distances to planes are right to two roundings: intervals of neighbouring cells overlap by a few.
const SLACK: f32 = 8.0 / 16_777_216.0;

#[inline(always)]
fn earlier(t: f32) -> f32 {
    arch::fma(t.abs(), -SLACK, t)
}

/// A distance and a few roundings: cells that begin beyond it are behind it for certain.
#[inline(always)]
pub fn later(t: f32) -> f32 {
    arch::fma(t.abs(), SLACK, t)
}

/// Where a ray goes from the cell of an inner node.
pub enum Way {
    /// To one child.
    One(Cell),
    /// To the nearer child, then to the other.
    Both(Cell, Cell),
}

impl Cell {
    /// From here to the children of `node`. It depends on the cell alone, not on what was found in others.
    #[inline(always)]
    pub fn way(self, node: Node, ray: &Ray, inverse: Vec3) -> Way {
        let axis = node.axis();
        let (origin, slope) = (ray.origin[axis], inverse[axis]);
        let t = (node.plane() - origin) * slope;
        let below_is_near = slope > 0.0;
        let near = node.below() + !below_is_near as u32;
        let far = node.below() + below_is_near as u32;
        if earlier(t) > self.last {
            Way::One(Self { node: near, ..self })
        } else if later(t) < self.first {
            Way::One(Self { node: far, ..self })
        } else {
            let near = Self { node: near, first: self.first, last: arch::min(self.last, later(t)) };
            let far = Self { node: far, first: arch::max(self.first, earlier(t)), last: self.last };
            Way::Both(near, far)
        }
    }
}

impl Structure for KdTree {
    const NAME: &'static str = "kd";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        let shear = RayShear::new(ray);
        let inverse = ray.inverse_direction();
        let Some(mut cell) = self.enter(ray, inverse) else { return };
        let mut storage = Storage::<Cell, MAX_DEPTH>::new();
        let mut stack = Stack::new(&mut storage);
        let mut t_far = ray.t_max;
        loop {
            counter.node();
            let node = self.nodes.at(cell.node);
            if !node.is_leaf() {
                // Near child first; the far one waits, unless the ray stays on one side of the plane.
                cell = match cell.way(node, ray, inverse) {
                    Way::One(child) => child,
                    Way::Both(near, far) => {
                        stack.push(far);
                        near
                    }
                };
                continue;
            }
            t_far = self.leaf(node, &shear, ray.t_min, t_far, counter, visitor);
            if t_far < ray.t_min {
                return;
            }
            // What begins behind the nearest hit is dropped, cell by cell: most of the stack lies further back, but cells
            // overlap where their distances are uncertain, so one that is too far says nothing about the next.
            let reach = later(t_far);
            cell = loop {
                match stack.pop() {
                    Some(cell) if cell.first <= reach => break cell,
                    Some(_) => {}
                    None => return,
                }
            };
        }
    }
}

impl KdTree {
    /// The root's cell, if the ray meets it.
    #[inline(always)]
    pub fn enter(&self, ray: &Ray, inverse: Vec3) -> Option<Cell> {
        let a = (self.low - ray.origin) * inverse;
        let b = (self.high - ray.origin) * inverse;
        let (low, high) = (a.min(b), a.max(b));
        let first = arch::max(arch::max(low.x, low.y), arch::max(low.z, ray.t_min));
        let last = arch::min(arch::min(high.x, high.y), arch::min(high.z, ray.t_max));
        let root = Cell { node: 0, first: earlier(first), last: later(last) };
        (root.first <= root.last).then_some(root)
    }

    /// Shows the triangles of a leaf, and answers how far the ray is of interest then: as before where there are none.
    #[inline(always)]
    pub fn leaf(
        &self,
        leaf: Node,
        shear: &RayShear,
        t_min: f32,
        mut t_far: f32,
        counter: &mut impl Counter,
        visitor: &mut impl Visitor,
    ) -> f32 {
        for reference in leaf.first()..leaf.first() + leaf.count() {
            counter.triangle();
            t_far = visitor.visit(shear, &self.triangles.load(self.references.at(reference)));
            if t_far < t_min {
                break;
            }
        }
        t_far
    }
}

const _: () = assert!(core::mem::size_of::<Node>() == 8);
