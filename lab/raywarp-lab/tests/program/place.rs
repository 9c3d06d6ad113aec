//! A folder of its own for a test, and the program in it.

use std::path::PathBuf;
use std::process::{Command, Output};

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

    pub fn run(&self, arguments: &[&str]) -> Run {
        let mut command = Command::new(env!("CARGO_BIN_EXE_raywarp-lab"));
        command.env("RAYWARP_CACHE", "").env_remove("RUST_BACKTRACE");
        Run(command.args(arguments).current_dir(self.0.path()).output().unwrap())
    }
}

/// What came of it.
pub struct Run(Output);

impl Run {
    fn said(&self) -> String {
        String::from_utf8_lossy(&self.0.stderr).into_owned()
    }

    pub fn out(&self) -> String {
        String::from_utf8_lossy(&self.0.stdout).into_owned()
    }

    #[track_caller]
    pub fn succeeds(self) -> Self {
        assert_eq!(self.0.status.code(), Some(0), "{}", self.said());
        self
    }

    /// Ends with a code and says a sentence, as an error and without a panic.
    #[track_caller]
    pub fn fails(self, code: i32, sentence: &str) -> Self {
        let said = self.said();
        assert_eq!(self.0.status.code(), Some(code), "{said}");
        assert!(said.contains(sentence) && said.contains("error: ") && !said.contains("panicked"), "{said}");
        self
    }
}

/// A triangle before a camera.
pub const SCENE: &str = r#"
version = 1

[[materials]]
name = "grey"

[[meshes]]
vertices = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]]
faces = [[0, 1, 2]]
material = "grey"

[[cameras]]
name = "near"
eye = [0, 0, 4]
target = [0, 0, 0]
"#;
