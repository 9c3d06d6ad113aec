//! What differs between two states of a scene, in the words of a scene file.

use std::collections::HashMap;

use super::entries::{CameraEntry, LightEntry, MaterialEntry, MaterialKeys, Move, Sky, Which};
use super::number::Color;
use super::parameters::Keys;
use super::SaveError;
use crate::{Instance, Material, RenderDefaults, Scene};

/// All that differs.
pub struct Changes {
    pub lights: Change<Vec<LightEntry>>,
    pub cameras: Change<Vec<CameraEntry>>,
    pub background: Change<Sky>,
    pub ambient: Change<Color>,
    pub render: Change<Keys>,
    pub materials: Vec<MaterialEntry>,
    pub moves: Vec<Move>,
}

/// How a part of a scene differs.
pub struct Change<T> {
    /// Nothing of it comes along from the base.
    pub dropped: bool,
    /// What the new file says.
    pub added: Option<T>,
}

impl<T> Change<T> {
    const NONE: Self = Self { dropped: false, added: None };

    fn is_none(&self) -> bool {
        !self.dropped && self.added.is_none()
    }
}

impl Changes {
    /// From one state to another.
    pub fn between(read: &Scene, now: &Scene) -> Result<Self, SaveError> {
        Ok(Self {
            lights: lights(read, now),
            cameras: cameras(read, now),
            background: value(read.background.as_ref().map(Sky::new), now.background.as_ref().map(Sky::new)),
            ambient: value(read.ambient.map(Color::new), now.ambient.map(Color::new)),
            render: render(&read.render, &now.render),
            materials: materials(&read.materials, &now.materials)?,
            moves: moves(&read.instances, &now.instances)?,
        })
    }

    /// The name of a part that differs, if any does.
    pub fn first(&self) -> Option<&'static str> {
        let parts = [
            ("the lights", self.lights.is_none()),
            ("the cameras", self.cameras.is_none()),
            ("the background", self.background.is_none()),
            ("the ambient light", self.ambient.is_none()),
            ("the options of rendering", self.render.is_none()),
            ("the materials", self.materials.is_empty()),
            ("the places of instances", self.moves.is_empty()),
        ];
        parts.into_iter().find(|(_, same)| !same).map(|(what, _)| what)
    }
}

/// Lights of a file come after those of its base.
fn lights(read: &Scene, now: &Scene) -> Change<Vec<LightEntry>> {
    let [read, now] = [read, now].map(|scene| scene.lights.iter().map(LightEntry::from).collect::<Vec<_>>());
    let added = now.strip_prefix(read.as_slice()).map(<[_]>::to_vec);
    list(added, now)
}

/// Cameras of a file come before those of its base.
fn cameras(read: &Scene, now: &Scene) -> Change<Vec<CameraEntry>> {
    let [read, now] = [read, now].map(|scene| scene.cameras.iter().map(CameraEntry::from).collect::<Vec<_>>());
    let added = now.strip_suffix(read.as_slice()).map(<[_]>::to_vec);
    list(added, now)
}

/// A list to which some were `added`, or else all of which is new.
fn list<T>(added: Option<Vec<T>>, all: Vec<T>) -> Change<Vec<T>> {
    match added {
        Some(added) if added.is_empty() => Change::NONE,
        Some(added) => Change { dropped: false, added: Some(added) },
        None => Change { dropped: true, added: Some(all) },
    }
}

fn value<T: PartialEq>(read: Option<T>, now: Option<T>) -> Change<T> {
    match now == read {
        true => Change::NONE,
        false => Change { dropped: now.is_none(), added: now },
    }
}

/// Key by key, unless one was taken away: a file can do that only with all of them.
fn render(read: &RenderDefaults, now: &RenderDefaults) -> Change<Keys> {
    let all = Keys::all(now);
    if !all.have_all_of(&Keys::all(read)) {
        return Change { dropped: true, added: Some(all) };
    }
    let added = Keys::changed(read, now);
    Change { dropped: false, added: (!added.is_empty()).then_some(added) }
}

