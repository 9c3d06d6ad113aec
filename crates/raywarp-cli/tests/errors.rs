//! Every kind of bad input: the exit code and the sentence.

use crate::common::{Place, SCENE};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// Files that cannot be read as what they claim to be, with a part of what is said about each.
fn broken_files() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let noise: Vec<u8> = (0..3000u32).map(|i| (i * 197 + 13) as u8).collect();
    let binary = |vertices: u64| {
        let header = "ply\nformat binary_little_endian 1.0\nelement vertex N\nproperty float x\nproperty float y\n\
                      property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
        let mut file = header.replace('N', &vertices.to_string()).into_bytes();
        file.extend([0; 20]);
        file
    };
    let glb = |length: u32| [b"glTF" as &[u8], &2u32.to_le_bytes(), &length.to_le_bytes(), &[0; 20]].concat();
    vec![
        ("empty.ply", Vec::new(), "the first line is not 'ply'"),
        ("empty.gltf", Vec::new(), "EOF while parsing"),
        ("empty.glb", Vec::new(), "empty.glb"),
        ("empty.toml", Vec::new(), "the key 'version' is missing"),
        ("noise.obj", noise.clone(), "is not a statement"),
        ("noise.ply", noise.clone(), "the first line is not 'ply'"),
        ("noise.gltf", noise.clone(), "the JSON of glTF 2.0"),
        ("noise.glb", noise.clone(), "noise.glb"),
        ("noise.toml", noise, "no UTF-8 text"),
        ("cut.obj", b"v 0 0 0\nv 1 0 0\nv 0 1".to_vec(), "cut.obj:3:6: 'v 0 1' has 2 numbers"),
        (
            "cut.stl",
            b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0".to_vec(),
            "cut.stl:4:13: the file ends within",
        ),
        ("noise.stl", (0..300u32).map(|i| (i * 197 + 13) as u8).collect(), "triangles are claimed"),
        ("cut.ply", binary(3), "3 rows of 'vertex'"),
        ("cut.gltf", br#"{"asset": {"version": "2.0"}, "meshes": ["#.to_vec(), "cut.gltf:1:41: EOF while parsing"),
        ("cut.glb", glb(1000), "a length of 1000 bytes in a file of 32"),
        ("cut.toml", b"version = 1\n[[meshes]]\nvertices = [[0,0".to_vec(), "cut.toml:3:"),
        ("huge.ply", binary(1 << 32), "claims 4294967296 rows"),
        ("huge.glb", glb(u32::MAX), "a length of 4294967295 bytes"),
        ("huge.gltf", gltf(&[0, 1, 2], [0.0; 3], 4 << 30).into(), "expected its byteLength of 4294967296"),
        ("index.obj", TRIANGLE.replace('3', "9").into(), "index.obj:4:7: '9' names vertex 9; expected 1 to 3"),
        ("index.ply", ply("0 0 0", "3 0 1 9").into(), "vertex index 9; expected a whole number from 0 to 2"),
        ("index.gltf", gltf(&[0, 1, 9], [0.0; 3], 0).into(), "expected an index below 3"),
        (
            "index.toml",
            SCENE.replace("[[0, 1, 2]]", "[[0, 1, 7]]").into(),
            "the vertex index 7; expected one from 0 to 2",
        ),
        ("nan.toml", SCENE.replace("[0, 1, 0]]", "[0, nan, 0]]").into(), "the number NaN"),
    ]
}

/// A PLY with three vertices, of which the first is given, and one face.
fn ply(first: &str, face: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face \
         1\nproperty list uchar int vertex_indices\nend_header\n{first}\n1 0 0\n0 1 0\n{face}\n"
    )
}

