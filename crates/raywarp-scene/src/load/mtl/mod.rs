//! Wavefront MTL: materials of the Phong model, with maps.
//!
//! A definition is first read as it stands ([`definition`]), then understood ([`meaning`]): its `illum` says which of
//! its values count, and its maps say whether transparency cuts holes or blends.

mod definition;
mod map;
mod meaning;
mod texels;

use std::collections::hash_map::Entry;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::quote::quote;
use super::text::{check_encoding, is_keyword, Kind, Statement, Statements, Tally};
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
    check_encoding(path, bytes)?;
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
    unknown: Tally<'a>,
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
            return Err(no_keyword(path, statement));
        }
        if keyword == b"newmtl" {
            self.definitions.push(Definition::new(statement.text(), statement.line));
        } else if IGNORED.contains(&keyword.as_slice()) {
        } else if PHYSICAL.contains(&keyword.as_slice()) {
            self.physical.get_or_insert(statement.line);
        } else if let Some(definition) = self.definitions.last_mut() {
            if !definition.statement(path, &keyword, statement, sources)? {
                self.unknown.count(statement);
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
        if self.physical.is_some() {
            let message = "statements of the physically based extension (Pr, Pm, ...) are skipped; Kd, Ks and Ns count";
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

/// They ask for nothing that a ray tracer would do otherwise.
const IGNORED: [&[u8]; 2] = [b"map_aat", b"sharpness"];

const PHYSICAL: [&[u8]; 14] = [
    b"pr", b"pm", b"ps", b"pc", b"pcr", b"aniso", b"anisor", b"map_pr", b"map_pm", b"map_ps", b"map_pc", b"map_pcr",
    b"map_rma", b"map_orm",
];

fn unknown(kind: &Kind) -> String {
    let statements = if kind.count == 1 { "statement is" } else { "statements are" };
    format!("{} {} {statements} skipped (not supported)", kind.count, quote(kind.keyword))
}

fn no_keyword(path: &Path, statement: &Statement) -> LoadError {
    let field = statement.first();
    let read = format!("{} is not a statement", field.quoted());
    let expected = "a keyword such as newmtl, Kd or map_Kd";
    statement.error(path, Some(field), read, expected, "Check that this is a Wavefront MTL file.")
}

#[cfg(test)]
mod tests;
