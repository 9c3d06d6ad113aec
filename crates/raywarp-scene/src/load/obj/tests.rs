//! By feature; the texts of errors and the random ones are apart.

mod errors;
mod random;

use std::path::PathBuf;

use super::*;
use crate::LoadOptions;

/// A folder with these files, the first an OBJ file to read.
struct Files(tempfile::TempDir, PathBuf);

impl Files {
    fn new(files: &[(&str, &[u8])]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        files.iter().for_each(|(name, bytes)| std::fs::write(folder.path().join(name), bytes).unwrap());
        let path = folder.path().join(files[0].0);
        Self(folder, path)
    }

    fn read(&self) -> Result<(Scene, Vec<String>), LoadError> {
        let mut sources = Sources::new(&LoadOptions::default());
        let scene = read(&self.1, &mut sources)?;
        Ok((scene, sources.into_warnings().iter().map(|warning| self.local(&warning.to_string())).collect()))
    }

    /// A message without the folder's name.
    fn local(&self, message: &str) -> String {
        message.replace(&format!("{}/", self.0.path().display()), "")
    }
}

fn load(text: &str) -> (Scene, Vec<String>) {
    Files::new(&[("a.obj", text.as_bytes())]).read().unwrap()
}

/// The scene of a file that gives no reason for a warning.
fn scene(text: &str) -> Scene {
    let (scene, warnings) = load(text);
    assert_eq!(warnings, [""; 0], "{text}");
    scene
}

/// Its only mesh.
fn mesh(text: &str) -> Mesh {
    let mut scene = scene(text);
    assert_eq!(scene.meshes.len(), 1);
    scene.meshes.remove(0)
}

/// The corners of all triangles.
fn corners(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    mesh.triangles.iter().map(|triangle| triangle.map(|vertex| mesh.positions[vertex as usize])).collect()
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
/// Two squares that share an edge at a right angle.
const FOLD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\n";

#[test]
fn a_triangle() {
    let scene = scene(&format!("{TRIANGLE}f 1 2 3"));
    let mesh = &scene.meshes[0];
    assert_eq!(corners(mesh), [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]);
    assert!(mesh.normals.is_empty() && mesh.uvs.is_empty() && mesh.colors.is_empty());
    assert_eq!((mesh.name.as_str(), mesh.materials[..].len(), scene.materials.len()), ("a", 1, 1));
    assert_eq!((scene.instances[0].mesh, scene.instances[0].transform), (0, Transform::IDENTITY));
}

#[test]
fn polygons_are_cut() {
    assert_eq!(mesh(&format!("{SQUARE}f 1 2 3 4")).triangles, [[0, 1, 2], [0, 2, 3]]);
    let dart = mesh("v 0 0 0\nv 2 0 0\nv .5 .5 0\nv 0 2 0\nf 2 3 4 1");
    assert_eq!(dart.triangles.len(), 2);
    assert!(dart.triangles.iter().all(|t| t.contains(&0)), "cut at the notch: {:?}", dart.triangles);
}

#[test]
fn corners_in_four_forms() {
    let points = format!("{TRIANGLE}vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 2\n");
    for face in
        ["1 2 3", "1/1 2/2 3/3", "1//1 2//1 3//1", "1/1/1 2/2/1 3/3/1", "-3/-3/-1 -2/-2/-1 -1/-1/-1", "1/ 2/ 3//"]
    {
        let mesh = mesh(&format!("{points}f {face}"));
        assert_eq!(corners(&mesh), [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]], "{face}");
        if face.contains("/1") {
            assert!(mesh.uvs.is_empty() || mesh.uvs == [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], "{face}");
            assert!(mesh.normals.is_empty() || mesh.normals == [[0.0, 0.0, 1.0]; 3], "{face}");
        }
    }
}

#[test]
fn negative_indices_count_from_their_line() {
    let text = format!("{TRIANGLE}f -3 -2 -1\nv 9 9 9\nv 8 8 8\nf -5 -4 -3\nf 1 2 3");
    assert_eq!(mesh(&text).triangles, [[0, 1, 2]; 3]);
}

#[test]
fn faces_may_come_before_their_points() {
    assert_eq!(mesh(&format!("f 1 2 3\n{TRIANGLE}")).triangles, [[0, 1, 2]]);
}

