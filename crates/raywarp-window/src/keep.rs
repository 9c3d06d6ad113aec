//! Files that people asked for while they looked.

use std::path::{Path, PathBuf};

use raywarp::write::{self, WriteError};

/// Writes a file into a folder, under a name that is still free there: `view.png`, else `view-2.png` and so on. Returns
/// its path. Folders within `name` are ignored.
///
/// # Errors
/// [`WriteError`] with the reason.
pub fn keep(folder: &Path, name: &str, content: &[u8]) -> Result<PathBuf, WriteError> {
    let path = free(folder, name);
    write::file(&path, content)?;
    Ok(path)
}

fn free(folder: &Path, name: &str) -> PathBuf {
    let name = Path::new(name);
    let part = |part: Option<&std::ffi::OsStr>| part.map(|part| part.to_string_lossy().into_owned());
    let stem = part(name.file_stem()).unwrap_or_else(|| "raywarp".to_owned());
    let ending = part(name.extension()).map_or_else(String::new, |ending| format!(".{ending}"));
    let mut path = folder.join(format!("{stem}{ending}"));
    let mut number = 1;
    // A link that leads nowhere is a name taken, too.
    while path.symlink_metadata().is_ok() {
        number += 1;
        path = folder.join(format!("{stem}-{number}{ending}"));
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let names: Vec<_> = (0..3u8).map(|i| keep(folder.path(), "a/../view.png", &[i]).unwrap()).collect();
        for (i, name) in ["view.png", "view-2.png", "view-3.png"].into_iter().enumerate() {
            assert_eq!(names[i], folder.path().join(name));
            assert_eq!(std::fs::read(&names[i]).unwrap(), [i as u8]);
        }
        assert_eq!(keep(folder.path(), "..", &[]).unwrap(), folder.path().join("raywarp"));
    }

    #[test]
    fn a_folder_that_is_gone_is_an_error() {
        let folder = tempfile::tempdir().unwrap().path().join("gone");
        assert!(keep(&folder, "view.png", &[]).is_err_and(|error| error.to_string().contains("there is no directory")));
    }
}
