//! raywarp's own scene file: meshes of other files placed, with materials, lights and cameras, in TOML.
//!
//! `docs/scene-file.md` describes it. [`file`] is what can be written, the other modules make a [`Scene`] of it.

mod base;
mod complaint;
mod edits;
mod file;
mod light;
mod material;
mod mesh;
mod parameters;
mod path;
mod place;
#[cfg(test)]
mod tests;
mod texture;
mod values;
mod words;

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use self::complaint::Complaint;
use self::file::{File, Name};
use super::environment::from_file as load_environment;
use super::precision::Rounding;
use super::quote::file_name;
use super::{LoadError, LoadOptions, Place, Sources};
use crate::{radians, Camera, CameraPath, Environment, Instance, Light, Scene, Transform};

/// The version of the format.
const VERSION: i64 = 1;
/// Geometry of this size belongs into a mesh file.
const MAX_BYTES: usize = 64 << 20;
/// Most placed meshes: files that place files that place files would soon fill any memory.
const MAX_INSTANCES: usize = 1_000_000;

/// Reads a scene file and what it names.
pub(super) fn read(path: &Path, sources: &mut Sources) -> Result<Scene, LoadError> {
    sources.enter(path)?;
    let scene = read_entered(path, sources);
    sources.leave();
    scene
}

fn read_entered(path: &Path, sources: &mut Sources) -> Result<Scene, LoadError> {
    let text = text(path, sources)?;
    read_text(path, &text, sources, None)
}

/// What a scene file with this text would make of its base.
///
/// # Errors
/// As [`read`], but for the base, which is not read.
pub(crate) fn applied(path: &Path, text: &str, base: Scene) -> Result<Scene, LoadError> {
    read_text(path, text, &mut Sources::new(&LoadOptions::default()), Some(base))
}

fn read_text(path: &Path, text: &str, sources: &mut Sources, given_base: Option<Scene>) -> Result<Scene, LoadError> {
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut reader = Reader {
        path,
        folder,
        text,
        sources,
        scene: Scene::default(),
        given_base,
        own_materials: 0..0,
        rounding: Rounding::default(),
    };
    let read = parse(text).and_then(|file| reader.read(&file));
    match read {
        Ok(()) => Ok(reader.scene),
        Err(Failure::Here(complaint)) => Err(complaint.into_error(path, text)),
        Err(Failure::Elsewhere(error)) => Err(*error),
    }
}

fn text(path: &Path, sources: &mut Sources) -> Result<String, LoadError> {
    let bytes = sources.bytes(path)?;
    if bytes.len() > MAX_BYTES {
        return Err(LoadError::TooLarge {
            path: path.to_owned(),
            place: Place::File,
            what: format!("the file has {} bytes, and a scene file may have {MAX_BYTES}", bytes.len()),
            help: "Put the geometry into a mesh file, such as a PLY, and name that.".to_owned(),
        });
    }
    String::from_utf8(bytes).map_err(|error| LoadError::Syntax {
        path: path.to_owned(),
        place: Place::Byte(error.utf8_error().valid_up_to() as u64),
        read: "a byte that is no UTF-8 text".to_owned(),
        expected: "a scene file in TOML".to_owned(),
        help: "Check that this is the right file.".to_owned(),
    })
}

fn parse(text: &str) -> Result<File, Failure> {
    let file: File = toml::from_str(text).map_err(|error| Complaint::from_parser(&error))?;
    if *file.version.get_ref() != VERSION {
        let at = file.version.span().start;
        let read = format!("version {}", file.version.get_ref());
        return Err(Complaint::new(at, read, format!("version = {VERSION}")).into());
    }
    Ok(file)
}

/// Why a text in TOML is not what it should be, with its place; `help` is what to do.
pub(crate) fn failure(path: &Path, text: &str, error: &::toml::de::Error, help: &str) -> LoadError {
    Complaint { help: help.to_owned(), ..Complaint::from_parser(error) }.into_error(path, text)
}

/// Why a scene file cannot be used.
enum Failure {
    /// Something in the file itself.
    Here(Complaint),
    /// Something in a file that it names.
    Elsewhere(Box<LoadError>),
}

impl From<Complaint> for Failure {
    fn from(complaint: Complaint) -> Self {
        Self::Here(complaint)
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        Self::Elsewhere(Box::new(error))
    }
}

