//! From a scene to a picture: flatten it, build the tree, put both on a device, trace.

mod arrange;
mod band_queue;
mod bands;
pub(crate) mod camera;
mod changes;
mod costs;
mod cut_out;
mod error;
mod film;
pub(crate) mod flatten;
mod framing;
mod levels;
mod lighting;
mod materials;
mod metallic_roughness;
mod options;
mod passes;
mod path;
mod resident;
mod structure;

use std::ops::Range;
use std::time::Instant;

use raywarp_core::film::Pixel;
use raywarp_core::kernels::{FirstHit, Frame};
use raywarp_core::shade::whitted::Limits;
use raywarp_core::surface;
use raywarp_core::traversal::Tests;
use raywarp_core::view::ViewMut;
use raywarp_device::kernels::{Timed, Views};

use crate::accel::{Build, Dropped, TreeStats};
use crate::device::{Buffer, Device, DeviceError};
use crate::image::Picture;
use crate::scene::{Camera, Scene, Viewpoint};
use arrange::Arranged;
use band_queue::BandQueue;
use bands::Bands;
use changes::NodesByDepth;
pub(crate) use flatten::Flat;
use lighting::{Ambient, Lighting};
use options::Window;
use path::PathSource;
use resident::ResidentScene;

pub use camera::{axes, ray};
pub use changes::world_triangles;
pub use costs::PixelCosts;
pub use error::RenderError;
pub use film::{Exposure, Film, Painted, Quantity};
pub(crate) use flatten::{check_instance, check_mesh, flags_of};
pub use framing::{chosen_camera, framing};
pub use levels::{two_level, Levels};
pub use lighting::{ambient, sky};
pub use options::{Integrator, RenderOptions, MAX_DEPTH, MAX_SIDE, MAX_SPP};
#[doc(hidden)]
pub use passes::Pass;
pub(crate) use passes::{upload, upload_instances};
pub use structure::Structure;

/// A scene on a device, ready to be traced from any camera.
pub struct Tracer {
    device: Device,
    scene: ResidentScene,
    structure: Structure,
    lighting: Lighting,
    camera: Camera,
    report: Report,
    /// Where the instances are.
    instances: Vec<surface::Instance>,
    /// Where their vertices are.
    vertices: Vec<Range<usize>>,
    /// Of the triangles of each material.
    flags: Vec<u32>,
    /// Of the structure, once something has moved.
    levels: Option<NodesByDepth>,
    /// For path tracing.
    path: PathSource,
}

/// The scene's first camera, or one that frames all of it from the front, right and above in a picture of the size that the
/// scene asks for.
pub fn default_camera(scene: &Scene) -> Camera {
    let [width, height] = scene.render.size().map(f64::from);
    scene.cameras.first().cloned().unwrap_or_else(|| framing::framed(scene, &Viewpoint::default(), width / height))
}

/// Finds out whether pictures can be taken with a camera.
///
/// # Errors
/// [`RenderError::Camera`] says why not.
pub fn check_camera(camera: &Camera) -> Result<(), RenderError> {
    camera::kernel_camera(camera, [1, 1]).map(drop)
}

/// What became of the scene on its way to the device.
#[derive(Clone, Debug)]
pub struct Report {
    /// Triangles that can be hit.
    pub triangles: usize,
    /// Triangles that cannot.
    pub dropped: Dropped,
    /// Vertices of all instances.
    pub vertices: usize,
    /// Low and high corner of all triangles; both zero where there are none.
    pub bounds: [[f32; 3]; 2],
    /// The structure.
    pub tree: TreeStats,
    /// Bytes on the device, without the picture.
    pub device_bytes: u64,
    /// Seconds to bring all instances to world space.
    pub flatten_seconds: f64,
    /// Seconds to build the structure.
    pub build_seconds: f64,
    /// Seconds to copy everything to the device.
    pub upload_seconds: f64,
    /// What the renderer added by its own choice, each a sentence without the full stop.
    pub notes: Vec<String>,
}

