//! A fast tree over the triangles of a scene, built on the device that traces it.

use std::time::Instant;

use super::structure::{upload, Built};
use super::SceneError;
use crate::accel::hploc::{self, DeviceTree, NodeSizes, TreeBuilder};
use crate::accel::{Accel, AccelKind, Build, Dropped, Quality, ResidentBvh2, ResidentDual, TreeStats};
use crate::device::Device;
use crate::render::passes::FrameKernels;
use crate::Triangle;

/// What became of triangles on the way to a structure.
pub(super) struct Counts {
    /// Those that can be hit.
    pub triangles: usize,
    pub dropped: Dropped,
    /// Low and high corner of those that can be hit; both zero where there are none.
    pub bounds: [[f32; 3]; 2],
}

/// Whether a structure is such a tree.
pub(super) fn is_meant(what: Build) -> bool {
    what.quality == Quality::Fast && what.kind.is_hierarchy()
}

/// Builds it; triangles that cannot be hit are left out on the way.
pub(super) fn arrange(device: &Device, what: Build, triangles: Vec<Triangle>) -> Result<(Built, Counts), SceneError> {
    device.reserve(size_of_val(&triangles[..]) as u64, "the triangles")?;
    let start = Instant::now();
    let given = device.upload(&triangles)?;
    drop(triangles);
    let (upload_seconds, start) = (start.elapsed().as_secs_f64(), Instant::now());
    let sizes = if what.kind == AccelKind::Bvh { NodeSizes::Both } else { NodeSizes::Full };
    let built = TreeBuilder::new(device, given.len() as usize)?.build(&given, sizes)?;
    let warning = built.warning();
    let hploc::Built { tree, triangles, dropped, bounds, .. } = built;
    let (resident, stats) = laid_out(device, what.kind, tree)?;
    device.mark()?.wait()?;
    let build_seconds = start.elapsed().as_secs_f64();
    let stats = TreeStats { build_seconds, ..stats };
    Ok((Built::on_device(resident, what, stats, upload_seconds, warning), Counts { triangles, dropped, bounds }))
}

/// In the layout of `kind`, which has nodes of both sizes where it needs them.
fn laid_out(
    device: &Device,
    kind: AccelKind,
    tree: DeviceTree,
) -> Result<(Box<dyn FrameKernels>, TreeStats), SceneError> {
    let stats = tree.stats();
    Ok(match kind {
        AccelKind::Bvh => (Box::new(ResidentDual::from(tree)), stats),
        AccelKind::Bvh2 => (Box::new(ResidentBvh2::from(tree)), stats),
        _ => {
            let accel = Accel::laid_out(kind, tree.download(0.0)?)?;
            (upload(device, &accel)?, accel.stats())
        }
    })
}
