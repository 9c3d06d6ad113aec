//! Textures on meshes that have no coordinates for them: there a material shows its plain colour, and not one texel.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use super::quote::quote;
use super::{LoadError, Sources};
use crate::{Material, NormalMap, Scene, Texture, UvSet};

/// Of the two sets of texture coordinates, those that something holds for.
type Sets = [bool; 2];

/// Takes the textures from the materials of such meshes, with one warning. A material that other meshes have
/// coordinates for stays as it is, and these get a copy of it.
pub(super) fn settle(path: &Path, scene: &mut Scene, sources: &mut Sources) -> Result<(), LoadError> {
    let coordinates = Coordinates::of(scene);
    if !coordinates.may_miss() {
        return Ok(());
    }
    let uses = Uses::of(scene, &coordinates);
    let Some(&(mesh, material)) = uses.without.first() else { return Ok(()) };
    warn(path, scene, [mesh, material as usize], uses.without.len() - 1, sources)?;
    let plain = plain_materials(scene, &uses, &coordinates);
    give(scene, &plain, &coordinates);
    Ok(())
}

/// Which sets of texture coordinates there are and are asked for.
struct Coordinates {
    /// Read by the textures of each material.
    read: Vec<Sets>,
    /// Not there, mesh by mesh.
    lacking: Vec<Sets>,
}

impl Coordinates {
    fn of(scene: &Scene) -> Self {
        let lacking = scene.meshes.iter().map(|mesh| [mesh.uvs.is_empty(), mesh.second_uvs.is_empty()]);
        Self { read: scene.materials.iter().map(sets_read).collect(), lacking: lacking.collect() }
    }

    /// Whether any mesh lacks what any material reads.
    fn may_miss(&self) -> bool {
        let any = |list: &[Sets], set: usize| list.iter().any(|sets| sets[set]);
        (0..2).any(|set| any(&self.read, set) && any(&self.lacking, set))
    }

    /// Sets that a material reads and a mesh lacks; none where it reads none, or there is no such mesh or material.
    fn missing(&self, mesh: usize, material: u32) -> Option<Sets> {
        let (lacking, read) = (self.lacking.get(mesh)?, self.read.get(material as usize)?);
        (read != &[false; 2]).then(|| [0, 1].map(|set| lacking[set] && read[set]))
    }
}

/// Which meshes use which textured materials.
#[derive(Default)]
struct Uses {
    /// Meshes that lack coordinates of materials, and these, each pair once.
    without: Vec<(usize, u32)>,
    /// Materials of meshes with all their texture coordinates.
    with: HashSet<u32>,
}

impl Uses {
    fn of(scene: &Scene, coordinates: &Coordinates) -> Self {
        let (mut uses, mut seen) = (Self::default(), HashSet::new());
        let own = scene.meshes.iter().enumerate().flat_map(|(at, mesh)| mesh.materials.iter().map(move |&m| (at, m)));
        let given = scene.instances.iter().filter_map(|instance| Some((instance.mesh, instance.material?)));
        let replaced = replaced(scene);
        let own = own.filter(|&(mesh, _)| !replaced[mesh]);
        let mut last = None;
        for pair in own.chain(given) {
            // Neighbours are alike as a rule.
            if last == Some(pair) {
                continue;
            }
            last = Some(pair);
            match coordinates.missing(pair.0, pair.1) {
                Some([false, false]) => drop(uses.with.insert(pair.1)),
                Some(_) if seen.insert(pair) => uses.without.push(pair),
                _ => {}
            }
        }
        uses
    }
}

/// Whether all instances of a mesh, at least one, have other materials than its own.
fn replaced(scene: &Scene) -> Vec<bool> {
    let (mut placed, mut own) = (vec![false; scene.meshes.len()], vec![false; scene.meshes.len()]);
    for instance in &scene.instances {
        if let (Some(placed), Some(own)) = (placed.get_mut(instance.mesh), own.get_mut(instance.mesh)) {
            *placed = true;
            *own |= instance.material.is_none();
        }
    }
    placed.into_iter().zip(own).map(|(placed, own)| placed && !own).collect()
}

