//! A scene made ready for a device: arrays for shading, and the structure.

use std::time::Instant;

use super::fast::Counts;
use super::flatten::{self, Flat};
use super::levels::plan;
use super::structure::{Built, Structure};
use super::{Levels, Report, SceneError};
use crate::accel::two_level::Plan;
use crate::accel::Build;
use crate::device::Device;
use crate::scene::Scene;
use crate::Triangle;

/// A scene as it goes to a device.
pub(super) struct Arranged {
    /// For shading; empty where there is none.
    pub flat: Flat,
    pub tree: Built,
    pub report: Report,
}

impl Arranged {
    /// For pictures and queries.
    pub fn of(scene: &Scene, levels: Levels, what: Build, device: &Device) -> Result<Self, SceneError> {
        let start = Instant::now();
        if levels.are_two(scene) {
            let plan = plan(scene, &scene.instances, &scene.materials)?;
            let flat = Flat::sharing(scene, &scene.instances, &scene.materials, |instance| plan.is_shared(instance))?;
            return Ok(Self::of_instances(scene, plan, what)?.shading(flat, start));
        }
        let mut flat = Flat::of(scene)?;
        let triangles = std::mem::take(&mut flat.triangles);
        Ok(Self::of_triangles(triangles, what, device)?.shading(flat, start))
    }

    /// For queries.
    pub fn geometry(scene: &Scene, levels: Levels, what: Build, device: &Device) -> Result<Self, SceneError> {
        if levels.are_two(scene) {
            return Self::of_instances(scene, plan(scene, &scene.instances, &scene.materials)?, what);
        }
        Self::of_triangles(Flat::of(scene)?.triangles, what, device)
    }

    /// In the structure that is asked for.
    pub fn of_triangles(triangles: Vec<Triangle>, what: Build, device: &Device) -> Result<Self, SceneError> {
        let (tree, Counts { triangles, dropped, bounds }) = Structure::arrange(device, what, triangles)?;
        let report = Report { triangles, dropped, bounds, ..tree.report() };
        Ok(Self { flat: Flat::default(), tree, report })
    }

    /// Each mesh once, in two levels of the same hierarchy whatever the layout that is asked for.
    fn of_instances(scene: &Scene, plan: Plan, what: Build) -> Result<Self, SceneError> {
        let (tree, counts) = Structure::arrange_instances(plan, what)?;
        let bounds = flatten::bounds_of_instances(scene);
        let report = Report { triangles: counts.seen as usize, dropped: counts.dropped, bounds, ..tree.report() };
        Ok(Self { flat: Flat::default(), tree, report })
    }

    /// With arrays that were begun to be made at `start`, as was the structure.
    fn shading(mut self, flat: Flat, start: Instant) -> Self {
        self.report.vertices = flat.positions.len();
        self.report.flatten_seconds = start.elapsed().as_secs_f64() - self.report.build_seconds;
        self.flat = flat;
        self
    }
}
