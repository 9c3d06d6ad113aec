//! Options of `raywarp info`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

/// Options of `info`.
#[derive(Debug, Args)]
pub struct InfoOptions {
    /// Scene file; none: the built-in scene
    #[arg(value_hint = ValueHint::FilePath)]
    pub scene: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Take the scene's warnings as errors
    #[arg(long)]
    pub strict: bool,
}