/// Indices of what stands for materials where sets of texture coordinates are missing.
type Plain = HashMap<(u32, Sets), u32>;

fn plain_materials(scene: &mut Scene, uses: &Uses, coordinates: &Coordinates) -> Plain {
    let mut plain = Plain::new();
    // A material that all its meshes lack the same for need not be copied.
    let mut kept = uses.with.clone();
    let mut originals = HashMap::new();
    for &(mesh, index) in &uses.without {
        let Some(missing) = coordinates.missing(mesh, index) else { continue };
        if plain.contains_key(&(index, missing)) {
            continue;
        }
        let original = originals.entry(index).or_insert_with(|| scene.materials[index as usize].clone());
        let mut stripped = original.clone();
        strip(&mut stripped, missing);
        if kept.insert(index) {
            scene.materials[index as usize] = stripped;
            plain.insert((index, missing), index);
        } else {
            stripped.name = format!("{} (without texture)", stripped.name);
            plain.insert((index, missing), scene.materials.len() as u32);
            scene.materials.push(stripped);
        }
    }
    plain
}

fn give(scene: &mut Scene, plain: &Plain, coordinates: &Coordinates) {
    let stand_in = |mesh: usize, material: u32| {
        let missing = coordinates.missing(mesh, material);
        missing.and_then(|missing| plain.get(&(material, missing)).copied()).unwrap_or(material)
    };
    for (at, mesh) in scene.meshes.iter_mut().enumerate() {
        mesh.materials.iter_mut().for_each(|material| *material = stand_in(at, *material));
    }
    for instance in &mut scene.instances {
        instance.material = instance.material.map(|material| stand_in(instance.mesh, material));
    }
}

fn sets_read(material: &Material) -> Sets {
    let maps = [&material.diffuse_map, &material.specular_map, &material.emission_map, &material.opacity_map];
    let textures = maps.into_iter().flatten().chain(material.normal_map.as_ref().map(texture_of));
    textures.fold([false; 2], |mut read, texture| {
        read[set_of(texture)] = true;
        read
    })
}

/// Takes the textures that read missing sets.
fn strip(material: &mut Material, missing: Sets) {
    let is_missing = |texture: &Texture| missing[set_of(texture)];
    let Material { diffuse_map, specular_map, emission_map, opacity_map, normal_map, .. } = material;
    for map in [diffuse_map, specular_map, emission_map, opacity_map] {
        map.take_if(|texture| is_missing(texture));
    }
    normal_map.take_if(|map| is_missing(texture_of(map)));
}

fn texture_of(map: &NormalMap) -> &Texture {
    match map {
        NormalMap::Tangent { texture, .. } | NormalMap::Height { texture, .. } => texture,
    }
}

fn set_of(texture: &Texture) -> usize {
    usize::from(texture.uv_set == UvSet::Second)
}

