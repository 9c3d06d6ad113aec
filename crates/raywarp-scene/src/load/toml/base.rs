//! What a scene file starts from: another scene, whole, which the rest of the file adds to and edits.

use serde::de::Deserializer;
use serde::Deserialize;

use super::complaint::Complaint;
use super::file::{self, Up};
use super::mesh::check_length;
use super::values::TextOrTable;
use super::{Failure, Reader};
use crate::load::{self, LoadError, BUILT_IN};
use crate::Scene;

/// A scene and what of it comes along: a file name, or a table.
pub struct Base(pub BaseTable);

impl<'de> Deserialize<'de> for Base {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expected = "a scene's file name, \"built-in\", or a table such as { file = \"box.glb\", lights = false }";
        deserializer.deserialize_any(TextOrTable::new(expected)).map(Self)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BaseTable {
    pub file: String,
    #[serde(default = "yes")]
    pub lights: bool,
    #[serde(default = "yes")]
    pub cameras: bool,
    #[serde(default = "yes")]
    pub background: bool,
    #[serde(default = "yes")]
    pub ambient: bool,
    #[serde(default = "yes")]
    pub render: bool,
}

fn yes() -> bool {
    true
}

impl From<String> for BaseTable {
    fn from(file: String) -> Self {
        Self { file, lights: true, cameras: true, background: true, ambient: true, render: true }
    }
}

impl BaseTable {
    /// Takes away what does not come along.
    pub fn strip(&self, scene: &mut Scene) {
        let usual = Scene::default();
        if !self.lights {
            scene.lights = usual.lights;
        }
        if !self.cameras {
            scene.cameras = usual.cameras;
        }
        if !self.background {
            (scene.background, scene.environment) = (usual.background, None);
        }
        if !self.ambient {
            scene.ambient = usual.ambient;
        }
        if !self.render {
            scene.render = usual.render;
        }
    }
}

impl Reader<'_> {
    /// Makes the base, if there is one, the start of the scene.
    pub(super) fn start_from_base(&mut self, file: &file::File) -> Result<(), Failure> {
        let Some(base) = &file.base else { return Ok(()) };
        let at = base.span().start;
        if file.up != Up::Y {
            let read = "an `up` beside a base, which has +Y up when it is read";
            return Err(Complaint::new(at, read, "one of them, and all numbers in axes with +Y up").into());
        }
        let table = &base.get_ref().0;
        check_length(&table.file, at)?;
        self.scene = match self.given_base.take() {
            Some(given) => given,
            None => self.read_base(&table.file, at)?,
        };
        table.strip(&mut self.scene);
        Ok(())
    }

    fn read_base(&mut self, name: &str, at: usize) -> Result<Scene, LoadError> {
        let path = match name {
            BUILT_IN => self.sources.add_built_in(),
            _ => self.folder.join(name),
        };
        let read = self.sources.count_use(&path).and_then(|()| load::read(&path, self.sources));
        read.map_err(|error| self.named_at(error, &path, name, at))
    }
}
