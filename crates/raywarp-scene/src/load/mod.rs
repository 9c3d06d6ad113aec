//! From files to a [`Scene`]: the extension picks the reader.

mod colors;
mod environment;
mod error;
mod gltf;
mod hash;
mod images;
mod mtl;
mod obj;
mod ply;
mod precision;
pub mod quote;
pub(crate) mod repair;
mod source;
mod stl;
mod text;
pub(crate) mod toml;
mod triangulate;
mod untextured;

use std::path::{Path, PathBuf};

use super::Scene;
use crate::memory::Budget;
pub use environment::environment;
pub use error::{LoadError, Place};
pub use source::{LoadOptions, Sources, Warning};

/// A scene and what had to be dropped or replaced to get it.
#[derive(Debug, Default)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// Each thing that is not as the file asks, once, in the order found.
    pub warnings: Vec<Warning>,
    /// What is as the file asks and yet worth knowing, such as digits that single precision does not hold.
    /// [`LoadOptions::strict`] makes no errors of these.
    pub notes: Vec<Warning>,
    /// Every file on disk that is part of the scene, textures and missing ones included, once, in the order asked for:
    /// the scene may change when one of them does.
    pub files: Vec<PathBuf>,
}

/// What became of reading a scene.
#[derive(Debug)]
pub struct Attempt {
    /// The scene, or why there is none.
    pub result: Result<Loaded, LoadError>,
    /// The files that were asked for until then, as [`Loaded::files`].
    pub files: Vec<PathBuf>,
}

/// Extensions that [`load`] knows, without the dot.
pub const EXTENSIONS: [&str; 6] = ["obj", "ply", "stl", "gltf", "glb", "toml"];

/// What the built-in scene is called where a scene file starts from it.
pub const BUILT_IN: &str = "built-in";

/// Its files; the first names the others.
const BUILT_IN_FILES: [(&str, &[u8]); 2] = [
    ("built-in/paper.toml", include_bytes!("../../built-in/paper.toml")),
    ("built-in/suzanne.ply", include_bytes!("../../built-in/suzanne.ply")),
];

/// Reads a scene from a file, with all the files it names.
///
/// # Errors
/// [`LoadError`] names the file, the place, what was read, what was expected and what to do. With
/// [`LoadOptions::strict`] the first warning is an error too.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded, LoadError> {
    attempt(path, options).result
}

/// As [`load`], and says which files were asked for even where it fails: one of them may become whole later.
pub fn attempt(path: &Path, options: &LoadOptions) -> Attempt {
    attempt_within(path, options, Budget::of_machine())
}

/// As [`attempt`], in so much memory: files, decoders at their peaks, decoded pictures, geometry and instances together.
pub fn attempt_within(path: &Path, options: &LoadOptions, budget: Budget) -> Attempt {
    let mut sources = Sources::within(options, budget);
    let scene = read(path, &mut sources);
    let files = sources.files().to_vec();
    Attempt { result: scene.map(|scene| sources.into_loaded(scene)), files }
}

/// The scene that is part of the program: the figure of the paper, Suzanne in a box of mirrors.
///
/// # Errors
/// None unless raywarp was built from a broken scene.
pub fn builtin() -> Result<Loaded, LoadError> {
    let mut sources = Sources::new(&LoadOptions::default());
    let path = sources.add_built_in();
    let scene = read(&path, &mut sources)?;
    Ok(sources.into_loaded(scene))
}

/// Reads one file of any known format; scene files call it for the meshes they name.
pub(crate) fn read(path: &Path, sources: &mut Sources) -> Result<Scene, LoadError> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let mut scene = match extension.as_str() {
        "obj" => obj::read(path, sources),
        "ply" => ply::read(path, sources),
        "stl" => stl::read(path, sources),
        "gltf" | "glb" => gltf::read(path, sources),
        "toml" => toml::read(path, sources),
        _ => Err(LoadError::unknown_format(path)),
    }?;
    untextured::settle(path, &mut scene, sources)?;
    Ok(scene)
}

#[cfg(test)]
mod tests_of_memory;

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn names(files: &[PathBuf]) -> Vec<String> {
        let name = |file: &PathBuf| file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        files.iter().map(name).collect()
    }

    /// Whatever a file says, messages are text that no terminal obeys.
    #[test]
    fn control_characters_never_reach_a_message() {
        let folder = tempfile::tempdir().unwrap();
        let gltf = r#"{"asset":{"version":"2.0"},"extensionsUsed":["A_\u001b[31m"],"buffers":[{"byteLength":4,
                       "uri":"b\u001b[31m.bin"}],"accessors":[{"bufferView":0,"componentType":5126,"count":1,"type":"VEC3"}],
                       "bufferViews":[{"buffer":0,"byteLength":4}],"meshes":[{"name":"\u001b","primitives":[{"attributes":
                       {"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]}"#;
        for (name, text) in [
            (
                "a.obj",
                "mtllib b\u{1b}[31m.mtl\nv 0 0 0\n\u{1b}[31m\ng \u{9b}31m\nusemtl \u{1b}c\nf 1 1 1 \nx\u{202e} 1",
            ),
            ("b.obj", "v 0 \u{1b}[31m 0"),
            (
                "a.ply",
                "ply\nformat ascii 1.0\ncomment TextureFile \u{1b}[31m.png\nelement vertex 1\nproperty float \u{1b}\n",
            ),
            ("a.stl", "solid \u{1b}\n\u{1b}[31m\nvertex 1 \u{1b} 1"),
            ("a.gltf", gltf),
            ("a.toml", "version = 1\n[[meshes]]\nfile = \"\\u001b[31m.obj\""),
            ("b.toml", "version = 1\n[[instances]]\nmesh = \"\\u001b[31m\""),
            ("c.toml", "version = 1\nbase = \"\\u001b[31m\\n.obj\""),
        ] {
            let path = folder.path().join(name);
            fs::write(&path, text).unwrap();
            let messages = match load(&path, &LoadOptions::default()) {
                Ok(loaded) => loaded.warnings.iter().map(ToString::to_string).collect(),
                Err(error) => vec![error.to_string()],
            };
            assert!(!messages.is_empty(), "{name} has something to say");
            let garbled = |message: &String| message.contains(|c: char| c.is_control() || c == '\u{202e}');
            assert!(!messages.iter().any(garbled), "{name}: {messages:?}");
        }
    }

    #[test]
    fn the_files_of_a_scene_are_known_even_where_it_fails() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("scene.toml"), "version = 1\n[[meshes]]\nfile = \"a.obj\"\n").unwrap();
        let obj = "mtllib a.mtl\nmtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
        fs::write(path("a.obj"), obj).unwrap();
        fs::write(path("a.mtl"), "newmtl m\nmap_Kd lost.png\nmap_Ks lost.png\n").unwrap();
        let all = ["scene.toml", "a.obj", "a.mtl", "lost.png", "none.mtl"];
        let loaded = load(&path("scene.toml"), &LoadOptions::default()).unwrap();
        assert_eq!(names(&loaded.files), all);

        let strict = attempt(&path("scene.toml"), &LoadOptions { strict: true });
        assert!(strict.result.is_err());
        assert_eq!(names(&strict.files), &all[..4]);
        fs::remove_file(path("a.obj")).unwrap();
        let failed = attempt(&path("scene.toml"), &LoadOptions::default());
        assert!(failed.result.is_err());
        assert_eq!(names(&failed.files), &all[..2]);
        assert!(builtin().unwrap().files.is_empty());
    }
}