fn warn(
    path: &Path,
    scene: &Scene,
    [mesh, material]: [usize; 2],
    more: usize,
    sources: &mut Sources,
) -> Result<(), LoadError> {
    let (mesh, material) = (&scene.meshes[mesh].name, &scene.materials[material].name);
    let others = match more {
        0 => String::new(),
        1 => "; so it is with 1 more such pair".to_owned(),
        more => format!("; so it is with {more} more such pairs"),
    };
    let (mesh, material) = (quote(mesh.as_bytes()), quote(material.as_bytes()));
    let message = format!(
        "the mesh {mesh} has no coordinates for the textures of the material {material}, which shows its plain colour \
         there{others}"
    );
    sources.warn(path, None, message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Instance, LoadOptions, Mesh, Transform};

    fn mesh(name: &str, uvs: bool, materials: &[u32]) -> Mesh {
        Mesh {
            name: name.to_owned(),
            uvs: if uvs { vec![[0.0; 2]; 3] } else { Vec::new() },
            materials: materials.to_vec(),
            ..Mesh::default()
        }
    }

    fn instance(mesh: usize, material: Option<u32>) -> Instance {
        Instance { name: String::new(), mesh, transform: Transform::IDENTITY, material }
    }

    fn brick() -> Material {
        Material { name: "brick".to_owned(), diffuse_map: Some(Texture::new(0, true)), ..Material::default() }
    }

    fn settled(mut scene: Scene) -> (Scene, Vec<String>) {
        let mut sources = Sources::new(&LoadOptions::default());
        settle(Path::new("a"), &mut scene, &mut sources).unwrap();
        (scene, sources.into_warnings().iter().map(ToString::to_string).collect())
    }

    #[test]
    fn the_plain_colour_shows_where_no_mesh_has_coordinates() {
        let meshes = vec![mesh("wall", false, &[0, 0]), mesh("floor", true, &[1])];
        let (scene, warnings) = settled(Scene { meshes, materials: vec![brick(), brick()], ..Scene::default() });
        assert_eq!((scene.materials[0].diffuse_map, scene.materials[0].name.as_str()), (None, "brick"));
        assert_eq!((scene.materials.len(), scene.materials[1].diffuse_map.is_some()), (2, true));
        assert_eq!(
            warnings,
            ["a: the mesh 'wall' has no coordinates for the textures of the material 'brick', which shows its plain colour \
              there"]
        );
    }

    #[test]
    fn a_material_that_other_meshes_need_is_copied() {
        let meshes = vec![mesh("wall", true, &[0]), mesh("bare", false, &[0, 1]), mesh("floor", false, &[1])];
        let instances = vec![instance(0, None), instance(1, None), instance(2, Some(0))];
        let (scene, warnings) =
            settled(Scene { meshes, instances, materials: vec![brick(), Material::default()], ..Scene::default() });
        assert_eq!((scene.meshes[0].materials[0], &scene.meshes[1].materials[..]), (0, &[2, 1][..]));
        assert_eq!((scene.instances[2].material, scene.materials[2].diffuse_map), (Some(2), None));
        assert_eq!(scene.materials[2].name, "brick (without texture)");
        assert!(scene.materials[0].diffuse_map.is_some());
        assert!(warnings.len() == 1 && warnings[0].ends_with("so it is with 1 more such pair"), "{warnings:?}");
    }

    #[test]
    fn materials_that_are_not_seen_there_stay() {
        let meshes = vec![mesh("wall", false, &[0])];
        let instances = vec![instance(0, Some(1))];
        let materials = vec![brick(), Material::default()];
        let (scene, warnings) = settled(Scene { meshes, instances, materials, ..Scene::default() });
        assert!(scene.materials[0].diffuse_map.is_some() && warnings.is_empty());
    }

    #[test]
    fn each_set_of_coordinates_counts_by_itself() {
        let glow = Texture { uv_set: UvSet::Second, ..Texture::new(0, true) };
        let both = || Material { emission_map: Some(glow), ..brick() };
        let second = Mesh { second_uvs: vec![[0.0; 2]; 3], ..mesh("second", false, &[0]) };
        let meshes = vec![second, mesh("first", true, &[0]), mesh("bare", false, &[0])];
        let (scene, warnings) = settled(Scene { meshes, materials: vec![both()], ..Scene::default() });
        let maps = |at: usize| {
            let material = &scene.materials[scene.meshes[at].materials[0] as usize];
            (material.diffuse_map.is_some(), material.emission_map.is_some())
        };
        assert_eq!([maps(0), maps(1), maps(2)], [(false, true), (true, false), (false, false)]);
        assert!(warnings.len() == 1 && warnings[0].ends_with("so it is with 2 more such pairs"), "{warnings:?}");
    }
}
