//! Surfaces: the Phong model of the paper and of Wavefront MTL, with mirror reflection and refraction.

use crate::schema::{Described, Field, Kind, PanelRow, Parameter, Usual, Value};
use crate::{MetallicRoughness, NormalMap, Texture};

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
    /// What path tracing follows instead of Phong's model; `None`: what [stands for it](MetallicRoughness::of_phong). Whitted's
    /// shading does not look at it: a file that has only this is given Phong's parameters beside it.
    pub metallic_roughness: Option<MetallicRoughness>,
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
            metallic_roughness: None,
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

macro_rules! parameters {
    ($($name:ident, $kind:expr, $default:expr, $panel:expr, $meaning:literal;)* [$($other:expr),*]) => {
        &[$(Parameter {
            name: stringify!($name),
            alias: None,
            kind: $kind,
            meaning: $meaning,
            default: $default,
            panel: $panel,
            read: |material: &Material| Some(material.$name.value()),
            write: |material: &mut Material, value| {
                if let Some(value) = Field::of(value) {
                    material.$name = value;
                }
            },
        },)* $($other),*]
    };
}

const BLACK: Usual = Usual::Value(|| Value::Triple([0.0; 3]));
const OFF: Usual = Usual::Value(|| Value::Flag(false));

impl Described for Material {
    fn parameters() -> impl Iterator<Item = &'static Parameter<Self>> {
        MATERIAL.iter()
    }
}

/// In the order of a saved file and of the panel.
const MATERIAL: &[Parameter<Material>] = parameters! {
    diffuse, Kind::Color, Usual::Value(|| Value::Triple([0.7; 3])), color("Diffuse", 1.0),
        "Colour of the cosine lobe";
    ambient, Kind::Color, Usual::Words("`diffuse`"), color("Ambient", 1.0),
        "Colour against an `ambient` light that the scene gives; the built-in one is reflected by `diffuse`";
    specular, Kind::Color, BLACK, color("Specular", 1.0),
        "Colour of the highlight";
    shininess, Kind::NON_NEGATIVE, Usual::Value(|| Value::Number(32.0)), number("Shininess", [0.0, 1000.0]),
        "Exponent of the highlight";
    emission, Kind::Color, BLACK, color("Emission", 10.0),
        "Radiance of its own; it lights other surfaces with path tracing alone";
    reflection, Kind::Share, BLACK, color("Reflection", 1.0),
        "Share of the mirrored radiance";
    transmission, Kind::Share, BLACK, color("Transmission", 1.0),
        "Share of what passes through; it also colours shadows";
    ior, Kind::Number { low: 0.01, high: 100.0, unit: "" }, Usual::Value(|| Value::Number(1.0)),
        number("Index of refraction", [1.0, 3.0]),
        "Index of refraction of the inside; 1 does not bend";
    fresnel, Kind::FLAG, OFF, Some(PanelRow::new("Fresnel")),
        "Whether Fresnel's equations share out the light: glass (a `transmission`, and an `ior` other than 1) mirrors their share, \
         tinted by `reflection` if that is not 0, and lets the rest through; other surfaces mirror `reflection` from the \
         front and more at grazing angles. Without it both count in full, so their sum should stay below 1";
    opacity, Kind::Number { low: 0.0, high: 1.0, unit: "" }, Usual::Value(|| Value::Number(1.0)),
        number("Opacity", [0.0, 1.0]),
        "Coverage";
    unlit, Kind::FLAG, OFF, None,
        "Shows `diffuse` without light or shadow";
    [ALPHA, CUTOFF, BASE_COLOR, METALLIC, ROUGHNESS, SPECULAR_WEIGHT, SPECULAR_COLOR, SPECULAR_IOR, TRANSMISSION_WEIGHT, THIN]
};

