//! Textures of surfaces: which image, and how it is laid out and sampled.

/// How a material samples an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture {
    /// Index into [`Scene::images`](super::Scene::images).
    pub image: u32,
    /// Which of the mesh's texture coordinates it is laid out by.
    pub uv_set: UvSet,
    /// The colour channels are sRGB and are decoded before filtering. Alpha never is.
    pub srgb: bool,
    /// What happens outside of [0, 1], along u and along v.
    pub wrap: [Wrap; 2],
    /// Between texels.
    pub filter: Filter,
    /// Which of the channels are used.
    pub channel: Channel,
    /// Rows of the map from mesh coordinates to image coordinates: `u' = r0[0] u + r0[1] v + r0[2]`, `v'` by `r1`.
    pub transform: [[f32; 3]; 2],
    /// The sampled colour becomes `base + gain * colour` (MTL `-mm`). Alpha does not.
    pub base: f32,
    /// See `base`.
    pub gain: f32,
}

impl Texture {
    /// The whole image, repeated, bilinear, unchanged.
    pub fn new(image: u32, srgb: bool) -> Self {
        Self {
            image,
            uv_set: UvSet::First,
            srgb,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Bilinear,
            channel: Channel::Rgb,
            transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            base: 0.0,
            gain: 1.0,
        }
    }
}

/// One of the sets of texture coordinates of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UvSet {
    /// [`Mesh::uvs`](super::Mesh::uvs).
    #[default]
    First,
    /// [`Mesh::second_uvs`](super::Mesh::second_uvs).
    Second,
}

/// Texture coordinates outside of [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The fractional part.
    #[default]
    Repeat,
    /// The nearest edge texel.
    Clamp,
    /// Back and forth.
    Mirror,
}

/// Reconstruction between texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The texel that the point lies in.
    Nearest,
    /// Linear in both directions between the four nearest texel centres.
    #[default]
    Bilinear,
}

/// Channel selection; a single channel is spread over red, green and blue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Channel {
    /// Colour as it is.
    #[default]
    Rgb,
    /// Red alone.
    Red,
    /// Green alone.
    Green,
    /// Blue alone.
    Blue,
    /// Alpha alone.
    Alpha,
    /// Rec. 709 luminance of the linear colour.
    Luminance,
}

/// What bends the shading normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NormalMap {
    /// Tangent-space normals, `2 rgb - 1`, green up (OpenGL's convention); x and y are scaled by `scale`.
    Tangent {
        /// The image, not sRGB.
        texture: Texture,
        /// 1 is as painted.
        scale: f32,
    },
    /// Heights; the normal leans by the finite difference of neighbouring texels.
    Height {
        /// The image, not sRGB.
        texture: Texture,
        /// Height of white over black, in texels.
        scale: f32,
    },
}
