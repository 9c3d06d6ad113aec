//! The sections of the report, in the paper's order. Each says what it shows and how that was measured, and nothing about
//! what follows from it.

mod about;
mod costs;
mod growth;
mod lanes;
mod loads;
mod paths;
mod sharing;
mod speed;
mod stages;
mod structures;

use super::document::{Document, Picture};
use super::plot::Palette;
use crate::study::findings::{SceneStudy, Study};

use raywarp_cli::failure::Result;

/// The whole report.
///
/// # Errors
/// Where a plot cannot be drawn.
pub fn document(study: &Study) -> Result<Document> {
    let mut page = Page::new(study);
    about::show(&mut page);
    let sections = [
        structures::show,
        growth::show,
        speed::show,
        stages::show,
        costs::show,
        loads::show,
        lanes::show,
        sharing::show,
        paths::show,
    ];
    sections.iter().try_for_each(|section| section(&mut page))?;
    Ok(page.document)
}

/// Kinds of rays whose colours do not depend on the run.
const RAYS: [&str; 4] = ["primary", "shadow", "reflected", "diffuse"];

/// A report that grows, with what every section needs.
struct Page<'a> {
    document: Document,
    study: &'a Study,
    /// Colours of structures.
    structures: Palette,
    /// Colours of kinds of rays.
    rays: Palette,
}

impl<'a> Page<'a> {
    fn new(study: &'a Study) -> Self {
        let built = study.scenes.iter().flat_map(|scene| &scene.structures).map(|structure| structure.name.as_str());
        let shared = study.scenes.iter().flat_map(|scene| &scene.sharing).map(|row| row.rays.as_str());
        let grown = study.growth.iter().map(|growth| growth.builder.as_str());
        Self {
            document: Document::new(format!("A study of ray tracing on {}", study.about.device)),
            study,
            structures: Palette::of_structures(built.chain(grown)),
            rays: Palette::of(RAYS.into_iter().chain(shared)),
        }
    }

    /// Shows something of every scene that `has` it, and says of which there is none.
    fn each_scene(
        &mut self,
        what: &str,
        has: impl Fn(&SceneStudy) -> bool,
        show: impl Fn(&mut Self, &'a SceneStudy) -> Result<()>,
    ) -> Result<()> {
        let study = self.study;
        if !study.scenes.iter().any(&has) {
            self.document.say(format!("This run has no {what}."));
            return Ok(());
        }
        for scene in &study.scenes {
            self.document.heading(&scene.name);
            if has(scene) {
                show(self, scene)?;
            } else {
                self.document.say(format!("This run has no {what} of this scene."));
            }
        }
        Ok(())
    }

    /// Adds a plot of a scene.
    fn plot(&mut self, scene: &SceneStudy, name: &str, svg: String, caption: impl Into<String>) {
        self.document.figure(&[name, &scene.name], Picture::Svg(svg), caption);
    }

    /// Says what the paper has.
    fn beside(&mut self, text: &str) {
        self.document.say(format!("The paper: {text}"));
    }
}

/// Each once, in the order in which they first come.
fn distinct<'a>(texts: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = Vec::new();
    for text in texts {
        if !seen.contains(&text) {
            seen.push(text);
        }
    }
    seen
}
