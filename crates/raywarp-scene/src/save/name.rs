//! Names of files in a scene file.

use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

use super::{Original, SaveError};
use crate::write::Identity;

/// Refuses a target that could not be read, or that the scene is made of: the new file would be its own base.
pub fn check_target(original: &Original, target: &Path) -> Result<(), SaveError> {
    if !target.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
        return Err(SaveError::Extension(target.to_owned()));
    }
    let (Original::File { path, files }, Some(written)) = (original, Identity::of(target)) else { return Ok(()) };
    let same = |file: &Path| Identity::of(file).as_ref() == Some(&written);
    if same(path) || files.iter().any(|file| same(file)) {
        return Err(SaveError::Original(target.to_owned()));
    }
    Ok(())
}

/// The path from the target's folder to a file, with slashes; an absolute one where they share no folder but the root.
pub fn relative(file: &Path, target: &Path) -> Result<String, SaveError> {
    let unnamed = || SaveError::Name(file.to_owned());
    // Folders alone are resolved: what a file names is looked for beside its own name, be that a symbolic link.
    let (from, to) = (real_folder(target)?, real_folder(file)?);
    let (from, mut to): (Vec<_>, Vec<_>) = (from.components().collect(), to.components().collect());
    to.push(Component::Normal(file.file_name().ok_or_else(unnamed)?));
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if !from[..shared].iter().any(|part| matches!(part, Component::Normal(_))) && shared < from.len() {
        return to.iter().collect::<PathBuf>().to_str().map(str::to_owned).ok_or_else(unnamed);
    }
    let up = std::iter::repeat_n("..", from.len() - shared).map(OsStr::new);
    let parts = up.chain(to[shared..].iter().map(|part| part.as_os_str()));
    let parts: Option<Vec<&str>> = parts.map(OsStr::to_str).collect();
    Ok(parts.ok_or_else(unnamed)?.join("/"))
}

fn real_folder(file: &Path) -> Result<PathBuf, SaveError> {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    folder.canonicalize().map_err(|source| SaveError::Folder { path: folder.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_the_scene_lacks_is_not_written_either() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("a.toml"), "").unwrap();
        let (path, files) = (at("a.toml"), [at("a.toml"), at("missing.toml")]);
        let original = Original::File { path: &path, files: &files };
        for name in ["a.toml", "missing.toml"] {
            assert!(matches!(check_target(&original, &at(name)), Err(SaveError::Original(_))), "{name}");
        }
        assert!(check_target(&original, &at("b.toml")).is_ok());
    }
}
