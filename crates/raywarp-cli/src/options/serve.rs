//! Options of `raywarp serve`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use super::LiveOptions;
use crate::values;

const EXAMPLES: &str = "\
Examples:
  raywarp serve model.glb                      open the address that it prints
  raywarp serve scene.toml --port 0 --token    any free port, and a secret, where others share the machine
  raywarp serve model.glb --host 0.0.0.0       for a whole network, always with a secret

The picture is rendered here and shown there; the browser needs no GPU. On a machine that is reached by
ssh, run the line that is printed on your own and open the address there. docs/serve.md has the rest.";

/// Options of `serve`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ServeOptions {
    /// Scene file: .obj, .ply, .stl, .gltf, .glb, or .toml (see docs/scene-file.md); none: the built-in scene
    #[arg(value_hint = ValueHint::FilePath)]
    pub scene: Option<PathBuf>,

    /// Port; 0 takes any that is free
    #[arg(long, value_name = "N", default_value_t = 8787, value_parser = values::whole::<u16>(0, 65535))]
    #[arg(help_heading = "Network")]
    pub port: u16,
    /// Address to listen at: of this machine only as it stands, 0.0.0.0 for all networks
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1", help_heading = "Network")]
    pub host: String,
    /// Let in only who has the printed address, which works once, or a secret; for any other address than this machine's
    /// own there always is one
    #[arg(long, help_heading = "Network")]
    pub token: bool,
    /// Let in only who knows the secret in this file, one line of 8 to 128 characters; none: the secret of RAYWARP_TOKEN,
    /// if that is set
    #[arg(long, value_name = "FILE", help_heading = "Network")]
    pub token_file: Option<PathBuf>,
    /// Most browsers at a time
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = values::whole::<u32>(1, 1000))]
    #[arg(help_heading = "Network")]
    pub viewers: u32,

    /// Read the scene again when its file changes
    #[arg(long, help_heading = "Scene")]
    pub watch: bool,
    /// Take the scene's warnings as errors
    #[arg(long, help_heading = "Scene")]
    pub strict: bool,

    #[command(flatten)]
    pub live: LiveOptions,
}
