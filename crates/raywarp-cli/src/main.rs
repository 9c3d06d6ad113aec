//! The program `raywarp`.

mod bench;
mod columns;
mod completions;
mod doctor;
mod failure;
mod frames;
mod guess;
mod info;
mod interrupt;
mod limits;
mod man;
mod options;
mod output;
mod paper;
mod progress;
mod provenance;
mod query;
mod read_ahead;
mod render;
mod report;
mod say;
mod serve;
mod study;
mod values;
mod view;

use std::process::ExitCode;

use options::{Command, RenderOptions};

fn main() -> ExitCode {
    let options = match guess::parse() {
        Ok(options) => options,
        Err(error) => return failure::of_options(&error),
    };
    let done = match options.command {
        None => render::run(&RenderOptions::built_in()),
        Some(Command::Render(options)) => render::run(&options),
        Some(Command::View(options)) => view::run(&options),
        Some(Command::Query(options)) => query::run(&options),
        Some(Command::Serve(options)) => serve::run(&options),
        Some(Command::Info(options)) => info::run(&options),
        Some(Command::Bench(options)) => bench::run(&options),
        Some(Command::Study(options)) => study::run(&options),
        Some(Command::Doctor) => doctor::run(),
        Some(Command::Completions(options)) => completions::run(&options),
        Some(Command::Man(options)) => man::run(&options),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failure::exit_code(&error),
    }
}
