use super::*;
use crate::{AlphaMode, Channel, Filter, Material, NormalMap, Wrap};

/// A picture of one texel.
fn plain(texel: [u8; 3]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_raw(1, 1, texel.to_vec()).unwrap();
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A picture of 2 by 1 texels: white, then (0, 128, 255).
fn picture() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_raw(2, 1, vec![255, 255, 255, 0, 128, 255]).unwrap();
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn with_material(material: &str) -> String {
    let uri = format!("data:image/png;base64,{}", base64(&picture()));
    let more = format!(
        r#","materials":[{material}],"images":[{{"uri":"{uri}"}}],
        "samplers":[{{"magFilter":9728,"wrapS":33071,"wrapT":33648}}],"textures":[{{"source":0}},{{"source":0,"sampler":0}}]"#
    );
    let uvs: Piece = (FLOAT, "VEC2", 3, floats(&[0.0; 6]), "");
    file(&[triangle_positions(), uvs], r#"{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}"#, &more)
}

fn material(json: &str) -> Material {
    scene(&with_material(json)).materials.remove(0)
}

fn near(a: [f32; 3], b: [f32; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-3)
}

#[test]
fn factors_are_linear_colors() {
    let m = material(
        r#"{"name":"paint","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,0.5],"metallicFactor":0},
        "emissiveFactor":[1,0.5,0],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4}}}"#,
    );
    assert_eq!((m.name.as_str(), m.diffuse, m.ambient, m.opacity), ("paint", [0.5, 0.25, 1.0], [0.5, 0.25, 1.0], 0.5));
    assert_eq!((m.emission, m.alpha), ([4.0, 2.0, 0.0], AlphaMode::Opaque));
    assert!(near(m.specular, [0.01; 3]) && m.shininess == 1.0 && m.reflection == [0.0; 3]);
}

#[test]
fn alpha_modes_are_kept() {
    assert_eq!(material(r#"{"alphaMode":"MASK"}"#).alpha, AlphaMode::Mask(0.5));
    assert_eq!(material(r#"{"alphaMode":"MASK","alphaCutoff":0.2}"#).alpha, AlphaMode::Mask(0.2));
    assert_eq!(material(r#"{"alphaMode":"BLEND"}"#).alpha, AlphaMode::Blend);
}

#[test]
fn glass_with_a_volume_bends_rays_and_thin_glass_does_not() {
    let glass = |more: &str| {
        material(&format!(
            r#"{{"pbrMetallicRoughness":{{"metallicFactor":0,"roughnessFactor":0}},"extensions":{{
            "KHR_materials_transmission":{{"transmissionFactor":1}},"KHR_materials_ior":{{"ior":1.33}}{more}}}}}"#
        ))
    };
    let thin = glass("");
    // A thin wall lets through what it does not mirror; where light is bent, Fresnel's equations share it out.
    assert_eq!((thin.ior, thin.diffuse), (1.0, [0.0; 3]));
    assert!(thin.fresnel && near(thin.reflection, [0.02; 3]) && near(thin.transmission, [0.98; 3]));
    let thick = glass(r#","KHR_materials_volume":{"thicknessFactor":0.5}"#);
    assert_eq!((thick.ior, thick.fresnel), (1.33, true));
    assert_eq!((thick.reflection, thick.transmission), ([0.0; 3], [1.0; 3]));
}

#[test]
fn specular_factors_scale_the_reflectance() {
    let m = material(
        r#"{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0},
        "extensions":{"KHR_materials_specular":{"specularFactor":0.5,"specularColorFactor":[1,0.5,2]}}}"#,
    );
    assert!(near(m.reflection, [0.02, 0.01, 0.04]), "{:?}", m.reflection);
}

#[test]
fn specular_glossiness_is_read() {
    let m = material(
        r#"{"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.5,0.5,0.5,1],
        "specularFactor":[0.2,0.1,0],"glossinessFactor":1,"diffuseTexture":{"index":0}}}}"#,
    );
    assert_eq!((m.diffuse, m.reflection), ([0.5; 3], [0.2, 0.1, 0.0]));
    assert!(m.diffuse_map.is_some());
}

#[test]
fn unlit_materials_show_their_color() {
    let m =
        material(r#"{"pbrMetallicRoughness":{"baseColorFactor":[0.5,1,1,1]},"extensions":{"KHR_materials_unlit":{}}}"#);
    assert!(m.unlit);
    assert_eq!((m.diffuse, m.specular, m.reflection), ([0.5, 1.0, 1.0], [0.0; 3], [0.0; 3]));
}

#[test]
fn textures_are_decoded_once_and_sampled_as_asked() {
    let scene = scene(&with_material(
        r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":1,
        "extensions":{"KHR_texture_transform":{"offset":[0.5,0.25],"scale":[2,4]}}}},
        "emissiveFactor":[1,1,1],"emissiveTexture":{"index":0},
        "normalTexture":{"index":0,"scale":0.5,"extensions":{"KHR_texture_transform":{"scale":[3,1]}}}}"#,
    ));
    assert_eq!(scene.images.len(), 1);
    let m = &scene.materials[0];
    let base = m.diffuse_map.unwrap();
    assert_eq!((base.srgb, base.wrap, base.filter), (true, [Wrap::Clamp, Wrap::Mirror], Filter::Nearest));
    // v' = 1 - (4 (1 - v) + 0.25)
    assert_eq!(base.transform, [[2.0, 0.0, 0.5], [0.0, 4.0, -3.25]]);
    let emission = m.emission_map.unwrap();
    assert_eq!((emission.srgb, emission.wrap, emission.filter), (true, [Wrap::Repeat; 2], Filter::Bilinear));
    let Some(NormalMap::Tangent { texture, scale }) = m.normal_map else { panic!("a normal map") };
    assert_eq!((texture.srgb, scale, texture.transform[0][0]), (false, 0.5, 3.0));
}

