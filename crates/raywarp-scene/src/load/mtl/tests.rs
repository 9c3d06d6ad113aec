use std::fs;

use super::*;
use crate::{AlphaMode, Channel, LoadOptions, Material, NormalMap, Texture, Wrap};

/// A library's scene and warnings, read in a folder with the pictures these tests name.
fn read_library(text: &str) -> Result<(Scene, Vec<String>), LoadError> {
    let folder = tempfile::tempdir().unwrap();
    let save = |name: &str, texels: [[u8; 4]; 4]| {
        let bytes = texels.iter().flatten().copied().collect();
        image::RgbaImage::from_raw(2, 2, bytes).unwrap().save(folder.path().join(name)).unwrap();
    };
    fs::create_dir(folder.path().join("a b")).unwrap();
    save("grey.png", [[10, 10, 10, 255], [200, 200, 200, 255], [3, 3, 3, 255], [99, 99, 99, 255]]);
    save("black and white.png", [[0, 0, 0, 255], [255, 255, 255, 255], [0, 0, 0, 255], [255, 255, 255, 255]]);
    save("leaf.png", [[9, 99, 9, 255], [9, 99, 9, 0], [9, 99, 9, 255], [9, 99, 9, 0]]);
    save("a b/normals.png", [[128, 128, 255, 255]; 4]);
    let path = folder.path().join("x.mtl");
    let (mut scene, mut sources) = (Scene::default(), Sources::new(&LoadOptions::default()));
    read(&path, text.as_bytes(), &mut HashMap::new(), &mut scene, &mut sources)?;
    let prefix = format!("{}/", folder.path().display());
    Ok((scene, sources.into_warnings().iter().map(|warning| warning.to_string().replace(&prefix, "")).collect()))
}

/// The only material of a definition that needs no warning.
fn material(statements: &str) -> Material {
    let (scene, warnings) = read_library(&format!("newmtl m\n{statements}\n")).unwrap();
    assert_eq!(warnings, [""; 0], "{statements}");
    scene.materials[0].clone()
}

fn warnings(statements: &str) -> Vec<String> {
    read_library(&format!("newmtl m\n{statements}\n")).unwrap().1
}

fn diffuse_map(statement: &str) -> Texture {
    material(statement).diffuse_map.unwrap()
}

#[test]
fn an_empty_definition_is_the_default() {
    assert_eq!(material(""), Material { name: "m".to_owned(), ..Material::default() });
}

#[test]
fn values_are_taken_as_they_are() {
    let m = material("Ka 0.1 0.2 0.3\nKd 0.4 0.5 0.6\nKs 0.7 0.8 0.9\nKe 1 2 3\nNs 10\nNi 1.5\nillum 2");
    assert_eq!((m.ambient, m.diffuse), ([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]));
    assert_eq!((m.specular, m.emission), ([0.7, 0.8, 0.9], [1.0, 2.0, 3.0]));
    assert_eq!((m.shininess, m.ior, m.opacity, m.alpha), (10.0, 1.5, 1.0, AlphaMode::Opaque));
    assert_eq!(material("Kd 0.5").ambient, [0.5; 3]);
    assert_eq!(material("Ni 0").ior, 1.0);
    assert_eq!(material("Ns -3").shininess, 0.0);
}

#[test]
fn illumination_models() {
    let model = |illum: i32| {
        let m = material(&format!("Ks 0.2\nNs 9\nTf 0.5\nd 0.25\nillum {illum}"));
        (m.unlit, m.specular[0], m.reflection[0], m.transmission[0], m.fresnel, m.opacity)
    };
    let transmitted = 0.5 * 0.75;
    assert_eq!(model(0), (true, 0.0, 0.0, 0.0, false, 0.25));
    assert_eq!(model(1), (false, 0.0, 0.0, 0.0, false, 0.25));
    for illum in [2, 10] {
        assert_eq!(model(illum), (false, 0.2, 0.0, 0.0, false, 0.25));
    }
    for illum in [3, 8] {
        assert_eq!(model(illum), (false, 0.2, 0.2, 0.0, false, 0.25));
    }
    for illum in [4, 6, 9] {
        assert_eq!(model(illum), (false, 0.2, 0.2, transmitted, false, 1.0));
    }
    assert_eq!(model(5), (false, 0.2, 0.2, 0.0, true, 0.25));
    assert_eq!(model(7), (false, 0.2, 0.2, transmitted, true, 1.0));
    assert_eq!(warnings("illum 11"), ["x.mtl:2: the illumination model 11 is not one of 0 to 10; 2 is used"]);
}

