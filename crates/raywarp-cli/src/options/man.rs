//! Options of `raywarp man`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

/// Options of `man`.
#[derive(Debug, Args)]
pub struct ManOptions {
    /// Write raywarp.1, raywarp-render.1 and so on there
    #[arg(value_hint = ValueHint::DirPath)]
    pub directory: Option<PathBuf>,
}
