//! The program `raywarp`.

use std::process::ExitCode;

fn main() -> ExitCode {
    raywarp_cli::main()
}
