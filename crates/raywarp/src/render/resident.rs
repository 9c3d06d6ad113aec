//! A scene and its structure in the memory of a device.

use std::marker::PhantomData;

use raywarp_kernels::film::Pixel;
use raywarp_kernels::kernels::{Frame, Kernel, Surfel, Surfels, Whitted};
use raywarp_kernels::light::Light;
use raywarp_kernels::material::Material;
use raywarp_kernels::math::Vec3;
use raywarp_kernels::shade::whitted::Limits;
use raywarp_kernels::surface::{self, Primitive};
use raywarp_kernels::texture::{Texture, Textures};
use raywarp_kernels::traverse::{self, bvh2, kdtree, Structure, Tests, Uncounted};
use raywarp_kernels::triangle::Triangle;
use raywarp_kernels::view::ViewMut;

use super::flatten::Flat;
use super::lighting::Lighting;
use super::materials::{self, Surfaces};
use crate::accel::Accel;
use crate::backend::{Buffer, Device, DeviceError};
use crate::scene::Scene;

/// What shading reads.
pub(super) struct ResidentScene {
    primitives: Buffer<Primitive>,
    positions: Buffer<Vec3>,
    normals: Buffer<Vec3>,
    uvs: Buffer<[f32; 2]>,
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
        let vertices = size(&flat.positions) + size(&flat.normals) + size(&flat.uvs) + size(&flat.colors);
        let texels: usize = scene.images.iter().map(|image| size(&image.texels)).sum();
        (vertices + size(&flat.tangents) + size(&flat.primitives) + texels) as u64
    }

    pub fn upload(device: &Device, flat: &Flat, scene: &Scene) -> Result<Self, DeviceError> {
        let Surfaces { materials, textures } = materials::ready(scene);
        Ok(Self {
            primitives: device.upload(&flat.primitives)?,
            positions: device.upload(&flat.positions)?,
            normals: device.upload(&flat.normals)?,
            uvs: device.upload(&flat.uvs)?,
            colors: device.upload(&flat.colors)?,
            tangents: device.upload(&flat.tangents)?,
            materials: device.upload(&materials)?,
            textures: device.upload(&textures)?,
            texels: device.upload(&materials::texels(scene))?,
            decode: device.upload(&materials::srgb_table())?,
        })
    }

    pub fn view(&self, lights: &Buffer<Light>, lighting: &Lighting) -> surface::Scene {
        surface::Scene {
            primitives: self.primitives.view(),
            positions: self.positions.view(),
            normals: self.normals.view(),
            uvs: self.uvs.view(),
            colors: self.colors.view(),
            tangents: self.tangents.view(),
            materials: self.materials.view(),
            textures: Textures {
                list: self.textures.view(),
                texels: self.texels.view(),
                decode: self.decode.view(),
            },
            lights: lights.view(),
            background: lighting.background,
            ambient: lighting.ambient,
        }
    }
}

fn size<T>(items: &[T]) -> usize {
    std::mem::size_of_val(items)
}

/// What traversal reads.
pub(super) enum ResidentStructure {
    Brute { triangles: Buffer<Triangle> },
    Kd { nodes: Buffer<kdtree::Node>, references: Buffer<u32>, triangles: Buffer<Triangle>, low: Vec3, high: Vec3 },
    Bvh { nodes: Buffer<bvh2::Node>, triangles: Buffer<Triangle> },
}

/// One launch of a frame: everything but the structure.
#[derive(Clone, Copy)]
pub(super) struct Pass {
    pub scene: surface::Scene,
    pub frame: Frame,
    pub limits: Limits,
    pub film: ViewMut<Pixel>,
    /// Empty: nobody counts.
    pub tests: ViewMut<Tests>,
}

/// Evaluates an expression with the structure's view under a name, once for each kind.
macro_rules! with_structure {
    ($resident:expr, $structure:ident => $body:expr) => {
        match $resident {
            ResidentStructure::Brute { triangles } => {
                let $structure = traverse::Brute { triangles: triangles.view() };
                $body
            }
            ResidentStructure::Kd { nodes, references, triangles, low, high } => {
                let $structure = traverse::KdTree {
                    nodes: nodes.view(),
                    references: references.view(),
                    triangles: triangles.view(),
                    low: *low,
                    high: *high,
                };
                $body
            }
            ResidentStructure::Bvh { nodes, triangles } => {
                let $structure = traverse::Bvh2 { nodes: nodes.view(), triangles: triangles.view() };
                $body
            }
        }
    };
}

impl ResidentStructure {
    pub fn upload(device: &Device, tree: &Accel) -> Result<Self, DeviceError> {
        Ok(match tree {
            Accel::Brute(triangles) => Self::Brute { triangles: device.upload(triangles)? },
            Accel::Kd(tree) => Self::Kd {
                nodes: device.upload(&tree.nodes)?,
                references: device.upload(&tree.references)?,
                triangles: device.upload(&tree.triangles)?,
                low: tree.low,
                high: tree.high,
            },
            Accel::Bvh(tree) => {
                Self::Bvh { nodes: device.upload(&tree.nodes)?, triangles: device.upload(&tree.triangles)? }
            }
        })
    }

    /// Adds the samples of a pass to the film; returns the seconds on the device.
    pub fn shade(&self, device: &Device, pass: &Pass) -> Result<f64, DeviceError> {
        with_structure!(self, structure => match pass.tests.is_empty() {
            true => run(device, pass, &whitted::<_, Uncounted>(structure, pass)),
            false => run(device, pass, &whitted::<_, Tests>(structure, pass)),
        })
    }

    /// Fills a surfel for each pixel of a pass.
    pub fn surfels(&self, device: &Device, pass: &Pass, surfels: ViewMut<Surfel>) -> Result<f64, DeviceError> {
        let (scene, frame) = (pass.scene, pass.frame);
        with_structure!(self, structure => run(device, pass, &Surfels { structure, scene, frame, surfels }))
    }
}

fn whitted<S: Structure, C>(structure: S, pass: &Pass) -> Whitted<S, C> {
    let Pass { scene, frame, limits, film, tests } = *pass;
    Whitted { structure, scene, frame, limits, film, tests, counter: PhantomData }
}

fn run(device: &Device, pass: &Pass, kernel: &impl Kernel) -> Result<f64, DeviceError> {
    // SAFETY: the structure's views are of buffers borrowed for this call; those of the pass belong to the frame that
    // `Tracer` holds while it waits here. `Flat` checked the indices of the scene, the builders those of the trees.
    unsafe { device.launch(kernel, pass.frame.extent) }
}
