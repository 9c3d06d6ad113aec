//! Options of `study`.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use raywarp::device::DeviceChoice;
use raywarp_cli::bench::SubjectOptions;
use raywarp_cli::options::DEVICES;
use raywarp_cli::values;

const EXAMPLES: &str = "\
Examples:
  raywarp-lab study                                     the paper's scene, into the folder study
  raywarp-lab study --quick                             the same in a minute, without a GPU as well
  raywarp-lab study model.obj other.glb -o report
  raywarp-lab study --suite lab/docs/study/suite.toml --models DIR -o report

lab/docs/study/README.md has a finished run and what it says.";

/// Options of `study`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct StudyOptions {
    /// Which scenes.
    #[command(flatten)]
    pub subjects: SubjectOptions,

    /// Folder for the report: report.html, report.md, study.json and plots; files of these names in it are replaced
    #[arg(short, long, value_name = "DIR", default_value = "study", help_heading = "Output")]
    #[arg(value_hint = ValueHint::DirPath)]
    pub output: PathBuf,
    /// Small pictures, fewer rays and repeats: a minute on two CPU cores
    #[arg(long, help_heading = "How often")]
    pub quick: bool,
    /// Size of the pictures in pixels; none: 1920x1080, with --quick 240x135
    #[arg(long, value_name = "WxH", value_parser = values::size, help_heading = "How often")]
    pub size: Option<[u32; 2]>,
    /// Timed repeats, of which the median counts; none: 10, with --quick 3
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(1, 1000))]
    #[arg(help_heading = "How often")]
    pub repeats: Option<u32>,
    /// Where to trace: auto (a GPU if there is one), cpu, cuda, cuda:N
    #[arg(long, value_name = "DEVICE", default_value_t, help_heading = "Machine")]
    #[arg(value_parser = values::words::<DeviceChoice>(DEVICES), hide_possible_values = true)]
    pub device: DeviceChoice,
    /// Threads of the CPU; none: all
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(1, 4096), help_heading = "Machine")]
    pub threads: Option<u32>,
}
