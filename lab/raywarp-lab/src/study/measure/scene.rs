//! One scene, from its rays to what it shows.

use raywarp::accel::Quality;
use raywarp::query::{opaque_triangles, PixelOrder, RayKind, RaySource, Workload};
use raywarp::render::default_camera;
use raywarp::scene::{Camera, Scene};
use raywarp::Triangle;
use raywarp_lab::structures::{Build, StructureKind, Tree};

use super::{costs, frames, lanes, paths, sharing, structures, Setting};
use crate::study::findings::SceneStudy;
use raywarp_cli::bench::Subject;
use raywarp_cli::failure::{ensure, Result};
use raywarp_cli::messages;

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
    pub tree: Tree,
    /// In tiles.
    pub workloads: Vec<Workload>,
    /// The pixel, row by row, of each camera ray, and of each point where others start.
    pixels: Vec<u32>,
    spots: Vec<u32>,
}

impl Stage<'_> {
    /// Says what comes next: it may take a while.
    pub fn say(&self, what: &str) {
        messages::line(&format!("{}: {what} ...", self.name));
    }

    /// The same rays of a kind, in the order of their pixels along another way through the picture.
    pub fn reordered(&self, workload: &Workload, order: PixelOrder) -> Workload {
        let starts = match workload.kind {
            RayKind::Primary => &self.pixels,
            _ => &self.spots,
        };
        // Rank of each pixel in that order; rays that start again from the first one on stay behind the others.
        let [width, height] = self.setting.size;
        let mut rank = vec![0; width as usize * height as usize];
        for (place, [x, y]) in order.pixels(self.setting.size).into_iter().enumerate() {
            rank[(y * width + x) as usize] = place;
        }
        let key = |index: usize| (index / starts.len(), rank[starts[index % starts.len()] as usize]);
        let mut indices: Vec<usize> = (0..workload.rays.len()).collect();
        indices.sort_by_key(|&index| key(index));
        Workload { kind: workload.kind, rays: indices.into_iter().map(|index| workload.rays[index]).collect() }
    }
}

/// The tree that ways of tracing are compared on.
pub const PLAIN: Build = Build { kind: StructureKind::BVH2, quality: Quality::Medium };

/// Studies a scene.
///
/// # Errors
/// It is empty or has no view, or the device fails.
pub fn scene(setting: &Setting, subject: &Subject, scene: &Scene, notes: &mut Vec<String>) -> Result<SceneStudy> {
    let triangles = opaque_triangles(scene)?;
    ensure!(!triangles.is_empty(), "the scene '{}' has no triangle that a ray can hit", subject.name);
    let camera = subject.view.adjust(default_camera(scene));
    let tree = Tree::build(PLAIN, triangles.clone())?;
    let source = RaySource::new(&triangles, &camera, setting.size)?;
    let primary = source.primary();
    let hits = tree.caster(setting.device)?.hits(&primary.rays)?;
    let all = source.spots(&primary.rays, &hits);
    let workloads: Vec<_> = KINDS.iter().map(|&kind| source.workload(kind, &all, setting.least_rays)).collect();
    let pixels: Vec<u32> =
        PixelOrder::Tiles.pixels(setting.size).iter().map(|[x, y]| y * setting.size[0] + x).collect();
    let seen = |index: &usize| !source.spots(&primary.rays[*index..=*index], &hits[*index..=*index]).is_empty();
    let spots = (0..pixels.len()).filter(seen).map(|index| pixels[index]).collect();
    if workloads.iter().any(|workload| workload.rays.is_empty()) {
        notes.push(format!("{}: the camera sees nothing that rays could start from", subject.name));
    }
    let stage = Stage { setting, name: &subject.name, scene, camera, triangles, tree, workloads, pixels, spots };
    let entrants = structures::entrants(&stage)?;
    let tests = costs::tests(&stage, &entrants);
    let rates = structures::rates(&stage, &entrants)?;
    let found = frames::frames(&stage)?;
    Ok(SceneStudy {
        name: subject.name.clone(),
        triangles: stage.triangles.len(),
        picture: setting.size,
        structures: structures::rows(&stage, entrants, rates, &found.times),
        tests,
        shares: found.shares,
        loads: found.loads,
        lanes: lanes::lanes(&stage)?,
        shapes: found.shapes,
        sharing: sharing::sharing(&stage)?,
        paths: paths::paths(&stage)?,
    })
}
