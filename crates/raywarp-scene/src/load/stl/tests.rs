use proptest::prelude::*;

use super::*;
use crate::{LoadOptions, Loaded};

fn load_bytes(bytes: &[u8]) -> Result<Loaded, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.stl");
    std::fs::write(&path, bytes).unwrap();
    let local = |error: LoadError| error.to_string().replace(&path.display().to_string(), "F");
    crate::load::load(&path, &LoadOptions::default()).map_err(local)
}

fn scene(bytes: &[u8]) -> Scene {
    let loaded = load_bytes(bytes).unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    loaded.scene
}

fn warnings(bytes: &[u8]) -> Vec<String> {
    load_bytes(bytes).unwrap().warnings.into_iter().map(|warning| warning.message).collect()
}

/// Each corner as `vertex`, the normal as programs write it that do not know.
fn facet(corners: &[[f32; 3]]) -> String {
    let vertices: String = corners.iter().map(|[x, y, z]| format!("   vertex {x} {y} {z}\n")).collect();
    format!(" facet normal 0 0 0\n  outer loop\n{vertices}  endloop\n endfacet\n")
}

fn text(triangles: &[[[f32; 3]; 3]]) -> String {
    format!("solid a part\n{}endsolid a part\n", triangles.iter().map(|corners| facet(corners)).collect::<String>())
}

fn binary(head: &[u8], triangles: &[[[f32; 3]; 3]], attributes: &[u16]) -> Vec<u8> {
    let mut bytes = head.to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for (at, triangle) in triangles.iter().enumerate() {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend(attributes.get(at).copied().unwrap_or(0).to_le_bytes());
    }
    bytes
}

const SQUARE: [[[f32; 3]; 3]; 2] =
    [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]];

fn corners(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    mesh.triangles.iter().map(|triangle| triangle.map(|vertex| mesh.positions[vertex as usize])).collect()
}

#[test]
fn a_square_in_both_forms() {
    for bytes in [text(&SQUARE).into_bytes(), binary(b"solid by its head alone", &SQUARE, &[])] {
        let scene = scene(&bytes);
        let mesh = &scene.meshes[0];
        assert_eq!((corners(mesh), mesh.positions.len()), (SQUARE.to_vec(), 4));
        assert!(mesh.normals.is_empty() && mesh.colors.is_empty(), "facets are flat");
        assert_eq!((scene.instances.len(), scene.materials[0].diffuse), (1, [DIFFUSE; 3]));
    }
    assert_eq!(scene(text(&SQUARE).as_bytes()).meshes[0].name, "a part");
    assert_eq!(scene(&binary(b"", &SQUARE, &[])).meshes[0].name, "part");
}

#[test]
fn every_solid_is_a_mesh() {
    let scene =
        scene(format!("{}solid\nendsolid\n{}", text(&SQUARE), text(&SQUARE[..1]).replace("a part", "")).as_bytes());
    let names: Vec<_> = scene.instances.iter().map(|instance| instance.name.as_str()).collect();
    assert_eq!((names, scene.meshes[1].triangles.len()), (vec!["a part", "part"], 1));
}

#[test]
fn words_may_be_in_capitals_and_lines_joined() {
    for text in [text(&SQUARE).to_uppercase(), text(&SQUARE).replace('\n', "\r\n"), text(&SQUARE) + "\u{1a}"] {
        assert_eq!(scene(text.as_bytes()).meshes[0].triangles.len(), 2, "{text}");
    }
    let line = format!("solid\n{}", facet(&SQUARE[0]).replace('\n', " "));
    assert_eq!(corners(&scene(line.as_bytes()).meshes[0]), SQUARE[..1]);
}

