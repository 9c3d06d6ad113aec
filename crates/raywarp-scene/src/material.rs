//! Surfaces: the Phong model of the paper and of Wavefront MTL, with mirror reflection and refraction.

/// How a surface answers light. The default is a matt grey.
///
/// Radiance leaving the surface (Phong 1975 with the recursive terms of Whitted 1980):
/// `emission + ambient * L_a + sum over lights of L (diffuse cos + specular cos^shininess)
///  + reflection * L(mirror direction) + transmission * L(refracted direction)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the file.
    pub name: String,
    /// Reflectance of the ambient light, usually the diffuse colour.
    pub ambient: [f32; 3],
    /// Reflectance of the cosine lobe.
    pub diffuse: [f32; 3],
    /// Strength of the highlight.
    pub specular: [f32; 3],
    /// Phong exponent of the highlight, 0 or more.
    pub shininess: f32,
    /// Radiance that the surface sends out itself.
    pub emission: [f32; 3],
    /// Share of the mirrored radiance.
    pub reflection: [f32; 3],
    /// Share of the radiance that passes through, bent by `ior`; it also filters shadows.
    pub transmission: [f32; 3],
    /// Index of refraction of the inside against the outside; 1 does not bend.
    pub ior: f32,
    /// Fresnel's equations share out the light. Glass (`transmission` and an `ior` other than 1) mirrors their share,
    /// tinted by `reflection` if that has a colour, and lets the rest through, tinted by `transmission`. Every other
    /// surface mirrors `reflection` at normal incidence and more at grazing angles (Schlick 1994).
    pub fresnel: bool,
    /// What a ray loses within the closed surface, per scene unit and channel, 0 or more: of radiance that travels a length
    /// `d` inside, `exp(-absorption d)` is left (Beer's law). Only for what bends or passes rays by `transmission`.
    pub absorption: [f32; 3],
    /// Coverage from 0 to 1: what is not covered shows what lies straight behind.
    pub opacity: f32,
    /// What `opacity` times its texture means.
    pub alpha: AlphaMode,
    /// Shows `diffuse` as it is, without light or shadow (MTL illum 0, KHR_materials_unlit).
    pub unlit: bool,
    /// Pictures show it only from outside, where its vertices run counter-clockwise: camera rays, mirrored and refracted
    /// ones pass through from behind. Its shadow falls from either side, as it does in viewers that cull, and queries
    /// meet both sides. A surface that transmits is always seen from both, for rays must leave it.
    pub single_sided: bool,
    /// It is a metal: what tints `diffuse`, texture and colours of vertices, tints `specular` and `reflection` as well.
    pub metallic: bool,
    /// Multiplies `diffuse` and `ambient`; its alpha multiplies `opacity` unless `alpha` is opaque.
    pub diffuse_map: Option<Texture>,
    /// Multiplies `specular`.
    pub specular_map: Option<Texture>,
    /// Multiplies `emission`.
    pub emission_map: Option<Texture>,
    /// Multiplies `opacity`.
    pub opacity_map: Option<Texture>,
    /// Bends the shading normal.
    pub normal_map: Option<NormalMap>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            ambient: [0.7; 3],
            diffuse: [0.7; 3],
            specular: [0.0; 3],
            shininess: 0.0,
            emission: [0.0; 3],
            reflection: [0.0; 3],
            transmission: [0.0; 3],
            ior: 1.0,
            fresnel: false,
            absorption: [0.0; 3],
            opacity: 1.0,
            alpha: AlphaMode::Opaque,
            unlit: false,
            single_sided: false,
            metallic: false,
            diffuse_map: None,
            specular_map: None,
            emission_map: None,
            opacity_map: None,
            normal_map: None,
        }
    }
}

/// What a coverage below one means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Coverage is ignored.
    #[default]
    Opaque,
    /// A surface where coverage is at least this threshold, nothing elsewhere.
    Mask(f32),
    /// Coverage mixes the surface with what lies behind it.
    Blend,
}

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
