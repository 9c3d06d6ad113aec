//! Files that are whole or not there.

mod error;

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

pub use error::WriteError;

/// Whether a path is `-`.
pub fn is_dash(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Finds out whether [`file()`] can be expected to succeed, before hours of work.
///
/// # Errors
/// As [`file()`].
pub fn check(path: &Path) -> Result<(), WriteError> {
    if is_dash(path) {
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
/// [`WriteError`] with the reason; no temporary file is left then.
pub fn file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let written = if is_dash(path) {
        to_standard_output(|output| output.write_all(bytes))
    } else {
        match Target::of(path)? {
            Target::Special(target) => to_special(&target, |output| output.write_all(bytes)),
            Target::File(target) => replace(&target, |file| file.write_all(bytes)),
        }
    };
    written.map_err(|error| from_io(path, bytes.len() as u64, error))
}

/// As [`file()`] for what need not fit in memory, of about `bytes` bytes: `fill` writes it into an empty file, and may
/// go back in it.
///
/// # Errors
/// As [`file()`].
pub fn with(path: &Path, bytes: u64, fill: impl FnOnce(&mut File) -> io::Result<()>) -> Result<(), WriteError> {
    let written = if is_dash(path) {
        by_way_of_a_file(fill).and_then(|mut file| to_standard_output(|output| io::copy(&mut file, output).map(drop)))
    } else {
        match Target::of(path)? {
            Target::Special(target) => by_way_of_a_file(fill)
                .and_then(|mut file| to_special(&target, |output| io::copy(&mut file, output).map(drop))),
            Target::File(target) => replace(&target, fill),
        }
    };
    written.map_err(|error| from_io(path, bytes, error))
}

/// What a pipe gets has to be in order: a file without a name holds it until it is.
fn by_way_of_a_file(fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<File> {
    let mut file = tempfile::tempfile()?;
    fill(&mut file)?;
    file.rewind()?;
    Ok(file)
}

fn to_standard_output(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut output = io::stdout().lock();
    write(&mut output)?;
    output.flush()
}

fn to_special(target: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    write(&mut OpenOptions::new().write(true).open(target)?)
}

fn from_io(path: &Path, bytes: u64, error: io::Error) -> WriteError {
    WriteError::from_io(path.to_owned(), bytes, error)
}

/// The folder of a file that is to be written; the working directory's for a bare name and for standard output.
pub fn directory_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// What is at the end of a path and its symbolic links.
enum Target {
    /// A regular file, or nothing yet.
    File(PathBuf),
    /// A device or a pipe: nothing could be renamed over it.
    Special(PathBuf),
}

impl Target {
    fn of(path: &Path) -> Result<Self, WriteError> {
        match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => Err(WriteError::Directory(path.to_owned())),
            Ok(metadata) => {
                let target = fs::canonicalize(path).map_err(|error| from_io(path, 0, error))?;
                Ok(if metadata.is_file() { Self::File(target) } else { Self::Special(target) })
            }
            Err(_) => Self::new_file(path),
        }
    }

    fn new_file(path: &Path) -> Result<Self, WriteError> {
        if path.file_name().is_none() {
            return Err(WriteError::Directory(path.to_owned()));
        }
        let directory = directory_of(path);
        if !directory.is_dir() {
            return Err(WriteError::NoDirectory { path: path.to_owned(), directory });
        }
        Ok(Self::File(path.to_owned()))
    }
}

fn replace(target: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let mut temporary = Temporary::create(target)?;
    fill(&mut temporary.file)?;
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

    #[test]
    fn a_file_that_is_not_finished_never_was() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.npz");
        file(&path, b"old").unwrap();
        let failed = with(&path, 0, |file| file.write_all(b"half").and(Err(io::Error::other("no more"))));
        assert!(matches!(failed, Err(WriteError::Write { .. })));
        assert_eq!((fs::read(&path).unwrap(), names(directory.path())), (b"old".to_vec(), vec!["a.npz".to_owned()]));
        with(&path, 3, |file| file.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
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
        assert!(matches!(file(directory.path(), b""), Err(WriteError::Directory(_))));
        assert!(matches!(check(&inside("none/a.png")), Err(WriteError::NoDirectory { .. })));
        assert!(names(directory.path()).is_empty());
    }
}
