//! Textures on meshes that have no coordinates for them: there a material shows its plain colour, and not one texel.

use std::collections::HashSet;
use std::path::Path;

use super::quote::quote;
use super::{LoadError, Sources};
use crate::{Material, Scene};

/// Takes the textures from the materials of such meshes, with one warning. A material that other meshes have
/// coordinates for stays as it is, and these get a copy of it.
pub(super) fn settle(path: &Path, scene: &mut Scene, sources: &mut Sources) -> Result<(), LoadError> {
    let is_textured: Vec<bool> = scene.materials.iter().map(has_texture).collect();
    if !is_textured.contains(&true) || scene.meshes.iter().all(|mesh| !mesh.uvs.is_empty()) {
        return Ok(());
    }
    let uses = Uses::of(scene, &is_textured);
    let Some(&(mesh, material)) = uses.without.first() else { return Ok(()) };
    warn(path, scene, [mesh, material as usize], uses.without.len() - 1, sources)?;
    let plain = plain_materials(scene, &uses);
    give(scene, &plain);
    Ok(())
}

/// Which meshes use which textured materials.
#[derive(Default)]
struct Uses {
    /// Meshes without texture coordinates and their materials, each pair once.
    without: Vec<(usize, u32)>,
    /// Materials of meshes with texture coordinates.
    with: HashSet<u32>,
}

impl Uses {
    fn of(scene: &Scene, is_textured: &[bool]) -> Self {
        let (mut uses, mut seen) = (Self::default(), HashSet::new());
        let own = scene.meshes.iter().enumerate().flat_map(|(at, mesh)| mesh.materials.iter().map(move |&m| (at, m)));
        let given = scene.instances.iter().filter_map(|instance| Some((instance.mesh, instance.material?)));
        let replaced = replaced(scene);
        let own = own.filter(|&(mesh, _)| !replaced[mesh]);
        let mut last = None;
        for pair in own.chain(given) {
            // Neighbours are alike as a rule.
            let (mesh, material) = pair;
            if last == Some(pair) || !is_textured.get(material as usize).is_some_and(|&is| is) {
                continue;
            }
            last = Some(pair);
            match scene.meshes.get(mesh) {
                Some(mesh) if !mesh.uvs.is_empty() => drop(uses.with.insert(material)),
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

/// Index of what stands for each material on a mesh without texture coordinates.
fn plain_materials(scene: &mut Scene, uses: &Uses) -> Vec<u32> {
    let mut plain: Vec<u32> = (0..scene.materials.len() as u32).collect();
    for &(_, index) in &uses.without {
        let index = index as usize;
        if plain[index] as usize != index {
            continue;
        }
        let stripped = without_textures(&scene.materials[index]);
        if uses.with.contains(&(index as u32)) {
            plain[index] = scene.materials.len() as u32;
            let name = format!("{} (without texture)", stripped.name);
            scene.materials.push(Material { name, ..stripped });
        } else {
            scene.materials[index] = stripped;
        }
    }
    plain
}

fn give(scene: &mut Scene, plain: &[u32]) {
    let stand_in = |material: u32| plain.get(material as usize).copied().unwrap_or(material);
    let meshes = &mut scene.meshes;
    for mesh in meshes.iter_mut().filter(|mesh| mesh.uvs.is_empty()) {
        mesh.materials.iter_mut().for_each(|material| *material = stand_in(*material));
    }
    for instance in &mut scene.instances {
        if meshes.get(instance.mesh).is_some_and(|mesh| mesh.uvs.is_empty()) {
            instance.material = instance.material.map(stand_in);
        }
    }
}

fn has_texture(material: &Material) -> bool {
    let maps = [&material.diffuse_map, &material.specular_map, &material.emission_map, &material.opacity_map];
    material.normal_map.is_some() || maps.into_iter().any(Option::is_some)
}

fn without_textures(material: &Material) -> Material {
    Material {
        diffuse_map: None,
        specular_map: None,
        emission_map: None,
        opacity_map: None,
        normal_map: None,
        ..material.clone()
    }
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
    use crate::{Instance, LoadOptions, Mesh, Texture, Transform};

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
}
