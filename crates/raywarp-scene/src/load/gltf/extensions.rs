//! Which extensions are read, and what to do about the others.

use super::super::quote::file_name;
use super::super::{LoadError, Place, Sources};
use super::origin::Origin;

const READ: [&str; 12] = [
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Change nothing of the picture that the file shows at first.
const HARMLESS: [&str; 4] = ["KHR_animation_pointer", "KHR_materials_variants", "KHR_xmp", "KHR_xmp_json_ld"];

/// Refuses a file that requires what raywarp lacks, and warns of what it merely uses.
pub(super) fn check(
    origin: Origin,
    used: &[String],
    required: &[String],
    sources: &mut Sources,
) -> Result<(), LoadError> {
    let known = |name: &str| READ.contains(&name) || HARMLESS.contains(&name);
    if let Some(name) = required.iter().find(|name| !known(name)) {
        return Err(LoadError::Unsupported {
            path: origin.path.to_owned(),
            place: Place::File,
            what: format!("the extension {}, which the file requires,", file_name(name)),
            help: way_out(name).to_owned(),
        });
    }
    for name in used.iter().filter(|name| !known(name)) {
        sources.warn(origin.path, None, format!("the extension {} is ignored", file_name(name)))?;
    }
    Ok(())
}

fn way_out(name: &str) -> &'static str {
    match name {
        "KHR_draco_mesh_compression" => "Export the model again without Draco compression.",
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "Export the model again without meshopt compression, for example by gltfpack without -c."
        }
        "KHR_texture_basisu" => "Export the model again with PNG or JPEG textures instead of KTX2.",
        "EXT_texture_avif" | "MSFT_texture_dds" => "Export the model again with PNG or JPEG textures.",
        _ => "Export the model again without it.",
    }
}
