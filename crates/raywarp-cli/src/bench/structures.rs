//! The structures that can be measured: raywarp's own here, more in its laboratory.

use raywarp::accel::{self, Accel, AccelKind, Build, Quality, TreeStats};
use raywarp::device::{Device, DeviceChoice};
use raywarp::device_scene::Structure;
use raywarp::query::{tests, RayCaster, Tests};
use raywarp::render::Tracer;
use raywarp::scene::Scene;
use raywarp::{Ray, Triangle};

use crate::failure::Result;

/// Structures by name.
pub trait Structures {
    /// A device that has their kernels.
    ///
    /// # Errors
    /// As for [`Device::open`].
    fn open(&self, choice: DeviceChoice) -> Result<Device>;

    /// Whether a structure comes in several qualities.
    ///
    /// # Errors
    /// There is none of this name.
    fn is_hierarchy(&self, name: &str) -> Result<bool>;

    /// Builds one, and copies it to a device.
    ///
    /// # Errors
    /// The structure cannot hold the triangles, or the device cannot trace it.
    fn build(&self, name: &str, quality: Quality, triangles: &[Triangle], device: &Device) -> Result<Built>;

    /// A scene before one.
    ///
    /// # Errors
    /// As for [`build`](Self::build).
    fn tracer(&self, name: &str, scene: &Scene, device: &Device) -> Result<Tracer>;
}

/// A structure over triangles, on a device.
pub struct Built {
    /// Asks it about rays there.
    pub caster: RayCaster,
    /// Size and quality.
    pub stats: TreeStats,
    /// Of all its triangles.
    pub triangle_bytes: usize,
    /// Counts nodes and triangles of a sample of rays on the host: see [`tests`].
    pub tests: Box<Count>,
}

/// Of which rays, whether any hit will do, and how many at most.
pub type Count = dyn Fn(&[Ray], bool, usize) -> Vec<Tests>;

/// Those that raywarp renders with.
pub struct Own;

impl Own {
    fn kind(name: &str) -> Result<AccelKind> {
        Ok(name.parse()?)
    }
}

impl Structures for Own {
    fn open(&self, choice: DeviceChoice) -> Result<Device> {
        Ok(Device::open(choice)?)
    }

    fn is_hierarchy(&self, name: &str) -> Result<bool> {
        Ok(Self::kind(name)?.is_hierarchy())
    }

    fn build(&self, name: &str, quality: Quality, triangles: &[Triangle], device: &Device) -> Result<Built> {
        let build = Build { kind: Self::kind(name)?, quality, cached: false };
        let accel = Accel::build(build, triangles.to_vec())?;
        let (structure, stats) = (Structure::of(&accel, quality, device)?, accel.stats());
        let caster = RayCaster::of_structure(structure, device);
        let triangle_bytes = size_of_val(&*accel.triangles());
        let count = move |rays: &[Ray], any_hit, most| tests(&accel, rays, any_hit, most);
        Ok(Built { caster, stats, triangle_bytes, tests: Box::new(count) })
    }

    fn tracer(&self, name: &str, scene: &Scene, device: &Device) -> Result<Tracer> {
        Ok(Tracer::new(scene, Self::kind(name)?, device)?)
    }
}

/// Name of the fastest on a device.
pub fn fastest_on(device: &Device) -> &'static str {
    accel::fastest_on(device).name()
}
