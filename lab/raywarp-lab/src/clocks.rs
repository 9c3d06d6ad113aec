//! Where a frame's time goes, and single pixels followed.

use raywarp::accel::{Rendered, Resident, ResidentBrute, ResidentBvh2, ResidentKd};
use raywarp::render::{Pass, RenderError, RenderOptions, Tracer};
use raywarp::scene::Camera;
use raywarp_core::camera::pixel_centre;
use raywarp_core::film::Pixel;
use raywarp_core::shade::whitted::trace;
use raywarp_core::traversal::Counter;
use raywarp_core::view::ViewMut;
use raywarp_lab_core::clocks::{Clocks, StageTimes};

use raywarp_device::kernels::Views;

/// How long the threads of all pixels were in each stage, added up: making camera rays, looking for hits, everything
/// else. In units of [`PixelCosts::ticks`](raywarp::render::PixelCosts::ticks); a thread that waits for others of its warp is in
/// the stage where it waits. The kernel with clocks is a little slower than the one without. None for structures other than
/// `brute`, `kd`, `kdsah` and `bvh2`.
///
/// # Errors
/// As for [`Tracer::render`].
pub fn stage_times(tracer: &Tracer, camera: &Camera, options: &RenderOptions) -> Result<Option<[u64; 3]>, RenderError> {
    let structure = tracer.scene().structure();
    tracer.first_sample(camera, options, |pass| {
        if let Some(list) = structure.resident::<ResidentBrute>() {
            timed(tracer, pass, list).map(Some)
        } else if let Some(tree) = structure.resident::<ResidentKd>() {
            timed(tracer, pass, tree).map(Some)
        } else if let Some(tree) = structure.resident::<ResidentBvh2>() {
            timed(tracer, pass, tree).map(Some)
        } else {
            Ok(None)
        }
    })
}

fn timed<R: Rendered>(tracer: &Tracer, pass: &Pass, structure: &R) -> Result<[u64; 3], RenderError> {
    let (device, extent) = (tracer.device(), pass.frame.extent);
    let pixels = extent[0] as usize * extent[1] as usize;
    let mut film = device.zeroed::<Pixel>(pixels)?;
    let mut times = device.zeroed::<StageTimes>(pixels)?;
    let pass = Pass { film: film.view_mut(), ticks: ViewMut::EMPTY, ..*pass };
    let kernel = pass.whitted::<_, Clocks>(structure.long(), times.view_mut());
    // SAFETY: the tracer holds structure and scene, and this the rest, until the kernel is done, which is when `times` are there.
    unsafe { device.launch(&kernel, extent) }?;
    let add = |sum: [u64; 3], time: StageTimes| {
        let spent = [time.generation, time.intersection, time.shading];
        [0, 1, 2].map(|i| sum[i] + u64::from(spent[i]))
    };
    Ok(times.download()?.into_iter().fold([0; 3], add))
}

/// Traces single pixels as [`Tracer::render`] would with one sample, with a counter for each. None but for a `bvh2` on the CPU.
///
/// # Errors
/// As for [`Tracer::render`].
pub fn follow<C: Counter>(
    tracer: &Tracer,
    camera: &Camera,
    options: &RenderOptions,
    pixels: &[[u32; 2]],
) -> Result<Option<Vec<C>>, RenderError> {
    let Some(tree) = tracer.scene().structure().resident::<ResidentBvh2>() else { return Ok(None) };
    if tracer.device().is_cuda() {
        return Ok(None);
    }
    let structure = tree.long();
    tracer.first_sample(camera, options, |pass| {
        let follow = |&[x, y]: &[u32; 2]| {
            let (centre, mut counter) = (pixel_centre(x, y), C::default());
            let ray = pass.frame.camera.ray(centre.x, centre.y);
            trace(&structure, &pass.scene, &pass.limits, &ray, &mut counter);
            counter
        };
        Ok(Some(pixels.iter().map(follow).collect()))
    })
}
