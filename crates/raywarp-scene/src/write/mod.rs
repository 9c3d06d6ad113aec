//! Files that are whole or not there.

mod error;
mod identity;
mod outputs;
mod temporary;

use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

pub use error::WriteError;
pub(crate) use identity::Identity;
pub use outputs::Outputs;
pub use temporary::beside as temporary;

/// The path that stands for standard output.
pub const STANDARD: &str = "-";

/// Whether a path is `-`.
pub fn is_dash(path: &Path) -> bool {
    path.as_os_str() == STANDARD
}

/// A path for people, who know what `-` stands for.
pub fn name(path: &Path, dash: &str) -> String {
    match is_dash(path) {
        true => dash.to_owned(),
        false => path.display().to_string(),
    }
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
        Target::File(target) => temporary::beside(&target).map(drop).map_err(|e| from_io(path, 0, e)),
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

/// As [`file()`], but only where there is nothing of that name, be it a link that leads nowhere.
///
/// # Errors
/// As [`file()`], and [`WriteError::Exists`].
pub fn new_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    if path.symlink_metadata().is_ok() {
        return Err(WriteError::Exists(path.to_owned()));
    }
    let Target::File(target) = Target::of(path)? else { return Err(WriteError::Exists(path.to_owned())) };
    let written = filled(&target, |file| file.write_all(bytes));
    let written = written.and_then(|file| file.persist_noclobber(&target).map(drop).map_err(|failed| failed.error));
    written.map_err(|error| from_io(path, bytes.len() as u64, error))
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
    let temporary = filled(target, fill)?;
    temporary.persist(target).map(drop).map_err(|failed| failed.error)
}

/// A file beside the target that only lacks its name.
fn filled(target: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<NamedTempFile> {
    let mut temporary = temporary::beside(target)?;
    temporary::take_over_permissions(temporary.as_file(), target)?;
    fill(temporary.as_file_mut())?;
    // Else a power failure could leave the new name with none of the contents.
    temporary.as_file().sync_all()?;
    Ok(temporary)
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

    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_permissions_and_a_new_one_has_the_usual_ones() {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir().unwrap();
        let (path, usual) = (directory.path().join("a.png"), directory.path().join("usual"));
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        fs::write(&usual, "").unwrap();
        file(&path, b"new").unwrap();
        assert_eq!(mode(&path), mode(&usual));
        for bits in [0o640, 0o600, 0o666] {
            fs::set_permissions(&path, fs::Permissions::from_mode(bits)).unwrap();
            file(&path, b"newer").unwrap();
            assert_eq!(mode(&path) & 0o777, bits);
        }
    }

    #[test]
    fn a_new_file_replaces_nothing() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        new_file(&path, b"first").unwrap();
        assert!(matches!(new_file(&path, b"second"), Err(WriteError::Exists(_))));
        assert_eq!((fs::read(&path).unwrap(), names(directory.path())), (b"first".to_vec(), vec!["a.png".to_owned()]));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_told_with_what_is_needed() {
        let error = file(Path::new("/dev/full"), &[0; 5000]).unwrap_err();
        assert!(error.to_string().contains("the disk is full (5000 bytes are needed)"), "{error}");
    }

    #[test]
    fn what_cannot_be_written_is_said() {
        let directory = tempfile::tempdir().unwrap();
        let inside = |name: &str| directory.path().join(name);
        assert!(matches!(file(directory.path(), b""), Err(WriteError::Directory(_))));
        assert!(matches!(check(&inside("none/a.png")), Err(WriteError::NoDirectory { .. })));
        assert!(names(directory.path()).is_empty());
        let gone = inside("gone");
        fs::create_dir(&gone).unwrap();
        let vanished = with(&gone.join("a.png"), 0, |_| fs::remove_dir_all(&gone)).unwrap_err();
        assert!(matches!(vanished, WriteError::NoDirectory { .. }), "{vanished}");
    }
}
