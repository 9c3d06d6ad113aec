//! A scene on a device: one structure, shared by pictures and queries, that can be changed in place.
//!
//! A [`Tracer`](crate::Tracer) takes pictures of it and a [`RayCaster`](crate::RayCaster) answers rays, any number of them at
//! a time. It is changed where nobody else holds it: [`Tracer::scene_mut`](crate::Tracer::scene_mut).
//!
//! ```
//! use std::sync::Arc;
//!
//! use raywarp::accel::AccelKind;
//! use raywarp::device::{Device, DeviceChoice};
//! use raywarp::{DeviceScene, Ray, RayCaster, Tracer, Vec3};
//!
//! let scene = raywarp::scene::load::builtin()?.scene;
//! let device = Device::open(DeviceChoice::Auto)?;
//! let on_device = Arc::new(DeviceScene::new(&scene, AccelKind::default(), &device)?);
//! let mut tracer = Tracer::of_scene(Arc::clone(&on_device))?;
//! let down = Ray::new(Vec3::new(0.1, 5.0, 0.2), Vec3::new(0.0, -1.0, 0.0));
//! assert!(RayCaster::of_scene(on_device).any(&[down])?[0]);
//! // Nobody holds the scene now but the tracer.
//! tracer.scene_mut()?.set_lights(&scene);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arrange;
mod changes;
mod error;
mod fast;
pub(crate) mod flatten;
mod levels;
mod lighting;
mod materials;
mod metallic_roughness;
mod report;
mod resident;
mod structure;

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use raywarp_core::light::Light;
use raywarp_core::surface;

use crate::accel::{Build, Refitting};
use crate::device::{Buffer, Device};
use crate::render::default_camera;
use crate::render::path::PathSource;
use crate::scene::{Camera, Scene};
use crate::Triangle;
use arrange::Arranged;
pub(crate) use flatten::{check_instance, check_mesh, flags_of, Flat};
use lighting::Ambient;
pub(crate) use lighting::Lighting;
pub(crate) use materials::Surfaces;
use resident::ResidentScene;

pub use changes::world_triangles;
pub use error::SceneError;
pub use levels::{two_level, Levels};
pub use lighting::{ambient, sky};
pub use report::Report;
pub use structure::Structure;

/// A scene in the memory of a device.
pub struct DeviceScene {
    device: Device,
    structure: Structure,
    appearance: Option<Appearance>,
    report: Report,
}

/// What pictures need beside the structure.
pub(crate) struct Appearance {
    pub resident: ResidentScene,
    pub lighting: Lighting,
    /// The first of the scene, or one that frames it.
    pub camera: Camera,
    /// Where the instances are.
    instances: Vec<surface::Instance>,
    /// Where their vertices are.
    vertices: Vec<Range<usize>>,
    /// For path tracing.
    pub path: PathSource,
    /// Of the triangles of each material.
    flags: Vec<u32>,
    /// Of the structure, once something has moved.
    refitting: Option<Refitting>,
}

impl DeviceScene {
    /// Brings a scene to a device, for pictures and queries.
    ///
    /// # Errors
    /// [`SceneError`] where the scene has indices out of range, or is too large for the structure or for the device's memory.
    pub fn new(scene: &Scene, what: impl Into<Build>, device: &Device) -> Result<Self, SceneError> {
        Self::with_levels(scene, Levels::Auto, what, device)
    }

    /// The same, with instances or without. Pictures of the two may differ where rounding decides, as rays are brought to
    /// the space of a mesh or its triangles to world space.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn with_levels(
        scene: &Scene,
        levels: Levels,
        what: impl Into<Build>,
        device: &Device,
    ) -> Result<Self, SceneError> {
        Self::arranged(Arranged::of(scene, levels, what.into(), device)?, Some(scene), device)
    }

    /// The structure over a scene alone, which answers queries: nothing of materials, textures and lights.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn geometry(
        scene: &Scene,
        levels: Levels,
        what: impl Into<Build>,
        device: &Device,
    ) -> Result<Self, SceneError> {
        Self::arranged(Arranged::geometry(scene, levels, what.into(), device)?, None, device)
    }

    /// The same over those of the triangles that can be hit. Hits say the primitive and the instance that the triangles have.
    ///
    /// # Errors
    /// [`SceneError`] for too many triangles for the structure or for the device's memory.
    pub fn of_triangles(triangles: Vec<Triangle>, what: impl Into<Build>, device: &Device) -> Result<Self, SceneError> {
        Self::arranged(Arranged::of_triangles(triangles, what.into(), device)?, None, device)
    }

    /// The same of a structure that is on the device already.
    pub fn of_structure(structure: Structure, device: &Device) -> Self {
        let stats = structure.stats;
        let report = Report { triangles: structure.triangles(), tree: stats, ..Report::default() };
        Self { device: device.clone(), structure, appearance: None, report }
    }

    fn arranged(arranged: Arranged, scene: Option<&Scene>, device: &Device) -> Result<Self, SceneError> {
        let Arranged { flat, tree, mut report } = arranged;
        let shading = scene.map_or(0, |scene| ResidentScene::bytes(&flat, scene));
        report.device_bytes += shading;
        device.reserve(tree.bytes_to_upload() + shading, "the scene")?;
        let start = Instant::now();
        let appearance = scene.map(|scene| Appearance::upload(device, scene, flat, report.bounds)).transpose()?;
        let structure = tree.upload(device)?;
        report.upload_seconds = start.elapsed().as_secs_f64();
        if scene.is_some_and(|scene| scene.cameras.is_empty()) {
            report.notes.push("no camera in the scene: it is framed".to_owned());
        }
        report.notes.extend(structure.warning.clone());
        Ok(Self { device: device.clone(), structure, appearance, report })
    }

    /// Where it is.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// What became of the scene.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// What finds the triangles along a ray.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// For pictures.
    pub(crate) fn appearance(&self) -> Result<&Appearance, SceneError> {
        self.appearance.as_ref().ok_or(SceneError::GeometryAlone)
    }

    /// To be changed, where nobody else holds it.
    pub(crate) fn exclusive(this: &mut Arc<Self>) -> Result<&mut Self, SceneError> {
        let holders = Arc::strong_count(this);
        Arc::get_mut(this).ok_or(SceneError::Shared { holders })
    }
}

impl Appearance {
    /// Of a scene with these arrays, between a low and a high corner.
    fn upload(device: &Device, scene: &Scene, flat: Flat, bounds: [[f32; 3]; 2]) -> Result<Self, SceneError> {
        let surfaces = materials::ready(&scene.materials, &scene.images, Ambient::of(scene));
        Ok(Self {
            resident: ResidentScene::upload(device, &flat, scene, &surfaces)?,
            lighting: Lighting::of(scene),
            camera: default_camera(scene),
            path: PathSource::new(scene, &surfaces, bounds),
            instances: flat.instances,
            vertices: flat.vertices,
            flags: scene.materials.iter().map(flags_of).collect(),
            refitting: None,
        })
    }

    /// As kernels read it, with lights that were [uploaded](Lighting::upload).
    pub fn view(&self, lights: &Buffer<Light>) -> surface::Scene {
        self.resident.view(lights, &self.lighting)
    }
}
