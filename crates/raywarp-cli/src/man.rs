//! `raywarp man`.

use std::path::Path;

use clap::CommandFactory;
use raywarp::write::Outputs;

use crate::failure::{Context, Result};
use crate::messages;
use crate::options::{ManOptions, Options};

/// Prints the manual page, or writes one a command.
pub fn run(options: &ManOptions) -> Result<()> {
    let Some(directory) = &options.directory else {
        let mut text = Vec::new();
        clap_mangen::Man::new(Options::command()).render(&mut text)?;
        return Ok(messages::out(&text)?);
    };
    let failed = || format!("cannot write manual pages into {}", directory.display());
    std::fs::create_dir_all(directory).with_context(failed)?;
    let made = tempfile::tempdir().with_context(failed)?;
    clap_mangen::generate_to(Options::command(), &made).with_context(failed)?;
    put_pages(made.path(), directory)
}

/// Puts every page in its place, whole or not at all.
fn put_pages(made: &Path, directory: &Path) -> Result<()> {
    for page in std::fs::read_dir(made)? {
        let page = page?;
        let mut run = Outputs::default();
        let path = directory.join(page.file_name());
        run.add(&path)?;
        run.file(&path, &std::fs::read(page.path())?)?;
    }
    Ok(())
}