/// A glTF with three positions, of which the first is given, and a claim of the buffer's length unless 0.
fn gltf(indices: &[u16], first: [f32; 3], claim: u64) -> String {
    let mut bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let offset = bytes.len();
    let positions = [first, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    bytes.extend(positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    let (length, count) = (bytes.len(), indices.len());
    let claimed = if claim == 0 { length as u64 } else { claim };
    // Percent-encoded bytes need no base64.
    let uri: String = bytes.iter().map(|byte| format!("%{byte:02x}")).collect();
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":1}},"indices":0}}]}}],
        "buffers":[{{"byteLength":{claimed},"uri":"data:application/octet-stream,{uri}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{offset}}},{{"buffer":0,"byteOffset":{offset},"byteLength":36}}],
        "accessors":[{{"bufferView":0,"componentType":5123,"count":{count},"type":"SCALAR"}},
        {{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}}]}}"#
    )
}

#[test]
fn broken_files_are_errors_that_name_the_file_and_leave_nothing() {
    let place = Place::new();
    for (name, contents, sentence) in broken_files() {
        place.write(name, contents);
        let run = place.render(&[name, "--size", "8x8"]).fails(2, sentence);
        assert!(run.err().contains(name), "{name}: {}", run.err());
        place.run(&["info", name]).fails(2, sentence);
    }
    assert!(!place.names().iter().any(|name| name.ends_with(".png") || name.ends_with(".tmp")));
}

#[test]
fn names_from_files_do_not_command_the_terminal() {
    let place = Place::new();
    place.write("a.obj", format!("o \u{1b}[31mred\n{TRIANGLE}usemtl \u{1b}c\nl 1 2\n\u{1b}]0;title\u{7}\n"));
    let run = place.run(&["info", "a.obj"]).succeeds();
    let shown = format!("{}{}", run.out(), run.err());
    assert!(shown.contains("red") && !shown.contains(|c: char| c.is_control() && c != '\n'), "{shown:?}");
}

#[test]
fn digits_that_are_lost_are_a_note_and_strict_lets_it_pass() {
    let place = Place::new();
    place.write("far.obj", "v 4500000.123 0 0\nv 4500001 0 0\nv 4500000 1 0\nf 1 2 3\n");
    let run = place.render(&["far.obj", "--size", "8x8", "--strict"]).succeeds();
    assert!(run.err().contains("note: far.obj: positions lose up to 1.23e-1 scene units"), "{}", run.err());
}

#[test]
fn what_can_be_dropped_is_a_warning_and_with_strict_an_error() {
    let place = Place::new();
    place.write("nan.obj", TRIANGLE.replacen("v 0 0 0", "v 0 0 nan", 1));
    place.write("inf.obj", TRIANGLE.replacen("v 0 0 0", "v 0 0 1e999", 1));
    place.write("nan.ply", ply("nan 0 0", "3 0 1 2"));
    place.write("nan.gltf", gltf(&[0, 1, 2], [f32::NAN, 0.0, 0.0], 0));
    place.write("inf.gltf", gltf(&[0, 1, 2], [f32::INFINITY, 0.0, 0.0], 0));
    place.write("no_mtl.obj", format!("mtllib none.mtl\n{TRIANGLE}"));
    place.write("no_texture.obj", format!("mtllib no_texture.mtl\n{}", TRIANGLE.replace("f ", "usemtl m\nf ")));
    place.write("no_texture.mtl", "newmtl m\nmap_Kd none.png\n");
    place.write("no_texture.toml", SCENE.replace("diffuse = 0", "diffuse_map = \"none.png\""));
    place.write("empty.obj", "");
    place.write("edge.obj", format!("{TRIANGLE}f 1 2\n"));
    place.write("normal.obj", TRIANGLE.replace("1 2 3", "1//1 2//1 3//1"));
    place.write("foreign.obj", format!("$ what\n{TRIANGLE}"));
    place.write("longer.ply", ply("0 0 0 7", "3 0 1 2"));
    for (name, sentence) in [
        ("nan.obj", "not finite"),
        ("edge.obj", "fewer than 3 corners"),
        ("normal.obj", "names normals that the file lacks"),
        ("foreign.obj", "is not a statement of OBJ"),
        ("longer.ply", "more values than the header declares"),
        ("inf.obj", "not finite"),
        ("nan.ply", "not finite"),
        ("nan.gltf", "not finite"),
        ("inf.gltf", "not finite"),
        ("no_mtl.obj", "the material library none.mtl cannot be read"),
        ("no_texture.obj", "the image none.png cannot be used"),
        ("no_texture.toml", "the image none.png cannot be used"),
        ("empty.obj", "no faces"),
    ] {
        let run = place.render(&[name, "--size", "8x8"]).says(sentence);
        assert!(run.err().contains("warning: "), "{}", run.err());
        place
            .render(&[name, "--size", "8x8", "--strict"])
            .fails(2, "(an error, as reading is strict); without --strict it is a warning");
    }
}

#[test]
fn triangles_without_area_are_dropped_and_counted() {
    let place = Place::new();
    place.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 1 2 4\n");
    place.render(&["flat.obj", "--size", "8x8"]).succeeds();
    let info = place.run(&["info", "flat.obj"]).succeeds().out();
    assert!(info.contains("triangles       1 ("), "{info}");
}

#[test]
fn what_is_no_file_is_no_scene() {
    let place = Place::new();
    std::fs::create_dir(place.path("directory.obj")).unwrap();
    place.render(&["directory.obj"]).fails(2, "directory.obj: a directory as a scene is not supported");
    place.render(&["missing.ply"]).fails(2, "cannot read missing.ply: No such file or directory");
    place.render(&["scene.xyz"]).fails(2, "Give a file that ends in .obj, .ply, .stl, .gltf, .glb, .toml.");
    place.render(&["scene"]).fails(2, "without an extension");
    place.render(&[""]).fails(2, "error: ");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("nowhere", place.path("dangling.glb")).unwrap();
        place.render(&["dangling.glb"]).fails(2, "cannot read dangling.glb: No such file or directory");
        std::os::unix::fs::symlink("loop.toml", place.path("loop.toml")).unwrap();
        place.render(&["loop.toml"]).fails(2, "cannot read loop.toml: ");
    }
}

#[cfg(unix)]
#[test]
fn an_unreadable_file_is_an_error() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    place.write("secret.obj", TRIANGLE);
    std::fs::set_permissions(place.path("secret.obj"), std::fs::Permissions::from_mode(0o000)).unwrap();
    // Permissions mean nothing to root.
    if std::fs::read(place.path("secret.obj")).is_err() {
        place.render(&["secret.obj"]).fails(2, "Check the file's permissions.");
    }
}

