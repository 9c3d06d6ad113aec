//! Meshes of a scene file: other files, or written out.

use toml::Spanned;

use super::complaint::Complaint;
use super::file::{self, Normals};
use super::values::Coordinate;
use super::{Failure, Group, Reader};
use crate::load::{self, precision::Rounding};
use crate::{normals, Instance, Material, Mesh, MetallicRoughness, Scene, Transform};

/// In bytes; no system has longer ones by much.
const LONGEST_NAME: usize = 1024;

impl Reader<'_> {
    /// Reads a mesh, or all that is in a file, into the scene. Nothing is placed yet.
    pub(super) fn mesh(&mut self, entry: &Spanned<file::Mesh>) -> Result<Group, Failure> {
        let at = entry.span().start;
        let entry = entry.get_ref();
        let material = entry.material.as_ref().map(|name| self.material_index(name)).transpose()?;
        let read = match (&entry.file, &entry.vertices) {
            (Some(file), None) => self.named_file(entry, file)?,
            (None, Some(_)) => self.written_out(entry, at)?,
            (None, None) => {
                return Err(Complaint::new(at, "a mesh without geometry", "file, or vertices and faces").into())
            }
            (Some(_), Some(_)) => {
                return Err(Complaint::new(at, "a mesh with a file and vertices", "one of them").into());
            }
        };
        let mut group = self.adopt(read, material);
        if let Some(name) = &entry.name {
            name_instances(&mut group.instances, name.get_ref());
        }
        Ok(group)
    }

    fn named_file(&mut self, entry: &file::Mesh, file: &file::Name) -> Result<Scene, Failure> {
        if !entry.faces.is_empty() || !entry.uvs.is_empty() {
            let read = "faces or uvs beside a file";
            return Err(Complaint::new(file.span().start, read, "them with vertices alone").into());
        }
        check_length(file.get_ref(), file.span().start)?;
        let path = self.folder.join(file.get_ref());
        let read = self.sources.count_use(&path).and_then(|()| load::read(&path, self.sources));
        let mut read = read.map_err(|error| self.named_at(error, &path, file.get_ref(), file.span().start))?;
        for mesh in &mut read.meshes {
            match &entry.normals {
                None | Some(Normals::File) => {}
                Some(Normals::Flat) => mesh.normals.clear(),
                Some(Normals::Smooth) => normals::smooth(mesh),
                Some(Normals::Given(_)) => {
                    let expected = "normals = \"file\", \"flat\" or \"smooth\"";
                    return Err(Complaint::new(file.span().start, "normals beside a file", expected).into());
                }
            }
        }
        if !entry.lights {
            read.lights.clear();
        }
        if !entry.cameras {
            read.cameras.clear();
            read.paths.clear();
        }
        Ok(read)
    }

    fn written_out(&mut self, entry: &file::Mesh, at: usize) -> Result<Scene, Failure> {
        let mut rounding = Rounding::default();
        let rounded = |vertex: &[Coordinate; 3]| vertex.map(|number| rounding.round(number.0));
        let positions: Vec<[f32; 3]> = entry.vertices.iter().flatten().map(rounded).collect();
        rounding.tell(self.path, positions.iter().copied(), self.sources);
        let mut triangles = Vec::new();
        for face in &entry.faces {
            triangles.extend(fan(face, positions.len())?);
        }
        if triangles.is_empty() {
            return Err(Complaint::new(at, "vertices without faces", "faces = [[0, 1, 2], ...]").into());
        }
        let uvs: Vec<_> = entry.uvs.iter().map(|uv| uv.map(|number| number.0)).collect();
        if !uvs.is_empty() && uvs.len() != positions.len() {
            return Err(count_differs(at, "uvs", uvs.len(), positions.len()).into());
        }
        let materials = vec![0; triangles.len()];
        let mut mesh = Mesh { positions, triangles, materials, uvs, ..Mesh::default() };
        mesh.name = entry.name.as_ref().map(|name| name.get_ref().clone()).unwrap_or_default();
        give_normals(&mut mesh, entry, at)?;
        let name = mesh.name.clone();
        let instance = Instance { name, mesh: 0, transform: Transform::IDENTITY, material: None };
        let material = Material { name: "default".to_owned(), ..Material::default() };
        Ok(Scene { meshes: vec![mesh], instances: vec![instance], materials: vec![material], ..Scene::default() })
    }

    /// Moves what another scene has into this one, with a material for all of it if one is given.
    fn adopt(&mut self, read: Scene, material: Option<u32>) -> Group {
        let scene = &mut self.scene;
        let (first_mesh, first_image) = (scene.meshes.len(), scene.images.len() as u32);
        let first_material = scene.materials.len() as u32;
        for mut mesh in read.meshes {
            for index in &mut mesh.materials {
                *index = material.unwrap_or(*index + first_material);
            }
            scene.meshes.push(mesh);
        }
        if material.is_none() {
            scene.images.extend(read.images);
            scene.materials.extend(read.materials.into_iter().map(|material| with_images_from(material, first_image)));
        }
        let instance = |instance: Instance| Instance {
            mesh: instance.mesh + first_mesh,
            material: instance.material.filter(|_| material.is_none()).map(|index| index + first_material),
            ..instance
        };
        let instances = read.instances.into_iter().map(instance).collect();
        Group { instances, lights: read.lights, cameras: read.cameras, paths: read.paths }
    }
}

