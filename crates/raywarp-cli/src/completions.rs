//! `raywarp completions`.

use clap::CommandFactory;

use crate::options::{CompletionsOptions, Options};
use crate::say;

/// Prints the completions for a shell.
pub fn run(options: &CompletionsOptions) -> anyhow::Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(options.shell, &mut Options::command(), "raywarp", &mut text);
    Ok(say::out(&text)?)
}
