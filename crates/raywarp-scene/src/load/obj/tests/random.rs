//! Written and read again; broken and read.

use std::fmt::Write;

use proptest::prelude::*;

use super::*;

type Triangle = [[f32; 3]; 3];

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![-10.0_f32..10.0, (-3_i8..3).prop_map(f32::from), any::<f32>().prop_filter("finite", |x| x.is_finite())]
}

fn soup() -> impl Strategy<Value = Vec<Triangle>> {
    prop::collection::vec(prop::array::uniform3(prop::array::uniform3(coordinate())), 1..20)
}

/// As an OBJ file; every other face by negative indices, with groups and smoothing between.
fn write(triangles: &[Triangle]) -> String {
    let mut text = String::new();
    for (index, triangle) in triangles.iter().enumerate() {
        for [x, y, z] in triangle {
            writeln!(text, "v {x} {y:e} {z}").unwrap();
        }
        let first = 3 * index + 1;
        match index % 4 {
            0 => writeln!(text, "f {first} {} {}", first + 1, first + 2).unwrap(),
            1 => writeln!(text, "s {index}\nf -3 -2 \\\n-1").unwrap(),
            2 => writeln!(text, "g {}\nf -3// -2/ -1", index / 8).unwrap(),
            _ => writeln!(text, "s off\r\nf -3 -2 -1 # {index}").unwrap(),
        }
    }
    text
}

fn read_bytes(bytes: &[u8]) -> Result<(Scene, Vec<String>), LoadError> {
    Files::new(&[("a.obj", bytes)]).read()
}

/// What [`Mesh`] promises.
fn check(mesh: &Mesh, materials: usize) {
    let vertices = mesh.positions.len();
    assert!([mesh.normals.len(), mesh.uvs.len(), mesh.colors.len()]
        .iter()
        .all(|&length| length == 0 || length == vertices));
    assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < vertices));
    assert_eq!(mesh.materials.len(), mesh.triangles.len());
    assert!(mesh.materials.iter().all(|&material| (material as usize) < materials));
    assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()));
}

proptest! {
    #[test]
    fn triangles_survive_being_written(triangles in soup()) {
        let (scene, _) = read_bytes(write(&triangles).as_bytes()).unwrap();
        let mut read: Vec<_> = scene.meshes.iter().flat_map(corners).map(|t| format!("{t:?}")).collect();
        let mut written: Vec<_> = triangles.iter().map(|t| format!("{t:?}")).collect();
        read.sort();
        written.sort();
        prop_assert_eq!(read, written);
    }

    #[test]
    fn broken_files_do_not_panic(
        triangles in soup(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop_oneof![any::<u8>(), Just(b'\n'), Just(b'/'), Just(b'\\'), Just(b'1')]), 1..8),
    ) {
        let mut bytes = write(&triangles).into_bytes();
        for (at, byte) in &changes {
            let at = at.index(bytes.len());
            bytes[at] = *byte;
        }
        if let Ok((scene, _)) = read_bytes(&bytes) {
            scene.meshes.iter().for_each(|mesh| check(mesh, scene.materials.len()));
        }
    }

    #[test]
    fn garbage_is_a_short_sentence(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        if let Err(error) = read_bytes(&bytes) {
            prop_assert!(error.to_string().len() < 600, "{}", error);
        }
    }

    #[test]
    fn statements_of_all_kinds_do_not_panic(lines in prop::collection::vec(
        ("(v|vt|vn|f|g|o|s|usemtl|mtllib|l|curv)", "( (-?[0-4](/|//)?[0-3]?|nan|off|x|1e39|\\\\)){0,6}"), 0..20)
    ) {
        let text: String = lines.iter().map(|(keyword, rest)| format!("{keyword}{rest}\n")).collect();
        if let Ok((scene, _)) = read_bytes(text.as_bytes()) {
            scene.meshes.iter().for_each(|mesh| check(mesh, scene.materials.len()));
        }
    }
}
