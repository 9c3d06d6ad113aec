//! A scene made ready for a device: arrays for shading, and the structure.

use super::flatten::{self, Flat};
use super::levels::plan;
use super::structure::{Built, Structure};
use super::RenderError;
use crate::accel::{drop_degenerate, Build, Dropped};
use crate::device::Device;
use crate::scene::Scene;

/// A scene as it goes to a device.
pub(super) struct Arranged {
    pub flat: Flat,
    pub tree: Built,
    /// Triangles that can be hit, and those that cannot.
    pub triangles: usize,
    pub dropped: Dropped,
    /// Low and high corner of all triangles; both zero where there are none.
    pub bounds: [[f32; 3]; 2],
}

impl Arranged {
    /// Every triangle in world space, in the structure that is asked for.
    pub fn in_world(scene: &Scene, what: Build, device: &Device) -> Result<Self, RenderError> {
        let mut flat = Flat::of(scene)?;
        let (list, dropped) = drop_degenerate(std::mem::take(&mut flat.triangles));
        let (triangles, bounds) = (list.len(), flatten::bounds(&list));
        let tree = Structure::arrange(device, what, list)?;
        Ok(Self { flat, tree, triangles, dropped, bounds })
    }

    /// Each mesh once, in two levels of the same hierarchy whatever the layout that is asked for.
    pub fn shared(scene: &Scene, what: Build) -> Result<Self, RenderError> {
        let plan = plan(scene, &scene.instances, &scene.materials)?;
        let flat = Flat::sharing(scene, &scene.instances, &scene.materials, |instance| plan.is_shared(instance))?;
        let (tree, counts) = Structure::arrange_instances(plan, what)?;
        let bounds = flatten::bounds_of_instances(scene);
        Ok(Self { flat, tree, triangles: counts.seen as usize, dropped: counts.dropped, bounds })
    }
}