#[test]
fn facets_of_more_corners_are_cut() {
    let dart = facet(&[[0.5, 0.5, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    let scene = scene(format!("solid\n{dart}").as_bytes());
    assert_eq!(scene.meshes[0].triangles.len(), 2);
}

#[test]
fn colours_of_two_programs() {
    let red = [1.0, 0.0, 0.0, 1.0];
    let solid_view = scene(&binary(b"", &SQUARE, &[1 << 15 | 31 << 10, 0]));
    assert_eq!((solid_view.meshes[0].colors[0], solid_view.meshes[0].colors[3]), (red, [1.0; 4]));
    let magics = scene(&binary(b"COLOR=\x00\xff\x00\x80,MATERIAL=", &SQUARE, &[31, 1 << 15]));
    let [r, g, b, a] = magics.meshes[0].colors[3];
    assert_eq!((magics.meshes[0].colors[0], [r, g, b]), (red, [0.0, 1.0, 0.0]));
    assert!((a - 0.5).abs() < 0.01 && magics.materials[0].alpha == AlphaMode::Blend);
}

#[test]
fn what_is_left_out_is_counted() {
    assert_eq!(
        warnings(&binary(b"", &SQUARE, &[7, 0])),
        ["1 triangles have attributes that are no colours; they are left out"]
    );
    let mut longer = binary(b"", &SQUARE, &[]);
    longer.extend(b"more");
    assert_eq!(warnings(&longer), ["4 bytes behind the last triangle are skipped"]);
    let odd = text(&SQUARE).replace("endsolid", "$ what\nendsolid") + &facet(&[[0.0; 3]; 2]);
    assert_eq!(
        warnings(odd.as_bytes()),
        [
            "1 line is not a statement of STL and is skipped: '$ what'",
            "1 facets have fewer than 3 corners and are dropped"
        ]
    );
    let nan = text(&SQUARE).replacen("vertex 0 0 0", "vertex nan 0 0", 1);
    assert_eq!(warnings(nan.as_bytes()), ["1 triangles use vertices that are not finite and were dropped"]);
    assert_eq!(warnings(b"solid nothing\nendsolid"), ["the file has no triangles: there is nothing to see"]);
}

#[test]
fn errors_name_the_place() {
    let error = |bytes: &[u8]| load_bytes(bytes).unwrap_err();
    assert_eq!(
        error(text(&SQUARE).replacen("1 0 0", "1 x 0", 1).as_bytes()),
        "F:5:13: 'x' is not a number; expected 'vertex x y z'. Write numbers as 1.5 or -2e-3."
    );
    assert_eq!(
        error(text(&SQUARE).replacen("1 0 0", "1 0", 1).as_bytes()),
        "F:5:14: 'vertex 1 0' has too few numbers; expected 'vertex x y z'. Check that the file is complete."
    );
    assert_eq!(
        error(b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
        "F:4:13: the file ends within a facet; expected 'endfacet'. Check that the file is complete."
    );
    assert_eq!(
        error(b"\x7fELF"),
        "F, byte 0: the file has 4 bytes and does not begin with 'solid'; expected text that does, or the 84 bytes that \
         begin a binary STL file. Check that this is a whole STL file."
    );
    assert!(
        error(format!("solid prose\n{}", "of a book\n".repeat(200)).as_bytes()).contains("100 lines are no statements")
    );
}

#[test]
fn claims_beyond_the_file_are_refused_with_both_numbers() {
    let mut bytes = binary(b"", &SQUARE, &[]);
    bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(
        load_bytes(&bytes).unwrap_err(),
        "F, byte 80: 4294967295 triangles are claimed, which take 214748364834 bytes, and the file has 184; the limit is \
         1431655765 triangles. The file is cut off or no STL file: write it again."
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_is_read(triangles in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-1e9f32..1e9)), 1..20)) {
        for bytes in [text(&triangles).into_bytes(), binary(b"", &triangles, &[])] {
            prop_assert_eq!(corners(&load_bytes(&bytes).unwrap().scene.meshes[0]), triangles.clone());
        }
    }

    #[test]
    fn mutated_files_never_panic(
        as_text in any::<bool>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        length in any::<prop::sample::Index>(),
    ) {
        let mut bytes = if as_text { text(&SQUARE).into_bytes() } else { binary(b"", &SQUARE, &[]) };
        for (place, value) in changes {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        bytes.truncate(length.index(bytes.len()) + 1);
        let _ = load_bytes(&bytes);
    }
}
