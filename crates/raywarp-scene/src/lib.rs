//! A scene as plain data: what the files say, nothing yet arranged for tracing.
//!
//! Coordinates are right-handed, +Y up, in scene units. Colours are linear; files that hold sRGB are converted where
//! they are read (texels stay 8-bit and are decoded when sampled, see [`Texture::srgb`]). Angles are in radians.

mod background;
mod camera;
pub mod deform;
mod environment;
mod image;
mod light;
pub mod load;
mod material;
pub mod memory;
mod mesh;
mod metallic_roughness;
pub mod normals;
mod path;
pub mod save;
pub mod schema;
pub mod settings;
pub mod srgb;
mod texture;
mod viewpoint;
pub mod write;

pub use background::Background;
pub use camera::{axis_name, degrees, radians, Camera, Projection};
pub use environment::{Environment, Radiance};
pub use image::Image;
pub use light::{Light, LightKind};
pub use load::{LoadError, LoadOptions, Loaded, Warning};
pub use material::{AlphaMode, Material};
pub use mesh::{Instance, Mesh, Transform};
pub use metallic_roughness::MetallicRoughness;
pub use path::{CameraKey, CameraPath, PathError};
pub use settings::RenderDefaults;
pub use texture::{Channel, Filter, NormalMap, Texture, UvSet, Wrap};
pub use viewpoint::{Side, UnknownCamera, UnknownSide, Viewpoint};

/// Everything that a picture needs. Meshes are placed by instances: a mesh without an instance is not seen.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Triangle meshes, each in its own space.
    pub meshes: Vec<Mesh>,
    /// Placed meshes.
    pub instances: Vec<Instance>,
    /// Surfaces; [`Mesh::materials`] and [`Instance::material`] are indices into this list.
    pub materials: Vec<Material>,
    /// Decoded pictures; [`Texture::image`] is an index into this list.
    pub images: Vec<Image>,
    /// Light sources. Empty: the renderer lights the scene itself and says so.
    pub lights: Vec<Light>,
    /// Viewpoints. Empty: the renderer frames the bounds.
    pub cameras: Vec<Camera>,
    /// Flights of a camera.
    pub paths: Vec<CameraPath>,
    /// What a ray sees that leaves the scene. `None`: the renderer's choice.
    pub background: Option<Background>,
    /// What is seen and lights instead of the background, with path tracing. `None`: the background does.
    pub environment: Option<Environment>,
    /// Light that arrives everywhere, multiplied by each material's ambient colour. `None`: the renderer's choice.
    pub ambient: Option<[f32; 3]>,
    /// Defaults for the options of rendering.
    pub render: RenderDefaults,
    /// Which way is up, for what the renderer adds by its own choice: a camera that frames, a sun, a sky. `None`: +Y.
    pub up: Option<[f32; 3]>,
}

impl Scene {
    /// A copy without the geometry and the texels: all that can be edited, and small. Indices into
    /// [`meshes`](Self::meshes) and [`images`](Self::images) lead nowhere in it, so it cannot be rendered.
    pub fn outline(&self) -> Self {
        Self {
            meshes: Vec::new(),
            images: Vec::new(),
            instances: self.instances.clone(),
            materials: self.materials.clone(),
            lights: self.lights.clone(),
            cameras: self.cameras.clone(),
            paths: self.paths.clone(),
            background: self.background,
            environment: self.environment.clone(),
            ambient: self.ambient,
            render: self.render,
            up: self.up,
        }
    }
}
