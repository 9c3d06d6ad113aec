//! What does not fit is an error before it is allocated, whichever format asks for it.

use std::fs;
use std::path::{Path, PathBuf};

use super::{attempt_within, LoadError, LoadOptions};
use crate::memory::Budget;
use crate::Scene;

fn read(path: &Path, bytes: u64) -> Result<Scene, LoadError> {
    attempt_within(path, &LoadOptions::default(), Budget::of(bytes)).result.map(|loaded| loaded.scene)
}

/// Corners of so many triangles, each apart from the others.
fn corners(triangles: u32) -> Vec<[f32; 3]> {
    (0..3 * triangles).map(|i| [(i / 3) as f32, (i % 3 == 1) as u32 as f32, (i % 3 == 2) as u32 as f32]).collect()
}

fn bytes(corners: &[[f32; 3]]) -> Vec<u8> {
    corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

/// The same triangles in every format that has geometry of its own.
fn files(folder: &Path) -> Vec<PathBuf> {
    const COUNT: u32 = 2000;
    let corners = corners(COUNT);
    let lines = |word: &str| corners.iter().map(|[x, y, z]| format!("{word} {x} {y} {z}\n")).collect::<String>();
    let faces = |first: u32, word: &str| -> String {
        (0..COUNT)
            .map(|i| [0, 1, 2].map(|k| 3 * i + k + first))
            .map(|[a, b, c]| format!("{word} {a} {b} {c}\n"))
            .collect()
    };
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face \
         {COUNT}\nproperty list uchar int vertex_indices\nend_header\n{}{}",
        corners.len(),
        lines("").replace("\n ", "\n").trim_start(),
        faces(0, "3"),
    );
    let facet = |v: &[[f32; 3]]| {
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", {
            v.iter().map(|[x, y, z]| format!("vertex {x} {y} {z}\n")).collect::<String>()
        })
    };
    let ascii: String = corners.chunks(3).map(facet).collect();
    let records = corners.chunks(3).flat_map(|v| [vec![0; 12], bytes(v), vec![0; 2]].concat());
    let stl: Vec<u8> = [0; 80].into_iter().chain(COUNT.to_le_bytes()).chain(records).collect();
    let buffer = bytes(&corners);
    let gltf = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"a.bin","byteLength":{0}}}],"bufferViews":[{{"buffer":0,
        "byteLength":{0}}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":{1},"type":"VEC3"}}],"meshes":[{{
        "primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]}}]}}"#,
        buffer.len(),
        corners.len(),
    );
    fs::write(folder.join("a.bin"), buffer).unwrap();
    let all: [(&str, Vec<u8>); 5] = [
        ("a.obj", (lines("v") + &faces(1, "f")).into_bytes()),
        ("a.ply", ply.into_bytes()),
        ("a.stl", stl),
        ("b.stl", format!("solid\n{ascii}endsolid\n").into_bytes()),
        ("a.gltf", gltf.into_bytes()),
    ];
    let write = |(name, content): (&str, Vec<u8>)| {
        fs::write(folder.join(name), content).unwrap();
        folder.join(name)
    };
    all.into_iter().map(write).collect()
}

#[track_caller]
fn assert_short(result: Result<Scene, LoadError>, path: &Path, what: &str) {
    let error = result.map(|_| ()).unwrap_err();
    let LoadError::Memory { path: of, what: said, shortage } = &error else { panic!("{}: {error}", path.display()) };
    assert!(shortage.needed > shortage.free && said.contains(what), "{error}");
    assert!(of == path && error.to_string().contains(" of memory needed, "), "{error}");
}

#[test]
fn the_file_and_what_it_unfolds_to_have_to_fit() {
    let folder = tempfile::tempdir().unwrap();
    for path in files(folder.path()) {
        let length = fs::metadata(&path).unwrap().len();
        assert_eq!(read(&path, 1 << 30).unwrap().meshes[0].triangles.len(), 2000, "{}", path.display());
        assert_short(read(&path, length - 1), &path, "the file");
        let buffer = if path.ends_with("a.gltf") { 72_000 } else { 0 };
        assert_short(read(&path, length + buffer + 500), &path, "its ");
    }
}

#[test]
fn a_decoded_picture_has_to_fit_and_nothing_stands_in_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("a.obj"), "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n").unwrap();
    fs::write(path("a.mtl"), "newmtl m\nmap_Kd a.png\n").unwrap();
    image::RgbImage::from_pixel(1000, 1000, image::Rgb([9, 9, 9])).save(path("a.png")).unwrap();
    let scene = read(&path("a.obj"), 64 << 20).unwrap();
    assert_eq!(scene.images[0].texels.len(), 1_000_000);
    // Three bytes a texel three times and four twice, for a moment.
    assert_short(read(&path("a.obj"), 16 << 20), &path("a.mtl"), "the image ");
}

#[test]
fn budgets_are_for_a_whole_scene() {
    let folder = tempfile::tempdir().unwrap();
    files(folder.path());
    let scene = folder.path().join("scene.toml");
    let mesh = |name: &str| format!("[[meshes]]\nfile = \"{name}\"\n");
    let alone = |name: &str| {
        fs::write(&scene, format!("version = 1\n{}", mesh(name))).unwrap();
        read(&scene, 9 << 20).is_ok()
    };
    assert!(["a.obj", "a.ply", "a.stl", "b.stl", "a.gltf"].into_iter().all(alone));
    let many: String = (0..12).map(|_| mesh("a.obj")).collect();
    fs::write(&scene, format!("version = 1\n{many}")).unwrap();
    assert!(read(&scene, 1 << 30).is_ok());
    let error = read(&scene, 9 << 20).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("would not fit: "), "{error}");
}

#[test]
#[cfg(target_os = "linux")]
fn only_regular_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["zero.obj", "zero.ply", "zero.stl", "zero.glb", "zero.toml"] {
        std::os::unix::fs::symlink("/dev/zero", path(name)).unwrap();
        let error = read(&path(name), 1 << 30).map(|_| ()).unwrap_err();
        assert!(matches!(error, LoadError::Unsupported { .. }) && error.to_string().contains("a device"), "{error}");
    }
    // A part is not waited for either: a pipe that nobody writes.
    std::process::Command::new("mkfifo").arg(path("pipe.png")).status().unwrap();
    fs::write(path("a.obj"), "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n").unwrap();
    fs::write(path("a.mtl"), "newmtl m\nmap_Kd pipe.png\n").unwrap();
    let loaded = attempt_within(&path("a.obj"), &LoadOptions::default(), Budget::of(1 << 30)).result.unwrap();
    assert!(loaded.warnings[0].message.contains("it is not a regular file"), "{:?}", loaded.warnings);
}

#[test]
#[cfg(target_os = "linux")]
fn a_file_that_grows_ends_where_it_ended_when_it_was_opened() {
    use std::io::Write;
    use std::sync::atomic::{AtomicBool, Ordering};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.obj");
    fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".repeat(1000)).unwrap();
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut file = fs::OpenOptions::new().append(true).open(&path).unwrap();
            while !done.load(Ordering::Relaxed) {
                file.write_all(&b"# more and more and more\n".repeat(400)).unwrap();
                std::thread::sleep(std::time::Duration::from_micros(200));
            }
        });
        for _ in 0..20 {
            let scene = read(&path, 1 << 30);
            assert!(scene.is_ok_and(|scene| scene.meshes[0].triangles.len() == 1000));
        }
        done.store(true, Ordering::Relaxed);
    });
}
