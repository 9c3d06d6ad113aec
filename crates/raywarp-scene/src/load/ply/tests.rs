use std::path::PathBuf;

use proptest::prelude::*;

use super::surface::DIFFUSE;
use crate::load::{load, LoadError, LoadOptions, Loaded, Place};
use crate::{AlphaMode, Mesh};

const TRIANGLE: &str = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                        element face 1\nproperty list uchar int vertex_indices\nend_header\n";

fn load_bytes(bytes: &[u8]) -> (PathBuf, Result<Loaded, LoadError>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("test.ply");
    std::fs::write(&path, bytes).unwrap();
    let result = load(&path, &LoadOptions::default());
    (path, result)
}

fn loaded(text: &str) -> Loaded {
    load_bytes(text.as_bytes()).1.unwrap()
}

fn mesh(text: &str) -> Mesh {
    loaded(text).scene.meshes.remove(0)
}

/// The message behind the path of the file.
fn refusal(bytes: &[u8]) -> String {
    let (path, result) = load_bytes(bytes);
    result.unwrap_err().to_string().replace(&path.display().to_string(), "F")
}

fn ascii(rest: &str) -> String {
    format!("ply\nformat ascii 1.0\n{rest}")
}

fn only_warning(loaded: &Loaded) -> &str {
    assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
    &loaded.warnings[0].message
}

#[test]
fn a_triangle_is_one_mesh_one_instance_one_material() {
    let loaded = loaded(&ascii(&format!("{TRIANGLE}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")));
    assert!(loaded.warnings.is_empty());
    let scene = loaded.scene;
    assert_eq!(scene.meshes[0].name, "test");
    assert_eq!(scene.meshes[0].positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(scene.meshes[0].materials, [0]);
    assert_eq!(scene.meshes[0].normals, [[0.0, 0.0, 1.0]; 3], "smooth normals are made");
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.materials[0].diffuse, [DIFFUSE; 3]);
}

#[test]
fn line_ends_of_windows_and_of_old_macs_are_line_ends() {
    let text = ascii(&format!("{TRIANGLE}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
    for end in ["\r\n", "\r"] {
        assert_eq!(mesh(&text.replace('\n', end)).triangles, [[0, 1, 2]]);
    }
}

#[test]
fn a_last_line_without_an_end_is_read() {
    assert_eq!(mesh(&ascii(&format!("{TRIANGLE}0 0 0\n1 0 0\n0 1 0\n3 0 1 2"))).triangles, [[0, 1, 2]]);
}

#[test]
fn comments_need_not_be_utf_8() {
    let mut bytes = b"ply\nformat ascii 1.0\ncomment caf\xe9\n".to_vec();
    bytes.extend_from_slice(format!("{TRIANGLE}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").as_bytes());
    assert!(load_bytes(&bytes).1.is_ok());
}

#[test]
fn all_types_and_all_vertex_properties_are_read() {
    let text = ascii(
        "element vertex 3\nproperty double x\nproperty short y\nproperty int z\nproperty float confidence\n\
         property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n\
         property uchar blue\nproperty uchar alpha\nproperty float s\nproperty float t\n\
         element face 1\nproperty uchar flags\nproperty list uchar uint vertex_index\nproperty list uchar float texcoord\n\
         element camera 1\nproperty float view\nend_header\n\
         0.5 2 -3 9  0 0 2  255 0 188 255  0.25 0.75\n1 0 0 9  0 3 0  0 0 0 51  0 1\n0 1 0 9  0 0 0  0 0 0 255  nan 1\n\
         7 3 0 1 2 2 0.5 0.5\n1.5\n",
    );
    let loaded = loaded(&text);
    let mesh = &loaded.scene.meshes[0];
    assert_eq!(mesh.positions[0], [0.5, 2.0, -3.0]);
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0; 3]]);
    assert_eq!(mesh.uvs, [[0.25, 0.75], [0.0, 1.0], [0.0, 1.0]]);
    assert_eq!(mesh.colors[0][0], 1.0);
    assert!((mesh.colors[0][2] - 0.5029).abs() < 1e-3, "sRGB 188 is about half the light");
    assert_eq!(mesh.colors[1][3], 0.2, "alpha is linear");
    assert_eq!(loaded.scene.materials[0].alpha, AlphaMode::Blend);
}

