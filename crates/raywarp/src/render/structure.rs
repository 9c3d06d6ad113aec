//! What finds the triangles along a ray, built and put on a device.

use std::any::Any;
use std::time::Instant;

use raywarp_core::screen::{AovRanges, DrawAov, ToneMapFilm};

use crate::accel::two_level::{InstancedStats, Plan, TwoLevel, UpperTree};
use crate::accel::{
    cache, check_device, Accel, AccelKind, Build, Quality, Rendered, ResidentKdTrees, ResidentLists, ResidentTwoLevel,
    TreeBox, TreeStats,
};
use crate::device::Device;
use crate::scene::Transform;
use crate::Triangle;

use super::passes::{upload, upload_instances, FrameKernels};
use super::RenderError;

/// A structure on a device, for [`Tracer::replace`](super::Tracer::replace). It can be built beside a tracer at work.
pub struct Structure {
    pub(super) resident: Box<dyn FrameKernels>,
    /// Which it is; nothing for one of others.
    pub kind: Option<AccelKind>,
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
    /// Of a structure of instances.
    upper: Option<UpperTree>,
}

impl Structure {
    /// Arranges triangles, such as those of [`world_triangles`](super::world_triangles), and copies them to a device.
    ///
    /// # Errors
    /// [`RenderError`] where there are too many triangles for the structure or too little memory for it.
    pub fn build(device: &Device, what: impl Into<Build>, triangles: Vec<Triangle>) -> Result<Self, RenderError> {
        let built = Self::arrange(device, what.into(), triangles)?;
        device.reserve(built.stats.bytes as u64, "the structure")?;
        built.upload(device)
    }

    /// Copies one that was built elsewhere to a device; `quality` is what is told of it.
    ///
    /// # Errors
    /// The device has no room for it, or no kernels.
    pub fn of(accel: &Accel, quality: Quality, device: &Device) -> Result<Self, RenderError> {
        check_device(accel.kind(), device)?;
        let (stats, start) = (accel.stats(), Instant::now());
        let resident = upload(device, accel)?;
        Ok(Self {
            resident,
            kind: Some(accel.kind()),
            quality,
            stats,
            build_seconds: stats.build_seconds,
            upload_seconds: start.elapsed().as_secs_f64(),
            warning: None,
            upper: None,
        })
    }

    /// A structure of others that is on a device already.
    ///
    /// # Safety
    /// It is on the device of the tracers that it is given to.
    pub unsafe fn of_resident(resident: impl Rendered, quality: Quality, stats: TreeStats) -> Self {
        Self {
            resident: Box::new(resident),
            kind: None,
            quality,
            stats,
            build_seconds: stats.build_seconds,
            upload_seconds: 0.0,
            warning: None,
            upper: None,
        }
    }

    /// What kernels get it from, if it is of this type: for kernels that are launched by hand.
    pub fn resident<R: Rendered>(&self) -> Option<&R> {
        let resident: &dyn Any = &*self.resident;
        resident.downcast_ref()
    }

    /// The same, to be changed.
    pub(super) fn resident_mut<R: Rendered>(&mut self) -> Option<&mut R> {
        let resident: &mut dyn Any = &mut *self.resident;
        resident.downcast_mut()
    }

    /// Whether meshes are placed by instances, which [move](super::Tracer::move_instance) without a change to any tree but that
    /// over them.
    pub fn has_instances(&self) -> bool {
        self.upper.is_some()
    }

    /// Puts instances elsewhere. Returns whether that is all: `false` if one is or would have to be in world space.
    pub(super) fn set_transforms(&mut self, moved: &[(usize, &Transform)]) -> Result<bool, RenderError> {
        let Some(upper) = &mut self.upper else { return Ok(false) };
        if upper.set_transforms(moved).is_none() {
            return Ok(false);
        }
        let resident: &mut dyn Any = &mut *self.resident;
        if let Some(tree) = resident.downcast_mut::<ResidentTwoLevel>() {
            tree.set_instances(upper)?;
        } else if let Some(trees) = resident.downcast_mut::<ResidentKdTrees>() {
            trees.set_instances(upper)?;
        } else if let Some(lists) = resident.downcast_mut::<ResidentLists>() {
            lists.set_instances(upper)?;
        }
        Ok(true)
    }

    /// Has the driver compile all kernels that trace through it, so that the first picture does not wait for them.
    ///
    /// # Errors
    /// [`RenderError`] where the driver refuses one.
    pub fn load_kernels(&self, device: &Device) -> Result<(), RenderError> {
        device.load::<ToneMapFilm>()?;
        device.load::<AovRanges>()?;
        device.load::<DrawAov>()?;
        Ok(self.resident.load(device)?)
    }

    /// Its boxes down to a level, see [`Accel::boxes`]. All nodes are read back from the device, as they are now: it is
    /// worth keeping what comes until something changes.
    ///
    /// # Errors
    /// [`RenderError`] where the device fails.
    pub fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, RenderError> {
        Ok(self.resident.tree_boxes(level)?)
    }

    /// The structure on this machine, and what there is to tell of it.
    pub(super) fn arrange(device: &Device, what: Build, triangles: Vec<Triangle>) -> Result<Built, RenderError> {
        check_device(what.kind, device)?;
        let start = Instant::now();
        let built = cache::build(what, triangles)?;
        let stats = built.accel.stats();
        let warning = built.warning.map(|warning| warning.to_string());
        let build_seconds = start.elapsed().as_secs_f64();
        Ok(Built { tree: Tree::World(built.accel), what, stats, build_seconds, warning })
    }

    /// The same over instances.
    pub(super) fn arrange_instances(plan: Plan, what: Build) -> Result<(Built, InstancedStats), RenderError> {
        let (start, count) = (Instant::now(), plan.placements());
        let tree = plan.build(what.quality)?;
        let (counts, build_seconds) = (tree.stats(), start.elapsed().as_secs_f64());
        let stats = TreeStats { build_seconds, ..tree.tree_stats() };
        Ok((Built { tree: Tree::Instances(tree, count), what, stats, build_seconds, warning: None }, counts))
    }
}

/// A structure on this machine, and what there is to tell of it.
pub(super) struct Built {
    tree: Tree,
    what: Build,
    pub stats: TreeStats,
    pub build_seconds: f64,
    warning: Option<String>,
}

enum Tree {
    World(Accel),
    /// Over so many instances of the scene.
    Instances(TwoLevel, usize),
}

impl Built {
    pub fn upload(self, device: &Device) -> Result<Structure, RenderError> {
        let start = Instant::now();
        let (resident, upper) = match &self.tree {
            Tree::World(tree) => (upload(device, tree)?, None),
            Tree::Instances(tree, count) => {
                (upload_instances(device, self.what.kind, tree)?, Some(UpperTree::of(tree, *count)))
            }
        };
        Ok(Structure {
            resident,
            kind: Some(self.what.kind),
            quality: self.what.quality,
            stats: self.stats,
            build_seconds: self.build_seconds,
            upload_seconds: start.elapsed().as_secs_f64(),
            warning: self.warning,
            upper,
        })
    }
}
