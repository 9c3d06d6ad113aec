//! Path tracing: what it needs of a scene beside what Whitted's shading does, and its launches.

mod alias;
mod emitters;
mod environment;
mod stages;

use std::sync::{Mutex, MutexGuard, PoisonError};

use raywarp_core::bsdf::MetallicRoughness;
use raywarp_core::light::Light;
use raywarp_core::lights::World;
use raywarp_core::sampling::{AliasEntry, AliasTable};
use raywarp_core::surface;
use raywarp_core::texture::luminance;
use raywarp_device::kernels::{Timed, Views};

use super::passes::Pass;
use super::{RenderError, Tracer};
use crate::device::{Buffer, Device, DeviceError};
use crate::device_scene::{Lighting, Surfaces};
use emitters::{Emitters, Others, Part};
use environment::ResidentEnvironment;
pub(super) use stages::pixels_to_fill;
pub(crate) use stages::Openings;
use stages::{Paths, Stages};

/// What path tracing must know of a scene, kept until the first path is traced and when something changes.
pub(crate) struct PathSource {
    /// One a material.
    pub materials: Vec<MetallicRoughness>,
    /// Mean luminance that each material sends out.
    pub glow: Vec<f32>,
    /// What stands in the way beside closed triangles.
    pub openings: Openings,
    /// Of each instance.
    parts: Vec<Part>,
    /// Low and high corner of all triangles.
    bounds: [[f32; 3]; 2],
    resident: Mutex<Option<Resident>>,
}

/// The same on the device.
struct Resident {
    materials: Buffer<MetallicRoughness>,
    environment: ResidentEnvironment,
    lights: Buffer<Light>,
    emitters: Emitters,
    paths: Option<Paths>,
}

impl PathSource {
    pub fn new(scene: &crate::scene::Scene, surfaces: &Surfaces, bounds: [[f32; 3]; 2]) -> Self {
        Self {
            materials: surfaces.metallic_roughness.clone(),
            glow: surfaces.glow.clone(),
            openings: surfaces.openings,
            parts: Part::of(scene),
            bounds,
            resident: Mutex::new(None),
        }
    }

    /// Takes over other surfaces of the same triangles.
    pub fn set_surfaces(&mut self, surfaces: &Surfaces) {
        (self.materials, self.glow) = (surfaces.metallic_roughness.clone(), surfaces.glow.clone());
        self.openings = surfaces.openings;
        self.forget();
    }

    /// Has all of it put on the device anew.
    pub fn forget(&mut self) {
        *self.lock() = None;
    }

    fn lock(&self) -> MutexGuard<'_, Option<Resident>> {
        self.resident.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Distance at which lights are compared: from the middle of the scene to its corners.
    fn reach(&self) -> f64 {
        let [low, high] = self.bounds;
        let square: f64 = (0..3).map(|axis| f64::from(high[axis] - low[axis]).powi(2)).sum();
        0.5 * square.sqrt()
    }

    fn upload(&self, device: &Device, scene: surface::Scene, lighting: &Lighting) -> Result<Resident, DeviceError> {
        let lights = lighting.path_lights();
        let environment = match &lighting.environment {
            Some(picture) => ResidentEnvironment::of_picture(device, picture, lighting.up, lighting.background)?,
            None => ResidentEnvironment::of_sky(device, lighting.background)?,
        };
        let middle = [0, 1, 2].map(|axis| 0.5 * (self.bounds[0][axis] + self.bounds[1][axis]));
        let reach = self.reach();
        let irradiance = |light: &Light| importance(light, middle, reach);
        let others = Others {
            lights: lights.iter().map(irradiance).collect(),
            environment: environment.mean * std::f64::consts::PI,
            distance_squared: (reach * reach).max(f64::MIN_POSITIVE),
        };
        let emitters = Emitters::find(device, scene, &self.parts, &self.glow, &others)?;
        let (materials, lights) = (device.upload(&self.materials)?, device.upload(&lights)?);
        Ok(Resident { materials, environment, lights, emitters, paths: None })
    }
}

/// About the irradiance from an infinitely small light in the middle of the scene, or as far off as its corners are.
fn importance(light: &Light, middle: [f32; 3], reach: f64) -> f64 {
    let color = f64::from(luminance(light.color)) * std::f64::consts::PI;
    if light.kind == raywarp_core::light::kind::DIRECTIONAL {
        return color.max(0.0);
    }
    let square: f64 = light.position.to_array().iter().zip(middle).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    let distance = square.sqrt().max(reach);
    let [constant, linear, quadratic] = light.attenuation.to_array().map(f64::from);
    let share = 1.0 / (constant + (linear + quadratic * distance) * distance);
    let irradiance = color * share;
    if irradiance > 0.0 && irradiance < f64::INFINITY {
        irradiance
    } else {
        0.0
    }
}

impl Resident {
    fn world(&self, scene: surface::Scene) -> World {
        let choice: &Buffer<AliasEntry> = &self.emitters.choice;
        World {
            scene: surface::Scene { lights: self.lights.view(), ..scene },
            materials: self.materials.view(),
            choice: AliasTable { entries: choice.view() },
            environment: self.environment.view(),
            triangles: self.emitters.view(),
        }
    }
}

impl Tracer {
    /// Has paths find light by some ways only, bits of [`strategy`](raywarp_core::wavefront::shade::strategy): for tests, as
    /// the mean is the same.
    #[doc(hidden)]
    pub fn set_strategies(&mut self, strategies: u32) {
        self.strategies = strategies;
    }

    /// Adds the samples of a pass to the film by tracing paths: enqueued, not waited for.
    pub(super) fn trace_paths(&self, pass: &Pass) -> Result<Timed, RenderError> {
        let appearance = self.scene.appearance()?;
        let path = &appearance.path;
        let mut guard = path.lock();
        let mut resident = match guard.take() {
            Some(resident) => resident,
            None => path.upload(&self.device, pass.scene, &appearance.lighting)?,
        };
        let world = resident.world(pass.scene);
        let mut paths = match resident.paths.take().filter(|paths| paths.fit(&self.device, pass.frame.extent)) {
            Some(paths) => paths,
            None => Paths::new(&self.device, pass.frame.extent)?,
        };
        let mut stages = Stages {
            device: &self.device,
            structure: self.kernels(),
            world,
            openings: path.openings,
            strategies: self.strategies,
            paths: &mut paths,
        };
        // SAFETY: as for the launches of `passes`: all buffers belong to this tracer or to the frame, and are freed in the
        // order of the device's own stream. Materials, lights and triangles are indexed by what was checked.
        let launch = Timed::around(&self.device, || unsafe { stages.enqueue(pass) });
        resident.paths = Some(paths);
        *guard = Some(resident);
        Ok(launch?)
    }
}
