//! The report of a study: a page, the same as Markdown with its plots as files, and the data.
//!
//! [`sections`] turn the findings into a [`document`], which [`html`] and [`markdown`] render. [`plot`] draws, [`format`]
//! writes numbers, and [`paper`](raywarp_cli::paper) is what the paper reports.

mod document;
mod format;
mod html;
mod markdown;
mod plot;
mod sections;

#[cfg(test)]
mod sample;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::{Path, PathBuf};

use raywarp::write::{self, Outputs};
use raywarp_cli::failure::{Context, Result};
use raywarp_cli::interrupt::Interrupt;
use raywarp_cli::output::Target;

use super::findings::Study;

/// The folder of the plots, within that of the report.
const PLOTS: &str = "plots";

/// The pages, and the data.
const PAGES: [&str; 3] = ["report.html", "report.md", "study.json"];

/// Finds out whether [`write`] can be expected to succeed, before minutes of work, and adds its files to the outputs of
/// the run. Makes the folder.
///
/// # Errors
/// As for [`write`].
pub fn check(folder: &Path, run: &mut Outputs, interrupt: &Interrupt) -> Result<()> {
    // A trial makes a file for a moment.
    let _held = interrupt.hold();
    let plots = make(folder)?;
    PAGES.iter().try_for_each(|name| run.add(&folder.join(name)))?;
    // Which plots there will be is known at the end; those of the last time are replaced.
    let entries = fs::read_dir(plots).into_iter().flatten().filter_map(Result::ok).map(|entry| entry.path());
    entries.filter(|path| path.is_file()).try_for_each(|path| run.add(&path))?;
    Ok(write::check(&folder.join(PAGES[0]))?)
}

/// Makes the folder for a report, and that for its plots.
fn make(folder: &Path) -> Result<PathBuf> {
    let plots = folder.join(PLOTS);
    fs::create_dir_all(&plots)
        .with_context(|| format!("cannot make the folder {} for the report", plots.display()))
        .map_err(|failure| failure.advising("give a folder that you may write to"))?;
    Ok(plots)
}

/// Writes `report.html`, `report.md`, `study.json` and the files in `plots` into a folder, which is made if it is not
/// there. Returns the paths of all of them, those that people open first. Each file is whole or not there, and the
/// plots come before the pages that show them; other files of the folder stay as they are.
///
/// # Errors
/// Where the folder cannot be made or a file not be written.
pub fn write(study: &Study, folder: &Path, target: Target) -> Result<Vec<PathBuf>> {
    let document = sections::document(study)?;
    let data = serde_json::to_vec_pretty(study).context("cannot write the study as JSON")?;
    // A report is whole: Ctrl-C waits for its last file.
    let _held = target.interrupt.hold();
    let plots = make(folder)?;
    let mut figures = Vec::new();
    for figure in document.figures() {
        let path = plots.join(&figure.file);
        target.run.file(&path, figure.picture.bytes())?;
        figures.push(path);
    }
    let pages = [html::page(&document).into_bytes(), markdown::text(&document, PLOTS).into_bytes(), data];
    let mut paths = Vec::new();
    for (name, bytes) in PAGES.into_iter().zip(pages) {
        let path = folder.join(name);
        target.run.file(&path, &bytes)?;
        paths.push(path);
    }
    paths.extend(figures);
    Ok(paths)
}