/// An entry's name is that of its instance. Of several, those keep theirs that their file names.
fn name_instances(instances: &mut [Instance], name: &str) {
    let alone = instances.len() == 1;
    for instance in instances.iter_mut().filter(|instance| alone || instance.name.is_empty()) {
        name.clone_into(&mut instance.name);
    }
}

/// Refuses a file name that is none.
pub(super) fn check_length(name: &str, at: usize) -> Result<(), Complaint> {
    if name.len() > LONGEST_NAME {
        let read = format!("a file name of {} bytes", name.len());
        return Err(Complaint::new(at, read, format!("at most {LONGEST_NAME}")));
    }
    Ok(())
}

fn count_differs(at: usize, what: &str, count: usize, vertices: usize) -> Complaint {
    Complaint::new(at, format!("{count} {what} for {vertices} vertices"), "one for each vertex")
}

/// The triangles of a convex polygon.
fn fan(face: &Spanned<Vec<i64>>, vertices: usize) -> Result<Vec<[u32; 3]>, Complaint> {
    let at = face.span().start;
    let index = |&index: &i64| match u32::try_from(index) {
        Ok(valid) if (valid as usize) < vertices => Ok(valid),
        _ => {
            let expected = format!("one from 0 to {}, as there are {vertices} vertices", vertices.saturating_sub(1));
            Err(Complaint::new(at, format!("the vertex index {index}"), expected))
        }
    };
    let corners = face.get_ref().iter().map(index).collect::<Result<Vec<u32>, _>>()?;
    if corners.len() < 3 {
        return Err(Complaint::new(at, format!("a face of {} vertices", corners.len()), "at least 3"));
    }
    Ok(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]).collect())
}

fn give_normals(mesh: &mut Mesh, entry: &file::Mesh, at: usize) -> Result<(), Complaint> {
    match &entry.normals {
        None | Some(Normals::Flat) => {}
        Some(Normals::Smooth) => normals::smooth(mesh),
        Some(Normals::Given(given)) if given.len() == mesh.positions.len() => {
            mesh.normals = given.iter().map(|normal| unit(normal.map(|number| number.0))).collect();
        }
        Some(Normals::Given(given)) => return Err(count_differs(at, "normals", given.len(), mesh.positions.len())),
        Some(Normals::File) => {
            return Err(Complaint::new(at, "normals = \"file\" without a file", "\"flat\", \"smooth\" or an array"));
        }
    }
    Ok(())
}

/// The unit vector of a normal; a zero one stays, and means flat.
fn unit(normal: [f32; 3]) -> [f32; 3] {
    let normal = normal.map(f64::from);
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 {
        normal.map(|x| (x / length) as f32)
    } else {
        [0.0; 3]
    }
}

/// A material whose images now come after `first` others.
fn with_images_from(mut material: Material, first: u32) -> Material {
    let maps =
        [&mut material.diffuse_map, &mut material.specular_map, &mut material.emission_map, &mut material.opacity_map];
    for texture in maps.into_iter().flatten() {
        texture.image += first;
    }
    let physical = material.metallic_roughness.iter_mut().flat_map(MetallicRoughness::maps_mut);
    for texture in physical.flatten() {
        texture.image += first;
    }
    use crate::NormalMap::{Height, Tangent};
    if let Some(Tangent { texture, .. } | Height { texture, .. }) = &mut material.normal_map {
        texture.image += first;
    }
    material
}
