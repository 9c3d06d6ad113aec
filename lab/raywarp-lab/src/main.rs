//! The program `raywarp-lab`: the paper's questions asked again, and every structure measured.

mod bench;
mod study;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use raywarp_cli::bench::BenchOptions;
use raywarp_lab::structures::StructureKind;

use study::StudyOptions;

/// What is only measured: structures and ways to trace that raywarp does not render with
#[derive(Debug, Parser)]
#[command(name = "raywarp-lab", version, max_term_width = 100, disable_help_subcommand = true)]
struct Options {
    /// What to do
    #[command(subcommand)]
    command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
enum Command {
    /// Study how rays are traced best on this device: structures, tests, load, ways to share out the work; as a report
    Study(Box<StudyOptions>),
    /// Measure rays a second, or whole pictures, by every structure, as `raywarp bench` does by its own
    Bench(Box<BenchOptions>),
}

/// The definitions, with the names of all structures in the help.
fn definitions() -> clap::Command {
    let names = StructureKind::ALL.map(StructureKind::name).join(", ");
    let help =
        format!("Structures, with commas: {names}; none: the fastest on the device, with --frames brute, kd and that");
    Options::command().mut_subcommand("bench", |bench| bench.mut_arg("layout", |layout| layout.help(help)))
}

fn main() -> ExitCode {
    let options = match Options::from_arg_matches(&definitions().get_matches()) {
        Ok(options) => options,
        Err(error) => error.exit(),
    };
    let done = match options.command {
        Command::Study(options) => study::run(&options),
        Command::Bench(options) => bench::run(&options),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.tell().into(),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_definitions_are_consistent() {
        super::definitions().debug_assert();
    }
}
