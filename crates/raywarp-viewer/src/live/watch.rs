//! Tells when one of a scene's files changes on disk.
//!
//! Folders are watched, not files: editors write a new file and rename it over the old one, and a file that is watched
//! itself would then be gone. What happens to other files of the same folders is ignored.

use std::collections::{HashMap, HashSet};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant, SystemTime};

use notify::{EventKind, RecursiveMode, Watcher};

/// Time without any change after which files are taken as whole: programs write in several steps.
const QUIET: Duration = Duration::from_millis(100);
/// A file that never rests is reported so often.
const LONGEST: Duration = Duration::from_secs(2);

/// Why files cannot be watched.
#[derive(Debug, thiserror::Error)]
#[error("cannot watch {}: {source}. The scene is not read again by itself; press Up to read it again", folder.display())]
pub struct WatchError {
    folder: PathBuf,
    source: notify::Error,
}

/// Watches files until it is dropped.
pub struct Watch {
    /// Kept for its threads.
    _watcher: notify::RecommendedWatcher,
    changed: mpsc::Receiver<()>,
}

impl Watch {
    /// Watches files, which need not exist. `wake` is called on a thread of its own after each change that
    /// [`poll`](Self::poll) will tell: a loop that sleeps can be woken by it.
    ///
    /// # Errors
    /// [`WatchError`] where the system refuses. A folder that does not exist is passed over.
    pub fn new(files: &[PathBuf], wake: impl Fn() + Send + 'static) -> Result<Self, WatchError> {
        let targets = Targets::of(files);
        let (folders, seen) = (targets.folders(), targets.state());
        let (report, reports) = mpsc::channel();
        let mut watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            if event.map_or(true, |event| targets.concern(&event)) {
                let _ = report.send(());
            }
        })
        .map_err(|source| WatchError { folder: PathBuf::from("."), source })?;
        for folder in folders {
            watcher.watch(&folder, RecursiveMode::NonRecursive).map_err(|source| WatchError { folder, source })?;
        }
        let (sender, changed) = mpsc::channel();
        let targets = Targets::of(files);
        // It ends when the watcher, and with it `report`, is dropped.
        std::thread::spawn(move || settle(&targets, seen, &reports, &|| sender.send(()).map(|()| wake()).is_ok()));
        Ok(Self { _watcher: watcher, changed })
    }

    /// Whether files have changed since the last call, and are at rest again. Costs nothing.
    pub fn poll(&self) -> bool {
        self.changed.try_iter().count() > 0
    }
}

/// Waits for quiet after the first report of a burst, and tells of it if a file is another now; until `tell` fails.
fn settle(targets: &Targets, mut seen: State, reports: &mpsc::Receiver<()>, tell: &dyn Fn() -> bool) {
    while reports.recv().is_ok() {
        let start = Instant::now();
        while start.elapsed() < LONGEST {
            match reports.recv_timeout(QUIET) {
                Ok(()) => {}
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
        // Files that were only opened or read report too on some systems.
        let now = targets.state();
        if now != seen && !tell() {
            return;
        }
        seen = now;
    }
}

/// Time and size of each file that exists.
type State = HashMap<PathBuf, (Option<SystemTime>, u64)>;

/// The files, by folder and name.
struct Targets(HashMap<PathBuf, HashSet<OsString>>);

impl Targets {
    fn of(files: &[PathBuf]) -> Self {
        let mut targets = HashMap::<PathBuf, HashSet<OsString>>::new();
        let mut add = |path: &Path| {
            let folder = raywarp::write::directory_of(path);
            if let (Some(name), Ok(folder)) = (path.file_name(), folder.canonicalize()) {
                targets.entry(folder).or_default().insert(name.to_owned());
            }
        };
        for file in files {
            add(file);
            // The target of a link changes elsewhere.
            if let Ok(real) = file.canonicalize() {
                add(&real);
            }
        }
        Self(targets)
    }

    fn folders(&self) -> Vec<PathBuf> {
        self.0.keys().cloned().collect()
    }

    fn concern(&self, event: &notify::Event) -> bool {
        let of_a_file = |path: &PathBuf| {
            let names = path.parent().and_then(|folder| self.0.get(folder));
            names.zip(path.file_name()).is_some_and(|(names, name)| names.contains(name))
        };
        // The queue of the system has overflown: anything may have happened.
        let lost = event.need_rescan();
        lost || !matches!(event.kind, EventKind::Access(_)) && event.paths.iter().any(of_a_file)
    }

    fn state(&self) -> State {
        let paths = self.0.iter().flat_map(|(folder, names)| names.iter().map(move |name| folder.join(name)));
        let state = |path: PathBuf| {
            let metadata = std::fs::metadata(&path).ok()?;
            Some((path, (metadata.modified().ok(), metadata.len())))
        };
        paths.filter_map(state).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::Arc;

    use super::*;

    /// Whether a change is told within a time that is long for a machine under load.
    fn is_told(watch: &Watch) -> bool {
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(10) {
            if watch.poll() {
                return true;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        false
    }

    fn is_quiet(watch: &Watch) -> bool {
        std::thread::sleep(4 * QUIET);
        !watch.poll()
    }

    #[test]
    fn changes_of_the_files_are_told_once_and_of_others_never() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("scene.toml"), "version = 1").unwrap();
        let woken = Arc::new(AtomicUsize::new(0));
        let count = woken.clone();
        let files = [path("scene.toml"), path("missing.png"), path("none/deep.png")];
        let watch = Watch::new(&files, move || _ = count.fetch_add(1, Ordering::SeqCst)).unwrap();
        assert!(is_quiet(&watch), "nothing has happened");

        fs::write(path("scene.toml"), "version = 1 ").unwrap();
        fs::write(path("scene.toml"), "version = 1  ").unwrap();
        assert!(is_told(&watch), "written");
        assert!(is_quiet(&watch), "told once");

        fs::write(path("scene.toml~"), "version = 1   ").unwrap();
        assert!(is_quiet(&watch), "a file that is not the scene's");
        fs::rename(path("scene.toml~"), path("scene.toml")).unwrap();
        assert!(is_told(&watch), "renamed over");

        fs::remove_file(path("scene.toml")).unwrap();
        assert!(is_told(&watch), "deleted");
        fs::write(path("scene.toml"), "version = 1").unwrap();
        assert!(is_told(&watch), "made again");

        fs::write(path("missing.png"), "x").unwrap();
        assert!(is_told(&watch), "there at last");
        fs::read(path("scene.toml")).unwrap();
        assert!(is_quiet(&watch), "only read");
        assert_eq!(woken.load(Ordering::SeqCst), 5);
    }

    #[cfg(unix)]
    #[test]
    fn the_target_of_a_link_counts() {
        let (folder, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let (link, real) = (folder.path().join("scene.obj"), other.path().join("real.obj"));
        fs::write(&real, "v 0 0 0").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        let watch = Watch::new(&[link], || ()).unwrap();
        fs::write(&real, "v 0 0 0 ").unwrap();
        assert!(is_told(&watch));
    }
}
