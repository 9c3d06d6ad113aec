//! One scene, from its rays to what it shows.

use raywarp::accel::{Accel, AccelKind, Build, Quality};
use raywarp::query::{opaque_triangles, PixelOrder, RayCaster, RayKind, RaySource, Workload};
use raywarp::render::default_camera;
use raywarp::scene::{Camera, Scene};
use raywarp::Triangle;

use super::{costs, frames, lanes, paths, sharing, structures, Setting};
use crate::bench::Subject;
use crate::say;
use crate::study::findings::SceneStudy;

/// Kinds of rays of the study.
pub const KINDS: [RayKind; 4] = [RayKind::Primary, RayKind::Shadow, RayKind::Reflected, RayKind::Diffuse];

/// A scene with the rays that it is asked about.
pub struct Stage<'a> {
    pub setting: &'a Setting<'a>,
    pub name: &'a str,
    pub scene: &'a Scene,
    pub camera: Camera,
    /// Numbered by their place, opaque.
    pub triangles: Vec<Triangle>,
    /// The renderer's own tree in its plain layout: what everything but structures is studied with.
    pub tree: Accel,
    /// In tiles.
    pub workloads: Vec<Workload>,
}

impl Stage<'_> {
    /// Says what comes next: it may take a while.
    pub fn say(&self, what: &str) {
        say::line(&format!("{}: {what} ...", self.name));
    }

    /// The rays of all kinds, with the pixels in some order.
    pub fn workloads(&self, order: PixelOrder) -> anyhow::Result<Vec<Workload>> {
        workloads(self.setting, &self.triangles, &self.camera, &self.tree, order)
    }
}

/// The tree that ways of tracing are compared on.
pub const PLAIN: Build = Build { kind: AccelKind::Bvh2, quality: Quality::Medium, cached: false };

/// Studies a scene.
///
/// # Errors
/// It is empty or has no view, or the device fails.
pub fn scene(
    setting: &Setting,
    subject: &Subject,
    scene: &Scene,
    notes: &mut Vec<String>,
) -> anyhow::Result<SceneStudy> {
    let triangles = opaque_triangles(scene)?;
    anyhow::ensure!(!triangles.is_empty(), "the scene '{}' has no triangle that a ray can hit", subject.name);
    let camera = subject.view.adjust(default_camera(scene, &triangles));
    let tree = Accel::build(PLAIN, triangles.clone())?;
    let workloads = workloads(setting, &triangles, &camera, &tree, PixelOrder::Tiles)?;
    if workloads.iter().any(|workload| workload.rays.is_empty()) {
        notes.push(format!("{}: the camera sees nothing that rays could start from", subject.name));
    }
    let stage = Stage { setting, name: &subject.name, scene, camera, triangles, tree, workloads };
    let mut entrants = structures::entrants(&stage)?;
    let tests = costs::tests(&stage, &entrants);
    let rates = structures::rates(&stage, &entrants)?;
    let found = frames::frames(&stage)?;
    Ok(SceneStudy {
        name: subject.name.clone(),
        triangles: stage.triangles.len(),
        picture: setting.size,
        structures: structures::rows(&stage, &mut entrants, rates, &found.times),
        tests,
        shares: found.shares,
        loads: found.loads,
        lanes: lanes::lanes(&stage)?,
        shapes: found.shapes,
        sharing: sharing::sharing(&stage)?,
        paths: paths::paths(&stage)?,
    })
}

fn workloads(
    setting: &Setting,
    triangles: &[Triangle],
    camera: &Camera,
    tree: &Accel,
    order: PixelOrder,
) -> anyhow::Result<Vec<Workload>> {
    let source = RaySource::new(triangles, camera, setting.size)?.ordered(order);
    let primary = source.primary();
    let caster = RayCaster::of(tree, setting.device)?;
    let spots = source.spots(&primary.rays, &caster.hits(&primary.rays)?);
    Ok(KINDS.iter().map(|&kind| source.workload(kind, &spots, setting.least_rays)).collect())
}
