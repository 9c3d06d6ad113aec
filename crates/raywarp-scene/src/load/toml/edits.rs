//! What a scene file changes in the files that it names: surfaces, and where things stand.

use std::collections::{HashMap, HashSet};
use std::fmt;

use serde::de::{Deserializer, Error, Unexpected, Visitor};
use serde::Deserialize;
use toml::Spanned;

use super::complaint::Complaint;
use super::file::{self, Rotation};
use super::place::{self, Placement, Rows};
use super::values::{Coordinate, PerAxis};
use super::{Failure, Reader};

/// One of a list: by its name, or by its number from 0.
pub enum Which {
    Named(String),
    Numbered(usize),
}

impl<'de> Deserialize<'de> for Which {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WhichVisitor)
    }
}

struct WhichVisitor;

impl Visitor<'_> for WhichVisitor {
    type Value = Which;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name, or a number from 0 in the order of the scene")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Which, E> {
        Ok(Which::Named(name.to_owned()))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Which, E> {
        match usize::try_from(number) {
            Ok(number) => Ok(Which::Numbered(number)),
            Err(_) => Err(E::invalid_value(Unexpected::Signed(number), &self)),
        }
    }
}

/// A new place for an instance.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Move {
    pub instance: Spanned<Which>,
    pub translate: Option<[Coordinate; 3]>,
    pub rotate: Option<Rotation>,
    pub scale: Option<PerAxis<3>>,
    pub matrix: Option<Rows>,
}

impl Reader<'_> {
    /// Changes the materials that come from other files, once all of them are there.
    pub(super) fn edit_materials(&mut self, file: &file::File) -> Result<(), Failure> {
        let edits =
            || file.materials.iter().filter_map(|entry| Some((entry, entry.get_ref().others.replaces.as_ref()?)));
        if edits().next().is_none() {
            return Ok(());
        }
        let own = self.own_materials.clone();
        let names = self.scene.materials.iter().map(|material| material.name.as_str());
        let mut list = List::new("material", names.enumerate().filter(|(index, _)| !own.contains(index)));
        for (entry, which) in edits() {
            for index in list.take(which, self.scene.materials.len())? {
                let mut material = self.scene.materials[index].clone();
                if let Some(name) = &entry.get_ref().others.name {
                    material.name = name.get_ref().clone();
                }
                self.set_material(entry, &mut material)?;
                self.scene.materials[index] = material;
            }
        }
        Ok(())
    }

    /// Puts instances elsewhere, once all of them are there.
    pub(super) fn move_instances(&mut self, file: &file::File) -> Result<(), Failure> {
        if file.moves.is_empty() {
            return Ok(());
        }
        let names = self.scene.instances.iter().map(|instance| instance.name.as_str());
        let mut list = List::new("instance", names.enumerate());
        for entry in &file.moves {
            let (at, moving) = (entry.span().start, entry.get_ref());
            let placement = moving.placement();
            if placement.is_empty() {
                let expected = "matrix, or any of scale, rotate and translate";
                return Err(Complaint::new(at, "a move without a place", expected).into());
            }
            let moved = list.take(&moving.instance, self.scene.instances.len())?;
            let &[index] = moved.as_slice() else {
                let read = format!("{} instances of that name", moved.len());
                let expected = format!("the number of one of them, of which the first is {}", moved[0]);
                return Err(Complaint::new(moving.instance.span().start, read, expected).into());
            };
            self.scene.instances[index].transform = place::transform(&placement, at, &mut self.rounding)?;
        }
        Ok(())
    }
}

/// What can be edited, each once: then a file of many edits takes no longer than it has lines and the scene parts.
struct List {
    /// "material", "instance".
    what: &'static str,
    by_name: HashMap<String, Vec<usize>>,
    editable: HashSet<usize>,
    edited: HashSet<usize>,
}

impl List {
    fn new<'a>(what: &'static str, names: impl Iterator<Item = (usize, &'a str)>) -> Self {
        let mut list = Self { what, by_name: HashMap::new(), editable: HashSet::new(), edited: HashSet::new() };
        for (index, name) in names {
            list.by_name.entry(name.to_owned()).or_default().push(index);
            list.editable.insert(index);
        }
        list
    }

    /// Indices, at least one, of what is to be edited, of a list of `count`.
    fn take(&mut self, which: &Spanned<Which>, count: usize) -> Result<Vec<usize>, Complaint> {
        let at = which.span().start;
        let found = match which.get_ref() {
            Which::Named(name) => self.by_name.get(name).cloned().ok_or_else(|| self.unknown(at, name))?,
            Which::Numbered(index) => vec![self.numbered(at, *index, count)?],
        };
        match found.iter().find(|&&index| !self.edited.insert(index)) {
            Some(index) => {
                let read = format!("a second change of {} {index}", self.what);
                Err(Complaint::new(at, read, "all of it in one place"))
            }
            None => Ok(found),
        }
    }

    fn unknown(&self, at: usize, name: &str) -> Complaint {
        let mut known: Vec<_> = self.by_name.iter().map(|(name, indices)| (indices, name.as_str())).collect();
        known.sort_unstable();
        let known: Vec<_> = known.into_iter().map(|(_, name)| name).collect();
        if known.is_empty() {
            let read = format!("there is no {} '{name}'", self.what);
            return Complaint::new(
                at,
                read,
                format!("a {} of a file that this one names, and there is none", self.what),
            );
        }
        Complaint::unknown(at, self.what, name, &known)
    }

    fn numbered(&self, at: usize, index: usize, count: usize) -> Result<usize, Complaint> {
        let what = self.what;
        if self.editable.contains(&index) {
            return Ok(index);
        }
        let (read, expected) = match count {
            _ if index < count => (
                format!("{what} {index}, which is of this file"),
                "one of another file; change this one where it is".into(),
            ),
            0 => (format!("there is no {what} {index}"), format!("no number, as there is no {what}")),
            _ => {
                let expected = format!("a number from 0 to {}, in the order of the scene", count - 1);
                (format!("there is no {what} {index}"), expected)
            }
        };
        Err(Complaint::new(at, read, expected))
    }
}

impl Move {
    fn placement(&self) -> Placement<'_> {
        Placement {
            translate: self.translate,
            rotate: self.rotate.as_ref(),
            scale: self.scale,
            matrix: self.matrix.as_ref(),
        }
    }
}
