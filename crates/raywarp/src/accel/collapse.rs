//! Makes a tree with many children a node out of a binary one (after Ylitie, Karras and Laine 2017, section 5.1).
//!
//! The binary tree is first taken apart down to single triangles. From the leaves upwards, dynamic programming then finds
//! what each subtree costs as at most 1, 2, … trees of the wide kind, by the surface area heuristic; from the root
//! downwards the best choice is followed.

use raywarp_core::traversal::bvh2::Child;
use raywarp_core::triangle::Triangle;

use super::bounds::Bounds;
use super::bvh2::{child_box, children_of, Bvh2};

/// What the wide tree is made for.
pub struct Shape {
    /// Most triangles of a leaf.
    pub leaf: usize,
    /// Cost of a step to a node.
    pub node_cost: f64,
    /// Cost of a leaf of so many triangles.
    pub leaf_cost: fn(usize) -> f64,
    /// Levels that the tree may have.
    pub levels: usize,
}

/// A node of at most `W` children, whatever its layout. Child nodes of one node follow each other, in the order of the
/// slots, and so do the triangles of its leaves; parents come before children.
#[derive(Clone, Debug)]
pub struct WideNode<const W: usize> {
    /// Around everything below it.
    pub bounds: Bounds,
    pub slots: [Option<Slot>; W],
}

/// A child.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    pub bounds: Bounds,
    pub link: Link,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// Index of a node.
    Node(u32),
    /// The first triangle, and how many.
    Leaf(u32, u32),
}

impl From<Child> for Link {
    fn from(child: Child) -> Self {
        if child.is_leaf() {
            Self::Leaf(child.index(), child.count())
        } else {
            Self::Node(child.index())
        }
    }
}

impl From<Link> for Child {
    fn from(link: Link) -> Self {
        match link {
            Link::Node(index) => Self::node(index),
            Link::Leaf(first, count) => Self::leaf(first, count),
        }
    }
}

/// Where a child that does not exist links to.
pub const NOTHING: Child = Child::leaf(0, 1);

/// The tree, and its triangles in the order of the leaves. There always is a root, and a triangle, be it in no leaf.
pub struct Wide<const W: usize> {
    pub nodes: Vec<WideNode<W>>,
    pub triangles: Vec<Triangle>,
}

/// Puts the children of a node, given by their boxes, into slots: says which child a slot takes.
pub type Arrange<const W: usize> = fn(&Bounds, &[Bounds]) -> [Option<usize>; W];

/// As they come.
pub fn in_order<const W: usize>(_: &Bounds, children: &[Bounds]) -> [Option<usize>; W] {
    std::array::from_fn(|slot| (slot < children.len()).then_some(slot))
}

/// The wide tree of least cost that a binary tree can become.
pub fn collapse<const W: usize>(tree: &Bvh2, shape: &Shape, arrange: Arrange<W>) -> Wide<W> {
    let binary = Binary::new(tree);
    let costs = Costs::new::<W>(&binary, shape);
    let mut wide = Wide { nodes: Vec::new(), triangles: Vec::with_capacity(binary.references.len()) };
    let root = WideNode { bounds: binary.nodes.first().map_or(Bounds::POINT, |root| root.bounds), slots: [None; W] };
    wide.nodes.push(root);
    if !binary.nodes.is_empty() {
        Collapse { tree, binary: &binary, costs: &costs, arrange, wide: &mut wide }.fill(0, 0, shape.levels);
    } else {
        wide.triangles.extend(tree.triangles.first());
    }
    wide
}

/// A binary tree with one triangle a leaf. The children of node `i` are `i + 1` and `right`; below it are the references
/// from `first` on, `count` of them.
struct Binary {
    nodes: Vec<BinaryNode>,
    /// Indices of the tree's triangles.
    references: Vec<u32>,
}

struct BinaryNode {
    bounds: Bounds,
    first: u32,
    count: u32,
    right: u32,
}

impl BinaryNode {
    fn children(&self, index: usize) -> [usize; 2] {
        [index + 1, self.right as usize]
    }

    fn is_leaf(&self) -> bool {
        self.count == 1
    }
}

/// A triangle, or the part of it that belongs to a leaf.
#[derive(Clone, Copy)]
struct Reference {
    bounds: Bounds,
    triangle: u32,
}

impl Binary {
    fn new(tree: &Bvh2) -> Self {
        let count = tree.triangles.len();
        let mut binary = Self { nodes: Vec::with_capacity(2 * count), references: Vec::with_capacity(count) };
        binary.add_node(tree, 0);
        binary
    }

