//! What a run reads and what it writes: no file is both, and none is written twice.

use std::collections::HashMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use super::{directory_of, temporary, Identity, WriteError};

/// The files of a run, held against each other before anything is written.
///
/// Names do not matter, files do: links of both kinds are followed, and a file that is named but missing counts too.
///
/// ```
/// use std::path::Path;
/// use raywarp_scene::write::Outputs;
///
/// let mut outputs = Outputs::default();
/// outputs.reads([Path::new("model.obj")])?;
/// outputs.add(Path::new("picture.png"))?;
/// assert!(outputs.reads([Path::new("./picture.png")]).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct Outputs {
    read: Files,
    written: Files,
    /// Outputs without a file, such as a pipe, which are told apart by name.
    streams: Vec<PathBuf>,
}

impl Outputs {
    /// Notes files that the run reads, be they missing.
    ///
    /// # Errors
    /// [`WriteError::Read`] where one of them is an output.
    pub fn reads<P: AsRef<Path>>(&mut self, paths: impl IntoIterator<Item = P>) -> Result<(), WriteError> {
        for path in paths {
            let path = path.as_ref();
            if let Some(file) = Identity::of(path) {
                self.note_read(file, path)?;
            }
        }
        Ok(())
    }

    /// Notes that the run reads standard input, which may come from a file.
    ///
    /// # Errors
    /// [`WriteError::Read`] where that file is an output.
    pub fn reads_standard_input(&mut self) -> Result<(), WriteError> {
        match Identity::of_standard_input() {
            Some(file) => self.note_read(file, Path::new("-")),
            None => Ok(()),
        }
    }

    fn note_read(&mut self, file: Identity, path: &Path) -> Result<(), WriteError> {
        if let Some(output) = self.written.find(&file) {
            return Err(WriteError::Read { path: output.to_owned(), read: path.to_owned() });
        }
        self.read.insert(file, path);
        Ok(())
    }

    /// Notes a file that the run will write; `-` is standard output. Whether it can be written is
    /// [`check`](super::check)'s to find out.
    ///
    /// # Errors
    /// [`WriteError::Read`] for a file that the run reads, [`WriteError::Twice`] for another output.
    pub fn add(&mut self, path: &Path) -> Result<(), WriteError> {
        let Some(file) = Identity::of(path) else { return self.add_stream(path) };
        if let Some(read) = self.read.find(&file) {
            return Err(WriteError::Read { path: path.to_owned(), read: read.to_owned() });
        }
        if let Some(other) = self.written.find(&file) {
            return Err(WriteError::Twice { path: path.to_owned(), other: other.to_owned() });
        }
        self.written.insert(file, path);
        Ok(())
    }

    fn add_stream(&mut self, path: &Path) -> Result<(), WriteError> {
        if self.streams.iter().any(|other| other == path) {
            return Err(WriteError::Twice { path: path.to_owned(), other: path.to_owned() });
        }
        self.streams.push(path.to_owned());
        Ok(())
    }

    /// As [`write::file`](super::file()), once more held against all that was read: links may lead elsewhere by now.
    ///
    /// # Errors
    /// As [`write::file`](super::file()), and [`WriteError::Read`].
    pub fn file(&self, path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
        self.allow(path)?;
        super::file(path, bytes)
    }

    /// As [`write::with`](super::with), once more held against all that was read.
    ///
    /// # Errors
    /// As [`write::with`](super::with), and [`WriteError::Read`].
    pub fn with(
        &self,
        path: &Path,
        bytes: u64,
        fill: impl FnOnce(&mut File) -> io::Result<()>,
    ) -> Result<(), WriteError> {
        self.allow(path)?;
        super::with(path, bytes, fill)
    }

    /// Whether a file is none that was read.
    ///
    /// # Errors
    /// [`WriteError::Read`] if it is.
    pub fn allow(&self, path: &Path) -> Result<(), WriteError> {
        match Identity::of(path).and_then(|file| self.read.find(&file)) {
            Some(read) => Err(WriteError::Read { path: path.to_owned(), read: read.to_owned() }),
            None => Ok(()),
        }
    }
}

/// Files and the names that they were given.
#[derive(Debug, Default)]
struct Files {
    names: HashMap<Identity, PathBuf>,
    /// Files that are not there, by their paths in small letters: some file systems tell no others apart.
    missing: HashMap<String, PathBuf>,
}

