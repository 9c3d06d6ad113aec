//! A folder of its own for a test, and the program in it.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder that goes with the test.
pub struct Place(tempfile::TempDir);

impl Place {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), contents).unwrap();
    }

    /// Every name in the folder, in order.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_raywarp-window"));
        // The trees of tests are nobody's to keep.
        command.env("RAYWARP_CACHE", "").env_remove("RUST_BACKTRACE");
        command.args(arguments).current_dir(self.0.path());
        command
    }
}

/// Decoded sRGB bytes of a PNG: width, height, pixels.
pub fn png(path: &Path) -> (u32, u32, Vec<[u8; 3]>) {
    let image = image::open(path).unwrap().to_rgb8();
    (image.width(), image.height(), image.pixels().map(|pixel| pixel.0).collect())
}

/// A red triangle in front of a green background.
pub const SCENE: &str = r#"
version = 1
background = [0.25, 0.5, 0.125]
ambient = 0

[[materials]]
name = "red"
diffuse = 0
emission = [0.5, 0, 0]

[[meshes]]
vertices = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]]
faces = [[0, 1, 2]]
material = "red"

[[lights]]
kind = "directional"
direction = [0, 0, -1]

[[cameras]]
name = "near"
eye = [0, 0, 4]
target = [0, 0, 0]
"#;