    /// Adds a node of the tree and all below it. One child takes the place of its parent.
    fn add_node(&mut self, tree: &Bvh2, index: u32) {
        let node = &tree.nodes[index as usize];
        let mut sides = children_of(node);
        match (sides.next(), sides.next()) {
            (Some(left), Some(right)) => {
                self.add_inner(|binary| binary.add_child(tree, index, left), |b| b.add_child(tree, index, right))
            }
            (Some(only), None) => self.add_child(tree, index, only),
            _ => {}
        }
    }

    fn add_inner(&mut self, left: impl FnOnce(&mut Self), right: impl FnOnce(&mut Self)) {
        let (index, first) = (self.nodes.len(), self.references.len() as u32);
        self.nodes.push(BinaryNode { bounds: Bounds::EMPTY, first, count: 0, right: 0 });
        left(self);
        let middle = self.nodes.len();
        right(self);
        let bounds = self.nodes[index + 1].bounds.join(&self.nodes[middle].bounds);
        let count = self.references.len() as u32 - first;
        self.nodes[index] = BinaryNode { bounds, first, count, right: middle as u32 };
    }

    fn add_child(&mut self, tree: &Bvh2, node: u32, side: usize) {
        let node = &tree.nodes[node as usize];
        let child = node.children[side];
        if !child.is_leaf() {
            return self.add_node(tree, child.index());
        }
        let cell = child_box(node, side);
        let mut references: Vec<Reference> = (child.index()..child.index() + child.count())
            .map(|triangle| Reference {
                bounds: Bounds::of(&tree.triangles[triangle as usize]).within(&cell),
                triangle,
            })
            .collect();
        self.add_references(&mut references);
    }

    /// Adds a tree over one or more triangles, cut where the heuristic says, among all cuts.
    fn add_references(&mut self, references: &mut [Reference]) {
        if let [only] = references {
            let first = self.references.len() as u32;
            self.references.push(only.triangle);
            return self.nodes.push(BinaryNode { bounds: only.bounds, first, count: 1, right: 0 });
        }
        let cuts = (0..3).map(|axis| {
            sort(references, axis);
            cheapest_cut(references)
        });
        let costs: Vec<(f64, usize)> = cuts.collect();
        let axis = (0..3).min_by(|&a, &b| costs[a].0.total_cmp(&costs[b].0)).unwrap_or(0);
        sort(references, axis);
        let (left, right) = references.split_at_mut(costs[axis].1);
        self.add_inner(|binary| binary.add_references(left), |binary| binary.add_references(right));
    }
}

/// By the centres of their boxes on an axis.
fn sort(references: &mut [Reference], axis: usize) {
    references.sort_by(|a, b| a.bounds.centre()[axis].total_cmp(&b.bounds.centre()[axis]));
}

/// Where two parts of sorted references have the least areas times counts, and how much that is.
fn cheapest_cut(references: &[Reference]) -> (f64, usize) {
    let cost = |part: &[Reference]| {
        let bounds = part.iter().fold(Bounds::EMPTY, |all, reference| all.join(&reference.bounds));
        bounds.half_area() * part.len() as f64
    };
    let cuts = (1..references.len()).map(|middle| {
        let (left, right) = references.split_at(middle);
        (cost(left) + cost(right), middle)
    });
    cuts.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::MAX, 1))
}

/// What subtrees of the binary tree cost, as trees of the wide kind.
struct Costs {
    /// By node, then by the number of trees less one: the least cost of at most so many trees.
    forests: Vec<[f64; MOST - 1]>,
    /// Binary levels below a node, down to the leaves of the wide tree: 0 for what is best a leaf.
    heights: Vec<u8>,
}

/// Most children of a wide node.
const MOST: usize = 8;

impl Costs {
    fn new<const W: usize>(binary: &Binary, shape: &Shape) -> Self {
        let count = binary.nodes.len();
        let mut costs = Self { forests: vec![[0.0; MOST - 1]; count], heights: vec![0; count] };
        // Children come after their parents.
        for index in (0..count).rev() {
            costs.weigh::<W>(binary, index, shape);
        }
        costs
    }

