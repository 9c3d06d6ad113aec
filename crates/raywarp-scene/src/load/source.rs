//! The files behind a scene: opened with limits, warned about once.

use std::collections::{HashMap, HashSet};
use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::error::Place;
use super::images::ImageIndices;
use super::quote::printable;
use super::{LoadError, Loaded};
use crate::memory::{Budget, Shortage};
use crate::Scene;

/// How forgiving reading is.
#[derive(Clone, Copy, Debug, Default)]
pub struct LoadOptions {
    /// Warnings are errors.
    pub strict: bool,
}

/// Something that is not as the file asks, and what was done instead. Shown, it is one line of printable text.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Warning {
    /// The file that asks.
    pub path: PathBuf,
    /// Where it asks.
    pub line: Option<usize>,
    /// What is wrong and what was done, a sentence without the full stop.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", printable(&self.path.to_string_lossy()))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}", printable(&self.message))
    }
}

/// What the readers share while one scene is read.
pub struct Sources {
    options: LoadOptions,
    budget: Budget,
    warnings: Vec<Warning>,
    notes: Vec<Warning>,
    seen: HashSet<Warning>,
    pub(super) images: ImageIndices,
    /// Files in memory, by their paths.
    files: HashMap<PathBuf, Vec<u8>>,
    /// Scene files that are being read, each named by the one before.
    nesting: Vec<PathBuf>,
    /// How often each file was read as part of a scene.
    uses: HashMap<PathBuf, usize>,
    /// Files on disk that were asked for, in order, each once.
    asked: Vec<PathBuf>,
    asked_before: HashSet<PathBuf>,
}

/// Most scene files within each other.
const MAX_NESTING: usize = 16;
/// Most times that one file is read: placing it again costs nothing, reading it again all of it.
const MAX_USES: usize = 64;

impl Sources {
    /// No file read yet. The memory is what this process can have now.
    pub fn new(options: &LoadOptions) -> Self {
        Self::within(options, Budget::of_machine())
    }

    /// The same with a budget of memory.
    pub fn within(options: &LoadOptions, budget: Budget) -> Self {
        Self {
            options: *options,
            budget,
            warnings: Vec::new(),
            notes: Vec::new(),
            seen: HashSet::new(),
            images: ImageIndices::default(),
            files: HashMap::new(),
            nesting: Vec::new(),
            uses: HashMap::new(),
            asked: Vec::new(),
            asked_before: HashSet::new(),
        }
    }

    /// What the scene may still take. Whoever allocates by what a file says asks it first.
    pub(super) fn budget(&self) -> &Budget {
        &self.budget
    }

    /// Files that are read from memory: paths and contents. They hide files of the same paths on disk.
    pub fn with_files(mut self, files: &[(&str, &[u8])]) -> Self {
        self.files.extend(files.iter().map(|(path, bytes)| (PathBuf::from(path), bytes.to_vec())));
        self
    }

    /// Makes the built-in scene readable, at the path returned.
    pub(super) fn add_built_in(&mut self) -> PathBuf {
        for (path, bytes) in super::BUILT_IN_FILES {
            self.files.insert(PathBuf::from(path), bytes.to_vec());
        }
        PathBuf::from(super::BUILT_IN_FILES[0].0)
    }

    /// Notes that a scene file is being read; [`leave`](Self::leave) must follow.
    ///
    /// # Errors
    /// [`LoadError::Unsupported`] for a file within itself, [`LoadError::TooLarge`] for too many within each other.
    pub(super) fn enter(&mut self, path: &Path) -> Result<(), LoadError> {
        let real = real_path(path);
        if self.nesting.contains(&real) {
            return Err(LoadError::Unsupported {
                path: path.to_owned(),
                place: Place::File,
                what: "a scene file that names itself, be it by way of others,".to_owned(),
                help: "Take it out of its own meshes, and do not make it its own base.".to_owned(),
            });
        }
        if self.nesting.len() == MAX_NESTING {
            return Err(LoadError::TooLarge {
                path: path.to_owned(),
                place: Place::File,
                what: format!("more than {MAX_NESTING} scene files name each other"),
                help: "Name the meshes themselves.".to_owned(),
            });
        }
        self.nesting.push(real);
        Ok(())
    }

    /// Notes that the last scene file is done.
    pub(super) fn leave(&mut self) {
        self.nesting.pop();
    }

    /// Notes that a file becomes part of a scene.
    ///
    /// # Errors
    /// [`LoadError::TooLarge`] where that happens too often.
    pub(super) fn count_use(&mut self, path: &Path) -> Result<(), LoadError> {
        let uses = self.uses.entry(real_path(path)).or_default();
        *uses += 1;
        if *uses > MAX_USES {
            return Err(LoadError::TooLarge {
                path: path.to_owned(),
                place: Place::File,
                what: format!("it is read more than {MAX_USES} times"),
                help: "Name it once in [[meshes]] and place it with [[instances]].".to_owned(),
            });
        }
        Ok(())
    }

