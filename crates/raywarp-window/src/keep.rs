//! Files that people asked for while they looked.

use std::path::{Path, PathBuf};

use raywarp::write::{self, Outputs, WriteError};

/// Writes a file into a folder, under a name that is still free there: `view.png`, else `view-2.png` and so on. Returns
/// its path. Folders within `name` are ignored. A name of one of the `scene`'s files is not free, be that file missing.
///
/// # Errors
/// [`WriteError`] with the reason.
pub fn keep(folder: &Path, name: &str, content: &[u8], scene: &[PathBuf]) -> Result<PathBuf, WriteError> {
    let mut outputs = Outputs::default();
    outputs.reads(scene)?;
    let mut number = 1;
    loop {
        let path = folder.join(numbered(name, number));
        match outputs.allow(&path).and_then(|()| write::new_file(&path, content)) {
            Err(WriteError::Exists(_) | WriteError::Read { .. }) => number += 1,
            written => return written.map(|()| path),
        }
    }
}

fn numbered(name: &str, number: u32) -> String {
    let name = Path::new(name);
    let part = |part: Option<&std::ffi::OsStr>| part.map(|part| part.to_string_lossy().into_owned());
    let stem = part(name.file_stem()).unwrap_or_else(|| "raywarp".to_owned());
    let ending = part(name.extension()).map_or_else(String::new, |ending| format!(".{ending}"));
    match number {
        1 => format!("{stem}{ending}"),
        _ => format!("{stem}-{number}{ending}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let names: Vec<_> = (0..3u8).map(|i| keep(folder.path(), "a/../view.png", &[i], &[]).unwrap()).collect();
        for (i, name) in ["view.png", "view-2.png", "view-3.png"].into_iter().enumerate() {
            assert_eq!(names[i], folder.path().join(name));
            assert_eq!(std::fs::read(&names[i]).unwrap(), [i as u8]);
        }
        assert_eq!(keep(folder.path(), "..", &[], &[]).unwrap(), folder.path().join("raywarp"));
    }

    #[test]
    fn files_of_the_scene_keep_their_names_though_they_are_missing() {
        let folder = tempfile::tempdir().unwrap();
        let scene = ["view.png", "view-2.png"].map(|name| folder.path().join(name));
        assert_eq!(keep(folder.path(), "view.png", &[1], &scene).unwrap(), folder.path().join("view-3.png"));
    }

    #[test]
    fn a_folder_that_is_gone_is_an_error() {
        let folder = tempfile::tempdir().unwrap().path().join("gone");
        assert!(
            keep(&folder, "view.png", &[], &[]).is_err_and(|error| error.to_string().contains("there is no directory"))
        );
    }
}