#[test]
fn transparency_is_d_and_tf_colours_it() {
    assert_eq!(material("illum 7\nd 0.5").transmission, [0.5; 3]);
    assert_eq!(material("illum 4\nd 0.5\nTf 0.2 0.4 0.6").transmission, [0.1, 0.2, 0.3]);
    for opaque in ["illum 4\nTf 1\nNi 1.5", "illum 9\nTf 1\nd 1", "illum 7\nTf 1\nNi 1", "illum 7", "illum 2\nTf 1"] {
        let m = material(opaque);
        assert_eq!((m.transmission, m.opacity, m.alpha), ([0.0; 3], 1.0, AlphaMode::Opaque), "{opaque}");
    }
}

#[test]
fn what_refracts_transmits_by_tf_alone() {
    assert_eq!(material("illum 7\nNi 1.5\nTf 0.3 0.4 0.5").transmission, [0.3, 0.4, 0.5]);
    assert_eq!(material("illum 6\nNi 1.5\nTf 1\nd 1").transmission, [1.0; 3]);
    assert_eq!(material("illum 7\nNi 1.5\nd 1\nTf 0").transmission, [0.0; 3]);
}

/// An exponent of 0 would cover the half space with the highlight.
#[test]
fn a_shininess_below_one_weakens_the_highlight() {
    assert_eq!(material("Ks 1\nNs 0").specular, [0.0; 3]);
    assert_eq!(material("Ks 1").specular, [0.0; 3]);
    assert_eq!(material("Ks 1\nNs 0.25").specular, [0.25; 3]);
    assert_eq!(material("Ks 1\nNs 1").specular, [1.0; 3]);
    assert_eq!(material("Ks 1\nNs 0\nillum 3").reflection, [1.0; 3]);
}

#[test]
fn tr_one_without_d_is_opaque() {
    let (scene, warnings) = read_library("newmtl a\nTr 1\nnewmtl b\nTr 1.0\nnewmtl c\nTr 1\nd 0.5").unwrap();
    let opacities: Vec<_> = scene.materials.iter().map(|material| material.opacity).collect();
    assert_eq!(opacities, [1.0, 1.0, 0.5]);
    assert_eq!(warnings, ["x.mtl:1: the material 'a' and 1 more have 'Tr 1' and no 'd'; they are opaque"]);
    assert_eq!(warnings_of_one("Tr 1"), "x.mtl:1: the material 'm' has 'Tr 1' and no 'd'; it is opaque");
}

fn warnings_of_one(statements: &str) -> String {
    let mut warnings = warnings(statements);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    warnings.remove(0)
}

#[test]
fn opacity_is_d_before_1_minus_tr() {
    assert_eq!((material("d 0.5").opacity, material("d 0.5").alpha), (0.5, AlphaMode::Blend));
    assert_eq!(material("Tr 0.25").opacity, 0.75);
    assert_eq!(material("d 1\nTr 1").opacity, 1.0);
    assert_eq!(material("d 7").opacity, 1.0);
    assert_eq!(warnings("d -halo 0.5").len(), 1);
}

#[test]
fn colours_of_cie_xyz() {
    let [r, g, b] = material("Kd xyz 0.95047 1 1.08883").diffuse;
    assert!([r, g, b].iter().all(|x| (x - 1.0).abs() < 1e-3), "{r} {g} {b}");
    assert_eq!(warnings("Kd spectral a.rfl").len(), 1);
}