    fn weigh<const W: usize>(&mut self, binary: &Binary, index: usize, shape: &Shape) {
        let node = &binary.nodes[index];
        let (area, count) = (node.bounds.half_area(), node.count as usize);
        let leaf = if count <= shape.leaf { area * (shape.leaf_cost)(count) } else { f64::INFINITY };
        if node.is_leaf() {
            self.forests[index] = [leaf; MOST - 1];
            return;
        }
        let children = node.children(index);
        let inner = area * shape.node_cost + self.cut(children, W).0;
        let mut forests = [leaf.min(inner); MOST - 1];
        for trees in 2..W {
            forests[trees - 1] = forests[trees - 2].min(self.cut(children, trees).0);
        }
        self.forests[index] = forests;
        if inner < leaf {
            self.heights[index] = 1 + children.map(|child| self.heights[child]).into_iter().max().unwrap_or(0);
        }
    }

    /// The least cost of at most `trees` trees over two nodes, 2 or more, and how many of them are for the first.
    fn cut(&self, [left, right]: [usize; 2], trees: usize) -> (f64, usize) {
        let cost = |first: usize| self.forests[left][first - 1] + self.forests[right][trees - first - 1];
        let ways = (1..trees).map(|first| (cost(first), first));
        ways.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, 1))
    }
}

/// The way down.
struct Collapse<'a, const W: usize> {
    tree: &'a Bvh2,
    binary: &'a Binary,
    costs: &'a Costs,
    arrange: Arrange<W>,
    wide: &'a mut Wide<W>,
}

impl<const W: usize> Collapse<'_, W> {
    /// Binary levels that opening the highest children first is sure to take off.
    const STEP: usize = W.ilog2() as usize;

    /// Gives a wide node the children of a binary one, and theirs, within so many levels of wide nodes.
    fn fill(&mut self, index: usize, node: usize, levels: usize) {
        let mut children = Vec::with_capacity(W);
        self.best_children(node, &mut children);
        // The cheapest way may take one level at a time: only as long as there are enough of them.
        if children.iter().any(|&child| self.costs.heights[child] as usize > Self::STEP * (levels - 1)) {
            children = self.lowest_children(node);
        }
        let bounds: Vec<Bounds> = children.iter().map(|&child| self.binary.nodes[child].bounds).collect();
        let places = (self.arrange)(&self.binary.nodes[node].bounds, &bounds);
        for (slot, child) in places.iter().enumerate() {
            self.wide.nodes[index].slots[slot] = child.map(|child| self.slot(children[child]));
        }
        for (slot, child) in places.iter().enumerate() {
            if let (Some(child), Some(Slot { link: Link::Node(below), .. })) =
                (child, self.wide.nodes[index].slots[slot])
            {
                self.fill(below as usize, children[*child], levels - 1);
            }
        }
    }

    /// With room for the node or the triangles themselves.
    fn slot(&mut self, node: usize) -> Slot {
        let binary = &self.binary.nodes[node];
        let link = if self.costs.heights[node] == 0 {
            let first = self.wide.triangles.len() as u32;
            let run = binary.first as usize..(binary.first + binary.count) as usize;
            let references = &self.binary.references[run];
            self.wide.triangles.extend(references.iter().map(|&i| self.tree.triangles[i as usize]));
            Link::Leaf(first, binary.count)
        } else {
            self.wide.nodes.push(WideNode { bounds: binary.bounds, slots: [None; W] });
            Link::Node(self.wide.nodes.len() as u32 - 1)
        };
        Slot { bounds: binary.bounds, link }
    }

    fn best_children(&self, node: usize, children: &mut Vec<usize>) {
        if self.costs.heights[node] == 0 {
            return children.push(node); // The root alone: others are leaves instead.
        }
        self.best_below(node, W, children);
    }

    fn best_below(&self, node: usize, trees: usize, children: &mut Vec<usize>) {
        let [left, right] = self.binary.nodes[node].children(node);
        let first = self.costs.cut([left, right], trees).1;
        self.best_forest(left, first, children);
        self.best_forest(right, trees - first, children);
    }

    /// At most so many trees, and no more of them than it takes for their cost.
    fn best_forest(&self, node: usize, mut trees: usize, children: &mut Vec<usize>) {
        let costs = &self.costs.forests[node];
        while trees > 1 && costs[trees - 2] <= costs[trees - 1] {
            trees -= 1;
        }
        if trees == 1 {
            children.push(node);
        } else {
            self.best_below(node, trees, children);
        }
    }

    fn lowest_children(&self, node: usize) -> Vec<usize> {
        let height = |node: usize| self.costs.heights[node];
        let mut children = vec![node];
        while children.len() < W {
            let highest = (0..children.len()).max_by_key(|&i| height(children[i])).unwrap_or(0);
            if height(children[highest]) == 0 {
                break;
            }
            let opened = children.swap_remove(highest);
            children.extend(self.binary.nodes[opened].children(opened));
        }
        children
    }
}
