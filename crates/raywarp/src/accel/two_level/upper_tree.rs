//! Instances that move: their boxes, and the tree over them made anew.

use rayon::prelude::*;
use raywarp_core::traversal::bvh2::{Child, Node};
use raywarp_core::traversal::two_level::Instance;

use super::join::cover;
use super::place::Inverse;
use super::{upper, TwoLevel};
use crate::accel::bounds::Bounds;
use crate::scene::Transform;

/// What is needed of a structure to move its instances, without the trees of its meshes.
#[derive(Clone, Debug)]
pub(crate) struct UpperTree {
    instances: Vec<Instance>,
    /// Of each instance, in the world.
    boxes: Vec<Bounds>,
    /// Boxes that hold each mesh together, and which of the meshes each instance is of.
    covers: Vec<Vec<Bounds>>,
    meshes: Vec<u32>,
    slack: f32,
    /// The place of each instance of the scene that is not baked.
    places: Vec<Option<u32>>,
}

impl UpperTree {
    /// Of a structure over a scene of so many instances.
    pub fn of(tree: &TwoLevel, instances: usize) -> Self {
        let covers: Vec<_> = tree.parts.iter().map(|part| cover(&tree.nodes, Child::node(part.node))).collect();
        let meshes: Vec<u32> = tree.instances.iter().map(|instance| tree.part_of(instance)).collect();
        let mut places = vec![None; instances];
        for (instance, place) in tree.instances.iter().zip(0..).filter(|(instance, _)| !instance.is_baked()) {
            places[instance.index as usize] = Some(place);
        }
        let bounds = |(instance, &mesh): (&Instance, &u32)| {
            let inverse = Inverse::of_rows(instance.rows);
            inverse.and_then(|inverse| inverse.world_bounds(&covers[mesh as usize])).unwrap_or(Bounds::ALL)
        };
        let boxes = tree.instances.iter().zip(&meshes).map(bounds).collect();
        Self { instances: tree.instances.clone(), boxes, covers, meshes, slack: tree.slack, places }
    }

    /// Instances of the scene.
    pub fn placements(&self) -> usize {
        self.places.len()
    }

    /// Puts instances of the scene elsewhere. None where that needs another structure: one is baked, or would have to be.
    pub fn set_transforms(&mut self, moved: &[(usize, &Transform)]) -> Option<()> {
        let placed = |&(instance, transform): &(usize, &Transform)| {
            let place = self.places.get(instance).copied().flatten()? as usize;
            let inverse = Inverse::of(transform)?;
            let bounds = inverse.world_bounds(&self.covers[self.meshes[place] as usize])?;
            Some((place, inverse, bounds))
        };
        for (place, inverse, bounds) in moved.par_iter().map(placed).collect::<Option<Vec<_>>>()? {
            self.boxes[place] = bounds;
            self.instances[place].rows = inverse.rows;
            self.slack = self.slack.max(inverse.slack());
        }
        Some(())
    }

    /// Which of the meshes each instance is of.
    pub fn meshes(&self) -> &[u32] {
        &self.meshes
    }

    /// As traversal reads them.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The tree over the boxes as they are now, of as many nodes as before.
    pub fn nodes(&self) -> Vec<Node> {
        upper::build(&self.boxes).0
    }

    /// See [`raywarp_core::traversal::TwoLevel::slack`].
    pub fn slack(&self) -> f32 {
        self.slack
    }
}
