//! Batches of rays, answered without a picture: closest hit, any hit, all hits, their number.
//!
//! A [`RayCaster`] holds a scene on a device. It answers slices of any length, in passes that fit the device's memory
//! ([`batch`](RayCaster::batch) reports on them and can be ended), and buffers of the device ([`device`]), on a stream if
//! need be. [`files`] reads rays and writes answers as NumPy and CSV files. All four questions are asked of one traversal
//! and agree: a ray's count is the number of all its hits, the first of which is the closest, and there is any hit where
//! there is one. What a hit is, and which rays have none, is said at [`Ray`]. [`RaySource`] makes the rays that raywarp
//! and its peers are measured with.

mod batch;
mod coherence;
mod cost;
pub mod device;
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
use std::time::Instant;

use crate::accel::two_level::TwoLevel;
use crate::accel::{
    cache, check_device, drop_degenerate, Accel, Build, Dropped, Resident, ResidentTwoLevel, TreeStats,
};
use crate::device::Device;
use crate::render::{upload, upload_instances, Flat};
use crate::scene::Scene;
use crate::{Hit, Ray, Triangle};

pub use crate::render::{two_level, Levels};
pub use batch::{Batch, Progress};
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
    shared: Arc<Shared>,
    /// What is expected of rays in buffers.
    expected: Coherence,
}

struct Shared {
    device: Device,
    structure: Box<dyn QueryKernels>,
    report: Report,
}

/// What became of the triangles on their way to the device.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Triangles that can be hit.
    pub triangles: usize,
    /// Triangles that cannot.
    pub dropped: Dropped,
    /// The structure.
    pub tree: TreeStats,
    /// Seconds to build the structure, or to read it from the cache.
    pub build_seconds: f64,
    /// Why the structure could not be kept on disk, as a sentence without the full stop.
    pub warning: Option<String>,
}

impl Report {
    fn of_instanced(tree: &TwoLevel) -> Self {
        let stats = tree.stats();
        Self { triangles: stats.seen as usize, tree: tree.tree_stats(), ..Self::default() }
    }
}

impl RayCaster {
    /// Builds a structure over the triangles of all instances and copies it to a device.
    ///
    /// # Errors
    /// The scene has indices out of range, or too many triangles for the structure or for the device's memory.
    pub fn from_scene(scene: &Scene, what: impl Into<Build>, device: &Device) -> Result<Self, QueryError> {
        Self::from_scene_in(scene, Levels::Auto, what, device)
    }

    /// The same, in one level or two.
    ///
    /// # Errors
    /// As for [`from_scene`](Self::from_scene).
    pub fn from_scene_in(
        scene: &Scene,
        levels: Levels,
        what: impl Into<Build>,
        device: &Device,
    ) -> Result<Self, QueryError> {
        let what = what.into();
        if !levels.are_two(scene) {
            return Self::build(Flat::of(scene)?.triangles, what, device);
        }
        let start = Instant::now();
        let tree = two_level(scene, what.quality)?;
        let build_seconds = start.elapsed().as_secs_f64();
        let structure = upload_instances(device, what.kind, &tree)?;
        let report = Report { build_seconds, ..Report::of_instanced(&tree) };
        Ok(Self::sharing(Shared { device: device.clone(), structure, report }))
    }

    /// Builds a structure over the triangles that can be hit and copies it to a device. Hits say the primitive and the
    /// instance that the triangles have.
    ///
    /// # Errors
    /// Too many triangles for the structure or for the device's memory.
    pub fn new(triangles: Vec<Triangle>, what: impl Into<Build>, device: &Device) -> Result<Self, QueryError> {
        Self::build(triangles, what.into(), device)
    }

    fn build(triangles: Vec<Triangle>, what: Build, device: &Device) -> Result<Self, QueryError> {
        check_device(what.kind, device)?;
        let start = Instant::now();
        let (triangles, dropped) = drop_degenerate(triangles);
        let count = triangles.len();
        let built = cache::build(what, triangles)?;
        let accel = built.accel;
        let build_seconds = start.elapsed().as_secs_f64();
        let warning = built.warning.map(|warning| warning.to_string());
        let report = Report { triangles: count, dropped, tree: accel.stats(), build_seconds, warning };
        device.reserve(report.tree.bytes as u64, "the scene")?;
        let structure = upload(device, &accel)?;
        Ok(Self::sharing(Shared { device: device.clone(), structure, report }))
    }

    /// Copies a structure that was built elsewhere to a device.
    ///
    /// # Errors
    /// The device has no room for it, or no kernels.
    pub fn of(accel: &Accel, device: &Device) -> Result<Self, QueryError> {
        check_device(accel.kind(), device)?;
        let report = Report { triangles: accel.triangles().len(), tree: accel.stats(), ..Report::default() };
        device.reserve(report.tree.bytes as u64, "the structure")?;
        let structure = upload(device, accel)?;
        Ok(Self::sharing(Shared { device: device.clone(), structure, report }))
    }

    /// A structure of others that is on a device already.
    ///
    /// # Safety
    /// It is on that one.
    pub unsafe fn of_resident(resident: impl Resident, stats: TreeStats, device: &Device) -> Self {
        let report = Report { triangles: stats.references - stats.duplicates, tree: stats, ..Report::default() };
        let structure = Box::new(resident);
        Self::sharing(Shared { device: device.clone(), structure, report })
    }

    /// Copies a structure of two levels to a device.
    ///
    /// # Errors
    /// The device has no room.
    pub fn from_instanced(tree: &TwoLevel, device: &Device) -> Result<Self, QueryError> {
        let structure = Box::new(ResidentTwoLevel::upload(device, tree)?);
        let report = Report::of_instanced(tree);
        Ok(Self::sharing(Shared { device: device.clone(), structure, report }))
    }

    fn sharing(shared: Shared) -> Self {
        Self { shared: Arc::new(shared), expected: Coherence::Incoherent }
    }

    /// The same for batches of rays in buffers of the device that are more often than not of this kind, which makes them
    /// faster and changes no answer. Without this they are taken to be [`Coherence::Incoherent`]. Slices are looked at.
    pub fn expecting(&self, coherence: Coherence) -> Self {
        Self { expected: coherence, ..self.clone() }
    }

    /// What became of the triangles.
    pub fn report(&self) -> &Report {
        &self.shared.report
    }

    /// Where rays are traced.
    pub fn device(&self) -> &Device {
        &self.shared.device
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
        &*self.shared.structure
    }
}
