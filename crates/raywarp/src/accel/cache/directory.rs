//! The directory: finding, keeping and throwing away.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use raywarp_core::traversal::bvh2::Node;
use raywarp_core::triangle::Triangle;
use tempfile::NamedTempFile;

use super::{file, Cache, CacheError};
use crate::accel::bvh2::Bvh2;

/// Of files that are whole.
const EXTENSION: &str = "tree";

/// Of files that somebody writes.
const UNFINISHED: &str = "part";

/// After this a file still unfinished was given up.
const GIVEN_UP: Duration = Duration::from_secs(3600);

impl Cache {
    fn path(&self, key: u128) -> PathBuf {
        self.directory.join(format!("{key:032x}.{EXTENSION}"))
    }

    /// The tree, if there is one as it was written.
    pub(super) fn read(&self, key: u128, triangles: &[Triangle]) -> Result<Option<Bvh2>, CacheError> {
        let path = self.path(key);
        let file = match File::open(&path) {
            Ok(file) => file,
            Err(source) if source.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(CacheError::Read { path, source }),
        };
        // Used just now; where that cannot be noted, it will go sooner.
        let _ = file.set_modified(SystemTime::now());
        file::decode(file, key, triangles).map_err(|source| CacheError::Read { path, source })
    }

    /// Keeps a tree and makes room for it.
    pub(super) fn write(&self, key: u128, nodes: &[Node], order: &[u32]) -> Result<(), CacheError> {
        let bytes = file::encode(key, nodes, order);
        if bytes.len() as u64 > self.limit {
            return Ok(());
        }
        self.put(key, &bytes).map_err(|source| CacheError::Write { path: self.directory.clone(), source })
    }

    fn put(&self, key: u128, bytes: &[u8]) -> io::Result<()> {
        fs::create_dir_all(&self.directory)?;
        self.make_room(bytes.len() as u64);
        // It goes if it is not renamed: half a file on a full disk helps nobody.
        let mut unfinished = self.unfinished(key)?;
        unfinished.write_all(bytes)?;
        unfinished.persist(self.path(key)).map(drop).map_err(|failed| failed.error)
    }

    /// A new file under a name that nobody can guess.
    fn unfinished(&self, key: u128) -> io::Result<NamedTempFile> {
        let mut options = OpenOptions::new();
        options.read(true).write(true).create_new(true);
        let (prefix, suffix) = (format!("{key:032x}-"), format!(".{UNFINISHED}"));
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(&suffix).rand_bytes(12).make_in(&self.directory, |path| options.open(path))
    }

    /// Removes what was not used for the longest time until `more` bytes fit. Files that cannot be removed, or that another
    /// program has removed, are left to it.
    fn make_room(&self, more: u64) {
        let Ok(entries) = fs::read_dir(&self.directory) else { return };
        let mut kept: Vec<CachedFile> = entries.filter_map(|entry| CachedFile::of(entry.ok()?.path())).collect();
        kept.sort_by_key(|file| file.used);
        let mut total: u64 = kept.iter().map(|file| file.size).sum::<u64>().saturating_add(more);
        for file in kept {
            let gone = total > self.limit || file.given_up;
            if gone && fs::remove_file(&file.path).is_ok() {
                total = total.saturating_sub(file.size);
            }
        }
    }
}

/// A file of the cache. Others in the directory are not ours to touch.
struct CachedFile {
    path: PathBuf,
    size: u64,
    used: SystemTime,
    given_up: bool,
}

impl CachedFile {
    /// Finished ones, and those that were given up.
    fn of(path: PathBuf) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        let is_name = path.file_stem()?.to_str()?.get(..32)?.bytes().all(|c| c.is_ascii_hexdigit());
        let about = fs::symlink_metadata(&path).ok().filter(fs::Metadata::is_file)?;
        let used = about.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        let given_up = extension == UNFINISHED && used.elapsed().is_ok_and(|age| age > GIVEN_UP);
        let ours = is_name && (extension == EXTENSION || given_up);
        ours.then_some(Self { size: about.len(), used, given_up, path })
    }
}