    /// Records a warning, the same one only once.
    ///
    /// # Errors
    /// [`LoadError::Strict`] where warnings are errors.
    pub fn warn(&mut self, path: &Path, line: Option<usize>, message: impl Into<String>) -> Result<(), LoadError> {
        let warning = Warning { path: path.to_owned(), line, message: message.into() };
        if self.options.strict {
            return Err(LoadError::Strict(warning));
        }
        if self.seen.insert(warning.clone()) {
            self.warnings.push(warning);
        }
        Ok(())
    }

    /// Records what a person may want to know of a file and what is as it asks: no reason to refuse it, whatever the
    /// options say.
    pub(super) fn inform(&mut self, path: &Path, message: String) {
        let note = Warning { path: path.to_owned(), line: None, message };
        if self.seen.insert(note.clone()) {
            self.notes.push(note);
        }
    }

    /// Whether there is such a file, in memory or on disk.
    pub(super) fn has(&self, path: &Path) -> bool {
        self.files.contains_key(path) || path.exists()
    }

    /// The whole file.
    ///
    /// # Errors
    /// [`LoadError::Io`] for a missing or unreadable file, [`LoadError::Unsupported`] for what is no regular file: a
    /// directory holds nothing to read, and a pipe or a device might never end; [`LoadError::Memory`] for one that does not
    /// fit.
    pub fn bytes(&mut self, path: &Path) -> Result<Vec<u8>, LoadError> {
        if let Some(bytes) = self.files.get(path) {
            return Ok(bytes.clone());
        }
        self.note(path);
        match read_regular(path, &self.budget) {
            Ok(bytes) => Ok(bytes),
            Err(Unread::Io(source)) => {
                Err(LoadError::Io { path: path.to_owned(), help: help_for(&source).to_owned(), source })
            }
            Err(Unread::NotAFile { is_directory }) => Err(not_a_file(path, is_directory)),
            Err(Unread::Memory(shortage)) => Err(LoadError::memory(path, "the file")(shortage)),
        }
    }

    /// Notes that a file on disk is part of the scene, be it missing.
    pub(super) fn note(&mut self, path: &Path) {
        if self.asked_before.insert(path.to_owned()) {
            self.asked.push(path.to_owned());
        }
    }

    /// What was recorded, in order.
    pub fn into_warnings(self) -> Vec<Warning> {
        self.warnings
    }

    /// The files on disk that were asked for, in order, each once.
    pub fn files(&self) -> &[PathBuf] {
        &self.asked
    }

    /// The scene that was read, with what was recorded on the way.
    pub(super) fn into_loaded(self, scene: Scene) -> Loaded {
        Loaded { scene, warnings: self.warnings, notes: self.notes, files: self.asked }
    }
}

/// Why a file was not read.
pub(super) enum Unread {
    Io(std::io::Error),
    NotAFile { is_directory: bool },
    Memory(Shortage),
}

/// The bytes that a regular file had when it was opened: one that grows meanwhile ends there.
pub(super) fn read_regular(path: &Path, budget: &Budget) -> Result<Vec<u8>, Unread> {
    // Before it is opened, as the opening of a pipe waits for a writer; and after, as it may be another then.
    let check = |metadata: std::fs::Metadata| match metadata.is_file() {
        true => Ok(metadata.len()),
        false => Err(Unread::NotAFile { is_directory: metadata.is_dir() }),
    };
    check(std::fs::metadata(path).map_err(Unread::Io)?)?;
    let file = File::open(path).map_err(Unread::Io)?;
    let length = check(file.metadata().map_err(Unread::Io)?)?;
    budget.take(length).map_err(Unread::Memory)?;
    let mut bytes = Vec::new();
    // Files of the kernel say 0 and have more: they are read as empty.
    bytes.try_reserve_exact(length as usize).map_err(|_| Unread::Memory(Shortage { needed: length, free: 0 }))?;
    file.take(length).read_to_end(&mut bytes).map_err(Unread::Io)?;
    Ok(bytes)
}

/// One path for one file; the path itself where there is no such file.
fn real_path(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

fn not_a_file(path: &Path, is_directory: bool) -> LoadError {
    let (what, help) = if is_directory {
        ("a directory as a scene", "Name the scene file inside it.")
    } else {
        ("a pipe or a device as a scene", "Write it to a file first.")
    };
    LoadError::Unsupported { path: path.to_owned(), place: Place::File, what: what.to_owned(), help: help.to_owned() }
}

fn help_for(error: &std::io::Error) -> &'static str {
    match error.kind() {
        std::io::ErrorKind::NotFound => "Check the path.",
        std::io::ErrorKind::PermissionDenied => "Check the file's permissions.",
        _ => "Check the file and the disk.",
    }
}
