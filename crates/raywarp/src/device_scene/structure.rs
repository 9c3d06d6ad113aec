//! What finds the triangles along a ray, built and put on a device.

use std::any::Any;
use std::time::Instant;

use raywarp_core::screen::{AovRanges, DrawAov, ToneMapFilm};

use crate::accel::two_level::{InstancedStats, Plan, TwoLevel, UpperTree};
use crate::accel::{
    cache, check_device, check_instances, drop_degenerate, Accel, AccelKind, Build, Movable, Quality, Rendered,
    ResidentBrute, ResidentBvh2, ResidentBvh8f, ResidentDual, ResidentKd, ResidentKdTrees, ResidentLists,
    ResidentTwoLevel, TreeBox, TreeStats,
};
use crate::device::{Device, DeviceError};
use crate::render::passes::FrameKernels;
use crate::scene::Transform;
use crate::Triangle;

use super::fast::{self, Counts};
use super::{flatten, Report, SceneError};

/// A structure on a device, for [`DeviceScene::replace`](super::DeviceScene::replace). It can be built beside a tracer at work.
pub struct Structure {
    pub(crate) resident: Box<dyn FrameKernels>,
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
    /// Of the world.
    triangles: usize,
}

impl Structure {
    /// Arranges triangles, such as those of [`world_triangles`](super::world_triangles), and copies them to a device.
    ///
    /// # Errors
    /// [`SceneError`] where there are too many triangles for the structure or too little memory for it.
    pub fn build(device: &Device, what: impl Into<Build>, triangles: Vec<Triangle>) -> Result<Self, SceneError> {
        let (built, _) = Self::arrange(device, what.into(), triangles)?;
        device.reserve(built.bytes_to_upload(), "the structure")?;
        built.upload(device)
    }

    /// Copies one that was built elsewhere to a device; `quality` is what is told of it.
    ///
    /// # Errors
    /// The device has no room for it, or no kernels.
    pub fn of(accel: &Accel, quality: Quality, device: &Device) -> Result<Self, SceneError> {
        check_device(accel.kind(), device)?;
        let stats = accel.stats();
        device.reserve(stats.bytes as u64, "the structure")?;
        let start = Instant::now();
        let resident = upload(device, accel)?;
        let upload_seconds = start.elapsed().as_secs_f64();
        Ok(Self { kind: Some(accel.kind()), upload_seconds, ..Self::told(resident, quality, stats) })
    }

    /// The same of two levels.
    ///
    /// # Errors
    /// As for [`of`](Self::of).
    pub fn of_instances(tree: &TwoLevel, device: &Device) -> Result<Self, SceneError> {
        let (counts, start) = (tree.stats(), Instant::now());
        let upper = UpperTree::of(tree, tree.instances().iter().map(|i| i.index as usize + 1).max().unwrap_or(0));
        let resident = upload_instances(device, AccelKind::default(), tree)?;
        let upload_seconds = start.elapsed().as_secs_f64();
        let told = Self::told(resident, Quality::default(), tree.tree_stats());
        Ok(Self { upper: Some(upper), triangles: counts.seen as usize, upload_seconds, ..told })
    }

    /// A structure of others that is on a device already.
    ///
    /// # Safety
    /// It is on the device of the scenes that it is given to.
    pub unsafe fn of_resident(resident: impl Rendered, quality: Quality, stats: TreeStats) -> Self {
        Self::told(Box::new(resident), quality, stats)
    }

    fn told(resident: Box<dyn FrameKernels>, quality: Quality, stats: TreeStats) -> Self {
        Self {
            resident,
            kind: None,
            quality,
            stats,
            build_seconds: stats.build_seconds,
            upload_seconds: 0.0,
            warning: None,
            upper: None,
            triangles: stats.references - stats.duplicates,
        }
    }

    /// What kernels get it from, if it is of this type: for kernels that are launched by hand.
    pub fn resident<R: Rendered>(&self) -> Option<&R> {
        let resident: &dyn Any = &*self.resident;
        resident.downcast_ref()
    }

