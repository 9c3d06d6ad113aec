//! From vertices and faces to a scene of one mesh.

use std::path::Path;

use super::super::images::{self, Asker};
use super::super::mtl::beside;
use super::super::quote::quote;
use super::super::{repair, LoadError, Sources};
use super::elements::{is_vertex_list, Body};
use super::faces::Faces;
use super::header::Header;
use super::split::split;
use super::vertices;
use crate::{normals, AlphaMode, Instance, Material, Mesh, Scene, Texture, Transform};

/// Diffuse reflectance of the material; vertex colours and textures multiply it.
pub(super) const DIFFUSE: f32 = 0.8;

/// The scene, with a warning for each kind of thing that was dropped.
pub(super) fn assemble(path: &Path, header: &Header, body: Body, sources: &mut Sources) -> Result<Scene, LoadError> {
    warn(path, header, &body, sources)?;
    let Body { vertices, mut faces, .. } = body;
    let Some(vertices) = vertices else {
        sources.warn(path, None, "the file has no vertices: there is nothing to see")?;
        return Ok(Scene::default());
    };
    vertices.rounding.tell(path, vertices.positions.iter().copied(), sources);
    let mut scene = Scene::default();
    let materials = materials(path, header, &faces, &mut scene, sources)?;
    let mut mesh = Mesh {
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        positions: vertices.positions,
        normals: vertices.normals,
        uvs: vertices.uvs,
        second_uvs: Vec::new(),
        colors: vertices.colors,
        tangents: Vec::new(),
        materials,
        triangles: std::mem::take(&mut faces.triangles),
    };
    match mesh.normals.is_empty() {
        true => normals::smooth(&mut mesh),
        false => mesh.normals.iter_mut().for_each(|normal| *normal = repair::unit_or_zero(*normal)),
    }
    take_attributes(path, &faces, &mut mesh, sources)?;
    let dropped = repair::drop_non_finite(&mut mesh);
    if dropped > 0 {
        sources.warn(path, None, format!("{dropped} triangles use vertices that are not finite and were dropped"))?;
    }
    if mesh.colors.iter().any(|color| color[3] < 1.0) {
        scene.materials.iter_mut().for_each(|material| material.alpha = AlphaMode::Blend);
    }
    place(mesh, &mut scene);
    Ok(scene)
}

fn warn(path: &Path, header: &Header, body: &Body, sources: &mut Sources) -> Result<(), LoadError> {
    let faces = &body.faces;
    for name in header.repeated.iter().filter(|name| vertices::is_read(name) || is_vertex_list(name)) {
        let message = format!("the property {} is defined again; the first holds", quote(name.as_bytes()));
        sources.warn(path, None, message)?;
    }
    if let Some(foreign) = &header.foreign {
        let (count, first) = (foreign.count, quote(foreign.text.as_bytes()));
        let message =
            format!("{count} lines of the header are not statements of PLY and are skipped; the first is {first}");
        sources.warn(path, Some(foreign.line), message)?;
    }
    if body.surplus.rows > 0 {
        let message = format!("{} rows have more values than the header declares; the first count", body.surplus.rows);
        sources.warn(path, Some(body.surplus.first_line), message)?;
    }
    if let Some(vertices) = body.vertices.as_ref().filter(|_| faces.triangles.is_empty() && faces.too_small == 0) {
        let count = vertices.positions.len();
        let message = format!("{count} vertices and no faces: a point cloud, and raywarp shows triangles alone");
        sources.warn(path, None, message)?;
    }
    let counts = [
        (faces.too_small, "faces have fewer than 3 vertices and were dropped"),
        (
            faces.odd_uvs,
            "faces have other than two texture coordinates a corner; those of their vertices or (0, 0) stand in",
        ),
        (body.bright_colors, "colours are brighter than 1 and are cut off there"),
    ];
    for (count, what) in counts.into_iter().filter(|(count, _)| *count > 0) {
        sources.warn(path, None, format!("{count} {what}"))?;
    }
    Ok(())
}

/// Adds the materials to the scene, one for each picture or one without, and says which each triangle has.
fn materials(
    path: &Path,
    header: &Header,
    faces: &Faces,
    scene: &mut Scene,
    sources: &mut Sources,
) -> Result<Vec<u32>, LoadError> {
    let files = &header.texture_files;
    for file in files {
        let asker = Asker { path, line: Some(file.line) };
        let image = images::from_file(&beside(path, &file.name), asker, scene, sources)?;
        let name = if files.len() == 1 { "default" } else { &file.name };
        let map = Some(Texture::new(image, true));
        scene.materials.push(Material { name: name.to_owned(), diffuse_map: map, ..grey() });
    }
    let has_texture = |number: i32| usize::try_from(number).is_ok_and(|number| number < files.len());
    let without = files.len() as u32;
    let numbers = &faces.textures;
    if files.is_empty() || !numbers.iter().all(|&number| has_texture(number)) {
        scene.materials.push(grey());
    }
    let material = |at: usize| match numbers.get(at) {
        Some(&number) if has_texture(number) => number as u32,
        Some(_) => without,
        None => 0,
    };
    Ok((0..faces.triangles.len()).map(material).collect())
}

fn grey() -> Material {
    Material { name: "default".to_owned(), ambient: [DIFFUSE; 3], diffuse: [DIFFUSE; 3], ..Material::default() }
}

/// Gives the mesh what faces say. Texture coordinates of corners take the place of those of vertices, and colours of
/// vertices stay before those of faces.
fn take_attributes(path: &Path, faces: &Faces, mesh: &mut Mesh, sources: &mut Sources) -> Result<(), LoadError> {
    // A table of strips beside the faces has nothing of the kind.
    let whole = |length: usize| length > 0 && length == mesh.triangles.len();
    let uvs = if whole(faces.uvs.len()) { &faces.uvs[..] } else { &[] };
    let mut colors = if whole(faces.colors.len()) { &faces.colors[..] } else { &[] };
    if !colors.is_empty() && !mesh.colors.is_empty() {
        sources.warn(path, None, "colours of faces are left out: vertices have colours of their own")?;
        colors = &[];
    }
    if !uvs.is_empty() || !colors.is_empty() {
        split(mesh, uvs, colors);
    }
    Ok(())
}

fn place(mesh: Mesh, scene: &mut Scene) {
    let name = mesh.name.clone();
    scene.instances.push(Instance { name, mesh: 0, transform: Transform::IDENTITY, material: None });
    scene.meshes.push(mesh);
}