#[test]
fn maps_are_srgb_where_they_are_colours() {
    let m = material("Ns 9\nmap_Kd grey.png\nmap_Ke leaf.png\nmap_Ks grey.png\nmap_Ka grey.png");
    assert!(m.diffuse_map.unwrap().srgb && m.emission_map.unwrap().srgb && !m.specular_map.unwrap().srgb);
    assert_eq!((m.diffuse, m.emission, m.specular), ([1.0; 3], [1.0; 3], [1.0; 3]));
    assert_eq!(m.diffuse_map.unwrap().image, m.specular_map.unwrap().image);
}

#[test]
fn names_of_maps_have_blanks_quotes_and_backslashes() {
    for name in ["a b\\normals.png", "./a b/normals.png", "\"a b/normals.png\"", "a b/normals.png  \r"] {
        let statement = format!("norm -bm 0.5 {name}");
        assert!(matches!(material(&statement).normal_map, Some(NormalMap::Tangent { scale: 0.5, .. })), "{name}");
    }
}

#[test]
fn options_of_maps() {
    let t = diffuse_map("map_Kd -s 2 3 1 -o 0.5 -mm 0.1 0.9 -clamp on -imfchan g -blendu off -texres 64 grey.png");
    assert_eq!(t.transform, [[2.0, 0.0, 0.5], [0.0, 3.0, 0.0]]);
    assert_eq!((t.base, t.gain, t.wrap, t.channel), (0.1, 0.9, [Wrap::Clamp; 2], Channel::Green));
    let behind = diffuse_map("map_Kd black and white.png -s 2 2 -clamp off");
    assert_eq!((behind.transform[1][1], behind.wrap), (2.0, [Wrap::Repeat; 2]));
    assert_eq!(warnings("map_Kd -t 1 1 1 grey.png").len(), 1);
    assert_eq!(warnings("map_Kd -imfchan z grey.png").len(), 1);
    assert_eq!(
        warnings("map_Kd -s 1 2 3"),
        ["x.mtl:2: the image 3 cannot be used: No such file or directory (os error 2); a magenta checker stands in for \
          its colours"]
    );
}

#[test]
fn maps_without_a_name_are_skipped() {
    assert_eq!(warnings("map_Kd"), ["x.mtl:2: 'map_Kd' names no image; it is skipped"]);
    assert_eq!(warnings("map_Kd -clamp on").len(), 1);
}

#[test]
fn an_alpha_channel_cuts_out() {
    let m = material("map_d leaf.png");
    assert_eq!(m.alpha, AlphaMode::Mask(0.5));
    assert_eq!(m.opacity_map.unwrap().channel, Channel::Alpha);
    assert_eq!(material("map_d -imfchan r leaf.png").opacity_map.unwrap().channel, Channel::Red);
    assert_eq!(material("map_d leaf.png\nd 0.5").alpha, AlphaMode::Blend);
}

/// The diffuse map's alpha counts by itself: twice would thin the edges.
#[test]
fn the_same_picture_for_colour_and_alpha_is_one_mask() {
    let m = material("map_Kd leaf.png\nmap_d leaf.png");
    assert_eq!((m.alpha, m.opacity_map), (AlphaMode::Mask(0.5), None));
    assert!(material("map_Kd leaf.png\nmap_d -s 2 leaf.png").opacity_map.is_some());
}

#[test]
fn luminance_covers_where_there_is_no_alpha() {
    let m = material("map_d grey.png");
    assert_eq!((m.alpha, m.opacity_map.unwrap().channel), (AlphaMode::Blend, Channel::Luminance));
    assert_eq!(material("map_d black and white.png").alpha, AlphaMode::Mask(0.5));
}

#[test]
fn bumps_are_heights_unless_they_have_colours() {
    assert!(matches!(
        material("map_Bump -bm 2 grey.png").normal_map,
        Some(NormalMap::Height { scale: 2.0, texture: Texture { channel: Channel::Luminance, srgb: false, .. } })
    ));
    assert!(matches!(material("bump a b/normals.png").normal_map, Some(NormalMap::Tangent { .. })));
    assert!(matches!(material("norm grey.png\nbump grey.png").normal_map, Some(NormalMap::Tangent { .. })));
}

