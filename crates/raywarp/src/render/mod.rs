//! Stand-in until the renderer lands.
#![allow(missing_docs)]
use crate::accel::{AccelKind, TreeStats};
use crate::backend::{Device, DeviceError};
use crate::image::Picture;
use crate::scene::{Camera, Projection, Scene};
use raywarp_kernels::kernels::Surfel;
use raywarp_kernels::traverse::Tests;

#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    #[error(transparent)]
    Device(#[from] DeviceError),
}
#[derive(Clone, Debug)]
pub struct RenderOptions {
    pub size: [u32; 2],
    pub spp: u32,
    pub max_depth: u32,
    pub shadows: bool,
    pub seed: u32,
    pub crop: Option<[u32; 4]>,
    pub count_tests: bool,
}
impl Default for RenderOptions {
    fn default() -> Self {
        Self { size: [1920, 1080], spp: 1, max_depth: 5, shadows: true, seed: 0, crop: None, count_tests: false }
    }
}
#[derive(Clone, Copy, Debug, Default)]
pub struct Dropped {
    pub degenerate: u64,
    pub not_finite: u64,
}
#[derive(Clone, Debug, Default)]
pub struct Report {
    pub triangles: usize,
    pub dropped: Dropped,
    pub vertices: usize,
    pub bounds: [[f32; 3]; 2],
    pub tree: TreeStats,
    pub device_bytes: u64,
    pub flatten_seconds: f64,
    pub build_seconds: f64,
    pub upload_seconds: f64,
    pub notes: Vec<String>,
}
pub struct Progress {
    pub done: u64,
    pub total: u64,
}
pub struct Rendering {
    pub picture: Picture,
    pub tests: Option<Vec<Tests>>,
    pub kernel_seconds: f64,
    pub launches: u32,
    pub rays: Option<u64>,
    pub non_finite: u64,
}
pub struct Tracer {
    report: Report,
    camera: Camera,
}
impl Tracer {
    pub fn new(scene: &Scene, _accel: AccelKind, _device: &Device) -> Result<Tracer, RenderError> {
        let camera = scene.cameras.first().cloned().unwrap_or(Camera {
            name: String::new(),
            eye: [0.0; 3],
            target: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            projection: Projection::Perspective { fov_y: 1.0 },
        });
        Ok(Self { report: Report::default(), camera })
    }
    pub fn report(&self) -> &Report {
        &self.report
    }
    pub fn default_camera(&self) -> &Camera {
        &self.camera
    }
    pub fn render(
        &self,
        _camera: &Camera,
        options: &RenderOptions,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Rendering, RenderError> {
        let [width, height] = size(options);
        let count = width as usize * height as usize;
        progress(Progress { done: 1, total: 1 });
        Ok(Rendering {
            picture: Picture { width, height, pixels: vec![[0.1, 0.2, 0.3, 0.0]; count] },
            tests: options.count_tests.then(|| vec![Tests { nodes: 3, triangles: 2, rays: 1 }; count]),
            kernel_seconds: 0.1,
            launches: 1,
            rays: options.count_tests.then_some(count as u64),
            non_finite: 0,
        })
    }
    pub fn layers(&self, _camera: &Camera, options: &RenderOptions) -> Result<Vec<Surfel>, RenderError> {
        let [width, height] = size(options);
        Ok(vec![Surfel::NONE; width as usize * height as usize])
    }
}
fn size(options: &RenderOptions) -> [u32; 2] {
    options.crop.map_or(options.size, |[x0, y0, x1, y1]| [x1 - x0, y1 - y0])
}
