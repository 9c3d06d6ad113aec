//! Wavefront MTL: materials of the Phong model, with maps.
//!
//! A definition is first read as it stands ([`definition`]), then understood ([`meaning`]): its `illum` says which of
//! its values count, and its maps say whether transparency cuts holes or blends.
//!
//! Nothing in a library refuses the geometry that names it: what cannot be read is skipped and counted.

mod definition;
mod map;
mod meaning;
mod texels;

use std::collections::hash_map::Entry;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::quote::quote;
use super::text::{is_keyword, Kind, SkippedStatements, Statement, Statements, Strays};
use super::{LoadError, Sources};
use crate::Scene;
use definition::Definition;

/// A file that another one names: beside it, with slashes for the backslashes of Windows.
pub(super) fn beside(path: &Path, name: &str) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(name.replace('\\', "/"))
}

/// Adds a library's materials to the scene and their indices to the names. Of two with the same name the first holds.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    by_name: &mut HashMap<String, u32>,
    scene: &mut Scene,
    sources: &mut Sources,
) -> Result<(), LoadError> {
    let library = Library::read(path, bytes, sources)?;
    library.warn(path, sources)?;
    for definition in library.definitions {
        match by_name.entry(definition.name.clone()) {
            Entry::Occupied(_) => {
                let message =
                    format!("the material {} is defined again; the first holds", quote(definition.name.as_bytes()));
                sources.warn(path, Some(definition.line), message)?;
            }
            Entry::Vacant(entry) => {
                entry.insert(scene.materials.len() as u32);
                let material = meaning::material(path, definition, scene, sources)?;
                scene.materials.push(material);
            }
        }
    }
    Ok(())
}

/// A file as it stands.
#[derive(Default)]
struct Library<'a> {
    definitions: Vec<Definition>,
    /// First line of the statements that belong to no material.
    astray: Option<usize>,
    /// First line of the statements of the physically based extension.
    physical: Option<usize>,
    unknown: SkippedStatements<'a>,
    /// Lines that are no statements.
    foreign: Strays,
    faulty: Faulty,
}

/// Statements whose values cannot be read.
#[derive(Default)]
struct Faulty {
    count: usize,
    /// Line and reason of the first.
    first: Option<(usize, String)>,
}

impl<'a> Library<'a> {
    fn read(path: &Path, bytes: &'a [u8], sources: &mut Sources) -> Result<Self, LoadError> {
        let mut library = Self::default();
        for statement in Statements::new(bytes) {
            library.statement(path, &statement, sources)?;
        }
        Ok(library)
    }

    /// Keywords are compared without case: exporters disagree on `map_Bump` and `map_bump`, on `Tf` and `tf`.
    fn statement(&mut self, path: &Path, statement: &Statement<'a>, sources: &mut Sources) -> Result<(), LoadError> {
        let keyword = statement.keyword.to_ascii_lowercase();
        if !is_keyword(&keyword) {
            self.foreign.count(statement);
        } else if keyword == b"newmtl" {
            self.definitions.push(Definition::new(statement.text(), statement.line));
        } else if IGNORED.contains(&keyword.as_slice()) {
        } else if PHYSICAL.contains(&keyword.as_slice()) {
            self.physical.get_or_insert(statement.line);
        } else if let Some(definition) = self.definitions.last_mut() {
            match definition.statement(path, &keyword, statement, sources) {
                Ok(true) => {}
                Ok(false) => self.unknown.count(statement),
                Err(LoadError::Syntax { read, expected, .. }) => self.faulty.count(statement, &read, &expected),
                Err(error) => return Err(error),
            }
        } else {
            self.astray.get_or_insert(statement.line);
        }
        Ok(())
    }

    fn warn(&self, path: &Path, sources: &mut Sources) -> Result<(), LoadError> {
        if self.astray.is_some() {
            sources.warn(path, self.astray, "statements before the first 'newmtl' are skipped")?;
        }
        let (is, are) = ("is not a statement of MTL and is skipped", "are not statements of MTL and are skipped");
        if let Some(message) = self.foreign.message(is, are) {
            sources.warn(path, Some(self.foreign.line), message)?;
        }
        if let Some((line, message)) = self.faulty.message() {
            sources.warn(path, Some(line), message)?;
        }
        self.warn_of_hidden(path, sources)?;
        if self.physical.is_some() {
            let message = "statements of the physically based extension beside Pr and Pm (Ps, Pc, ...) are skipped";
            sources.warn(path, self.physical, message)?;
        }
        for kind in &self.unknown.kinds {
            sources.warn(path, Some(kind.line), unknown(kind))?;
        }
        if self.unknown.more > 0 {
            sources.warn(path, None, format!("{} statements of more unknown kinds are skipped", self.unknown.more))?;
        }
        Ok(())
    }
}

impl Library<'_> {
    fn warn_of_hidden(&self, path: &Path, sources: &mut Sources) -> Result<(), LoadError> {
        let mut hidden = self.definitions.iter().filter(|definition| definition.is_hidden_by_tr());
        let Some(first) = hidden.next() else { return Ok(()) };
        let message = match hidden.count() {
            0 => format!("the material {} has 'Tr 1' and no 'd'; it is opaque", quote(first.name.as_bytes())),
            more => format!(
                "the material {} and {more} more have 'Tr 1' and no 'd'; they are opaque",
                quote(first.name.as_bytes())
            ),
        };
        sources.warn(path, Some(first.line), message)
    }
}

impl Faulty {
    fn count(&mut self, statement: &Statement, read: &str, expected: &str) {
        self.first.get_or_insert_with(|| (statement.line, format!("{read}; expected {expected}")));
        self.count += 1;
    }

    fn message(&self) -> Option<(usize, String)> {
        let (line, reason) = self.first.as_ref()?;
        Some(match self.count {
            1 => (*line, format!("{reason}: the statement is skipped")),
            count => {
                (*line, format!("{reason}: the statement is skipped, and {} more cannot be read either", count - 1))
            }
        })
    }
}

/// They ask for nothing that a ray tracer would do otherwise.
const IGNORED: [&[u8]; 2] = [b"map_aat", b"sharpness"];

const PHYSICAL: [&[u8]; 10] =
    [b"ps", b"pc", b"pcr", b"aniso", b"anisor", b"map_ps", b"map_pc", b"map_pcr", b"map_rma", b"map_orm"];

fn unknown(kind: &Kind) -> String {
    let statements = if kind.count == 1 { "statement is" } else { "statements are" };
    format!("{} {} {statements} skipped (not supported)", kind.count, quote(kind.keyword))
}

#[cfg(test)]
mod tests;