#[test]
fn corners_may_differ_in_form() {
    let mesh = mesh(&format!("{TRIANGLE}vt .5 .5\nvn 0 0 1\nf 1 2/1 3//1"));
    assert_eq!(mesh.uvs, [[0.0, 0.0], [0.5, 0.5], [0.0, 0.0]]);
    assert_eq!(mesh.normals, [[0.0; 3], [0.0; 3], [0.0, 0.0, 1.0]]);
}

#[test]
fn vertices_are_unified() {
    assert_eq!(mesh(&format!("{SQUARE}f 1 2 3\nf 1 3 4")).positions.len(), 4);
    assert_eq!(mesh(&format!("{SQUARE}vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/1 3/2 4/1")).positions.len(), 5);
}

#[test]
fn vertex_colours_are_srgb_and_may_have_an_alpha() {
    let scene = scene("v 0 0 0 1 0 0\nv 1 0 0 0.5 0.5 0.5 0.25\nv 0 1 0 1\nf 1 2 3");
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.colors[0], [1.0, 0.0, 0.0, 1.0]);
    assert!((mesh.colors[1][0] - 0.214).abs() < 1e-3 && mesh.colors[1][3] == 0.25, "{:?}", mesh.colors[1]);
    assert_eq!(mesh.colors[2], [1.0; 4]);
    assert_eq!(scene.materials[0].alpha, AlphaMode::Blend);
    let opaque = self::scene("v 0 0 0 1 0 0 1\nv 1 0 0 1 0 0 1\nv 0 1 0 1 0 0 1\nf 1 2 3");
    assert_eq!((opaque.meshes[0].colors[0], opaque.materials[0].alpha), ([1.0, 0.0, 0.0, 1.0], AlphaMode::Opaque));
}

#[test]
fn vertex_colours_may_count_to_255() {
    let mesh = mesh("v 0 0 0 255 0 0\nv 1 0 0 0 188 0\nv 0 1 0 0 0 0 51\nf 1 2 3");
    assert_eq!(mesh.colors[0], [1.0, 0.0, 0.0, 1.0]);
    assert!((mesh.colors[1][1] - 0.5029).abs() < 1e-3, "{:?}", mesh.colors[1]);
    assert_eq!(mesh.colors[2], [0.0, 0.0, 0.0, 0.2]);
}

#[test]
fn vertex_colours_end_at_white() {
    let (scene, warnings) = load("v 0 0 0 1.5 0.5 0\nv 1 0 0 1 0 0\nv 0 1 0 nan 0 0\nf 1 2 3");
    assert_eq!((scene.meshes[0].colors[0][0], scene.meshes[0].colors[2]), (1.0, [1.0; 4]));
    assert_eq!(warnings, ["a.obj: 1 vertex colours are brighter than 1 and are cut off there"]);
}

#[test]
fn of_other_numbers_the_first_three_count() {
    let (scene, warnings) = load("v 0 0 0 0.5 0.5\nv 1 0 0 1 2 3 4 5 6\nv 0 1 0\nf 1 2 3");
    assert_eq!(corners(&scene.meshes[0]), [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]);
    assert!(scene.meshes[0].colors.is_empty());
    assert_eq!(
        warnings,
        ["a.obj:1: 2 lines have more numbers than 'v x y z' has a meaning for; the first 3 count; the first is \
          'v 0 0 0 0.5 0.5'"]
    );
}

#[test]
fn faces_may_name_normals_and_texture_coordinates_that_are_not_there() {
    let (scene, warnings) = load(&format!("{SQUARE}f 1//1 2//2 3//3\nvt 0 0\nf 1/1/1 3/2 4/0"));
    let mesh = &scene.meshes[0];
    assert_eq!((mesh.triangles.len(), mesh.normals.len(), &mesh.uvs[..]), (2, 0, &[[0.0; 2]; 5][..]));
    assert_eq!(
        warnings,
        [
            "a.obj:7: 1 line names texture coordinates that the file lacks; they are left out: 'f 1/1/1 3/2 4/0'",
            "a.obj:5: 2 lines name normals that the file lacks; they are left out; the first is 'f 1//1 2//2 3//3'",
        ]
    );
}

#[test]
fn faces_of_fewer_than_three_corners_are_dropped_and_counted() {
    let (scene, warnings) = load(&format!("{TRIANGLE}f 1 2\nf 1 2 3\nf\nf 3"));
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(warnings, ["a.obj:4: 3 lines are faces of fewer than 3 corners and are dropped; the first is 'f 1 2'"]);
}

