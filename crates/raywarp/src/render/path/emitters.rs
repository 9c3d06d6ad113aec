//! Which triangles of a scene glow, and the table by which a light is chosen.

use raywarp_core::lights::{EmissiveTriangles, EmitterPowers};
use raywarp_core::sampling::AliasEntry;
use raywarp_core::surface;
use raywarp_device::kernels::Views;

use super::alias;
use crate::device::{Buffer, Device, DeviceError};
use crate::MISS;

/// The triangles of an instance, and which materials they have.
#[derive(Clone, Debug)]
pub struct Part {
    triangles: u32,
    materials: Vec<u32>,
}

impl Part {
    /// Of each instance of a scene.
    pub fn of(scene: &crate::scene::Scene) -> Vec<Self> {
        let mut of_meshes = Vec::with_capacity(scene.meshes.len());
        // The last mesh, counted from 1, that each material was seen in.
        let mut seen = vec![0; scene.materials.len()];
        for (mesh, number) in scene.meshes.iter().zip(1..) {
            // A mesh that nothing places may name materials that are not there.
            let is_new = |material: &u32| {
                seen.get_mut(*material as usize).is_some_and(|last| std::mem::replace(last, number) != number)
            };
            let materials = mesh.materials.iter().copied().filter(is_new).collect();
            of_meshes.push(Self { triangles: mesh.triangles.len() as u32, materials });
        }
        let part = |instance: &crate::scene::Instance| {
            let part = &of_meshes[instance.mesh];
            let materials = instance.material.map_or_else(|| part.materials.clone(), |material| vec![material]);
            Self { materials, ..part.clone() }
        };
        scene.instances.iter().map(part).collect()
    }
}

/// What glows, on a device.
pub struct Emitters {
    triangles: Buffer<[u32; 2]>,
    first: Buffer<u32>,
    /// Of all lights: those that are infinitely small, the environment, the triangles.
    pub choice: Buffer<AliasEntry>,
}

/// Importance of the lights that are no triangles.
pub struct Others {
    /// Irradiance in the middle of the scene from each infinitely small light.
    pub lights: Vec<f64>,
    /// And from the environment.
    pub environment: f64,
    /// The square of the distance at which triangles count.
    pub distance_squared: f64,
}

impl Emitters {
    /// Of instances whose materials have so much power a unit of area.
    pub fn find(
        device: &Device,
        scene: surface::Scene,
        parts: &[Part],
        weights: &[f32],
        others: &Others,
    ) -> Result<Self, DeviceError> {
        let (mut triangles, mut first) = (Vec::new(), Vec::with_capacity(parts.len()));
        for (part, instance) in parts.iter().zip(0..) {
            let glows = part.materials.iter().any(|&material| weights[material as usize] > 0.0);
            first.push(if glows { triangles.len() as u32 } else { MISS });
            if glows {
                triangles.extend((0..part.triangles).map(|primitive| [instance, primitive]));
            }
        }
        let triangles = device.upload(&triangles)?;
        let powers = powers(device, scene, &triangles, weights)?;
        let triangle = |&power: &f32| f64::from(power) / others.distance_squared;
        let all = others.lights.iter().copied().chain([others.environment]).chain(powers.iter().map(triangle));
        let choice = device.upload(&alias::table(&all.collect::<Vec<_>>()))?;
        Ok(Self { triangles, first: device.upload(&first)?, choice })
    }

    /// For kernels.
    pub fn view(&self) -> EmissiveTriangles {
        EmissiveTriangles { triangles: self.triangles.view(), first: self.first.view() }
    }
}

fn powers(
    device: &Device,
    scene: surface::Scene,
    triangles: &Buffer<[u32; 2]>,
    weights: &[f32],
) -> Result<Vec<f32>, DeviceError> {
    if triangles.is_empty() {
        return Ok(Vec::new());
    }
    let weights = device.upload(weights)?;
    let mut powers = device.zeroed::<f32>(triangles.len() as usize)?;
    let kernel =
        EmitterPowers { scene, triangles: triangles.view(), weights: weights.view(), powers: powers.view_mut() };
    // SAFETY: the buffers are freed in the order of the device's own stream; instances and primitives are the scene's own,
    // whose indices were checked.
    unsafe { device.launch(&kernel, [triangles.len(), 1]) }?;
    powers.download()
}