fn materials(read: &[Material], now: &[Material]) -> Result<Vec<MaterialEntry>, SaveError> {
    if read.len() != now.len() {
        return Err(unsupported("another number of materials"));
    }
    let names = Names::new(read.iter().map(|material| material.name.as_str()));
    let mut entries = Vec::new();
    for (index, (read, now)) in read.iter().zip(now).enumerate() {
        let keys = material(read, now)?;
        if keys != MaterialKeys::default() {
            entries.push(MaterialEntry { replaces: names.which(index, &read.name), keys });
        }
    }
    Ok(entries)
}

fn material(read: &Material, now: &Material) -> Result<MaterialKeys, SaveError> {
    let maps = [
        ("diffuse_map", read.diffuse_map == now.diffuse_map, now.diffuse_map.is_some()),
        ("specular_map", read.specular_map == now.specular_map, now.specular_map.is_some()),
        ("emission_map", read.emission_map == now.emission_map, now.emission_map.is_some()),
        ("opacity_map", read.opacity_map == now.opacity_map, now.opacity_map.is_some()),
        ("normal_map", read.normal_map == now.normal_map, now.normal_map.is_some()),
    ];
    let own = |material: &Material| material.metallic_roughness.clone().unwrap_or_default();
    let (before, after) = (own(read), own(now));
    let physical = [
        ("metallic_map", before.metallic_map == after.metallic_map, after.metallic_map.is_some()),
        ("roughness_map", before.roughness_map == after.roughness_map, after.roughness_map.is_some()),
        ("transmission_map", before.transmission_map == after.transmission_map, after.transmission_map.is_some()),
    ];
    let mut keys = MaterialKeys {
        name: (read.name != now.name).then(|| now.name.clone()),
        parameters: Keys::changed(read, now),
        ..MaterialKeys::default()
    };
    for (what, _, is_there) in maps.into_iter().chain(physical).filter(|(_, same, _)| !same) {
        if is_there {
            return Err(unsupported(&format!("another {} of the material '{}'", what.replace('_', " "), now.name)));
        }
        keys.maps.insert(what, false);
    }
    Ok(keys)
}

fn moves(read: &[Instance], now: &[Instance]) -> Result<Vec<Move>, SaveError> {
    let same = |(a, b): (&Instance, &Instance)| a.name == b.name && a.mesh == b.mesh && a.material == b.material;
    if read.len() != now.len() || !read.iter().zip(now).all(same) {
        return Err(unsupported("other instances, or instances with other names, meshes or materials"));
    }
    let bits = |instance: &Instance| {
        let transform = &instance.transform;
        (transform.columns.map(|column| column.map(f32::to_bits)), transform.translation.map(f32::to_bits))
    };
    let moved: Vec<_> = read.iter().zip(now).enumerate().filter(|(_, (a, b))| bits(a) != bits(b)).collect();
    if moved.is_empty() {
        return Ok(Vec::new());
    }
    let names = Names::new(read.iter().map(|instance| instance.name.as_str()));
    let entry = |(index, (read, now)): (usize, (&Instance, &Instance))| {
        Move::new(names.which(index, &read.name), &now.transform)
    };
    Ok(moved.into_iter().map(entry).collect())
}

/// How often each name is there.
struct Names<'a>(HashMap<&'a str, usize>);

impl<'a> Names<'a> {
    fn new(names: impl Iterator<Item = &'a str>) -> Self {
        let mut counts = HashMap::new();
        names.for_each(|name| *counts.entry(name).or_default() += 1);
        Self(counts)
    }

    /// A name if it says which one is meant, else the number.
    fn which(&self, index: usize, name: &str) -> Which {
        match self.0.get(name) {
            Some(1) if !name.is_empty() => Which::Named(name.to_owned()),
            _ => Which::Numbered(index),
        }
    }
}

fn unsupported(what: &str) -> SaveError {
    SaveError::Unsupported { what: what.to_owned() }
}
