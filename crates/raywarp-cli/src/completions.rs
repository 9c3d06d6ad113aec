//! `raywarp completions`.

use clap::CommandFactory;

use crate::messages;
use crate::options::{CompletionsOptions, Options};

/// Prints the completions for a shell.
pub fn run(options: &CompletionsOptions) -> anyhow::Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(options.shell, &mut Options::command(), "raywarp", &mut text);
    Ok(messages::out(&text)?)
}
