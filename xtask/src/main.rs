//! What a maintainer runs: `cargo xtask COMMAND`. One file a command.

mod bundle;
mod process;
mod ptx;

use std::process::ExitCode;

use clap::Parser;

/// What a maintainer of raywarp runs.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
enum Task {
    Ptx(ptx::Arguments),
    Bundle(bundle::Arguments),
}

fn main() -> ExitCode {
    let done = match Task::parse() {
        Task::Ptx(arguments) => ptx::run(&arguments),
        Task::Bundle(arguments) => bundle::run(&arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
