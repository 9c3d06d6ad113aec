//! A progress bar for people who wait.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use raywarp::render::Progress;

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar on standard error that comes after a second, on a terminal only.
pub struct Bar {
    wanted: bool,
    start: Instant,
    bar: Option<ProgressBar>,
}

impl Bar {
    /// No bar yet.
    pub fn new(quiet: bool) -> Self {
        Self { wanted: !quiet && io::stderr().is_terminal(), start: Instant::now(), bar: None }
    }

    /// Moves the bar.
    pub fn update(&mut self, progress: Progress) {
        if !self.wanted || (self.bar.is_none() && self.start.elapsed() < PATIENCE) {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let bar = ProgressBar::new(progress.total).with_elapsed(PATIENCE);
            let template = "render [{bar:40}] {percent}%, {elapsed} gone, {eta} to go";
            bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        bar.set_position(progress.done);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
