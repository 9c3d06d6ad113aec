//! Which file a path leads to, by whatever names and links.

use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};

use super::is_dash;

/// Two paths lead to the same regular file where these are equal.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Identity {
    /// Device and number of a file that is there: links of both kinds and names in other letters lead to one.
    #[cfg_attr(not(unix), allow(dead_code))]
    Inode(u64, u64),
    /// The path without links: of a file that is not there, or of any where the system has no such numbers.
    Path(PathBuf),
}

/// Most links that are followed, as the system does.
const MOST_LINKS: usize = 40;

impl Identity {
    /// The file at a path, be it still missing; nothing for a device, a pipe or a folder. `-` is standard output.
    pub fn of(path: &Path) -> Option<Self> {
        if is_dash(path) {
            return Self::of_standard_output();
        }
        match fs::metadata(path) {
            Ok(about) => about.is_file().then(|| Self::of_file(path, &about)),
            Err(_) => Some(Self::Path(real_path(path, MOST_LINKS))),
        }
    }

    #[cfg(unix)]
    fn of_file(_path: &Path, about: &Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        Self::Inode(about.dev(), about.ino())
    }

    #[cfg(not(unix))]
    fn of_file(path: &Path, _about: &Metadata) -> Self {
        Self::Path(real_path(path, MOST_LINKS))
    }

    /// The file that standard input comes from, if it is one.
    #[cfg(unix)]
    pub fn of_standard_input() -> Option<Self> {
        Self::of_open(std::io::stdin())
    }

    #[cfg(unix)]
    fn of_standard_output() -> Option<Self> {
        Self::of_open(std::io::stdout())
    }

    #[cfg(unix)]
    fn of_open(stream: impl std::os::fd::AsFd) -> Option<Self> {
        let file = fs::File::from(stream.as_fd().try_clone_to_owned().ok()?);
        let about = file.metadata().ok()?;
        about.is_file().then(|| Self::of_file(Path::new("-"), &about))
    }

    #[cfg(not(unix))]
    pub fn of_standard_input() -> Option<Self> {
        None
    }

    #[cfg(not(unix))]
    fn of_standard_output() -> Option<Self> {
        None
    }
}

/// A path without links, however much of it is there.
fn real_path(path: &Path, links: usize) -> PathBuf {
    if let Ok(real) = fs::canonicalize(path) {
        return real;
    }
    let Some(name) = path.file_name() else { return path.to_owned() };
    let folder = super::directory_of(path);
    match fs::read_link(path) {
        Ok(next) if links > 0 => real_path(&folder.join(next), links - 1),
        _ => real_path(&folder, links).join(name),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn names_and_links_of_one_file_are_one() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a"), "").unwrap();
        fs::create_dir(at("d")).unwrap();
        fs::hard_link(at("a"), at("hard")).unwrap();
        symlink("a", at("link")).unwrap();
        symlink("../none", at("d/dangling")).unwrap();
        symlink("loop", at("loop")).unwrap();
        let same = |a: &str, b: &str| Identity::of(&at(a)) == Identity::of(&at(b));
        assert!(same("a", "hard") && same("a", "link") && same("a", "d/../a") && same("none", "d/dangling"));
        assert!(!same("a", "none") && !same("none", "d/none") && !same("loop", "a"));
        assert!(same("lost/b", "d/../lost/b"));
        assert_eq!(Identity::of(folder.path()), None);
        assert_eq!(Identity::of(Path::new("/dev/null")), None);
    }
}