#[test]
fn an_error_says_its_cause_once() {
    let place = Place::new();
    let said = place.render(&["missing.ply"]).err();
    assert_eq!(said.matches("No such file").count(), 1, "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_rendering() {
    let place = Place::new();
    std::fs::create_dir(place.path("taken.png")).unwrap();
    for (output, sentence) in [
        ("none/a.png", "there is no directory none"),
        ("taken.png", "it is a directory"),
        ("a.gif", "its name does not end in .png or .exr"),
        ("a", "its name does not end in .png or .exr"),
    ] {
        // Rendering this would take hours.
        place.render(&["-o", output, "--spp", "100000"]).fails(2, sentence);
    }
    place.render(&["-o", "a.png", "-o", "a.png"]).fails(2, "two outputs have the same name, a.png");
    place.render(&["--heatmap", "a.exr"]).fails(2, "the heat map a.exr is a PNG");
    place.render(&["-o", "-", "--aov", "depth"]).fails(2, "standard output has no name");
    place.render(&["-o", "-", "--stats=json"]).fails(2, "cannot both go to standard output");
    assert_eq!(place.names(), ["taken.png"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_with_the_size() {
    let place = Place::new();
    for name in ["full.png", "full.exr"] {
        std::os::unix::fs::symlink("/dev/full", place.path(name)).unwrap();
        place.render(&["-o", name, "--size", "8x8"]).fails(2, "the disk is full");
    }
    assert_eq!(place.names(), ["full.exr", "full.png"]);
    assert!(std::path::Path::new("/dev/full").exists());
}

#[test]
fn sizes_without_pixels_and_absurd_ones_are_refused() {
    let place = Place::new();
    for (size, sentence) in [
        ("0x8", "a picture has at least 1x1 pixels"),
        ("8x0", "a picture has at least 1x1 pixels"),
        ("100000x100000", "a picture has at most 65536 pixels each way"),
        ("99999999999999999999x1", "give width and height in pixels"),
        ("-1x8", "give width and height in pixels"),
        ("wide", "give width and height in pixels"),
    ] {
        place.render(&[&format!("--size={size}")]).fails(2, sentence);
    }
    let run = place.render(&["--size", "65536x65536"]).fails(2, "a picture of 65536x65536");
    assert!(run.err().contains("GiB") || run.err().contains("counts up to"), "{}", run.err());
    assert!(place.names().is_empty());
}

#[test]
fn impossible_options_are_refused() {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    for (arguments, sentence) in [
        (&["--spp", "0"] as &[&str], "give a whole number from 1 to 1048576"),
        (&["--max-depth", "17"], "give a whole number from 0 to 16"),
        (&["--max-depth=-1"], "give a whole number from 0 to 16"),
        (&["--accel", "octree"], "octree"),
        (&["--device", "tpu"], "expected auto, cpu, cuda or cuda:N"),
        (&["--fov", "180"], "from 0.001 to 179 degrees"),
        (&["--eye", "1,2"], "give three numbers"),
        (&["--eye", "1,nan,3"], "coordinates are finite numbers"),
        (&["--up", "0,0,0"], "a direction is not zero"),
        (&["--exposure", "inf"], "from -60 to 60"),
        (&["--aov", "depth,colour"], "the layers are depth, normal"),
        (&["--heatmap-max", "5"], "--heatmap <FILE>"),
        (&["--crop", "5,5,5,9"], "it holds no pixels"),
        (&["--crop", "0,0,9,9", "--size", "8x8"], "leaves the picture of 8x8 pixels"),
        (&["--threads", "0"], "give a whole number from 1 to 4096"),
        (&["--camera", "side"], "there is no camera 'side'; the scene has 0 'near', 1 'away'"),
        (&["--camera", "2"], "there is no camera '2'"),
        (&["--eye", "0,0,0", "--target", "0,0,0"], "the camera 'near' stands on its own target"),
        (&["--stats=xml"], "[possible values: table, json]"),
        (&["--szie", "8x8"], "a similar argument exists: '--size'"),
    ] {
        place.run(&[&["render", "scene.toml"], arguments].concat()).fails(2, sentence);
    }
    assert_eq!(place.names(), ["scene.toml"]);
    place.run(&["rendr"]).fails(2, "a similar subcommand exists: 'render'");
}

#[test]
fn many_warnings_are_cut_to_twenty_and_counted() {
    let place = Place::new();
    let libraries: String = (0..30).map(|index| format!("mtllib none{index}.mtl\n")).collect();
    place.write("many.obj", format!("{libraries}{TRIANGLE}"));
    let said = place.render(&["many.obj", "--size", "8x8"]).says("warning: and 10 more of 30").err();
    assert_eq!(said.matches("warning: many.obj").count(), 20, "{said}");
}

#[test]
fn a_device_that_is_not_there_is_a_device_error() {
    let place = Place::new();
    place.run(&["render", "--device", "cuda:99", "--size", "8x8"]).fails(3, "CUDA");
    assert!(place.names().is_empty());
}