#[test]
fn lines_of_another_program_are_skipped_and_counted() {
    let (scene, warnings) = load(&format!("$ a foreign line\n{TRIANGLE}----\nf 1 2 3\n\u{1b}[0m"));
    assert_eq!(scene.meshes[0].triangles.len(), 1);
    assert_eq!(
        warnings,
        ["a.obj:1: 3 lines are not statements of OBJ and are skipped; the first is '$ a foreign line'"]
    );
}

#[test]
fn ctrl_z_ends_the_file() {
    for end in ["\u{1a}", "\n\u{1a}\n", "\0\0"] {
        assert_eq!(mesh(&format!("{TRIANGLE}f 1 2 3{end}")).triangles, [[0, 1, 2]], "{end:?}");
    }
}

#[test]
fn corners_that_repeat_do_not_spoil_a_polygon() {
    let dart = mesh("v 0.5 1 0\nv 0 0 0\nv 0 0 0\nv 2 1 0\nv 0 2 0\nv 0 2 0\nf 1 2 3 4 5 6");
    let area = |[a, b, c]: [[f32; 3]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let areas: Vec<_> = corners(&dart).into_iter().map(area).collect();
    assert_eq!((areas.len(), areas.iter().sum::<f32>()), (2, 3.0), "{areas:?}");
    assert!(areas.iter().all(|&area| area > 0.0));
}

#[test]
fn names_of_libraries_may_be_in_quotes() {
    let obj = |name: &str| format!("mtllib {name}\n{TRIANGLE}usemtl red\nf 1 2 3");
    let red: &[u8] = b"newmtl red\nKd 1 0 0";
    for (written, name) in [("\"my red.mtl\"", "my red.mtl"), ("\"red\"", "red"), ("\"red.mtl\"", "\"red.mtl\"")] {
        let (scene, warnings) = Files::new(&[("a.obj", obj(written).as_bytes()), (name, red)]).read().unwrap();
        assert_eq!((scene.materials[0].diffuse, warnings.len()), ([1.0, 0.0, 0.0], 0), "{written}");
    }
}

#[test]
fn a_library_of_another_encoding_does_not_refuse_the_geometry() {
    let utf_16: Vec<u8> = "\u{feff}newmtl a".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let obj = format!("mtllib a.mtl\n{TRIANGLE}usemtl a\nf 1 2 3");
    let (scene, warnings) = Files::new(&[("a.obj", obj.as_bytes()), ("a.mtl", &utf_16)]).read().unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), 1);
    assert_eq!(
        warnings,
        ["a.obj:1: the material library a.mtl cannot be read: the file is UTF-16; expected ASCII or UTF-8; a grey \
          material stands in for what it defines"]
    );
}

#[test]
fn digits_that_single_precision_does_not_hold_are_a_note() {
    let files = Files::new(&[("a.obj", b"v 4500000.123 0 0\nv 4500001.123 0 0\nv 4500000.123 1 0\nf 1 2 3")]);
    let loaded = crate::load::load(&files.1, &LoadOptions { strict: true }).unwrap();
    let notes: Vec<_> = loaded.notes.iter().map(|note| files.local(&note.to_string())).collect();
    assert_eq!(
        notes,
        ["a.obj: positions lose up to 1.23e-1 scene units in single precision: they are up to 4.500e6 from the origin, on \
          1.000e0 of extent"]
    );
}

#[test]
fn objects_and_groups_are_meshes() {
    let faces = ["o a", "g x y", "g", "o b", "g b", "g never", "o c", "o a"];
    let text: String = faces.iter().map(|name| format!("{name}\nf 1 2 3\n")).collect();
    let scene = scene(&format!("{TRIANGLE}g empty\n{text}").replace("g never\nf 1 2 3", "g never"));
    let names: Vec<_> = scene.meshes.iter().map(|mesh| (mesh.name.as_str(), mesh.triangles.len())).collect();
    assert_eq!(names, [("a", 3), ("a/x y", 1), ("b", 2), ("c", 1)]);
    let instances: Vec<_> = scene.instances.iter().map(|instance| (instance.name.as_str(), instance.mesh)).collect();
    assert_eq!(instances, [("a", 0), ("a/x y", 1), ("b", 2), ("c", 3)]);
}

