//! Boxes of a tree on a device that follow its triangles.

use raywarp_core::math::Vec3;
use raywarp_core::refit::{FindParents, Refit};
use raywarp_core::traversal::bvh2_quantized;
use raywarp_core::traversal::bvh2_quantized::Grid;
use raywarp_core::view::ViewMut;
use raywarp_device::kernels::Views;

use super::bounds::Bounds;
use super::bvh2_quantized::{covered, grid};
use super::{ResidentBvh2, ResidentDual};
use crate::device::{Buffer, Device, DeviceError};

/// Room for it, made once a tree.
pub(crate) struct Refitting {
    parents: Buffer<u32>,
    arrivals: Buffer<u32>,
    areas: Buffer<f32>,
    /// The sum of all areas before anything had moved.
    new: f32,
}

/// A tree that can be changed: its nodes of 64 bytes, and those of 32 if there are any.
pub(crate) struct Movable<'a> {
    pub full: &'a mut ResidentBvh2,
    small: Option<(&'a mut Buffer<bvh2_quantized::Node>, &'a mut Grid)>,
}

impl<'a> From<&'a mut ResidentBvh2> for Movable<'a> {
    fn from(full: &'a mut ResidentBvh2) -> Self {
        Self { full, small: None }
    }
}

impl<'a> From<&'a mut ResidentDual> for Movable<'a> {
    fn from(ResidentDual { full, small, grid }: &'a mut ResidentDual) -> Self {
        Self { full, small: Some((small, grid)) }
    }
}

impl Movable<'_> {
    /// Makes room for triangles whose corners are among these points: in the bounds of rounding errors, and on the grid of the
    /// small nodes, which grows by more than it must, lest it grow with every step.
    pub fn include(&mut self, points: &[Vec3]) {
        let Some((&first, rest)) = points.split_first() else { return };
        let (low, high) = rest.iter().fold((first, first), |(low, high), &v| (low.min(v), high.max(v)));
        let extent = (high - low).max_abs();
        let around = Bounds::padded(low.to_array(), high.to_array(), extent);
        let far = [0, 1, 2].map(|i| around.low[i].abs().max(around.high[i].abs()));
        let reach = self.full.reach.to_array();
        self.full.reach = [0, 1, 2].map(|i| reach[i].max(far[i])).into();
        let Some((_, now)) = &mut self.small else { return };
        let before = covered(now);
        if !before.contains(&around) {
            **now = grid(&before.join(&roomy(&around)));
        }
    }
}

/// An eighth larger on every side, as far as single precision goes.
fn roomy(bounds: &Bounds) -> Bounds {
    let more = [0, 1, 2].map(|i| (bounds.high[i] - bounds.low[i]) * 0.125);
    Bounds {
        low: [0, 1, 2].map(|i| (bounds.low[i] - more[i]).max(-f32::MAX)),
        high: [0, 1, 2].map(|i| (bounds.high[i] + more[i]).min(f32::MAX)),
    }
}

impl Refitting {
    /// Of a tree before anything has moved; waits for the sum of its areas.
    pub fn of(device: &Device, tree: &mut Movable) -> Result<Self, DeviceError> {
        let count = tree.full.nodes.len();
        let (mut parents, arrivals) = (device.zeroed(count as usize)?, device.zeroed(count as usize)?);
        let find = FindParents { nodes: tree.full.nodes.view(), parents: parents.view_mut() };
        // SAFETY: the buffers are borrowed for the call and of this device; links were checked by the builder.
        unsafe { device.launch(&find, [count, 1]) }?;
        let mut refitting = Self { parents, arrivals, areas: device.zeroed(count as usize)?, new: 0.0 };
        refitting.refit(device, tree)?;
        refitting.new = refitting.area()?;
        Ok(refitting)
    }

    /// The sum of the areas of all boxes over what it was before anything had moved: a tree that traces as well as then has
    /// about 1, and from 1.3 on a new one is worth its time. Waits for it.
    pub fn growth(&self) -> Result<f64, DeviceError> {
        let growth = f64::from(self.area()?) / f64::from(self.new);
        // Without areas, or beyond single precision, there is nothing to tell.
        Ok(if growth.is_finite() { growth } else { 1.0 })
    }

    fn area(&self) -> Result<f32, DeviceError> {
        Ok(self.areas.read(0, 1)?[0])
    }

    /// Gives all boxes the triangles as they are now: enqueued.
    pub fn refit(&mut self, device: &Device, tree: &mut Movable) -> Result<(), DeviceError> {
        let grid = tree.small.as_ref().map_or(Grid { base: Vec3::ZERO, scale: Vec3::ONE }, |(_, grid)| **grid);
        let small = tree.small.as_mut().map_or(ViewMut::EMPTY, |(small, _)| small.view_mut());
        let triangles = tree.full.triangles.view();
        let count = tree.full.nodes.len();
        let refit = Refit {
            nodes: tree.full.nodes.view_mut(),
            small,
            grid,
            triangles,
            parents: self.parents.view(),
            arrivals: self.arrivals.view_mut(),
            areas: self.areas.view_mut(),
        };
        // SAFETY: as above; the launch leaves the arrivals as it found them.
        unsafe { device.launch(&refit, [count, 1]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bvh2_quantized::{compress, same};
    use crate::accel::hploc::{NodeSizes, TreeBuilder};
    use crate::device::DeviceChoice;
    use crate::Triangle;

    fn triangles(shift: f32) -> Vec<Triangle> {
        let corner = |i: u32, y: f32| Vec3::new((i as f32 * 0.618).fract() * shift, y, (i as f32 * 0.414).fract());
        (0..2000).map(|i| Triangle::new(corner(i, 0.0), corner(i, 0.1), corner(i + 1, 0.0), i, 0)).collect()
    }

    #[test]
    fn small_nodes_follow_beyond_their_grid() {
        let device = Device::open(DeviceChoice::Cpu).unwrap();
        let given = device.upload(&triangles(1.0)).unwrap();
        let built = TreeBuilder::new(&device, 2000).unwrap().build(&given, NodeSizes::Both).unwrap();
        let mut tree = ResidentDual::from(built.tree);
        let mut refitting = Refitting::of(&device, &mut Movable::from(&mut tree)).unwrap();
        assert_eq!(refitting.growth().unwrap(), 1.0);
        for (shift, grows) in [(0.5, false), (1.0, false), (7.0, true), (7.5, false)] {
            let (moved, before) = (triangles(shift), tree.grid);
            let ordered: Vec<Triangle> =
                tree.full.triangles.to_vec().unwrap().iter().map(|t| moved[t.primitive as usize]).collect();
            tree.full.triangles.write(0, &ordered).unwrap();
            let mut movable = Movable::from(&mut tree);
            movable.include(&moved.iter().flat_map(|t| [t.v0, t.v1, t.v2]).collect::<Vec<_>>());
            refitting.refit(&device, &mut movable).unwrap();
            assert_eq!(tree.grid != before, grows, "{shift}");
            let nodes = tree.full.nodes.to_vec().unwrap();
            assert_eq!(same(&nodes, &tree.small.to_vec().unwrap(), &tree.grid), Ok(()), "{shift}");
            let expanded: Vec<_> = compress(&nodes, &tree.grid)
                .iter()
                .map(|node| crate::accel::bvh2_quantized::expand(node, &tree.grid))
                .collect();
            let small = crate::accel::bvh2::Bvh2::from_parts(expanded, ordered).map(drop);
            assert_eq!(small, Ok(()), "{shift}");
        }
        assert!(refitting.growth().unwrap() > 2.0);
    }
}