impl Files {
    fn insert(&mut self, file: Identity, name: &Path) {
        if let Identity::Path(path) = &file {
            self.missing.entry(small(path)).or_insert_with(|| name.to_owned());
        }
        self.names.entry(file).or_insert_with(|| name.to_owned());
    }

    fn find(&self, file: &Identity) -> Option<&Path> {
        let found = self.names.get(file).map(PathBuf::as_path);
        found.or_else(|| self.find_in_other_letters(file))
    }

    fn find_in_other_letters(&self, file: &Identity) -> Option<&Path> {
        let Identity::Path(path) = file else { return None };
        let other = self.missing.get(&small(path))?;
        takes_letters_for_equal(&directory_of(path)).then_some(other)
    }
}

fn small(path: &Path) -> String {
    path.to_string_lossy().to_lowercase()
}

/// Whether `A` and `a` are one file in a folder, which only a trial tells: it is the file system's choice, not the
/// platform's.
fn takes_letters_for_equal(folder: &Path) -> bool {
    let Ok(trial) = temporary::beside(&folder.join("trial")) else { return false };
    let name = trial.path().file_name().unwrap_or_default().to_string_lossy().to_uppercase();
    folder.join(name).exists()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn place() -> (tempfile::TempDir, impl Fn(&str) -> PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_owned();
        (folder, move |name: &str| path.join(name))
    }

    #[test]
    fn what_is_read_is_not_written_in_whichever_order_it_is_told() {
        let (_folder, at) = place();
        fs::write(at("a.png"), "").unwrap();
        for name in ["a.png", "missing.png"] {
            let mut outputs = Outputs::default();
            outputs.reads([at(name)]).unwrap();
            assert!(matches!(outputs.add(&at(name)), Err(WriteError::Read { .. })), "{name}");
            assert!(matches!(outputs.file(&at(name), b"new"), Err(WriteError::Read { .. })), "{name}");

            let mut outputs = Outputs::default();
            outputs.add(&at(name)).unwrap();
            assert!(matches!(outputs.reads([at(name)]), Err(WriteError::Read { .. })), "{name}");
        }
        assert_eq!(fs::read(at("a.png")).unwrap(), b"");
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_to_what_is_read() {
        let (_folder, at) = place();
        fs::write(at("scene.toml"), "scene").unwrap();
        std::os::unix::fs::symlink("scene.toml", at("soft.png")).unwrap();
        fs::hard_link(at("scene.toml"), at("hard.png")).unwrap();
        let mut outputs = Outputs::default();
        outputs.reads([at("scene.toml")]).unwrap();
        for name in ["soft.png", "hard.png"] {
            let said = outputs.add(&at(name)).unwrap_err().to_string();
            let sentence = format!("{}: it is the same file as {}", at(name).display(), at("scene.toml").display());
            assert!(said.contains(&sentence), "{said}");
        }
        // One that comes to lead there later is found when it is written.
        outputs.add(&at("late.png")).unwrap();
        std::os::unix::fs::symlink("scene.toml", at("late.png")).unwrap();
        assert!(outputs.file(&at("late.png"), b"new").is_err());
        assert!(outputs.with(&at("late.png"), 0, |_| Ok(())).is_err());
        assert_eq!(fs::read(at("scene.toml")).unwrap(), b"scene");
    }

    #[test]
    fn no_file_is_written_twice() {
        let (folder, at) = place();
        let mut outputs = Outputs::default();
        outputs.add(&at("a.png")).unwrap();
        assert!(outputs.add(&at("a.png")).unwrap_err().to_string().starts_with("two outputs have the same name"));
        let other = folder.path().join(".").join("a.png");
        assert!(matches!(outputs.add(&other), Err(WriteError::Twice { .. })));
        outputs.add(&at("b.png")).unwrap();
        assert_eq!(outputs.add(&at("A.PNG")).is_err(), takes_letters_for_equal(folder.path()));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[cfg(unix)]
    #[test]
    fn devices_may_be_read_and_written() {
        let mut outputs = Outputs::default();
        outputs.reads([Path::new("/dev/null")]).unwrap();
        outputs.add(Path::new("/dev/null")).unwrap();
        outputs.file(Path::new("/dev/null"), b"gone").unwrap();
    }
}