#[test]
fn too_many_groups_share_a_mesh() {
    let groups: String = (0..65_540).map(|group| format!("g {group}\nf 1 2 3\n")).collect();
    let (scene, warnings) = load(&format!("{TRIANGLE}{groups}"));
    assert_eq!((scene.meshes.len(), scene.meshes[65_535].triangles.len()), (65_536, 5));
    assert_eq!(warnings, ["a.obj: 4 more object and group names share one mesh"]);
}

#[test]
fn normals_are_flat_without_a_smoothing_group() {
    for smoothing in ["", "s off", "s 0", "s"] {
        assert!(mesh(&format!("{FOLD}{smoothing}\nf 1 2 3 4\nf 2 1 5 6")).normals.is_empty(), "{smoothing}");
    }
}

#[test]
fn normals_are_smooth_within_a_smoothing_group() {
    let mesh = mesh(&format!("{FOLD}s 1\nf 1 2 3 4\nf 2 1 5 6"));
    let half = 0.5_f32.sqrt();
    let close = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    assert_eq!(mesh.positions.len(), 6);
    assert!(close(mesh.normals[0], [0.0, half, half]), "{:?}", mesh.normals);
    assert!(close(mesh.normals[2], [0.0, 0.0, 1.0]), "{:?}", mesh.normals);
}

#[test]
fn smoothing_groups_part_vertices() {
    let mesh = mesh(&format!("{FOLD}s 1\nf 1 2 3 4\ns 2\nf 2 1 5 6"));
    assert_eq!((mesh.positions.len(), mesh.normals[0], mesh.normals[4]), (8, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]));
    let mixed = self::mesh(&format!("{FOLD}s 1\nf 1 2 3 4\ns off\nf 2 1 5 6"));
    assert_eq!((mixed.normals[0], mixed.normals[4]), ([0.0, 0.0, 1.0], [0.0; 3]));
}

/// Seams of textures and borders of groups are not edges of the surface.
#[test]
fn smoothing_reaches_over_seams_and_groups() {
    let text = format!("{FOLD}vt 0 0\nvt 1 1\ns 1\ng a\nf 1/1 2/1 3/1 4/1\ng b\nf 2/2 1/2 5/2 6/2");
    let scene = scene(&text);
    let half = 0.5_f32.sqrt();
    let found = [scene.meshes[0].normals[0], scene.meshes[1].normals[1]];
    assert!(found.iter().all(|n| (n[1] - half).abs() < 1e-6 && (n[2] - half).abs() < 1e-6), "{found:?}");
}

#[test]
fn normals_that_are_given_stay() {
    let mesh = mesh(&format!("{FOLD}vn 1 0 0\ns 1\nf 1//1 2//1 3//1 4//1\nf 2 1 5 6"));
    assert_eq!(mesh.normals[..4], [[1.0, 0.0, 0.0]; 4]);
    assert!((mesh.normals[4][1] - 1.0).abs() < 0.5);
}

#[test]
fn line_ends_joined_lines_and_comments() {
    let text = "# a\r\nv 0 0 0 # origin\r\nv 1 0 \\\r\n 0\r\n\r\nv 0 1 0\r\nf 1 2\\\r\n3\r\n";
    assert_eq!(mesh(text).triangles, [[0, 1, 2]]);
    assert_eq!(mesh(&text.replace("\r\n", "\r")).triangles, [[0, 1, 2]]);
}

#[test]
fn names_in_latin_1_are_read_as_far_as_possible() {
    let file = Files::new(&[("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\ng Stra\xdfe\nf 1 2 3")]);
    assert_eq!(file.read().unwrap().0.meshes[0].name, "Stra\u{fffd}e");
}

#[test]
fn what_is_not_finite_is_dropped_and_counted() {
    let (scene, warnings) = load(&format!("{TRIANGLE}v nan 0 0\nv 1e99 0 0\nf 1 2 4\nf 3 2 1\nf 1 2 5 3"));
    assert_eq!(scene.meshes[0].triangles.len(), 1);
    assert!(scene.meshes[0].positions.iter().flatten().all(|x| x.is_finite()));
    assert_eq!(warnings, ["a.obj: 3 triangles have a vertex that is not finite and are dropped"]);
}