    /// The same where its boxes can follow what moves.
    pub(super) fn movable(&mut self) -> Option<Movable<'_>> {
        let resident: &mut dyn Any = &mut *self.resident;
        if resident.is::<ResidentDual>() {
            return resident.downcast_mut::<ResidentDual>().map(Movable::from);
        }
        resident.downcast_mut::<ResidentBvh2>().map(Movable::from)
    }

    /// Whether meshes are placed by instances, which [move](super::DeviceScene::move_instances) without a change to any tree but that
    /// over them.
    pub fn has_instances(&self) -> bool {
        self.upper.is_some()
    }

    /// Instances of the scene, where meshes are placed by them.
    pub(super) fn instances(&self) -> usize {
        self.upper.as_ref().map_or(0, UpperTree::placements)
    }

    /// Puts instances elsewhere. Returns whether that is all: `false` if one is or would have to be in world space.
    pub(super) fn set_transforms(&mut self, moved: &[(usize, &Transform)]) -> Result<bool, SceneError> {
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

    /// Triangles that can be hit, each once.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// Has the driver compile all kernels that trace through it, so that the first picture does not wait for them.
    ///
    /// # Errors
    /// [`SceneError`] where the driver refuses one.
    pub fn load_kernels(&self, device: &Device) -> Result<(), SceneError> {
        device.load::<ToneMapFilm>()?;
        device.load::<AovRanges>()?;
        device.load::<DrawAov>()?;
        Ok(self.resident.load(device)?)
    }

    /// Its boxes down to a level, see [`Accel::boxes`]. All nodes are read back from the device, as they are now: it is
    /// worth keeping what comes until something changes.
    ///
    /// # Errors
    /// [`SceneError`] where the device fails.
    pub fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, SceneError> {
        Ok(self.resident.tree_boxes(level)?)
    }

    /// The structure over those of the triangles that can be hit, and what there is to tell of it.
    pub(super) fn arrange(
        device: &Device,
        what: Build,
        triangles: Vec<Triangle>,
    ) -> Result<(Built, Counts), SceneError> {
        check_device(what.kind, device)?;
        if fast::is_meant(what) {
            return fast::arrange(device, what, triangles);
        }
        let (triangles, dropped) = drop_degenerate(triangles);
        let counts = Counts { triangles: triangles.len(), dropped, bounds: flatten::bounds(&triangles) };
        let start = Instant::now();
        let built = cache::build(what, triangles)?;
        let stats = built.accel.stats();
        let warning = built.warning.map(|warning| warning.to_string());
        let build_seconds = start.elapsed().as_secs_f64();
        let tree = Tree::World(built.accel);
        Ok((Built { tree, what, stats, build_seconds, warning, triangles: counts.triangles }, counts))
    }

    /// The same over instances.
    pub(super) fn arrange_instances(plan: Plan, what: Build) -> Result<(Built, InstancedStats), SceneError> {
        let (start, count) = (Instant::now(), plan.placements());
        let tree = plan.build(what.quality)?;
        let (counts, build_seconds) = (tree.stats(), start.elapsed().as_secs_f64());
        let stats = TreeStats { build_seconds, ..tree.tree_stats() };
        let triangles = counts.seen as usize;
        let tree = Tree::Instances(tree, count);
        Ok((Built { tree, what, stats, build_seconds, warning: None, triangles }, counts))
    }
}

/// A structure before it is all on its device, and what there is to tell of it.
pub(super) struct Built {
    tree: Tree,
    what: Build,
    pub stats: TreeStats,
    pub build_seconds: f64,
    warning: Option<String>,
    triangles: usize,
}

enum Tree {
    /// On the device already, which took so many seconds to copy the triangles to.
    OnDevice(Box<dyn FrameKernels>, f64),
    World(Accel),
    /// Over so many instances of the scene.
    Instances(TwoLevel, usize),
}

impl Built {
    /// What is known before it is on a device.
    pub fn report(&self) -> Report {
        let device_bytes = self.stats.bytes as u64;
        Report { tree: self.stats, build_seconds: self.build_seconds, device_bytes, ..Report::default() }
    }

    /// Of a structure that is on its device already.
    pub fn on_device(
        resident: Box<dyn FrameKernels>,
        what: Build,
        stats: TreeStats,
        upload_seconds: f64,
        warning: Option<String>,
    ) -> Self {
        let (tree, triangles) = (Tree::OnDevice(resident, upload_seconds), stats.references);
        Self { tree, what, stats, build_seconds: stats.build_seconds, warning, triangles }
    }

    /// What the device still needs for it.
    pub fn bytes_to_upload(&self) -> u64 {
        if matches!(self.tree, Tree::OnDevice(..)) {
            return 0;
        }
        self.stats.bytes as u64
    }

    pub fn upload(self, device: &Device) -> Result<Structure, SceneError> {
        let start = Instant::now();
        let (resident, upper, before) = match self.tree {
            Tree::OnDevice(resident, seconds) => (resident, None, seconds),
            Tree::World(tree) => (upload(device, &tree)?, None, 0.0),
            Tree::Instances(tree, count) => {
                (upload_instances(device, self.what.kind, &tree)?, Some(UpperTree::of(&tree, count)), 0.0)
            }
        };
        Ok(Structure {
            kind: Some(self.what.kind),
            build_seconds: self.build_seconds,
            upload_seconds: before + start.elapsed().as_secs_f64(),
            warning: self.warning,
            upper,
            triangles: self.triangles,
            ..Structure::told(resident, self.what.quality, self.stats)
        })
    }
}

/// Copies a structure to a device, which has kernels for it.
pub(super) fn upload(device: &Device, tree: &Accel) -> Result<Box<dyn FrameKernels>, DeviceError> {
    Ok(match tree {
        Accel::Brute(list) => Box::new(ResidentBrute::upload(device, list)?),
        Accel::Kd(tree) => Box::new(ResidentKd::upload(device, tree)?),
        Accel::Bvh2(tree) => Box::new(ResidentBvh2::upload(device, tree)?),
        Accel::Bvh(tree) => Box::new(ResidentDual::upload(device, tree)?),
        Accel::Bvh8f(tree) => Box::new(ResidentBvh8f::upload(device, tree)?),
    })
}

/// Copies instances to a device, with the structure of each mesh that is asked for: a list, a k-d tree or a hierarchy.
fn upload_instances(device: &Device, kind: AccelKind, tree: &TwoLevel) -> Result<Box<dyn FrameKernels>, SceneError> {
    check_instances(kind, device)?;
    Ok(match kind {
        AccelKind::Brute => Box::new(ResidentLists::upload(device, tree)?),
        AccelKind::Kd => Box::new(ResidentKdTrees::upload(device, tree, &tree.kd_trees()?)?),
        _ => Box::new(ResidentTwoLevel::upload(device, tree)?),
    })
}