#[test]
fn floating_point_colors_are_linear() {
    let text = ascii(
        "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float red\n\
         property float green\nproperty float blue\nend_header\n0 0 0 0.5 2 -1\n",
    );
    assert_eq!(mesh(&text).colors, [[0.5, 1.0, 0.0, 1.0]]);
    assert!(loaded(&text).warnings.iter().any(|w| w.message == "1 colours are brighter than 1 and are cut off there"));
    let bytes = mesh(&text.replace("0.5 2 -1", "255 188 0")).colors[0];
    assert!(bytes[0] == 1.0 && (bytes[1] - 0.5029).abs() < 1e-3, "from 0 to 255 they are sRGB: {bytes:?}");
}

#[test]
fn files_without_vertices_are_empty_scenes() {
    for header in ["element face 0\nproperty list uchar int vertex_indices\n", "element vertex 0\nproperty int x\n", ""]
    {
        let loaded = loaded(&ascii(&format!("{header}end_header\n")));
        assert!(loaded.scene.meshes.is_empty() && loaded.scene.instances.is_empty());
        assert_eq!(only_warning(&loaded), "the file has no vertices: there is nothing to see");
    }
}

#[test]
fn rows_may_have_more_values_than_the_header_says() {
    let loaded = loaded(&ascii(&format!("{TRIANGLE}0 0 0 7\n1 0 0\n0 1 0 8 9\n3 0 1 2 9\n")));
    assert_eq!(loaded.scene.meshes[0].positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(loaded.scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(
        (only_warning(&loaded), loaded.warnings[0].line),
        ("3 rows have more values than the header declares; the first count", Some(10))
    );
}

#[test]
fn lines_of_the_header_may_begin_with_blanks_or_be_empty() {
    let text = TRIANGLE.replace("element", " element").replace("property list", "\n\t property list");
    assert_eq!(mesh(&ascii(&format!("{text}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"))).triangles, [[0, 1, 2]]);
    let message = refusal(ascii(&format!("{text}0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n")).as_bytes());
    assert!(message.starts_with("F:12:3: vertex 1 of 3: 'x'"), "{message}");
}

#[test]
fn foreign_lines_of_the_header_are_skipped_and_counted() {
    let loaded = loaded(&ascii(&format!("Created by a program\n$\n{TRIANGLE}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")));
    assert_eq!(loaded.scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(
        (only_warning(&loaded), loaded.warnings[0].line),
        (
            "2 lines of the header are not statements of PLY and are skipped; the first is 'Created by a program'",
            Some(3)
        )
    );
}

#[test]
fn padding_may_be_there_twice() {
    let pad = "property float z\nproperty uchar pad\nproperty uchar pad\nproperty uchar pad\n";
    let text = TRIANGLE.replace("property float z\n", pad);
    let loaded = loaded(&ascii(&format!("{text}0 0 0 9 9 9\n1 0 0 9 9 9\n0 1 0 9 9 9\n3 0 1 2\n")));
    assert_eq!((loaded.scene.meshes[0].triangles.len(), loaded.warnings.len()), (1, 0));
}

#[test]
fn of_two_properties_of_a_name_the_first_holds() {
    let text = TRIANGLE.replace("property float z\n", "property float z\nproperty float x\n");
    let loaded = loaded(&ascii(&format!("{text}0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2\n")));
    assert_eq!(loaded.scene.meshes[0].positions[1], [1.0, 0.0, 0.0]);
    assert_eq!(only_warning(&loaded), "the property 'x' is defined again; the first holds");
}

#[test]
fn bytes_behind_the_last_row_are_not_read() {
    let text = ascii(&format!("{TRIANGLE}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
    for end in ["\u{1a}", "\0\0"] {
        assert_eq!(mesh(&format!("{text}{end}")).triangles, [[0, 1, 2]]);
    }
}

/// Two triangles over a square, with more properties of a vertex and of a face, and these rows.
fn square(comment: &str, [vertex, face]: [&str; 2], vertices: [&str; 4], faces: [&str; 2]) -> Loaded {
    let places = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"];
    let vertices: String = places.iter().zip(vertices).map(|(place, more)| format!("{place} {more}\n")).collect();
    let text = ascii(&format!(
        "{comment}element vertex 4\nproperty float x\nproperty float y\nproperty float z\n{vertex}\
         element face 2\nproperty list uchar int vertex_indices\n{face}end_header\n{vertices}3 0 1 2 {}\n3 0 2 3 {}\n",
        faces[0], faces[1]
    ));
    let folder = tempfile::tempdir().unwrap();
    let picture = image::RgbaImage::from_pixel(2, 2, image::Rgba([255, 0, 0, 255]));
    ["red.png", "a b.png"].iter().for_each(|name| picture.save(folder.path().join(name)).unwrap());
    std::fs::write(folder.path().join("test.ply"), text).unwrap();
    load(&folder.path().join("test.ply"), &LoadOptions::default()).unwrap()
}

const ST: &str = "property float s\nproperty float t\n";
const WEDGES: &str = "property list uchar float texcoord\n";

#[test]
fn a_texture_file_is_shown_by_the_coordinates_of_vertices() {
    let loaded = square("comment TextureFile red.png\n", [ST, ""], ["0 0", "1 0", "1 1", "0 1"], [""; 2]);
    let scene = loaded.scene;
    assert!(loaded.warnings.is_empty());
    assert_eq!(scene.meshes[0].uvs, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!((scene.materials.len(), scene.images[0].texels[0]), (1, [255, 0, 0, 255]));
    assert_eq!(scene.materials[0].diffuse_map, Some(crate::Texture::new(0, true)));
}

#[test]
fn a_texture_file_is_shown_by_the_coordinates_of_corners() {
    let faces = ["6 0 0 1 0 1 1", "6 0 0 1 1 0 0.5"];
    let loaded = square("comment texturefile \"a b.png\"\n", ["", WEDGES], [""; 4], faces);
    let mesh = &loaded.scene.meshes[0];
    assert!(loaded.warnings.is_empty() && loaded.scene.materials[0].diffuse_map.is_some());
    assert_eq!((mesh.positions.len(), mesh.normals.len()), (4, 4), "equal corners share a vertex");
    let uvs = mesh.triangles.iter().map(|triangle| triangle.map(|vertex| mesh.uvs[vertex as usize]));
    assert_eq!(uvs.collect::<Vec<_>>(), [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[0.0, 0.0], [1.0, 1.0], [0.0, 0.5]]]);
    let split = square("", ["", WEDGES], [""; 4], ["6 0 0 1 0 1 1", "6 0.5 0 1 1 0 1"]);
    assert_eq!(split.scene.meshes[0].positions.len(), 5);
    let odd = square("", ["", WEDGES], [""; 4], ["3 0 0 1", "6 0 0 1 1 0 nan"]);
    assert_eq!(odd.scene.meshes[0].uvs.iter().flatten().filter(|&&x| x != 0.0).count(), 2);
    assert_eq!(
        only_warning(&odd),
        "1 faces have other than two texture coordinates a corner; those of their vertices or (0, 0) stand in"
    );
}

#[test]
fn faces_say_which_texture_file_they_show() {
    let comments = "comment TextureFile red.png\ncomment TextureFile a b.png\n";
    let face = format!("{WEDGES}property int texnumber\n");
    let faces = ["6 0 0 1 0 1 1 1", "6 0 0 1 1 0 1 -1"];
    let loaded = square(comments, ["", &face], [""; 4], faces);
    let names: Vec<_> = loaded.scene.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!((names, &loaded.scene.meshes[0].materials[..]), (vec!["red.png", "a b.png", "default"], &[1, 2][..]));
}

#[test]
fn faces_have_colours() {
    let face = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let loaded = square("", ["", face], [""; 4], ["255 0 0", "0 0 255"]);
    let mesh = &loaded.scene.meshes[0];
    let color = |triangle: usize| mesh.triangles[triangle].map(|vertex| mesh.colors[vertex as usize]);
    assert_eq!([color(0), color(1)], [[[1.0, 0.0, 0.0, 1.0]; 3], [[0.0, 0.0, 1.0, 1.0]; 3]]);
    assert_eq!((mesh.positions.len(), mesh.normals.len(), loaded.warnings.len()), (6, 6, 0));
    let both = square("", [face, face], ["0 0 0", "0 0 0", "0 0 0", "0 0 0"], ["255 0 0", "0 0 255"]);
    assert_eq!(both.scene.meshes[0].colors, [[0.0, 0.0, 0.0, 1.0]; 4]);
    assert_eq!(only_warning(&both), "colours of faces are left out: vertices have colours of their own");
}

#[test]
fn a_texture_file_without_coordinates_is_a_plain_colour_and_a_warning() {
    let loaded = square("comment TextureFile red.png\n", ["", ""], [""; 4], [""; 2]);
    assert_eq!(loaded.scene.materials[0].diffuse_map, None);
    assert_eq!(
        only_warning(&loaded),
        "the mesh 'test' has no coordinates for the textures of the material 'default', which shows its plain colour there"
    );
}

#[test]
fn convex_polygons_become_fans() {
    let text = ascii(
        "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
         element face 2\nproperty list uchar int vertex_indices\nend_header\n\
         0 0 0\n2 0 0\n3 1 0\n1 2 0\n-1 1 0\n5 0 1 2 3 4\n4 0 1 2 3\n",
    );
    assert_eq!(mesh(&text).triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 1, 2], [0, 2, 3]]);
}

#[test]
fn dented_polygons_are_cut_inside() {
    // An arrowhead, dented at its last corner: the fan around the first would leave it.
    let vertices = "0 0 0\n4 -2 0\n0 4 0\n1 0 0\n";
    let element = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    let face = "element face 1\nproperty list uchar int vertex_indices\n";
    let mesh = mesh(&ascii(&format!("{element}{face}end_header\n{vertices}4 1 2 0 3\n")));
    let area = |[a, b, c]: [u32; 3]| {
        let [a, b, c] = [a, b, c].map(|vertex| mesh.positions[vertex as usize]);
        ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
    };
    assert_eq!(mesh.triangles.len(), 2);
    assert!(mesh.triangles.iter().all(|&triangle| area(triangle) > 0.0), "{:?}", mesh.triangles);
}

#[test]
fn polygons_of_many_corners_end_in_time() {
    let corners = 100_000;
    let element = format!("element vertex {corners}\nproperty char x\nproperty char y\nproperty char z\n");
    let face = "element face 1\nproperty list uint uint vertex_indices\n";
    let mut bytes = format!("ply\nformat binary_little_endian 1.0\n{element}{face}end_header\n").into_bytes();
    bytes.extend((0..3 * corners).map(|place: u32| ((place * 7919) >> 3) as u8));
    bytes.extend(corners.to_le_bytes());
    (0..corners).for_each(|index| bytes.extend(index.to_le_bytes()));
    assert_eq!(load_bytes(&bytes).1.unwrap().scene.meshes[0].triangles.len(), corners as usize - 2);
}

#[test]
fn strips_alternate_and_restart() {
    let text = ascii(
        "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
         0 0 0\n1 0 0\n0 1 0\n1 1 0\n10 0 1 2 3 3 -1 1 3 2 -1\n",
    );
    assert_eq!(mesh(&text).triangles, [[0, 1, 2], [2, 1, 3], [1, 3, 2]]);
}

#[test]
fn faces_may_come_before_vertices() {
    let text = ascii(
        "element face 1\nproperty list uchar int vertex_indices\n\
         element vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n\
         3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n",
    );
    assert_eq!(mesh(&text).triangles, [[0, 1, 2]]);
}

#[test]
fn a_point_cloud_is_a_warning() {
    let loaded = loaded(&ascii(
        "element vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n1 0 0\n",
    ));
    assert!(loaded.scene.meshes[0].triangles.is_empty());
    assert_eq!(only_warning(&loaded), "2 vertices and no faces: a point cloud, and raywarp shows triangles alone");
}

#[test]
fn faces_of_two_corners_are_dropped_and_counted() {
    let text = ascii(&TRIANGLE.replace("face 1", "face 3")) + "0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 2\n0\n";
    let loaded = loaded(&text);
    assert_eq!(loaded.scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(only_warning(&loaded), "2 faces have fewer than 3 vertices and were dropped");
}

#[test]
fn vertices_that_are_not_finite_take_their_triangles_with_them() {
    for bad in ["nan", "inf", "-inf", "1.#QNAN", "-nan(ind)", "1e39"] {
        let text = ascii(&TRIANGLE.replace("vertex 3", "vertex 4").replace("face 1", "face 2"));
        let loaded = loaded(&format!("{text}0 0 0\n1 0 0\n0 1 0\n0 {bad} 0\n3 0 1 2\n3 1 2 3\n"));
        assert_eq!(loaded.scene.meshes[0].triangles, [[0, 1, 2]], "{bad}");
        assert!(loaded.scene.meshes[0].positions.iter().flatten().all(|x| x.is_finite()));
        assert_eq!(only_warning(&loaded), "1 triangles use vertices that are not finite and were dropped");
    }
}

#[test]
fn claims_beyond_the_file_are_refused_with_both_numbers() {
    let text = TRIANGLE.replace("vertex 3", "vertex 4000000000");
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let message = refusal(format!("ply\nformat {encoding} 1.0\n{text}0 0 0\n").as_bytes());
        let least = if encoding == "ascii" { 6 } else { 12 };
        assert_eq!(
            message,
            format!(
                "F: the header claims 4000000000 rows of 'vertex' of at least {least} bytes each, but 6 bytes follow it. \
                 The file is cut off or its header is wrong: write it again."
            )
        );
    }
}

#[test]
fn rows_without_properties_cost_nothing() {
    let text = TRIANGLE.replace("element vertex", "element nothing 4000000000000\nelement vertex");
    assert_eq!(mesh(&ascii(&format!("{text}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"))).triangles, [[0, 1, 2]]);
}

#[test]
fn indices_out_of_range_name_the_face_and_the_place() {
    for (index, line) in [("3", 13), ("-1", 13), ("1.5", 13)] {
        let message = refusal(ascii(&format!("{TRIANGLE}0 0 0\n1 0 0\n0 1 0\n3 0 1 {index}\n")).as_bytes());
        assert_eq!(
            message,
            format!(
                "F:{line}:1: face 0 of 1: vertex index {index}; expected a whole number from 0 to 2. \
                 Write the file again, or correct it there."
            )
        );
    }
    let mut binary = format!("ply\nformat binary_little_endian 1.0\n{TRIANGLE}").into_bytes();
    let list = binary.len() + 36;
    binary.extend_from_slice(&[0; 36]);
    binary.extend_from_slice(&[3, 0, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0]);
    let message = refusal(&binary);
    assert!(message.starts_with(&format!("F, byte {list}: face 0 of 1: vertex index 9; expected")), "{message}");
}

#[test]
fn broken_bodies_are_refused_where_they_break() {
    let broken = |body: &str| refusal(ascii(&format!("{TRIANGLE}{body}")).as_bytes());
    let cases = [
        ("0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n", "F:11:3: vertex 1 of 3: 'zero'; expected a number."),
        ("0 0 0\n1 0\n0 1 0\n3 0 1 2\n3 0", "F:11:4: vertex 1 of 3: the line ends; expected a number."),
        ("0 0 0\n1 0 0\n0 1 0\n\n\n\n", "F: face 0 of 1: the file ends; expected another line."),
        ("0 0 0\n1 0 0\n0 1 0\n200 0 1 2\n", "F:13:1: face 0 of 1: a list of 200 values; expected a whole number"),
        ("0 0 0\n1 0 0\n0 1 0\n-1 0 1 2\n", "F:13:1: face 0 of 1: a list of -1 values; expected a whole number"),
    ];
    for (body, start) in cases {
        let message = broken(body);
        assert!(message.starts_with(start), "{message}");
    }
}

#[test]
fn broken_headers_are_refused() {
    let cases = [
        ("", "F, byte 0: the first line is not 'ply'; expected"),
        ("plywood\n", "F, byte 0: the first line is not 'ply'; expected"),
        ("ply\nformat ascii 1.0\n", "F: the header has no end; expected a line 'end_header'."),
        ("ply\nformat ascii 1.0\nelement vertex many\nend_header\n", "F:3:1: 'element vertex many'; expected"),
        ("ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nend_header\n", "F:3:1: 'element vertex 999"),
        ("ply\nend_header\n", "F: the header is incomplete; expected 'format"),
        (
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nend_header\n1\n",
            "F: element 'vertex' has no property 'y'",
        ),
        (
            "ply\nformat ascii 1.0\nelement vertex 0\nelement vertex 0\nend_header\n",
            "F: the header defines an element twice; expected every name once.",
        ),
        (
            "ply\nformat ascii 1.0\nelement face 1\nproperty int x\nend_header\n1\n",
            "F: element 'face' has no vertex list; expected",
        ),
    ];
    for (text, start) in cases {
        let message = refusal(text.as_bytes());
        assert!(message.starts_with(start), "{message}");
    }
}

#[test]
fn errors_carry_their_place() {
    let error = load_bytes(ascii(&format!("{TRIANGLE}0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n")).as_bytes()).1.unwrap_err();
    assert!(matches!(error, LoadError::Syntax { place: Place::Line(11, 3), .. }), "{error:?}");
}

/// A mesh in the three encodings, its numbers exactly representable.
fn write_ply(encoding: &str, positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut out = format!(
        "ply\nformat {encoding} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        positions.len(),
        triangles.len()
    )
    .into_bytes();
    let big = encoding == "binary_big_endian";
    let order = |bytes: [u8; 4]| if big { bytes.iter().rev().copied().collect::<Vec<u8>>() } else { bytes.to_vec() };
    for [x, y, z] in positions {
        match encoding {
            "ascii" => out.extend(format!("{x} {y} {z}\n").bytes()),
            _ => [x, y, z].iter().for_each(|value| out.extend(order(value.to_le_bytes()))),
        }
    }
    for [a, b, c] in triangles {
        match encoding {
            "ascii" => out.extend(format!("3 {a} {b} {c}\n").bytes()),
            _ => {
                out.push(3);
                [a, b, c].iter().for_each(|value| out.extend(order(value.to_le_bytes())));
            }
        }
    }
    out
}

const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_is_read(
        positions in prop::collection::vec(prop::array::uniform3(-1e9f32..1e9), 3..40),
        corners in prop::collection::vec(prop::array::uniform3(0usize..1000), 0..60),
    ) {
        let triangles: Vec<[u32; 3]> =
            corners.iter().map(|corner| corner.map(|index| (index % positions.len()) as u32)).collect();
        for encoding in ENCODINGS {
            let loaded = load_bytes(&write_ply(encoding, &positions, &triangles)).1.unwrap();
            prop_assert_eq!(&loaded.scene.meshes[0].positions, &positions);
            prop_assert_eq!(&loaded.scene.meshes[0].triangles, &triangles);
        }
    }

    #[test]
    fn mutated_files_never_panic(
        encoding in 0usize..3,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        length in any::<prop::sample::Index>(),
        cut in any::<bool>(),
    ) {
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.5]];
        let mut bytes = write_ply(ENCODINGS[encoding], &positions, &[[0, 1, 2], [2, 1, 3]]);
        for (place, value) in changes {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        if cut {
            bytes.truncate(length.index(bytes.len()));
        }
        let _ = load_bytes(&bytes).1;
    }
}