#[test]
fn odd_texture_coordinates_and_normals_are_replaced_and_counted() {
    let (scene, warnings) = load(&format!("{TRIANGLE}vt nan 1\nvn inf 0 0\nvn 0 0 0\nf 1/1/1 2/1/2 3/1/1"));
    assert_eq!((scene.meshes[0].uvs[0], scene.meshes[0].normals[0]), ([0.0; 2], [0.0; 3]));
    assert_eq!(
        warnings,
        [
            "a.obj: 1 'vt' are not finite; 0 stands in for them",
            "a.obj: 1 'vn' are not finite; flat normals stand in for them"
        ]
    );
}

#[test]
fn repeated_vertices_are_dropped_and_flat_triangles_kept() {
    let (scene, warnings) = load(&format!("{TRIANGLE}v 1 0 0\nf 1 2 2\nf 1 2 4\nf 1 2 3 3"));
    assert_eq!(scene.meshes[0].triangles.len(), 2);
    assert_eq!(warnings, ["a.obj: 1 triangles have the same vertex twice and are dropped"]);
}

#[test]
fn other_elements_are_skipped_and_counted() {
    let text = format!("{TRIANGLE}f 1 2 3\nl 1 2\np 1\nl 2 3\ncurv2 1\nfoo\nlod 1\ncall x.obj");
    assert_eq!(
        load(&text).1,
        [
            "a.obj:5: 2 'l' statements are skipped (lines)",
            "a.obj:6: 1 'p' statement is skipped (points)",
            "a.obj:8: 1 'curv2' statement is skipped (free-form curves and surfaces)",
            "a.obj:9: 1 'foo' statement is skipped (unknown)",
            "a.obj:11: 1 'call' statement is skipped (not supported)",
        ]
    );
}

#[test]
fn a_file_without_faces_is_a_scene_without_triangles() {
    for text in ["", TRIANGLE, "# nothing"] {
        let (scene, warnings) = load(text);
        assert!(scene.meshes.is_empty() && scene.instances.is_empty());
        assert_eq!(warnings, ["a.obj: the file has no faces: raywarp shows triangles, not points or lines"]);
    }
}

#[test]
fn materials_of_several_libraries() {
    let obj = format!("mtllib a.mtl my b.mtl\nmtllib a.mtl\n{TRIANGLE}f 1 2 3\nusemtl red\nf 1 2 3\nusemtl the blue\nf 1 2 3\nusemtl None\nf 1 2 3");
    let files: [(&str, &[u8]); 3] =
        [("a.obj", obj.as_bytes()), ("a.mtl", b"newmtl red\nKd 1 0 0"), ("my b.mtl", b"newmtl the blue\nKd 0 0 1")];
    let (scene, warnings) = Files::new(&files).read().unwrap();
    let names: Vec<_> = scene.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!((names, warnings.len()), (vec!["red", "the blue", "default"], 0));
    assert_eq!(scene.meshes[0].materials, [2, 0, 1, 2]);
}

#[test]
fn a_missing_library_is_one_warning() {
    let (scene, warnings) = load(&format!("mtllib b.mtl\n{TRIANGLE}usemtl x\nf 1 2 3\nusemtl y\nf 1 2 3"));
    assert_eq!((scene.materials.len(), &scene.meshes[0].materials[..]), (1, &[0, 0][..]));
    assert_eq!(
        warnings,
        ["a.obj:1: the material library b.mtl cannot be read: No such file or directory (os error 2); a grey material \
          stands in for what it defines"]
    );
}

#[test]
fn undefined_materials_are_one_warning_each() {
    let obj = format!("mtllib a.mtl\n{TRIANGLE}usemtl x\nf 1 2 3\nusemtl y\nf 1 2 3\nusemtl x\nf 1 2 3");
    let (_, warnings) = Files::new(&[("a.obj", obj.as_bytes()), ("a.mtl", b"newmtl z")]).read().unwrap();
    assert_eq!(
        warnings,
        [
            "a.obj:5: the material 'x' is not in the file's material libraries; a grey one stands in for it",
            "a.obj:7: the material 'y' is not in the file's material libraries; a grey one stands in for it"
        ]
    );
    assert_eq!(
        load(&format!("{TRIANGLE}usemtl x\nusemtl y\nf 1 2 3")).1,
        ["a.obj:4: 'usemtl' names materials, but no 'mtllib' names their file; a grey one stands in for them"]
    );
}
