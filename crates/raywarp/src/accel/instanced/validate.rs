//! Proof that a traversal of two levels ends, stays within the arrays and meets every triangle that a ray may hit.

use raywarp_kernels::ray::MISS;
use raywarp_kernels::traverse::bvh2::{Child, Node};
use raywarp_kernels::traverse::instanced::{Instance, MAX_UPPER_DEPTH};

use super::join::cover;
use super::place::Inverse;
use super::{Instanced, Part};
use crate::accel::bounds::Bounds;
use crate::accel::bvh2::{child_box, children_of, Bvh2};
use crate::accel::Invalid;

impl Instanced {
    /// Whether a traversal ends, stays within the arrays, meets every triangle that a ray may hit and calls it by a name
    /// of its own mesh.
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        let upper = self.parts.first().map_or(0, |part| part.node as usize);
        if upper == 0 || upper > self.nodes.len() {
            return Err(Invalid::NoRoot);
        }
        for (mesh, &part) in (0..).zip(&self.parts) {
            self.check_mesh(mesh, part).map_err(|flaw| Invalid::Mesh { mesh, flaw: Box::new(flaw) })?;
        }
        let boxes = self.check_instances()?;
        let mut walk = Walk {
            tree: self,
            upper,
            boxes: &boxes,
            reached: vec![false; upper],
            leaves: vec![0; self.instances.len()],
        };
        walk.node(0, 0)?;
        walk.everything_reached()
    }

    /// As a tree by itself.
    fn check_mesh(&self, mesh: u32, part: Part) -> Result<(), Invalid> {
        let end = Part { node: self.nodes.len() as u32, triangle: self.triangles.len() as u32 };
        let end = self.parts.get(mesh as usize + 1).copied().unwrap_or(end);
        let nodes = part.node as usize..end.node as usize;
        let triangles = part.triangle as usize..end.triangle as usize;
        let (Some(nodes), Some(triangles)) = (self.nodes.get(nodes), self.triangles.get(triangles)) else {
            return Err(Invalid::NoRoot);
        };
        let alone = (0..).zip(nodes).map(|(index, node)| apart(index, node, part)).collect::<Result<_, _>>()?;
        Bvh2::from_parts(alone, triangles.to_vec()).map(drop)
    }

    /// The box that each instance needs in the world; none for one of an empty mesh.
    fn check_instances(&self) -> Result<Vec<Option<Bounds>>, Invalid> {
        let largest: Vec<u32> = (0..self.parts.len()).map(|part| self.largest_primitive(part)).collect();
        let covers: Vec<_> = self.parts.iter().map(|part| cover(&self.nodes, Child::node(part.node))).collect();
        let check = |(number, instance): (u32, &Instance)| {
            let wrong = |flaw| Invalid::Instance { instance: number, flaw };
            let part = self.parts.binary_search_by(|part| part.node.cmp(&instance.root.index()));
            let part = part.ok().filter(|_| !instance.root.is_leaf());
            let part = part.ok_or_else(|| wrong("begins at a node that is the root of no mesh"))?;
            if instance.first_primitive.checked_add(largest[part]).is_none_or(|last| last == MISS) {
                return Err(wrong("calls a triangle by a number that means a miss"));
            }
            let inverse = Inverse::of_rows(instance.rows);
            let inverse = inverse.ok_or_else(|| wrong("has a transform that cannot be undone"))?;
            if inverse.slack() > self.slack {
                return Err(wrong("rounds rays by more than the structure has slack for"));
            }
            Ok(inverse.world_bounds(&covers[part]))
        };
        (0..).zip(&self.instances).map(check).collect()
    }

    fn largest_primitive(&self, part: usize) -> u32 {
        let first = self.parts[part].triangle as usize;
        let end = self.parts.get(part + 1).map_or(self.triangles.len(), |next| next.triangle as usize);
        // The triangle of an empty mesh has no name.
        self.triangles[first..end].iter().map(|t| t.primitive).filter(|&p| p != MISS).max().unwrap_or(0)
    }
}

/// The node as if its mesh's arrays began at 0.
fn apart(index: u32, node: &Node, part: Part) -> Result<Node, Invalid> {
    let moved = |child: Child| {
        let (what, first) = if child.is_leaf() { ("triangle", part.triangle) } else { ("node", part.node) };
        let outside = Invalid::OutOfRange { node: index, what, index: child.index().into(), count: 0 };
        let own = child.index().checked_sub(first).ok_or(outside)?;
        Ok(if child.is_leaf() { Child::leaf(own, child.count()) } else { Child::node(own) })
    };
    let [left, right] = node.children.map(moved);
    Ok(Node { children: [left?, right?], ..*node })
}

/// What has been seen of the upper tree on the way down.
struct Walk<'a> {
    tree: &'a Instanced,
    /// Nodes of the upper tree.
    upper: usize,
    boxes: &'a [Option<Bounds>],
    reached: Vec<bool>,
    leaves: Vec<u32>,
}

impl Walk<'_> {
    /// Checks a node with `above` others on the way to it, and gives the box of the instances below it.
    fn node(&mut self, index: u32, above: usize) -> Result<Bounds, Invalid> {
        if above >= MAX_UPPER_DEPTH {
            return Err(Invalid::TooDeep { node: index, limit: MAX_UPPER_DEPTH });
        }
        if std::mem::replace(&mut self.reached[index as usize], true) {
            return Err(Invalid::Reached { node: index });
        }
        let node = &self.tree.nodes[index as usize];
        node.children.iter().try_for_each(|&child| self.in_range(index, child))?;
        let mut all = Bounds::EMPTY;
        for side in children_of(node) {
            let child = node.children[side];
            let below = if child.is_leaf() { self.leaf(child) } else { self.node(child.index(), above + 1)? };
            if !child_box(node, side).contains(&below) {
                return Err(Invalid::Outside { node: index });
            }
            all = all.join(&below);
        }
        Ok(all)
    }

    /// Of a child that does not exist too: a ray of NaN may follow it.
    fn in_range(&self, node: u32, child: Child) -> Result<(), Invalid> {
        let (what, count) =
            if child.is_leaf() { ("instance", self.tree.instances.len()) } else { ("node", self.upper) };
        let end = u64::from(child.index()) + u64::from(child.count().max(1));
        if end > count as u64 || child.count() > 1 {
            return Err(Invalid::OutOfRange { node, what, index: end - 1, count });
        }
        Ok(())
    }

    fn leaf(&mut self, child: Child) -> Bounds {
        self.leaves[child.index() as usize] += 1;
        self.boxes[child.index() as usize].unwrap_or(Bounds::EMPTY)
    }

    fn everything_reached(&self) -> Result<(), Invalid> {
        let reached = self.reached.iter().filter(|&&reached| reached).count();
        if reached != self.upper {
            return Err(Invalid::Unreached { reached, count: self.upper });
        }
        match self.leaves.iter().zip(self.boxes).position(|(&leaves, bounds)| leaves != bounds.is_some() as u32) {
            Some(lost) => Err(Invalid::Instance { instance: lost as u32, flaw: "is not in exactly one leaf" }),
            None => Ok(()),
        }
    }
}
