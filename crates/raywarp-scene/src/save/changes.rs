//! What differs between two states of a scene, in the words of a scene file.

use std::collections::HashMap;

use super::entries::{CameraEntry, LightEntry, MaterialEntry, MaterialKeys, Move, Render, Sky, Which};
use super::number::{Color, Number};
use super::SaveError;
use crate::{AlphaMode, Instance, Material, RenderDefaults, Scene};

/// All that differs.
pub struct Changes {
    pub lights: Change<Vec<LightEntry>>,
    pub cameras: Change<Vec<CameraEntry>>,
    pub background: Change<Sky>,
    pub ambient: Change<Color>,
    pub render: Change<Render>,
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
fn render(read: &RenderDefaults, now: &RenderDefaults) -> Change<Render> {
    let (read, now) = (Render::new(read), Render::new(now));
    let mut taken_away = false;
    let added = Render {
        size: different(read.size, now.size, &mut taken_away),
        spp: different(read.spp, now.spp, &mut taken_away),
        max_depth: different(read.max_depth, now.max_depth, &mut taken_away),
        shadows: different(read.shadows, now.shadows, &mut taken_away),
        seed: different(read.seed, now.seed, &mut taken_away),
        exposure: different(read.exposure, now.exposure, &mut taken_away),
        tone_map: different(read.tone_map, now.tone_map, &mut taken_away),
        accel: different(read.accel, now.accel, &mut taken_away),
        tree: different(read.tree, now.tree, &mut taken_away),
    };
    match taken_away {
        true => Change { dropped: true, added: Some(now) },
        false => Change { dropped: false, added: (!added.is_empty()).then_some(added) },
    }
}

fn different<T: PartialEq>(read: Option<T>, now: Option<T>, taken_away: &mut bool) -> Option<T> {
    *taken_away |= read.is_some() && now.is_none();
    now.filter(|now| read.as_ref() != Some(now))
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
    let map = |what: &str, same: bool, is_there: bool| match (same, is_there) {
        (true, _) => Ok(None),
        (false, false) => Ok(Some(false)),
        (false, true) => Err(unsupported(&format!("another {what} of the material '{}'", now.name))),
    };
    let (alpha, cutoff) = alpha(read.alpha, now.alpha);
    Ok(MaterialKeys {
        name: (read.name != now.name).then(|| now.name.clone()),
        diffuse: color(read.diffuse, now.diffuse),
        ambient: color(read.ambient, now.ambient),
        specular: color(read.specular, now.specular),
        shininess: number(read.shininess, now.shininess),
        emission: color(read.emission, now.emission),
        reflection: color(read.reflection, now.reflection),
        transmission: color(read.transmission, now.transmission),
        ior: number(read.ior, now.ior),
        fresnel: (read.fresnel != now.fresnel).then_some(now.fresnel),
        opacity: number(read.opacity, now.opacity),
        alpha,
        cutoff,
        unlit: (read.unlit != now.unlit).then_some(now.unlit),
        diffuse_map: map("diffuse map", read.diffuse_map == now.diffuse_map, now.diffuse_map.is_some())?,
        specular_map: map("specular map", read.specular_map == now.specular_map, now.specular_map.is_some())?,
        emission_map: map("emission map", read.emission_map == now.emission_map, now.emission_map.is_some())?,
        opacity_map: map("opacity map", read.opacity_map == now.opacity_map, now.opacity_map.is_some())?,
        normal_map: map("normal map", read.normal_map == now.normal_map, now.normal_map.is_some())?,
    })
}

fn color(read: [f32; 3], now: [f32; 3]) -> Option<Color> {
    Some(Color::new(now)).filter(|now| *now != Color::new(read))
}

fn number(read: f32, now: f32) -> Option<Number> {
    Some(Number::new(now)).filter(|now| !now.is(read))
}

fn alpha(read: AlphaMode, now: AlphaMode) -> (Option<&'static str>, Option<Number>) {
    let words = |mode| match mode {
        AlphaMode::Opaque => ("opaque", None),
        AlphaMode::Mask(cutoff) => ("mask", Some(Number::new(cutoff))),
        AlphaMode::Blend => ("blend", None),
    };
    let (read, now) = (words(read), words(now));
    match read == now {
        true => (None, None),
        false => (Some(now.0), now.1),
    }
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