#[test]
fn missing_maps_neither_bend_nor_cut() {
    let (scene, warnings) = read_library("newmtl m\nbump gone.png\nmap_d gone.png\nmap_Kd gone.png").unwrap();
    let m = &scene.materials[0];
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].starts_with("x.mtl:4: the image "), "{warnings:?}");
    assert!(m.normal_map.is_none() && m.opacity_map.is_none() && m.diffuse_map.is_some());
}

#[test]
fn metal_and_roughness_are_kept_for_path_tracing() {
    let own = material("Kd 0.8 0.4 0.2\nPm 0.25\nmap_Pr grey.png\nKs 0.5").metallic_roughness.unwrap();
    assert_eq!((own.base_color, own.metallic, own.roughness), ([0.8, 0.4, 0.2], 0.25, 1.0));
    assert!(own.roughness_map.is_some() && (own.reflectance()[0] - 0.04).abs() < 1e-6);
    let (scene, warnings) = read_library("newmtl m\nmap_Pr gone.png").unwrap();
    let own = scene.materials[0].metallic_roughness.as_ref().unwrap();
    assert!(warnings.len() == 1 && own.roughness_map.is_none());
    assert_eq!(material("Kd 0.8\nNs 10").metallic_roughness, None);
}

#[test]
fn what_is_unknown_is_one_warning_a_keyword() {
    assert_eq!(
        warnings("Ps 1\nPc 0\nmap_Ps x.png\nrefl a.png\nrefl b.png\nxyz 1\nsharpness 60"),
        [
            "x.mtl:2: statements of the physically based extension beside Pr and Pm (Ps, Pc, ...) are skipped",
            "x.mtl:5: 2 'refl' statements are skipped (not supported)",
            "x.mtl:7: 1 'xyz' statement is skipped (not supported)",
        ]
    );
}

#[test]
fn odd_definitions_are_warnings() {
    let (scene, warnings) = read_library("Kd 1\nnewmtl a\nKd nan 0 0\nnewmtl a\nKd 1\n").unwrap();
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(scene.materials[0].diffuse, [0.7; 3]);
    assert_eq!(
        warnings,
        [
            "x.mtl:3: 'Kd nan 0 0' is not finite; the default is used",
            "x.mtl:1: statements before the first 'newmtl' are skipped",
            "x.mtl:4: the material 'a' is defined again; the first holds",
        ]
    );
}

#[test]
fn what_cannot_be_read_is_skipped_and_counted() {
    assert_eq!(
        warnings_of_one("Kd 1 x 1"),
        "x.mtl:2: 'x' is not a number; expected a number: the statement is skipped"
    );
    assert_eq!(
        warnings_of_one("map_Kd -mm 1"),
        "x.mtl:2: 'map_Kd -mm 1' ends in an option; expected its value: the statement is skipped"
    );
    assert_eq!(
        warnings_of_one("Ks 1 0\nNs x\nd\nillum two"),
        "x.mtl:2: 'Ks 1 0' has too few numbers; expected 1 or 3 numbers: the statement is skipped, and 3 more cannot be \
         read either"
    );
}

#[test]
fn lines_that_are_no_statements_are_skipped_and_counted() {
    let (scene, warnings) = read_library("\x01\x02\nnewmtl a\nKd 1 0 0\n-----\n0.5 0.5\nKs 1\nNs 5\x1a").unwrap();
    assert_eq!((scene.materials[0].diffuse, scene.materials[0].specular), ([1.0, 0.0, 0.0], [1.0; 3]));
    assert_eq!(warnings, ["x.mtl:1: 3 lines are not statements of MTL and are skipped; the first is '\\u{1}\\u{2}'"]);
    assert_eq!(warnings_of_one("-----"), "x.mtl:2: 1 line is not a statement of MTL and is skipped: '-----'");
}

proptest::proptest! {
    #[test]
    fn nothing_panics(lines in proptest::collection::vec(
        ("(newmtl|Kd|d|map_d|bump|illum|norm|Tf|x)", "[-a-z0-9. \\\\#]{0,20}"), 0..8)
    ) {
        let text: String = lines.iter().map(|(keyword, rest)| format!("{keyword} {rest}\n")).collect();
        let _ = read_library(&text);
    }
}
