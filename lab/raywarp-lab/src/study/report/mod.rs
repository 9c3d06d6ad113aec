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

use anyhow::Context;
use raywarp::write;

use super::findings::Study;

/// The folder of the plots, within that of the report.
const PLOTS: &str = "plots";

/// Finds out whether [`write`] can be expected to succeed, before minutes of work. Makes the folder.
///
/// # Errors
/// As for [`write`].
pub fn check(folder: &Path) -> anyhow::Result<()> {
    make(folder)?;
    Ok(write::check(&folder.join("report.html"))?)
}

/// Makes the folder for a report, and that for its plots.
fn make(folder: &Path) -> anyhow::Result<PathBuf> {
    let plots = folder.join(PLOTS);
    fs::create_dir_all(&plots).with_context(|| {
        format!("cannot make the folder {} for the report: give a folder that you may write to", plots.display())
    })?;
    Ok(plots)
}

/// Writes `report.html`, `report.md`, `study.json` and the files in `plots` into a folder, which is made if it is not
/// there. Returns the paths of all of them, those that people open first. Each file is whole or not there, and the
/// plots come before the pages that show them; other files of the folder stay as they are.
///
/// # Errors
/// Where the folder cannot be made or a file not be written.
pub fn write(study: &Study, folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let document = sections::document(study)?;
    let data = serde_json::to_vec_pretty(study).context("cannot write the study as JSON")?;
    let plots = make(folder)?;
    let mut figures = Vec::new();
    for figure in document.figures() {
        let path = plots.join(&figure.file);
        write::file(&path, figure.picture.bytes())?;
        figures.push(path);
    }
    let pages = [
        ("report.html", html::page(&document).into_bytes()),
        ("report.md", markdown::text(&document, PLOTS).into_bytes()),
        ("study.json", data),
    ];
    let mut paths = Vec::new();
    for (name, bytes) in pages {
        let path = folder.join(name);
        write::file(&path, &bytes)?;
        paths.push(path);
    }
    paths.extend(figures);
    Ok(paths)
}
