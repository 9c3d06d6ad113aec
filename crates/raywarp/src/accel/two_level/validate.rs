//! Proof that a traversal of two levels ends, stays within the arrays and meets every triangle that a ray may hit.

use raywarp_core::ray::MISS;
use raywarp_core::traversal::bvh2::{Child, Node};
use raywarp_core::traversal::two_level::{Instance, MAX_UPPER_DEPTH};

use super::join::cover;
use super::place::Inverse;
use super::{Part, TwoLevel};
use crate::accel::bounds::Bounds;
use crate::accel::bvh2::{child_box, children_of, Bvh2};
use crate::accel::Invalid;

impl TwoLevel {
    /// Whether a traversal ends, stays within the arrays and meets every triangle that a ray may hit.
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        let upper = self.upper_nodes();
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
        let covers: Vec<_> = self.parts.iter().map(|part| cover(&self.nodes, Child::node(part.node))).collect();
        let check = |(number, instance): (u32, &Instance)| {
            let wrong = |flaw| Invalid::Instance { instance: number, flaw };
            let part = self.parts.binary_search_by(|part| part.node.cmp(&instance.root.index()));
            let part = part.ok().filter(|_| !instance.root.is_leaf());
            let part = part.ok_or_else(|| wrong("begins at a node that is the root of no mesh"))?;
            if instance.index == MISS {
                return Err(wrong("has the number that means a miss"));
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
    tree: &'a TwoLevel,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::two_level::{build, Placement};
    use crate::accel::Quality;
    use crate::scene::Transform;
    use raywarp_core::math::vec3;
    use raywarp_core::triangle::Triangle;

    /// Two meshes, the first in three places, the second in two.
    fn scene() -> TwoLevel {
        let row = |count: u32| -> Vec<Triangle> {
            let at = |i: u32, y, z| vec3(i as f32, y, z);
            (0..count).map(|i| Triangle::new(at(i, 0.0, 0.0), at(i, 1.0, 0.0), at(i, 0.0, 1.0), i, 0)).collect()
        };
        let place = |mesh: usize, x: f32| {
            let columns = [[0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.5, 3.0]];
            let transform = Transform { columns, translation: [x, 0.0, 0.0] };
            Placement { mesh, transform, instance: x as u32, flags: None }
        };
        let places = [place(0, 0.0), place(0, 30.0), place(1, 60.0), place(0, 90.0), place(1, 120.0)];
        build(vec![row(20), row(30)], &places, Quality::default()).unwrap()
    }

    #[test]
    fn what_was_built_is_whole() {
        assert_eq!(scene().validate(), Ok(()));
    }

    #[test]
    fn flaws_of_the_upper_tree_are_found() {
        let broken = |change: fn(&mut TwoLevel)| {
            let mut tree = scene();
            change(&mut tree);
            tree.validate().unwrap_err()
        };
        assert_eq!(broken(|tree| tree.nodes.clear()), Invalid::NoRoot);
        assert_eq!(broken(|tree| tree.parts.clear()), Invalid::NoRoot);
        assert_eq!(broken(|tree| tree.nodes[0].children[0] = Child::node(0)), Invalid::Reached { node: 0 });
        // A node of a mesh.
        assert!(matches!(broken(|tree| tree.nodes[0].children[0] = Child::node(4)), Invalid::OutOfRange { .. }));
        assert!(matches!(broken(|tree| tree.nodes[3].children[0] = Child::leaf(5, 1)), Invalid::OutOfRange { .. }));
        assert!(matches!(broken(|tree| tree.nodes[3].children[0] = Child::leaf(0, 2)), Invalid::OutOfRange { .. }));
        assert_eq!(broken(|tree| tree.nodes[0].high[1].x -= 1.0), Invalid::Outside { node: 0 });
        assert_eq!(
            broken(|tree| tree.nodes[0].low[0] = vec3(1e9, 0.0, 0.0)),
            Invalid::Unreached { reached: 3, count: 4 }
        );
    }

    #[test]
    fn flaws_of_instances_are_found() {
        let broken = |change: fn(&mut TwoLevel)| {
            let mut tree = scene();
            change(&mut tree);
            let flaw = tree.validate().unwrap_err();
            assert!(matches!(flaw, Invalid::Instance { instance: 1 | 2, .. } | Invalid::Outside { .. }), "{flaw}");
            flaw.to_string()
        };
        assert!(broken(|tree| tree.instances[1].root = Child::node(0)).contains("root of no mesh"));
        assert!(broken(|tree| tree.instances[1].root = Child::leaf(4, 1)).contains("root of no mesh"));
        assert!(broken(|tree| tree.instances[2].index = MISS).contains("means a miss"));
        assert!(broken(|tree| tree.instances[1].rows[1] = [0.0; 4]).contains("cannot be undone"));
        assert!(broken(|tree| tree.instances[1].rows[0][0] += 20.0).contains("slack"));
        assert!(broken(|tree| tree.instances[1].rows[0][3] += 0.5).contains("sticks out"));
    }

    #[test]
    fn flaws_of_a_mesh_say_which() {
        let mut tree = scene();
        let second = tree.parts[1].node as usize;
        tree.nodes[second].high[0].x -= 1.0;
        let flaw = Box::new(Invalid::Outside { node: 0 });
        assert_eq!(tree.validate(), Err(Invalid::Mesh { mesh: 1, flaw }));
        // Into the first mesh.
        let mut tree = scene();
        tree.nodes[second].children[0] = Child::node(4);
        assert!(matches!(tree.validate(), Err(Invalid::Mesh { mesh: 1, .. })));
    }
}
