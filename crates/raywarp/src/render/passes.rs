//! The launches of a frame: one entry point for each structure and each wish.

use std::marker::PhantomData;

use raywarp_kernels::camera::pixel_centre;
use raywarp_kernels::film::Pixel;
use raywarp_kernels::kernels::{Frame, Kernel, Surfel, Surfels, Whitted};
use raywarp_kernels::shade::whitted::{trace, Limits};
use raywarp_kernels::surface;
use raywarp_kernels::traverse::{Brute, Bvh2, Clocks, Counter, Kept, StageTimes, Structure, Tests, Uncounted};
use raywarp_kernels::view::ViewMut;

use crate::accel::{with_structure, Resident};
use crate::backend::{Device, DeviceError};

/// One launch of a frame: everything but the structure.
#[derive(Clone, Copy)]
pub(super) struct Pass {
    pub scene: surface::Scene,
    pub frame: Frame,
    pub limits: Limits,
    pub film: ViewMut<Pixel>,
    /// Empty: nobody counts.
    pub tests: ViewMut<Tests>,
    /// Time of each pixel's thread, where tests are counted.
    pub ticks: ViewMut<u32>,
}

/// Adds the samples of a pass to the film; returns the seconds on the device.
pub(super) fn shade(device: &Device, structure: &Resident, pass: &Pass) -> Result<f64, DeviceError> {
    with_structure!(structure, structure, both => both.compact, match pass.tests.is_empty() {
            true => run(device, pass, &whitted::<_, Uncounted>(structure, pass, ViewMut::EMPTY)),
            false => run(device, pass, &whitted::<_, Tests>(structure, pass, pass.tests)),
    })
}

/// As [`shade`], and says how long each pixel's thread was in each stage. Nothing where the structure has no such kernel.
pub(super) fn clock(
    device: &Device,
    structure: &Resident,
    pass: &Pass,
    times: ViewMut<StageTimes>,
) -> Result<Option<f64>, DeviceError> {
    let seconds = match structure {
        Resident::Brute { triangles } => {
            let structure = Brute { triangles: triangles.view() };
            run(device, pass, &whitted::<_, Clocks>(structure, pass, times))
        }
        Resident::Kd(tree) => run(device, pass, &whitted::<_, Clocks>(tree.view(), pass, times)),
        Resident::Bvh2 { nodes, triangles, reach } => {
            let structure = Bvh2 { nodes: nodes.view(), triangles: triangles.view(), reach: *reach };
            run(device, pass, &whitted::<_, Clocks>(structure, pass, times))
        }
        _ => return Ok(None),
    };
    seconds.map(Some)
}

/// Fills a surfel for each pixel of a pass.
pub(super) fn surfels(
    device: &Device,
    structure: &Resident,
    pass: &Pass,
    surfels: ViewMut<Surfel>,
) -> Result<f64, DeviceError> {
    let (scene, frame) = (pass.scene, pass.frame);
    with_structure!(structure, structure, both => both.compact, run(device, pass, &Surfels { structure, scene, frame, surfels }))
}

/// Has the driver compile what traces through a structure, so that no frame waits for it.
pub(super) fn load(device: &Device, structure: &Resident) -> Result<(), DeviceError> {
    with_structure!(structure, structure, both => both.compact, load_for(device, structure))
}

fn load_for<S: Structure>(device: &Device, _: S) -> Result<(), DeviceError>
where
    Whitted<S, Uncounted>: Kernel,
    Whitted<S, Tests>: Kernel,
    Surfels<S>: Kernel,
{
    device.load::<Whitted<S, Uncounted>>()?;
    device.load::<Whitted<S, Tests>>()?;
    device.load::<Surfels<S>>()
}

fn whitted<S: Structure, C: Kept>(structure: S, pass: &Pass, counts: ViewMut<C::Record>) -> Whitted<S, C> {
    let Pass { scene, frame, limits, film, ticks, .. } = *pass;
    Whitted { structure, scene, frame, limits, film, counts, ticks, counter: PhantomData }
}

/// Traces the rays through the centres of pixels, here and now; nothing but for a `bvh2` in the memory of this machine.
pub(super) fn follow<C: Counter>(
    device: &Device,
    structure: &Resident,
    pass: &Pass,
    pixels: &[[u32; 2]],
) -> Option<Vec<C>> {
    let Resident::Bvh2 { nodes, triangles, reach } = structure else { return None };
    if device.is_cuda() {
        return None;
    }
    let structure = Bvh2 { nodes: nodes.view(), triangles: triangles.view(), reach: *reach };
    let follow = |&[x, y]: &[u32; 2]| {
        let (centre, mut counter) = (pixel_centre(x, y), C::default());
        let ray = pass.frame.camera.ray(centre.x, centre.y);
        trace(&structure, &pass.scene, &pass.limits, &ray, &mut counter);
        counter
    };
    Some(pixels.iter().map(follow).collect())
}

fn run(device: &Device, pass: &Pass, kernel: &impl Kernel) -> Result<f64, DeviceError> {
    // SAFETY: the structure's views are of buffers borrowed for this call; those of the pass belong to the frame that
    // `Tracer` holds while it waits here. `Flat` checked the indices of the scene, the builders those of the trees.
    unsafe { device.launch(kernel, pass.frame.extent) }
}
