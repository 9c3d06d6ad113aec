//! What to build, and what is best on a device.

use raywarp_scene::settings::{AccelKind, Quality, RenderDefaults};

use raywarp_core::kernels::Closest;
use raywarp_core::traversal::{Brute, Bvh8f, Instances, KdTree};

use super::BuildError;
use crate::device::Device;

/// The fastest structure on a device, as measured on an H200 and on x86-64: `docs/bench`. On a GPU the tree in two
/// layouts, from which each warp takes what suits its rays; on a CPU the one whose boxes fill a vector.
pub fn fastest_on(device: &Device) -> AccelKind {
    if device.is_cuda() {
        AccelKind::Bvh
    } else {
        AccelKind::Bvh8f
    }
}

/// Whether a structure can be traced on a device.
pub(crate) fn check_device(kind: AccelKind, device: &Device) -> Result<(), BuildError> {
    match kind {
        AccelKind::Bvh8f if !device.has_kernel::<Closest<Bvh8f>>() => {
            Err(BuildError::NoKernels { structure: kind, device: device.description() })
        }
        _ => Ok(()),
    }
}

/// Whether a structure of each mesh under instances can be traced on a device.
pub(crate) fn check_instances(kind: AccelKind, device: &Device) -> Result<(), BuildError> {
    let (structure, device) = match kind {
        AccelKind::Brute if !device.has_kernel::<Closest<Instances<Brute>>>() => (kind, device.description()),
        AccelKind::Kd if !device.has_kernel::<Closest<Instances<KdTree>>>() => (kind, device.description()),
        _ => return Ok(()),
    };
    Err(BuildError::NoInstances { structure, device })
}

/// What to build.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub struct Build {
    /// The structure.
    pub kind: AccelKind,
    /// How good it should be.
    pub quality: Quality,
    /// Whether to keep trees on disk, and to look for them there: [`cache`](super::cache).
    pub cached: bool,
}

impl From<AccelKind> for Build {
    fn from(kind: AccelKind) -> Self {
        Self { kind, ..Self::default() }
    }
}

impl Build {
    /// What the scene or the command line wishes, and else what is fastest on the device.
    pub fn wished(wishes: &RenderDefaults, device: &Device, cached: bool) -> Self {
        let kind = wishes.accel.unwrap_or_else(|| fastest_on(device));
        Self { kind, quality: wishes.tree.unwrap_or_default(), cached }
    }
}
