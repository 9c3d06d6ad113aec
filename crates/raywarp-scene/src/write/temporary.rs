//! Files that stand in for their targets until they are whole.
//!
//! A temporary file is created anew under a random name, so no link is followed and nobody can guess it, and is locked
//! while it lives. One that nobody locks was left behind by a run that was killed, and goes when the next run writes into
//! the folder.

use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, SystemTime};

use tempfile::NamedTempFile;

use super::directory_of;

/// What every such name begins and ends with; between them are the machine and random letters.
const PREFIX: &str = ".raywarp-";
const SUFFIX: &str = ".tmp";
/// Letters and digits: 62 to the power of this many names.
const RANDOM: usize = 12;

/// Files of other machines are left alone for so long: their locks may not be seen from here.
const GIVEN_UP: Duration = Duration::from_secs(24 * 3600);

/// Attempts at a file that nobody takes for a leftover before it is locked.
const ATTEMPTS: usize = 8;

/// A new file in the folder of `target`, locked, which goes when it is dropped before it got another name. What earlier
/// runs left in that folder is removed first, once in the life of the program.
///
/// # Errors
/// Where no file can be made in the folder.
pub fn beside(target: &Path) -> io::Result<NamedTempFile> {
    let folder = directory_of(target);
    clear_once(&folder);
    for _ in 1..ATTEMPTS {
        let file = create_in(&folder)?;
        if keep_from_clearing(file.as_file())? {
            return Ok(file);
        }
    }
    create_in(&folder)
}

fn create_in(folder: &Path) -> io::Result<NamedTempFile> {
    let prefix = format!("{PREFIX}{}-", machine().unwrap_or("0"));
    let mut options = OpenOptions::new();
    options.read(true).write(true).create_new(true);
    let mut builder = tempfile::Builder::new();
    // With the permissions of any new file: a picture is no secret of its own.
    builder.prefix(&prefix).suffix(SUFFIX).rand_bytes(RANDOM).make_in(folder, |path| options.open(path))
}

/// The permissions of the file that is about to be replaced, and its owner where that can be had.
pub fn take_over_permissions(file: &File, target: &Path) -> io::Result<()> {
    let Ok(replaced) = fs::metadata(target) else { return Ok(()) };
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        // Only an administrator can give a file away.
        let _ = std::os::unix::fs::fchown(file, Some(replaced.uid()), Some(replaced.gid()));
    }
    file.set_permissions(replaced.permissions())
}

/// Which start of which machine this is: locks are sure to be seen by the programs of one alone.
fn machine() -> Option<&'static str> {
    static MACHINE: OnceLock<Option<String>> = OnceLock::new();
    let read = || fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?.get(..8).map(str::to_owned);
    MACHINE.get_or_init(read).as_deref()
}

fn clear_once(folder: &Path) {
    static CLEARED: OnceLock<Mutex<HashSet<PathBuf>>> = OnceLock::new();
    let cleared = CLEARED.get_or_init(Mutex::default);
    if cleared.lock().unwrap_or_else(PoisonError::into_inner).insert(folder.to_owned()) {
        clear(folder);
    }
}

/// Removes what runs that were killed have left in a folder.
fn clear(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).filter(|path| may_be_left(path)) {
        // One that cannot be opened or removed is left to its owner.
        let Ok(file) = OpenOptions::new().write(true).open(&path) else { continue };
        if lock(&file) == Lock::Held {
            let _ = fs::remove_file(&path);
        }
    }
}

/// Whether a file would be a leftover if nobody held it.
fn may_be_left(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let Some(inner) = name.strip_prefix(PREFIX).and_then(|name| name.strip_suffix(SUFFIX)) else { return false };
    let Some((made_by, random)) = inner.split_once('-') else { return false };
    let is_name = random.len() == RANDOM && random.bytes().all(|letter| letter.is_ascii_alphanumeric());
    let Ok(about) = path.symlink_metadata() else { return false };
    let here = machine() == Some(made_by);
    is_name && about.is_file() && (here || is_old(&about))
}

fn is_old(about: &fs::Metadata) -> bool {
    let age = |changed: SystemTime| changed.elapsed().is_ok_and(|age| age > GIVEN_UP);
    about.modified().is_ok_and(age)
}

/// Locks a new file. Whether it is safe: another program may have taken it for a leftover just before.
fn keep_from_clearing(file: &File) -> io::Result<bool> {
    match lock(file) {
        Lock::Taken => Ok(false),
        // Where there are no locks nothing is cleared.
        Lock::Unknown => Ok(true),
        Lock::Held => has_name(file),
    }
}

/// What came of locking a file.
#[derive(Debug, PartialEq)]
enum Lock {
    Held,
    /// Somebody else holds it.
    #[cfg_attr(not(unix), allow(dead_code))]
    Taken,
    /// The file system has no locks.
    #[cfg_attr(not(unix), allow(dead_code))]
    Unknown,
}

#[cfg(unix)]
fn lock(file: &File) -> Lock {
    use rustix::fs::{flock, FlockOperation};
    match flock(file, FlockOperation::NonBlockingLockExclusive) {
        Ok(()) => Lock::Held,
        Err(rustix::io::Errno::WOULDBLOCK) => Lock::Taken,
        Err(_) => Lock::Unknown,
    }
}

#[cfg(unix)]
fn has_name(file: &File) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    Ok(file.metadata()?.nlink() > 0)
}

/// Elsewhere a file that is open cannot be removed.
#[cfg(not(unix))]
fn lock(_file: &File) -> Lock {
    Lock::Held
}

#[cfg(not(unix))]
fn has_name(_file: &File) -> io::Result<bool> {
    Ok(true)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn what_nobody_holds_is_cleared_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let held = create_in(folder.path()).unwrap();
        assert!(keep_from_clearing(held.as_file()).unwrap());
        let (_, left) = create_in(folder.path()).unwrap().keep().unwrap();
        let kept = [".raywarp-notes.tmp", ".raywarp-0-abc.tmp", ".raywarp-00000000-abcdefghijkl.tmp", "a.png"];
        kept.iter().for_each(|name| fs::write(at(name), "").unwrap());
        let here = machine().unwrap_or("0");
        std::os::unix::fs::symlink(at("a.png"), at(&format!(".raywarp-{here}-abcdefghijkl.tmp"))).unwrap();
        let before = names(folder.path());
        clear(folder.path());
        let gone: Vec<_> = before.into_iter().filter(|name| at(name).symlink_metadata().is_err()).collect();
        assert_eq!(gone, [left.file_name().unwrap().to_str().unwrap()]);
        assert!(held.path().exists());
    }

    #[test]
    fn files_of_other_machines_are_left_alone_for_a_day() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(".raywarp-00000000-abcdefghijkl.tmp");
        let file = File::create(&path).unwrap();
        file.set_modified(SystemTime::now() - GIVEN_UP / 2).unwrap();
        assert!(!may_be_left(&path));
        file.set_modified(SystemTime::now() - 2 * GIVEN_UP).unwrap();
        assert!(may_be_left(&path));
    }

    #[test]
    fn a_file_that_was_cleared_before_its_lock_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let file = create_in(folder.path()).unwrap();
        clear(folder.path());
        assert!(!keep_from_clearing(file.as_file()).unwrap());
    }
}