#[test]
fn metallic_and_roughness_textures_count_by_their_mean_in_phongs_model() {
    let scene = scene(&with_material(
        r#"{"pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":0},"baseColorFactor":[1,1,1,1]}}"#,
    ));
    let m = &scene.materials[0];
    // Blue is all metal; green is 0.751 on average, alpha its square.
    assert!(near(m.diffuse, [0.5639; 3]), "{:?}", m.diffuse);
    assert_eq!(scene.images.len(), 1, "kept once, for path tracing");
}

#[test]
fn pictures_in_views_are_read() {
    let png = picture();
    let length = png.len();
    let json = with_material(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#)
        .replace(r#""bufferViews":["#, &format!(r#""bufferViews":[{{"buffer":1,"byteLength":{length}}},"#))
        .replace(r#"{"bufferView":1"#, r#"{"bufferView":2"#)
        .replace(r#"{"bufferView":0"#, r#"{"bufferView":1"#)
        .replace(
            r#"}],"bufferViews""#,
            &format!(r#"}},{{"byteLength":{length},"uri":"{}"}}],"bufferViews""#, data_uri(&png)),
        );
    let start = json.find(r#""images":"#).unwrap();
    let end = start + json[start..].find(']').unwrap();
    let json = format!(r#"{}"images":[{{"bufferView":0,"mimeType":"image/png"}}{}"#, &json[..start], &json[end..]);
    let scene = scene(&json);
    assert_eq!((scene.images[0].width, scene.images[0].texels[1]), (2, [0, 128, 255, 255]));
}

#[test]
fn a_missing_picture_is_a_warning_and_a_checker() {
    let json = with_material(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#);
    let json = json.replace(&format!("data:image/png;base64,{}", base64(&picture())), "none.png");
    let loaded = load_json(&json);
    assert!(loaded.warnings[0].message.contains("none.png"), "{:?}", loaded.warnings);
    assert!(loaded.scene.materials[0].diffuse_map.is_some());
}

#[test]
fn a_picture_on_the_web_is_a_warning_and_a_checker() {
    let json = with_material(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#);
    let picture = format!("data:image/png;base64,{}", base64(&picture()));
    let loaded = load_json(&json.replace(&picture, "https://example.org/a.png"));
    let message = &loaded.warnings[0].message;
    assert!(message.contains("the scheme 'https' in the URI of images[0] is not supported"), "{message}");
    assert!(loaded.scene.materials[0].diffuse_map.is_some());
    let broken = load_json(&json.replace(&picture, "data:image/png;base64,!"));
    assert!(broken.warnings[0].message.contains("expected base64"), "{:?}", broken.warnings);
}

#[test]
fn missing_pictures_of_numbers_count_as_absent() {
    let without = |json: &str| {
        let json = with_material(json);
        load_json(&json.replace(&format!("data:image/png;base64,{}", base64(&picture())), "none.png"))
    };
    let rough = without(r#"{"pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":0},"roughnessFactor":0.5}}"#);
    let plain = material(r#"{"pbrMetallicRoughness":{"roughnessFactor":0.5}}"#);
    let found = &rough.scene.materials[0];
    assert_eq!((found.reflection, found.shininess), (plain.reflection, plain.shininess));
    assert_eq!(rough.warnings.len(), 1);
    let bent = without(r#"{"normalTexture":{"index":0}}"#);
    assert!(bent.scene.materials[0].normal_map.is_none());
    assert_eq!(bent.warnings.len(), 1);
}

#[test]
fn metal_painted_gold_is_the_metal_gold() {
    let painted = with_material(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"roughnessFactor":0.3}}"#)
        .replace(&base64(&picture()), &base64(&plain([255, 200, 0])));
    let painted = scene(&painted).materials.remove(0);
    let gold = [1.0, crate::srgb::srgb_to_linear(200.0 / 255.0), 0.0];
    let solid = material(&format!(
        r#"{{"pbrMetallicRoughness":{{"baseColorFactor":[1,{},0,1],"roughnessFactor":0.3}}}}"#,
        gold[1]
    ));
    // The texture tints all of it: see `Material::metallic`.
    assert!(painted.metallic && solid.metallic);
    let tinted = |color: [f32; 3]| [0, 1, 2].map(|c| color[c] * gold[c]);
    assert!(near(tinted(painted.specular), solid.specular) && near(tinted(painted.reflection), solid.reflection));
    assert!(near(tinted(painted.diffuse), solid.diffuse));
}

#[test]
fn volumes_absorb_by_the_length_inside() {
    let glass = |volume: &str| {
        material(&format!(
            r#"{{"pbrMetallicRoughness":{{"metallicFactor":0}},"extensions":{{"KHR_materials_transmission":
            {{"transmissionFactor":1}},"KHR_materials_volume":{volume}}}}}"#
        ))
    };
    let red = glass(r#"{"thicknessFactor":1,"attenuationDistance":0.5,"attenuationColor":[1,0.25,0]}"#);
    // A quarter is left after half a unit.
    assert_eq!(red.absorption[0], 0.0);
    assert!((red.absorption[1] - 2.0 * 4.0f32.ln()).abs() < 1e-5 && red.absorption[2].is_finite());
    assert_eq!(glass(r#"{"thicknessFactor":1,"attenuationColor":[1,0,0]}"#).absorption, [0.0; 3], "no distance");
    assert_eq!(glass(r#"{"attenuationDistance":1,"attenuationColor":[1,0,0]}"#).absorption, [0.0; 3], "a thin wall");
}

#[test]
fn surfaces_are_single_sided_unless_they_say() {
    assert!(material("{}").single_sided);
    assert!(!material(r#"{"doubleSided":true}"#).single_sided);
}

#[test]
fn a_texture_without_a_source_is_left_out() {
    let json = with_material(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#)
        .replace(r#""textures":[{"source":0}"#, r#""textures":[{}"#);
    assert_eq!(warnings(&json), ["textures[0] names no picture that raywarp can read: it is left out"]);
}

#[test]
fn webp_is_preferred_where_it_is_offered() {
    let json = with_material(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#)
        .replace(r#""textures":[{"source":0}"#, r#""textures":[{"extensions":{"EXT_texture_webp":{"source":0}}}"#);
    assert_eq!(scene(&json).images.len(), 1);
}

#[test]
fn a_texture_on_a_mesh_without_coordinates_is_a_warning_and_the_plain_color() {
    let json = with_material(
        r#"{"name":"paint","pbrMetallicRoughness":{"baseColorTexture":{"index":0},"baseColorFactor":[0.5,0.5,0.5,1],
        "metallicFactor":0},"normalTexture":{"index":0}}"#,
    );
    let both = json.replace(
        r#"{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}"#,
        r#"{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0},{"attributes":{"POSITION":0},"material":0}"#,
    );
    let loaded = load_json(&both);
    let messages: Vec<_> = loaded.warnings.iter().map(|warning| warning.message.as_str()).collect();
    assert_eq!(
        messages,
        ["the mesh 'shape' has no coordinates for the textures of the material 'paint', which shows its plain colour there"]
    );
    let [textured, plain] = &loaded.scene.materials[..] else { panic!("two materials") };
    assert!(textured.diffuse_map.is_some() && textured.normal_map.is_some());
    assert!(plain.diffuse_map.is_none() && plain.normal_map.is_none() && plain.diffuse == [0.5; 3]);
    assert_eq!(loaded.scene.meshes.iter().map(|mesh| mesh.materials[0]).collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn metal_and_roughness_are_kept_with_their_textures() {
    let own = |json: &str| material(json).metallic_roughness.unwrap();
    let paint = own(r#"{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,0.5],"metallicFactor":0.5,
        "roughnessFactor":0.75,"metallicRoughnessTexture":{"index":1}}}"#);
    assert_eq!((paint.base_color, paint.metallic, paint.roughness), ([0.5, 0.25, 1.0], 0.5, 0.75));
    let (metallic, roughness) = (paint.metallic_map.unwrap(), paint.roughness_map.unwrap());
    assert_eq!((metallic.channel, roughness.channel), (Channel::Blue, Channel::Green));
    assert_eq!((metallic.filter, metallic.wrap, metallic.srgb), (Filter::Nearest, [Wrap::Clamp, Wrap::Mirror], false));

    let glass = |volume: &str| {
        own(&format!(
            r#"{{"pbrMetallicRoughness":{{"metallicFactor":0}},"extensions":{{"KHR_materials_ior":{{"ior":1.33}},
            "KHR_materials_specular":{{"specularFactor":0.5,"specularColorFactor":[1,0.5,2]}},
            "KHR_materials_transmission":{{"transmissionFactor":0.25,"transmissionTexture":{{"index":0}}}}{volume}}}}}"#
        ))
    };
    let thin = glass("");
    assert_eq!((thin.ior, thin.specular, thin.specular_color), (1.33, 0.5, [1.0, 0.5, 2.0]));
    assert_eq!((thin.transmission, thin.transmission_map.unwrap().channel, thin.thin), (0.25, Channel::Red, true));
    assert!(!glass(r#","KHR_materials_volume":{"thicknessFactor":0.5}"#).thin);
}