const ALPHA: Parameter<Material> = Parameter {
    name: "alpha",
    alias: None,
    kind: Kind::Words(&["opaque", "mask", "blend"]),
    meaning: "`\"opaque\"`: coverage is ignored; `\"mask\"`: there or not, by `cutoff`; `\"blend\"`: mixed",
    default: Usual::Words("`\"blend\"` with an `opacity` below 1 or an `opacity_map`, else `\"opaque\"`"),
    panel: None,
    read: |material| {
        Some(Value::Word(match material.alpha {
            AlphaMode::Opaque => "opaque",
            AlphaMode::Mask(_) => "mask",
            AlphaMode::Blend => "blend",
        }))
    },
    write: |material, value| {
        material.alpha = match (value, material.alpha) {
            (Value::Word("opaque"), _) => AlphaMode::Opaque,
            (Value::Word("blend"), _) => AlphaMode::Blend,
            (Value::Word("mask"), AlphaMode::Opaque | AlphaMode::Blend) => AlphaMode::Mask(USUAL_CUTOFF),
            (_, same) => same,
        }
    },
};

/// Least coverage that is there, unless the file says otherwise.
const USUAL_CUTOFF: f32 = 0.5;

/// After `alpha`, as only a mask has one.
const CUTOFF: Parameter<Material> = Parameter {
    name: "cutoff",
    alias: None,
    kind: Kind::Number { low: 0.0, high: 1.0, unit: "" },
    meaning: "With `\"mask\"`: least coverage that is there",
    default: Usual::Value(|| Value::Number(USUAL_CUTOFF)),
    panel: None,
    read: |material| match material.alpha {
        AlphaMode::Mask(cutoff) => Some(Value::Number(cutoff)),
        _ => None,
    },
    write: |material, value| {
        if let (AlphaMode::Mask(cutoff), Value::Number(number)) = (&mut material.alpha, value) {
            *cutoff = number;
        }
    },
};

/// Parameters of [`MetallicRoughness`]: the first that is set gives a material one, of what stands for the rest of it.
macro_rules! physical {
    ($($constant:ident, $name:literal, $field:ident, $kind:expr, $panel:expr, $meaning:literal;)*) => {$(
        const $constant: Parameter<Material> = Parameter {
            name: $name,
            alias: None,
            kind: $kind,
            meaning: $meaning,
            default: Usual::Words("of what stands for the other model"),
            panel: $panel,
            read: |material| Some(material.metallic_roughness.as_ref()?.$field.value()),
            write: |material, value| {
                if let Some(value) = Field::of(value) {
                    let phong = MetallicRoughness::of_phong(material);
                    material.metallic_roughness.get_or_insert(phong).$field = value;
                }
            },
        };
    )*};
}

const UNIT: Kind = Kind::Number { low: 0.0, high: 1.0, unit: "" };

physical! {
    BASE_COLOR, "base_color", base_color, Kind::Share, color("Base colour", 1.0),
        "Path tracing: reflectance of what is matt, and of metal from the front";
    METALLIC, "metallic", metallic, UNIT, number("Metallic", [0.0, 1.0]),
        "Path tracing: share of metal";
    ROUGHNESS, "roughness", roughness, UNIT, number("Roughness", [0.0, 1.0]),
        "Path tracing: from 0, a mirror, to 1";
    SPECULAR_WEIGHT, "specular_weight", specular, UNIT, number("Specular weight", [0.0, 1.0]),
        "Path tracing: strength of the reflection of what is no metal";
    SPECULAR_COLOR, "specular_color", specular_color, Kind::Color, color("Specular colour", 1.0),
        "Path tracing: tint of that reflection from the front";
    SPECULAR_IOR, "specular_ior", ior, Kind::Number { low: 1.0, high: 100.0, unit: "" }, number("Specular index", [1.0, 3.0]),
        "Path tracing: index of refraction of what is no metal; 1.5 reflects 4 % from the front";
    TRANSMISSION_WEIGHT, "transmission_weight", transmission, UNIT, number("Transmission weight", [0.0, 1.0]),
        "Path tracing: share that passes through of what is neither metal nor reflected, tinted by `base_color`";
    THIN, "thin_walled", thin, Kind::FLAG, Some(PanelRow::new("Thin wall")),
        "Path tracing: whether it is the wall of nothing, which does not bend what passes";
}

const fn color(label: &'static str, high: f32) -> Option<PanelRow> {
    Some(PanelRow::ranged(label, [0.0, high], 0.0))
}

const fn number(label: &'static str, range: [f32; 2]) -> Option<PanelRow> {
    Some(PanelRow::ranged(label, range, 0.0))
}
