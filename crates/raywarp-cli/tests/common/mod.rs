//! Runs the program as a shell would.
#![allow(dead_code, missing_docs)]

pub mod browser;
pub mod server;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A directory of its own for a test, and the program in it.
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

    /// Every name in the directory, in order.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        // Where these tests were copied to another machine, the program is elsewhere.
        let copied = std::env::var_os("RAYWARP_PROGRAM");
        let mut command = Command::new(copied.unwrap_or_else(|| env!("CARGO_BIN_EXE_raywarp").into()));
        // The trees of tests are nobody's to keep.
        command.env("RAYWARP_CACHE", "").env_remove("RAYWARP_TOKEN");
        command.args(arguments).current_dir(self.0.path()).env("COLUMNS", "100").env_remove("RUST_BACKTRACE");
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Run {
        Run(self.command(arguments).output().unwrap(), arguments.join(" "))
    }

    /// `render` on the CPU with the given arguments.
    pub fn render(&self, arguments: &[&str]) -> Run {
        self.run(&[&["render", "--device", "cpu"], arguments].concat())
    }
}

/// What came of it.
pub struct Run(pub Output, pub String);

impl Run {
    pub fn code(&self) -> i32 {
        self.0.status.code().unwrap_or(-1)
    }

    pub fn out(&self) -> String {
        String::from_utf8_lossy(&self.0.stdout).into_owned()
    }

    pub fn err(&self) -> String {
        String::from_utf8_lossy(&self.0.stderr).into_owned()
    }

    #[track_caller]
    pub fn succeeds(self) -> Self {
        assert_eq!(self.code(), 0, "{}: {}", self.1, self.err());
        self
    }

    /// Ends with a code and says a sentence, as an error and without a panic.
    #[track_caller]
    pub fn fails(self, code: i32, sentence: &str) -> Self {
        let said = self.err();
        assert_eq!(self.code(), code, "{}: {said}", self.1);
        assert!(said.contains(sentence) && said.contains("error: "), "{}: {said}", self.1);
        assert!(!said.contains("panicked"), "{}: {said}", self.1);
        self
    }

    /// Succeeds and says a sentence.
    #[track_caller]
    pub fn says(self, sentence: &str) -> Self {
        assert!(self.err().contains(sentence), "{}: {}", self.1, self.err());
        self.succeeds()
    }
}

/// Decoded sRGB bytes of a PNG: width, height, pixels.
pub fn png(path: &Path) -> (u32, u32, Vec<[u8; 3]>) {
    let image = image::open(path).unwrap().to_rgb8();
    (image.width(), image.height(), image.pixels().map(|pixel| pixel.0).collect())
}

/// A red triangle in front of a constant background, with two cameras: "near", and "away" which sees no triangle.
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

[[cameras]]
name = "away"
eye = [0, 0, 4]
target = [0, 0, 8]
"#;
