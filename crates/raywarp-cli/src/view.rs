//! `raywarp view`: the window where it is installed, else the page in a browser.

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::failure::{Context, Result};
use crate::options::ViewOptions;
use crate::{browser, serve};

/// File name of the program that shows a window.
const WINDOW: &str = if cfg!(windows) { "raywarp-window.exe" } else { "raywarp-window" };

/// Shows a scene until its window is closed, or until an interrupt.
pub fn run(options: &ViewOptions) -> Result<()> {
    match browser::has_display().then(window).flatten() {
        Some(program) => start(&program),
        None => serve::view(options),
    }
}

/// The window's program: beside this one, else where programs are looked for.
fn window() -> Option<PathBuf> {
    let here = env::current_exe().ok();
    let path = env::var_os("PATH").unwrap_or_default();
    find(here.as_deref().and_then(Path::parent), &path)
}

fn find(beside: Option<&Path>, path: &OsStr) -> Option<PathBuf> {
    let folders = beside.map(Path::to_path_buf).into_iter().chain(env::split_paths(path));
    folders.map(|folder| folder.join(WINDOW)).find(|program| program.is_file())
}

/// The words after `view`, which may be left out before a scene.
fn words(mut given: impl Iterator<Item = OsString>) -> Vec<OsString> {
    given.next();
    let first = given.next().filter(|word| word != "view");
    first.into_iter().chain(given).collect()
}

/// Gives the words to the window's program, which has the same options.
fn start(program: &Path) -> Result<()> {
    let mut command = Command::new(program);
    command.args(words(env::args_os()));
    let failed = || format!("cannot start {}", program.display());
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt;
        // It takes this program's place: signals and the exit code are its own.
        Err(command.exec()).with_context(failed)
    }
    #[cfg(not(unix))]
    {
        let status = command.status().with_context(failed)?;
        std::process::exit(status.code().unwrap_or(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_gets_the_words_of_the_viewer() {
        for given in [["raywarp", "view", "a.obj"].as_slice(), &["raywarp", "a.obj"]] {
            assert_eq!(words(given.iter().map(OsString::from)), ["a.obj"]);
        }
        assert!(words(["raywarp", "view"].iter().map(OsString::from)).is_empty());
    }

    #[test]
    fn the_window_beside_the_program_comes_before_one_on_the_path() {
        let [beside, first, second] = [(); 3].map(|()| tempfile::tempdir().unwrap());
        let path = env::join_paths([first.path(), second.path()]).unwrap();
        let put = |folder: &Path| std::fs::write(folder.join(WINDOW), "").unwrap();
        assert_eq!(find(Some(beside.path()), &path), None);
        std::fs::create_dir(first.path().join(WINDOW)).unwrap();
        put(second.path());
        assert_eq!(find(Some(beside.path()), &path), Some(second.path().join(WINDOW)));
        put(beside.path());
        assert_eq!(find(Some(beside.path()), &path), Some(beside.path().join(WINDOW)));
        assert_eq!(find(None, &path), Some(second.path().join(WINDOW)));
    }
}
