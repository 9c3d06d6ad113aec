//! Which extensions are read, and what to do about the others.

use super::super::quote::file_name;
use super::super::{LoadError, Place, Sources};
use super::origin::Origin;

const READ: [&str; 15] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_texture_transform",
];

/// Change nothing of the picture that the file shows at first: what they add is notes, other choices, motion, sound, or
/// for programs that do more than show it.
const HARMLESS: [&str; 28] = [
    "AGI_articulations",
    "AGI_stk_metadata",
    "EXT_feature_metadata",
    "EXT_instance_features",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "FB_geometry_metadata",
    "GODOT_single_root",
    "KHR_animation_pointer",
    "KHR_audio_emitter",
    "KHR_interactivity",
    "KHR_materials_variants",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_physics_rigid_bodies",
    "KHR_implicit_shapes",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_audio_emitter",
    "MSFT_collision_mesh",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
    "MSFT_physics",
    "OMI_physics_body",
    "OMI_physics_shape",
    "OMI_spawn_point",
];

/// Refuses a file that requires what raywarp lacks, and warns of what it merely uses. A surface that is not known is
/// still a surface: extensions of materials never refuse the file.
pub(super) fn check(
    origin: Origin,
    used: &[String],
    required: &[String],
    sources: &mut Sources,
) -> Result<(), LoadError> {
    let known = |name: &str| READ.contains(&name) || HARMLESS.contains(&name);
    if let Some(name) = required.iter().find(|name| !known(name) && !is_of_materials(name)) {
        return Err(LoadError::Unsupported {
            path: origin.path.to_owned(),
            place: Place::File,
            what: format!("the extension {}, which the file requires,", file_name(name)),
            help: way_out(name).to_owned(),
        });
    }
    for name in used.iter().chain(required).filter(|name| !known(name)) {
        sources.warn(origin.path, None, format!("the extension {} is ignored", file_name(name)))?;
    }
    Ok(())
}

/// `KHR_materials_sheen` and its like, of any vendor.
fn is_of_materials(name: &str) -> bool {
    name.split_once('_').is_some_and(|(_, subject)| subject.starts_with("materials_"))
}

fn way_out(name: &str) -> &'static str {
    match name {
        "KHR_texture_basisu" => "Export the model again with PNG or JPEG textures instead of KTX2.",
        "EXT_texture_avif" | "MSFT_texture_dds" => "Export the model again with PNG or JPEG textures.",
        _ => "Export the model again without it.",
    }
}