/// A file under way.
struct Reader<'a> {
    path: &'a Path,
    /// Where names of files start.
    folder: PathBuf,
    text: &'a str,
    sources: &'a mut Sources,
    scene: Scene,
    /// A base that stands for the one that the file names.
    given_base: Option<Scene>,
    /// Where in the scene the materials of this file are.
    own_materials: Range<usize>,
    /// Of the places of instances.
    rounding: Rounding,
}

/// What an entry of `[[meshes]]` stands for: all that its file places.
struct Group {
    instances: Vec<Instance>,
    lights: Vec<Light>,
    cameras: Vec<Camera>,
    paths: Vec<CameraPath>,
}

impl Reader<'_> {
    fn read(&mut self, file: &File) -> Result<(), Failure> {
        self.start_from_base(file)?;
        self.materials(file)?;
        let mut groups = self.groups(file)?;
        self.place(file, &mut groups)?;
        self.edit_materials(file)?;
        self.move_instances(file)?;
        self.rounding.tell_of_places(self.path, &self.scene, self.sources);
        for entry in &file.lights {
            self.scene.lights.push(light::light(entry)?);
        }
        for (index, entry) in file.cameras.iter().enumerate() {
            // The file's own cameras come before those of the files that it names.
            self.scene.cameras.insert(index, light::camera(entry, file.up)?);
        }
        self.paths(file)?;
        self.turn_upright(file);
        self.scene.background = file.background.as_ref().map(light::background).or(self.scene.background);
        self.environment(file)?;
        self.scene.ambient = file.ambient.map(|color| color.0).or(self.scene.ambient);
        file.render.given.apply(&mut self.scene.render);
        Ok(())
    }

    /// The file's own environment counts instead of that of its base.
    fn environment(&mut self, file: &File) -> Result<(), Failure> {
        let Some(entry) = &file.environment else { return Ok(()) };
        let entry = entry.get_ref();
        let read = load_environment(&self.folder.join(&entry.file), self.sources)?;
        self.scene.environment = Some(Environment {
            rotation: radians(entry.rotation.as_ref().map_or(0.0, |angle| angle.0.into())),
            strength: entry.strength.as_ref().map_or(1.0, |strength| strength.0),
            ..read
        });
        Ok(())
    }

    /// The file's own paths come before those of the files that it names.
    fn paths(&mut self, file: &File) -> Result<(), Failure> {
        for (index, entry) in file.paths.iter().enumerate() {
            let same = |path: &CameraPath| entry.get_ref().name.as_ref().filter(|name| name.get_ref() == path.name());
            if let Some(name) = self.scene.paths.iter().take(index).find_map(same) {
                return Err(twice("path", name).into());
            }
            self.scene.paths.insert(index, path::path(entry, file.up)?);
        }
        Ok(())
    }

    /// Reads the materials of this file. Those that edit others wait until all are there.
    fn materials(&mut self, file: &File) -> Result<(), Failure> {
        let first = self.scene.materials.len();
        for entry in file.materials.iter().filter(|entry| entry.get_ref().others.replaces.is_none()) {
            let Some(name) = &entry.get_ref().others.name else {
                let expected = "name = \"NAME\", or replaces = \"NAME\" to change a material of another file";
                return Err(Complaint::new(entry.span().start, "a material without a name", expected).into());
            };
            if self.scene.materials[first..].iter().any(|material| &material.name == name.get_ref()) {
                return Err(twice("material", name).into());
            }
            let material = self.new_material(entry, name.get_ref())?;
            self.scene.materials.push(material);
        }
        self.own_materials = first..self.scene.materials.len();
        Ok(())
    }

    /// Reads every mesh, in the order of the file.
    fn groups(&mut self, file: &File) -> Result<Vec<Option<Group>>, Failure> {
        let mut names = HashMap::new();
        for name in file.meshes.iter().filter_map(|entry| entry.get_ref().name.as_ref()) {
            if names.insert(name.get_ref(), ()).is_some() {
                return Err(twice("mesh", name).into());
            }
        }
        file.meshes.iter().map(|entry| self.mesh(entry).map(Some)).collect()
    }

    /// Places every instance, then once each mesh that has none.
    fn place(&mut self, file: &File, groups: &mut [Option<Group>]) -> Result<(), Failure> {
        let mut placed = vec![false; groups.len()];
        for entry in &file.instances {
            let at = entry.span().start;
            let instance = entry.get_ref();
            let index = mesh_index(file, &instance.mesh)?;
            let transform = place::transform(&instance.into(), at, &mut self.rounding)?;
            let material = instance.material.as_ref().map(|name| self.material_index(name)).transpose()?;
            if let Some(group) = &groups[index] {
                let first = !std::mem::replace(&mut placed[index], true);
                self.place_group(group, &transform, material, instance.name.as_deref(), first)?;
            }
        }
        for (group, placed) in groups.iter_mut().zip(placed) {
            if let (Some(group), false) = (group.take(), placed) {
                self.place_group(&group, &Transform::IDENTITY, None, None, true)?;
            }
        }
        Ok(())
    }

    fn place_group(
        &mut self,
        group: &Group,
        transform: &Transform,
        material: Option<u32>,
        name: Option<&str>,
        first: bool,
    ) -> Result<(), LoadError> {
        let count = self.scene.instances.len() + group.instances.len();
        if count > MAX_INSTANCES || self.scene.lights.len() + group.lights.len() > MAX_INSTANCES {
            return Err(self.too_many());
        }
        self.scene.instances.extend(group.instances.iter().map(|instance| Instance {
            name: name.unwrap_or(&instance.name).to_owned(),
            mesh: instance.mesh,
            transform: transform.after(&instance.transform),
            material: material.or(instance.material),
        }));
        self.scene.lights.extend(group.lights.iter().map(|light| place::moved_light(light, transform)));
        if first {
            self.scene.cameras.extend(group.cameras.iter().map(|camera| place::moved_camera(camera, transform)));
            let moved = |path: &CameraPath| path.moved(|camera| place::moved_camera(camera, transform));
            self.scene.paths.extend(group.paths.iter().map(moved));
        }
        Ok(())
    }

    fn too_many(&self) -> LoadError {
        LoadError::TooLarge {
            path: self.path.to_owned(),
            place: Place::File,
            what: format!("it places more than {MAX_INSTANCES} meshes or lights"),
            help: "Place fewer.".to_owned(),
        }
    }

    /// From the file's axes to the scene's.
    fn turn_upright(&mut self, file: &File) {
        let upright = place::upright(file.up);
        if upright == Transform::IDENTITY {
            return;
        }
        for instance in &mut self.scene.instances {
            instance.transform = upright.after(&instance.transform);
        }
        for light in &mut self.scene.lights {
            *light = place::moved_light(light, &upright);
        }
        for camera in &mut self.scene.cameras {
            *camera = place::moved_camera(camera, &upright);
        }
        for path in &mut self.scene.paths {
            *path = path.moved(|camera| place::moved_camera(camera, &upright));
        }
    }

    /// Index of a material by its name: of this file first, then of the files read so far.
    fn material_index(&self, name: &Name) -> Result<u32, Complaint> {
        let materials = &self.scene.materials;
        let own = self.own_materials.clone();
        let mut order = own.clone().chain(0..own.start).chain(own.end..materials.len());
        match order.find(|&index| &materials[index].name == name.get_ref()) {
            Some(index) => Ok(index as u32),
            None => {
                let known: Vec<_> = materials.iter().map(|material| material.name.as_str()).collect();
                Err(Complaint::unknown(name.span().start, "material", name.get_ref(), &known))
            }
        }
    }

    /// An error about a file as a whole, with the place where it is named.
    fn named_at(&self, error: LoadError, path: &Path, name: &str, at: usize) -> LoadError {
        if !error.is_about_all_of(path) {
            return error;
        }
        let place = complaint::place(self.text, at);
        LoadError::Named { path: self.path.to_owned(), place, name: file_name(name), error: Box::new(error) }
    }

    /// The line of an offset, from 1.
    fn line(&self, at: usize) -> usize {
        self.text.get(..at).unwrap_or_default().matches('\n').count() + 1
    }
}

fn mesh_index(file: &File, name: &Name) -> Result<usize, Complaint> {
    let names = || file.meshes.iter().map(|entry| entry.get_ref().name.as_ref().map(|name| name.get_ref().as_str()));
    names().position(|known| known == Some(name.get_ref())).ok_or_else(|| {
        let known: Vec<_> = names().flatten().collect();
        Complaint::unknown(name.span().start, "mesh", name.get_ref(), &known)
    })
}

fn twice(what: &str, name: &Name) -> Complaint {
    Complaint::new(name.span().start, format!("a second {what} '{}'", name.get_ref()), "every name once")
}
