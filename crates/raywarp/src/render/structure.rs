//! What finds the triangles along a ray, built and put on a device.

use std::time::Instant;

use raywarp_kernels::screen::{Develop, Paint, Ranges};

use crate::accel::{cache, Accel, AccelKind, Build, Quality, Resident, TreeBox, TreeStats};
use crate::backend::Device;
use crate::Triangle;

use super::{passes, RenderError};

/// A structure on a device, for [`Tracer::replace`](super::Tracer::replace). It can be built beside a tracer at work.
pub struct Structure {
    pub(super) resident: Resident,
    /// Which it is.
    pub kind: AccelKind,
    /// How good it was to be.
    pub quality: Quality,
    /// Size and quality.
    pub stats: TreeStats,
    /// Seconds to build it, or to read it from the cache.
    pub build_seconds: f64,
    /// Seconds to copy it to the device.
    pub upload_seconds: f64,
    /// What was wrong with the cache, if anything.
    pub warning: Option<String>,
}

impl Structure {
    /// Arranges triangles, such as those of [`world_triangles`](super::world_triangles), and copies them to a device.
    ///
    /// # Errors
    /// [`RenderError`] where there are too many triangles for the structure or too little memory for it.
    pub fn build(device: &Device, what: impl Into<Build>, triangles: Vec<Triangle>) -> Result<Self, RenderError> {
        let (tree, built) = Self::arrange(what.into(), triangles)?;
        device.reserve(built.stats.bytes as u64, "the structure")?;
        built.upload(device, &tree)
    }

    /// Has the driver compile all kernels that trace through it, so that the first picture does not wait for them.
    ///
    /// # Errors
    /// [`RenderError`] where the driver refuses one.
    pub fn load_kernels(&self, device: &Device) -> Result<(), RenderError> {
        device.load::<Develop>()?;
        device.load::<Ranges>()?;
        device.load::<Paint>()?;
        Ok(passes::load(device, &self.resident)?)
    }

    /// Its boxes down to a level, see [`Accel::boxes`]. All nodes are read back from the device, as they are now: it is
    /// worth keeping what comes until something changes.
    ///
    /// # Errors
    /// [`RenderError`] where the device fails.
    pub fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, RenderError> {
        Ok(self.resident.boxes(level)?)
    }

    /// The structure on this machine, and what there is to tell of it.
    pub(super) fn arrange(what: Build, triangles: Vec<Triangle>) -> Result<(Accel, Built), RenderError> {
        let start = Instant::now();
        let built = cache::build(what, triangles)?;
        let stats = built.accel.stats();
        let warning = built.warning.map(|warning| warning.to_string());
        Ok((built.accel, Built { what, stats, build_seconds: start.elapsed().as_secs_f64(), warning }))
    }
}

/// What there is to tell of a structure.
pub(super) struct Built {
    what: Build,
    pub stats: TreeStats,
    build_seconds: f64,
    warning: Option<String>,
}

impl Built {
    pub fn upload(self, device: &Device, tree: &Accel) -> Result<Structure, RenderError> {
        let start = Instant::now();
        Ok(Structure {
            resident: Resident::upload(device, tree)?,
            kind: self.what.kind,
            quality: self.what.quality,
            stats: self.stats,
            build_seconds: self.build_seconds,
            upload_seconds: start.elapsed().as_secs_f64(),
            warning: self.warning,
        })
    }
}
