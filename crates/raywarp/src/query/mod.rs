//! Batches of rays, answered without a picture: closest hit, any hit, all hits, their number.
//!
//! A [`RayCaster`] holds a scene on a device. It answers slices of any length, in passes that fit the device's memory
//! ([`batch`](RayCaster::batch) reports on them and can be ended), and buffers of the device ([`device`]), on a stream if
//! need be. [`files`] reads rays and writes answers as NumPy and CSV files. All four questions are asked of one traversal
//! and agree: a ray's count is the number of all its hits, the first of which is the closest, and there is any hit where
//! there is one. What a hit is, and which rays have none, is said at [`Ray`]. [`RaySource`] makes the rays that raywarp
//! and its peers are measured with.

mod batch;
mod closest_point;
mod coherence;
mod cost;
pub mod device;
pub mod enqueue;
mod error;
pub mod files;
mod geometry;
mod hit_buffers;
mod hits;
pub(crate) mod kernels;
mod launch;
mod ray_kind;
mod timed;
mod workload;

use std::sync::Arc;

use crate::accel::Build;
use crate::device::Device;
use crate::device_scene::{DeviceScene, Levels, Report, SceneError, Structure};
use crate::scene::Scene;
use crate::{Hit, Ray, Triangle};

pub use batch::{Batch, Progress};
pub use closest_point::ClosestPoints;
pub use coherence::Coherence;
pub use cost::{sampled, tests, Cost};
pub use error::QueryError;
pub use geometry::{intersect, world_triangle};
pub use hit_buffers::HitBuffers;
pub use hits::{AllHits, Hits};
use kernels::QueryKernels;
pub(crate) use launch::persistent;
pub use ray_kind::{RayKind, UnknownRayKind};
pub use raywarp_core::traversal::Tests;
pub use timed::{Answers, Timed};
pub use workload::{opaque_triangles, PixelOrder, RaySource, Spot, Workload};

/// Triangles on a device, ready to be asked. Cloning gives another handle to the same.
///
/// ```
/// use raywarp::accel::AccelKind;
/// use raywarp::device::{Device, DeviceChoice};
/// use raywarp::query::RayCaster;
/// use raywarp::{Ray, Vec3};
///
/// let scene = raywarp::scene::load::builtin()?.scene;
/// let device = Device::open(DeviceChoice::Auto)?;
/// let caster = RayCaster::from_scene(&scene, AccelKind::default(), &device)?;
///
/// let down = Ray::new(Vec3::new(0.1, 5.0, 0.2), Vec3::new(0.0, -1.0, 0.0));
/// let up = Ray { direction: Vec3::new(0.0, 1.0, 0.0), ..down };
/// let hits = caster.closest(&[down, up])?;
/// println!("triangle {} of instance {} at {}", hits.primitive[0], hits.geometry[0], hits.t[0]);
/// assert_eq!(hits.t[1], f32::INFINITY);
///
/// let all = caster.all(&[down, up])?;
/// assert_eq!(all.hits.t[0], hits.t[0]);
/// assert_eq!(all.offsets[1] as u32, caster.count(&[down])?[0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct RayCaster {
    scene: Arc<DeviceScene>,
    /// What is expected of rays in buffers.
    expected: Coherence,
}

impl RayCaster {
    /// Brings the geometry of a scene to a device.
    ///
    /// # Errors
    /// The scene has indices out of range, or too many triangles for the structure or for the device's memory.
    pub fn from_scene(scene: &Scene, what: impl Into<Build>, device: &Device) -> Result<Self, QueryError> {
        Ok(Self::of_scene(Arc::new(DeviceScene::geometry(scene, Levels::Auto, what, device)?)))
    }

    /// Of the triangles that can be hit, brought to a device. Hits say the primitive and the instance that the triangles have.
    ///
    /// # Errors
    /// Too many triangles for the structure or for the device's memory.
    pub fn new(triangles: Vec<Triangle>, what: impl Into<Build>, device: &Device) -> Result<Self, QueryError> {
        Ok(Self::of_scene(Arc::new(DeviceScene::of_triangles(triangles, what, device)?)))
    }

    /// Of a structure that is on the device already.
    pub fn of_structure(structure: Structure, device: &Device) -> Self {
        Self::of_scene(Arc::new(DeviceScene::of_structure(structure, device)))
    }

    /// Of a scene that is on its device, and may be shared.
    pub fn of_scene(scene: Arc<DeviceScene>) -> Self {
        Self { scene, expected: Coherence::Incoherent }
    }

    /// The scene, for others to hold.
    pub fn scene(&self) -> &Arc<DeviceScene> {
        &self.scene
    }

    /// The scene, to be changed.
    ///
    /// # Errors
    /// [`SceneError::Shared`] where others hold it: tracers, other casters, batches that are under way.
    pub fn scene_mut(&mut self) -> Result<&mut DeviceScene, SceneError> {
        DeviceScene::exclusive(&mut self.scene)
    }

    /// The same for batches of rays in buffers of the device that are more often than not of this kind, which makes them
    /// faster and changes no answer. Without this they are taken to be [`Coherence::Incoherent`]. Slices are looked at.
    pub fn expecting(&self, coherence: Coherence) -> Self {
        Self { expected: coherence, ..self.clone() }
    }

    /// What became of the scene.
    pub fn report(&self) -> &Report {
        self.scene.report()
    }

    /// Where rays are traced.
    pub fn device(&self) -> &Device {
        self.scene.device()
    }

    /// The closest hit of each ray; of several at the same distance that of the smallest instance and primitive.
    ///
    /// # Errors
    /// The device fails, or has no room.
    pub fn closest(&self, rays: &[Ray]) -> Result<Hits, QueryError> {
        self.batch(rays).closest()
    }

    /// Whether anything stands between the ends of each ray. Every triangle counts as opaque.
    ///
    /// # Errors
    /// The device fails, or has no room.
    pub fn any(&self, rays: &[Ray]) -> Result<Vec<bool>, QueryError> {
        self.batch(rays).any()
    }

    /// How many hits each ray has, each triangle once.
    ///
    /// # Errors
    /// The device fails, or has no room.
    pub fn count(&self, rays: &[Ray]) -> Result<Vec<u32>, QueryError> {
        self.batch(rays).count()
    }

    /// Every hit of each ray, by distance, then by instance and primitive.
    ///
    /// # Errors
    /// The device fails, or has no room.
    pub fn all(&self, rays: &[Ray]) -> Result<AllHits, QueryError> {
        self.batch(rays).all()
    }

    /// The closest hit of each ray, one after the other.
    ///
    /// # Errors
    /// The device fails, or has no room.
    pub fn hits(&self, rays: &[Ray]) -> Result<Vec<Hit>, QueryError> {
        self.batch(rays).hits()
    }

    /// A batch to be asked with a bound on hits, or watched.
    pub fn batch<'a>(&'a self, rays: &'a [Ray]) -> Batch<'a> {
        Batch::new(self, rays)
    }

    fn structure(&self) -> &dyn QueryKernels {
        &*self.scene.structure().resident
    }
}
