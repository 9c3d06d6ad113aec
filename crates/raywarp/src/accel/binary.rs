//! A binary tree with one triangle a leaf, as the builders of good trees shape it before it becomes a [`Bvh2`].
//!
//! Siblings lie side by side, so that both boxes come with one cache line and a node's sibling is known from its index
//! alone. A leaf is a reference: a box and a triangle. After spatial splits several references share a triangle, each
//! with the box of a part of it.
//!
//! [`Bvh2`]: super::bvh2::Bvh2

use super::bounds::Bounds;

/// Where a node's children are, or which triangle it holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Link(u32);

/// Set in the link of a leaf.
const LEAF: u32 = 1 << 31;

impl Link {
    /// Of a place that no node took.
    pub const NOTHING: Self = Self(u32::MAX);

    pub const fn leaf(triangle: u32) -> Self {
        Self(LEAF | triangle)
    }

    /// `first` is that of the left child, an even number; the right one follows.
    pub const fn pair(first: u32) -> Self {
        Self(first)
    }

    pub const fn is_nothing(self) -> bool {
        self.0 == u32::MAX
    }

    pub const fn triangle(self) -> Option<u32> {
        if self.0 & LEAF != 0 {
            Some(self.0 & !LEAF)
        } else {
            None
        }
    }

    pub fn children(self) -> Option<[u32; 2]> {
        (self.0 & LEAF == 0).then_some([self.0, self.0 + 1])
    }
}

/// Half a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Node {
    pub bounds: Bounds,
    pub link: Link,
    pub parent: u32,
}

impl Node {
    pub const NOTHING: Self = Self { bounds: Bounds::EMPTY, link: Link::NOTHING, parent: ROOT };
}

/// Index of the root. Its sibling's place is empty.
pub(super) const ROOT: u32 = 0;

/// The node beside this one.
pub(super) const fn sibling(node: u32) -> u32 {
    node ^ 1
}

/// The tree. Not all places need be taken, and parents need not come before their children.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
}

impl Tree {
    /// Of nodes whose boxes, links and parents are right.
    pub fn new(nodes: Vec<Node>) -> Self {
        Self { nodes }
    }

    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    #[inline(always)]
    pub fn at(&self, node: u32) -> &Node {
        &self.nodes[node as usize]
    }

    #[inline(always)]
    pub fn parent(&self, node: u32) -> u32 {
        self.at(node).parent
    }

    /// Takes `node` out of the tree and puts it back beside `target`. Neither is the root, the two are not siblings, and
    /// neither lies below the other.
    pub fn reinsert(&mut self, node: u32, target: u32) {
        let (parent, freed) = (self.parent(node), sibling(node));
        // The sibling takes the parent's place, the target the sibling's, and a new parent the target's.
        self.put(parent, *self.at(freed));
        self.put(freed, *self.at(target));
        self.nodes[target as usize].link = Link::pair(node & !1);
        self.nodes[node as usize].parent = target;
        self.nodes[freed as usize].parent = target;
        self.refit(target);
        if parent != ROOT {
            self.refit(self.parent(parent));
        }
    }

    /// Gives a place the box and the children of another.
    fn put(&mut self, place: u32, node: Node) {
        self.nodes[place as usize] = Node { parent: self.parent(place), ..node };
        for child in node.link.children().into_iter().flatten() {
            self.nodes[child as usize].parent = place;
        }
    }

    /// Makes boxes fit again, from an inner node up to where nothing changes.
    fn refit(&mut self, mut node: u32) {
        while let Some([left, right]) = self.at(node).link.children() {
            let bounds = self.at(left).bounds.join(&self.at(right).bounds);
            if bounds == self.at(node).bounds {
                return;
            }
            self.nodes[node as usize].bounds = bounds;
            if node == ROOT {
                return;
            }
            node = self.parent(node);
        }
    }

    /// Every node, parents before their children, the larger child first.
    pub fn downwards(&self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.nodes.len());
        let mut open = vec![ROOT];
        while let Some(node) = open.pop() {
            order.push(node);
            if let Some(children) = self.at(node).link.children() {
                let [larger, smaller] = self.by_area(children);
                open.extend([smaller, larger]);
            }
        }
        order
    }

    /// The larger one first: more rays will want it.
    pub fn by_area(&self, [a, b]: [u32; 2]) -> [u32; 2] {
        if self.at(b).bounds.half_area() > self.at(a).bounds.half_area() {
            [b, a]
        } else {
            [a, b]
        }
    }
}

const _: () = assert!(size_of::<Node>() == 32);
