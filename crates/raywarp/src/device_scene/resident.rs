//! A scene and its structure in the memory of a device.

use raywarp_core::light::Light;
use raywarp_core::material::Material;
use raywarp_core::math::Vec3;
use raywarp_core::surface::{self, Instance, Primitive};
use raywarp_core::texture::{Texture, Textures};
use raywarp_core::view::View;
use raywarp_device::kernels::Views;

use super::flatten::Flat;
use super::lighting::Lighting;
use super::materials::{self, Surfaces};
use crate::device::{Buffer, Device, DeviceError};
use crate::scene::Scene;

/// What shading reads.
pub(crate) struct ResidentScene {
    instances: Buffer<Instance>,
    primitives: Buffer<Primitive>,
    positions: Buffer<Vec3>,
    normals: Buffer<Vec3>,
    uvs: Buffer<[f32; 2]>,
    /// Where the second ones begin among them; 0 where there are none.
    second_uvs: u32,
    colors: Buffer<[f32; 4]>,
    tangents: Buffer<[f32; 4]>,
    materials: Buffer<Material>,
    textures: Buffer<Texture>,
    texels: Buffer<u32>,
    decode: Buffer<f32>,
}

impl ResidentScene {
    /// What it will take on a device.
    pub fn bytes(flat: &Flat, scene: &Scene) -> u64 {
        let uvs = size(&flat.uvs) + size(&flat.second_uvs);
        let vertices = size(&flat.positions) + size(&flat.normals) + uvs + size(&flat.colors);
        let texels: usize = scene.images.iter().map(|image| size(&image.texels)).sum();
        (vertices + size(&flat.tangents) + size(&flat.primitives) + size(&flat.instances) + texels) as u64
    }

    pub fn upload(device: &Device, flat: &Flat, scene: &Scene, surfaces: &Surfaces) -> Result<Self, DeviceError> {
        let Surfaces { materials, textures, .. } = surfaces;
        Ok(Self {
            instances: device.upload(&flat.instances)?,
            primitives: device.upload(&flat.primitives)?,
            positions: device.upload(&flat.positions)?,
            normals: device.upload(&flat.normals)?,
            uvs: device.upload(&[&flat.uvs[..], &flat.second_uvs].concat())?,
            second_uvs: if flat.second_uvs.is_empty() { 0 } else { flat.uvs.len() as u32 },
            colors: device.upload(&flat.colors)?,
            tangents: device.upload(&flat.tangents)?,
            materials: device.upload(materials)?,
            textures: device.upload(textures)?,
            texels: device.upload(&materials::texels(scene))?,
            decode: device.upload(&materials::srgb_table())?,
        })
    }

    /// Takes over other materials of the same images.
    pub fn set_materials(&mut self, device: &Device, surfaces: &Surfaces) -> Result<(), DeviceError> {
        let Surfaces { materials, textures, .. } = surfaces;
        (self.materials, self.textures) = (device.upload(materials)?, device.upload(textures)?);
        Ok(())
    }

    /// Takes over vertices from `first` on.
    pub fn move_vertices(&mut self, first: usize, flat: &Flat) -> Result<(), DeviceError> {
        self.positions.write(first, &flat.positions)?;
        self.normals.write(first, &flat.normals)?;
        if self.tangents.is_empty() || flat.tangents.is_empty() {
            return Ok(());
        }
        self.tangents.write(first, &flat.tangents)
    }

    /// Takes over where an instance is, whose vertices have moved.
    pub fn set_instance(&mut self, index: usize, instance: Instance) -> Result<(), DeviceError> {
        self.instances.write(index, &[instance])
    }

    /// The same of all.
    pub fn set_instances(&mut self, instances: &[Instance]) -> Result<(), DeviceError> {
        self.instances.write(0, instances)
    }

    pub fn instances(&self) -> View<Instance> {
        self.instances.view()
    }

    pub fn primitives(&self) -> View<Primitive> {
        self.primitives.view()
    }

    pub fn positions(&self) -> View<Vec3> {
        self.positions.view()
    }

    pub fn view(&self, lights: &Buffer<Light>, lighting: &Lighting) -> surface::Scene {
        surface::Scene {
            instances: self.instances.view(),
            primitives: self.primitives.view(),
            positions: self.positions.view(),
            normals: self.normals.view(),
            uvs: self.uvs.view(),
            second_uvs: self.second_uvs,
            colors: self.colors.view(),
            tangents: self.tangents.view(),
            materials: self.materials.view(),
            textures: Textures { list: self.textures.view(), texels: self.texels.view(), decode: self.decode.view() },
            lights: lights.view(),
            background: lighting.background,
            ambient: lighting.ambient,
        }
    }
}

fn size<T>(items: &[T]) -> usize {
    std::mem::size_of_val(items)
}
