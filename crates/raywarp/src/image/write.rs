//! Files that are whole or not there.

use std::ffi::OsString;
use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::ImageError;

/// Kinds of picture files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Eight bits a channel, sRGB.
    Png,
    /// 32 bits a channel, linear, with layers.
    Exr,
}

impl Format {
    /// What a file's extension asks for; `-` is PNG to standard output.
    ///
    /// # Errors
    /// [`ImageError::UnknownExtension`].
    pub fn of(path: &Path) -> Result<Self, ImageError> {
        if is_standard_output(path) {
            return Ok(Self::Png);
        }
        match path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase().as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(ImageError::UnknownExtension(path.to_owned())),
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Png => "PNG",
            Self::Exr => "EXR",
        })
    }
}

/// Whether a path is `-`.
pub fn is_standard_output(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Finds out whether [`file()`] can be expected to succeed, before hours of rendering.
///
/// # Errors
/// As [`file()`].
pub fn check(path: &Path) -> Result<(), ImageError> {
    if is_standard_output(path) {
        return Ok(());
    }
    match Target::of(path)? {
        Target::Special(_) => Ok(()),
        Target::File(target) => Temporary::create(&target).map(drop).map_err(|e| from_io(path, 0, e)),
    }
}

/// Writes a file by way of a temporary one beside it: at any moment the path holds what it held before or all of
/// `bytes`. A device or a pipe is written to as it is; `-` is standard output.
///
/// # Errors
/// [`ImageError`] with the reason; no temporary file is left then.
pub fn file(path: &Path, bytes: &[u8]) -> Result<(), ImageError> {
    let written = if is_standard_output(path) {
        let mut output = io::stdout().lock();
        output.write_all(bytes).and_then(|()| output.flush())
    } else {
        match Target::of(path)? {
            Target::Special(target) => {
                OpenOptions::new().write(true).open(target).and_then(|mut file| file.write_all(bytes))
            }
            Target::File(target) => replace(&target, bytes),
        }
    };
    written.map_err(|error| from_io(path, bytes.len(), error))
}

fn from_io(path: &Path, bytes: usize, error: io::Error) -> ImageError {
    ImageError::from_io(path.to_owned(), bytes, error)
}

/// What is at the end of a path and its symbolic links.
enum Target {
    /// A regular file, or nothing yet.
    File(PathBuf),
    /// A device or a pipe: nothing could be renamed over it.
    Special(PathBuf),
}

impl Target {
    fn of(path: &Path) -> Result<Self, ImageError> {
        match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => Err(ImageError::Directory(path.to_owned())),
            Ok(metadata) => {
                let target = fs::canonicalize(path).map_err(|error| from_io(path, 0, error))?;
                Ok(if metadata.is_file() { Self::File(target) } else { Self::Special(target) })
            }
            Err(_) => Self::new_file(path),
        }
    }

    fn new_file(path: &Path) -> Result<Self, ImageError> {
        if path.file_name().is_none() {
            return Err(ImageError::Directory(path.to_owned()));
        }
        let directory = directory_of(path);
        if !directory.is_dir() {
            return Err(ImageError::NoDirectory { path: path.to_owned(), directory });
        }
        Ok(Self::File(path.to_owned()))
    }
}

fn directory_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

fn replace(target: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut temporary = Temporary::create(target)?;
    temporary.file.write_all(bytes)?;
    // Else a power failure could leave the new name with none of the contents.
    temporary.file.sync_all()?;
    fs::rename(&temporary.path, target)?;
    temporary.renamed = true;
    Ok(())
}

/// A file beside its target that goes when it is not renamed.
struct Temporary {
    path: PathBuf,
    file: File,
    renamed: bool,
}

impl Temporary {
    fn create(target: &Path) -> io::Result<Self> {
        let mut name = OsString::from(".");
        name.push(target.file_name().unwrap_or_default());
        name.push(format!(".{}.tmp", std::process::id()));
        let path = directory_of(target).join(name);
        // A file of this name is the remains of a process that was killed.
        let file = File::create(&path)?;
        Ok(Self { path, file, renamed: false })
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // Nothing better can be done where even this fails.
            let _ = fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_replaced_and_nothing_is_left_beside_it() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        for contents in [b"first" as &[u8], b"second"] {
            check(&path).unwrap();
            file(&path, contents).unwrap();
            assert_eq!(fs::read(&path).unwrap(), contents);
        }
        assert_eq!(names(directory.path()), ["a.png"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let directory = tempfile::tempdir().unwrap();
        let (path, link) = (directory.path().join("a.png"), directory.path().join("b.png"));
        fs::write(&path, b"old").unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        file(&link, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[test]
    fn what_cannot_be_written_is_said() {
        let directory = tempfile::tempdir().unwrap();
        let inside = |name: &str| directory.path().join(name);
        assert!(matches!(file(directory.path(), b""), Err(ImageError::Directory(_))));
        assert!(matches!(check(&inside("none/a.png")), Err(ImageError::NoDirectory { .. })));
        assert!(matches!(Format::of(&inside("a.gif")), Err(ImageError::UnknownExtension(_))));
        assert!(names(directory.path()).is_empty());
    }
}
