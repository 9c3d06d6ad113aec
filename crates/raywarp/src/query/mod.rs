//! Batches of rays, answered without a picture.

mod levels;

use raywarp_kernels::kernels::{Closest, Kernel, Occluded};

use crate::accel::{sift, with_any_structure, Accel, AnyResident, Build, BuildError, Resident};
use crate::backend::{Device, DeviceError};
use crate::{Hit, Ray, Triangle};

pub use levels::{two_level, Levels};

/// Triangles on a device, ready to be asked.
///
/// ```
/// use raywarp::accel::AccelKind;
/// use raywarp::backend::{Device, DeviceChoice};
/// use raywarp::query::RayCaster;
/// use raywarp::{Ray, Triangle, Vec3};
///
/// let floor = Triangle::new([0.0, 0.0, 0.0].into(), [1.0, 0.0, 0.0].into(), [0.0, 0.0, 1.0].into(), 7, 0);
/// let caster = RayCaster::new(vec![floor], AccelKind::default(), &Device::open(DeviceChoice::Cpu)?)?;
/// let down = Ray::new(Vec3::new(0.25, 2.0, 0.25), Vec3::new(0.0, -1.0, 0.0));
/// let hits = caster.closest(&[down])?;
/// assert_eq!((hits[0].primitive, hits[0].t), (7, 2.0));
/// # Ok::<(), raywarp::query::QueryError>(())
/// ```
pub struct RayCaster {
    device: Device,
    structure: AnyResident,
}

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum QueryError {
    /// The structure cannot hold the triangles.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The device fails.
    #[error(transparent)]
    Device(#[from] DeviceError),
}

impl RayCaster {
    /// Builds a structure over the triangles that can be hit and copies it to a device.
    ///
    /// # Errors
    /// Too many triangles for the structure or for the device's memory.
    pub fn new(triangles: Vec<Triangle>, what: impl Into<Build>, device: &Device) -> Result<Self, QueryError> {
        let tree = Accel::build(what, sift(triangles).0)?;
        Ok(Self { structure: AnyResident::One(Resident::upload(device, &tree)?), device: device.clone() })
    }

    /// The closest hit of each ray; of several at the same distance that of the smallest primitive.
    ///
    /// # Errors
    /// The device fails, or has no room for the batch.
    pub fn closest(&self, rays: &[Ray]) -> Result<Vec<Hit>, QueryError> {
        let rays = self.device.upload(rays)?;
        let mut hits = self.device.zeroed(rays.len() as usize)?;
        let answers = hits.view_mut();
        with_any_structure!(&self.structure, structure => {
            self.run(&Closest { structure, rays: rays.view(), hits: answers }, rays.len())?;
        });
        Ok(hits.download()?)
    }

    /// Whether anything stands between the ends of each ray.
    ///
    /// # Errors
    /// The device fails, or has no room for the batch.
    pub fn occluded(&self, rays: &[Ray]) -> Result<Vec<bool>, QueryError> {
        let rays = self.device.upload(rays)?;
        let mut occluded = self.device.zeroed::<u32>(rays.len() as usize)?;
        let answers = occluded.view_mut();
        with_any_structure!(&self.structure, structure => {
            self.run(&Occluded { structure, rays: rays.view(), occluded: answers }, rays.len())?;
        });
        Ok(occluded.download()?.iter().map(|&answer| answer != 0).collect())
    }

    fn run(&self, kernel: &impl Kernel, rays: u32) -> Result<f64, DeviceError> {
        // SAFETY: the structure is borrowed and the callers hold the batch and the answers until this returns. The
        // builders keep their indices in range.
        unsafe { self.device.launch(kernel, [rays, 1]) }
    }
}
