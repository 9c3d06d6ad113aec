//! `raywarp man`.

use anyhow::Context;
use clap::CommandFactory;

use crate::options::{ManOptions, Options};
use crate::say;

/// Prints the manual page, or writes one a command.
pub fn run(options: &ManOptions) -> anyhow::Result<()> {
    let Some(directory) = &options.directory else {
        let mut text = Vec::new();
        clap_mangen::Man::new(Options::command()).render(&mut text)?;
        return Ok(say::out(&text)?);
    };
    let failed = || format!("cannot write manual pages into {}", directory.display());
    std::fs::create_dir_all(directory).with_context(failed)?;
    clap_mangen::generate_to(Options::command(), directory).with_context(failed)
}
