//! `raywarp completions`.

use clap::CommandFactory;

use crate::failure::Result;
use crate::messages;
use crate::options::{CompletionsOptions, Options};

/// Prints the completions for a shell.
pub fn run(options: &CompletionsOptions) -> Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(options.shell, &mut Options::command(), "raywarp", &mut text);
    Ok(messages::out(&text)?)
}