/// How far a rendering is, in samples of all pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Samples taken.
    pub done: u64,
    /// Samples to take.
    pub total: u64,
}

/// A finished picture and what it cost.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Mean radiance of each pixel.
    pub picture: Picture,
    /// Tests of each pixel, where they were asked for.
    pub tests: Option<Vec<Tests>>,
    /// Seconds that the kernels ran on the device.
    pub kernel_seconds: f64,
    /// Kernels launched.
    pub launches: u32,
    /// Rays of all kinds, where tests were asked for.
    pub rays: Option<u64>,
    /// Pixels that came out infinite or NaN; they are black in the picture.
    pub non_finite: u64,
}

impl Tracer {
    /// Prepares a scene.
    ///
    /// # Errors
    /// [`RenderError`] where the scene is too large for the structure or for the device's memory.
    pub fn new(scene: &Scene, accel: impl Into<Build>, device: &Device) -> Result<Self, RenderError> {
        Self::with_levels(scene, Levels::Auto, accel, device)
    }

    /// The same, with instances or without. Pictures of the two may differ where rounding decides, as rays are brought to
    /// the space of a mesh or its triangles to world space.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn with_levels(
        scene: &Scene,
        levels: Levels,
        accel: impl Into<Build>,
        device: &Device,
    ) -> Result<Self, RenderError> {
        let start = Instant::now();
        let Arranged { flat, tree, triangles: count, dropped, bounds } = if levels.are_two(scene) {
            Arranged::shared(scene, accel.into())?
        } else {
            Arranged::in_world(scene, accel.into(), device)?
        };
        let flatten_seconds = start.elapsed().as_secs_f64() - tree.build_seconds;
        let estimate = ResidentScene::bytes(&flat, scene) + tree.stats.bytes as u64;
        device.reserve(estimate, "the scene")?;

        let start = Instant::now();
        let surfaces = materials::ready(&scene.materials, &scene.images, Ambient::of(scene));
        let resident = ResidentScene::upload(device, &flat, scene, &surfaces)?;
        let path = PathSource::new(scene, &surfaces, bounds);
        let structure = tree.upload(device)?;
        let upload_seconds = start.elapsed().as_secs_f64();

        let lighting = Lighting::of(scene);
        let camera = default_camera(scene);
        let mut notes = Vec::new();
        if scene.cameras.is_empty() {
            notes.push("no camera in the scene: it is framed".to_owned());
        }
        notes.extend(structure.warning.clone());
        let report = Report {
            triangles: count,
            dropped,
            vertices: flat.positions.len(),
            bounds,
            tree: structure.stats,
            device_bytes: estimate,
            flatten_seconds,
            build_seconds: structure.build_seconds,
            upload_seconds,
            notes,
        };
        Ok(Self {
            device: device.clone(),
            scene: resident,
            structure,
            lighting,
            camera,
            report,
            instances: flat.instances,
            vertices: flat.vertices,
            flags: scene.materials.iter().map(flags_of).collect(),
            levels: None,
            path,
        })
    }

    /// What became of the scene.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// What an integrator adds to the lights by its own choice or leaves out, each a sentence without the full stop.
    pub fn notes_of(&self, integrator: Integrator) -> Vec<String> {
        self.lighting.notes(integrator)
    }

    /// Where it traces.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The scene's first camera, or one that frames it: [`default_camera`].
    pub fn default_camera(&self) -> &Camera {
        &self.camera
    }

    /// Renders a picture and calls `progress` after each launch, which aims at 0.08 s. The same scene, camera, options and seed give
    /// the same picture on every device.
    ///
    /// # Errors
    /// [`RenderError`] for impossible options, a camera without a direction, or a device that fails.
    pub fn render(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Rendering, RenderError> {
        let window = options.check()?;
        let pixels = window.pixels();
        let counted = if options.count_tests { pixels } else { 0 };
        let bytes = pixels * std::mem::size_of::<Pixel>() + counted * std::mem::size_of::<Tests>();
        self.device.reserve(bytes as u64, "the picture")?;
        let mut film = self.device.zeroed::<Pixel>(pixels)?;
        let mut tests = self.device.zeroed::<Tests>(counted)?;

        // Bands of rows, each large enough to fill the device and small enough to report on.
        let lights = self.lighting.upload(&self.device, camera)?;
        let scene = self.scene.view(&lights, &self.lighting);
        let camera = camera::kernel_camera(camera, options.size)?;
        let is_gpu = self.device.is_cuda();
        let mut queue = BandQueue::new(Bands::new(window, options.spp, is_gpu), is_gpu, progress);
        while let Some(band) = queue.next()? {
            let frame = Frame {
                camera,
                origin: band.origin,
                extent: band.extent,
                film: [window.origin[0], window.origin[1], window.extent[0]],
                samples: [band.samples[0], band.samples[1], options.spp],
                seed: options.seed,
            };
            let limits = Limits { depth: options.max_depth, shadows: options.shadows as u32 };
            let pass = passes::Pass {
                scene,
                frame,
                limits,
                film: film.view_mut(),
                tests: tests.view_mut(),
                ticks: ViewMut::EMPTY,
            };
            queue.push(band, self.take_samples(options.integrator, &pass)?);
        }
        finish(options, film, tests, queue.kernel_seconds, queue.launches, window)
    }

    /// Adds the samples of a pass to the film: enqueued, not waited for.
    fn take_samples(&self, integrator: Integrator, pass: &passes::Pass) -> Result<Timed, DeviceError> {
        match integrator {
            Integrator::Whitted => passes::shade(&self.device, &*self.structure.resident, pass),
            Integrator::Path => self.trace_paths(pass),
        }
    }

    /// What the ray through the centre of each pixel meets first, row by row.
    ///
    /// # Errors
    /// As for [`render`](Self::render).
    pub fn layers(&self, camera: &Camera, options: &RenderOptions) -> Result<Vec<FirstHit>, RenderError> {
        let window = options.check()?;
        self.device.reserve((window.pixels() * std::mem::size_of::<FirstHit>()) as u64, "the layers of the picture")?;
        let mut first_hits = self.device.zeroed::<FirstHit>(window.pixels())?;
        let lights = self.lighting.upload(&self.device, camera)?;
        let pass = self.whole(camera, options, window, &lights)?;
        passes::first_hits(&self.device, &*self.structure.resident, &pass, first_hits.view_mut())?;
        Ok(first_hits.download()?)
    }
}

/// Sums to means, and the bill.
fn finish(
    options: &RenderOptions,
    film: Buffer<Pixel>,
    tests: Buffer<Tests>,
    kernel_seconds: f64,
    launches: u32,
    window: Window,
) -> Result<Rendering, RenderError> {
    let ([width, height], samples) = (window.extent, options.spp as f32);
    let mut non_finite = 0;
    let pixels = film.download()?.iter().map(|pixel| mean(pixel, samples, &mut non_finite)).collect();
    let tests = if options.count_tests { Some(tests.download()?) } else { None };
    let rays = tests.as_ref().map(|tests| tests.iter().map(|t| t.rays as u64).sum());
    let picture = Picture { width, height, origin: window.origin, whole: options.size, pixels };
    Ok(Rendering { picture, tests, kernel_seconds, launches, rays, non_finite })
}

fn mean(pixel: &Pixel, samples: f32, non_finite: &mut u64) -> [f32; 4] {
    let mean = pixel.mean(samples);
    *non_finite += mean.is_none() as u64;
    let [r, g, b] = mean.map_or([0.0; 3], |mean| mean.to_array());
    [r, g, b, pixel.hits / samples]
}
