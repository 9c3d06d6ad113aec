//! All instances brought to world space, in arrays as the kernels read them.

use glam::{Mat3, Vec3};
use raywarp_core::math;
use raywarp_core::surface::Primitive;
use raywarp_core::triangle::{flags, Triangle};

use super::RenderError;
use crate::backend::DeviceError;
use crate::scene::{memory, AlphaMode, Instance, Material, Mesh, Scene};

/// A scene without instances. Optional vertex data is either there for all vertices or for none.
#[derive(Debug, Default)]
pub(crate) struct Flat {
    pub positions: Vec<math::Vec3>,
    pub normals: Vec<math::Vec3>,
    pub uvs: Vec<[f32; 2]>,
    pub second_uvs: Vec<[f32; 2]>,
    pub colors: Vec<[f32; 4]>,
    pub tangents: Vec<[f32; 4]>,
    pub primitives: Vec<Primitive>,
    pub triangles: Vec<Triangle>,
    /// Of each instance.
    pub places: Vec<Place>,
}

/// Where an instance is among the vertices and primitives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub first_vertex: usize,
    pub vertices: usize,
    pub first_primitive: u32,
    /// Its triangles turn round.
    pub mirrored: bool,
}

impl Flat {
    /// # Errors
    /// [`RenderError::Scene`] for an index out of range.
    pub fn of(scene: &Scene) -> Result<Self, RenderError> {
        Self::with(scene, &scene.instances, &scene.materials)
    }

    /// With these instances and materials instead of the scene's own.
    ///
    /// # Errors
    /// As for [`of`](Self::of).
    pub fn with(scene: &Scene, instances: &[Instance], materials: &[Material]) -> Result<Self, RenderError> {
        let placed = || instances.iter().filter_map(|instance| scene.meshes.get(instance.mesh));
        let with_uvs = placed().any(|mesh| !mesh.uvs.is_empty());
        let with_second_uvs = placed().any(|mesh| !mesh.second_uvs.is_empty());
        let with_colors = placed().any(|mesh| !mesh.colors.is_empty());
        let with_tangents = placed().any(|mesh| !mesh.tangents.is_empty());
        let totals = placed().fold([0; 2], |[v, t], mesh| [v + mesh.positions.len(), t + mesh.triangles.len()]);
        if let Some(&len) = totals.iter().find(|&&len| u32::try_from(len).is_err()) {
            return Err(DeviceError::TooMany { len }.into());
        }
        let optional = [with_uvs, with_second_uvs, with_colors, with_tangents].into_iter().zip([8, 8, 16, 16]);
        check_memory(totals, optional.filter(|(there, _)| *there).map(|(_, bytes)| bytes).sum())?;
        let triangle_flags: Vec<u32> = materials.iter().map(flags_of).collect();

        let mut flat = Self::default();
        for instance in instances {
            let mesh = check_instance(scene, instance)?;
            check_mesh(scene, instance, mesh)?;
            let first = flat.positions.len() as u32;
            flat.places.push(Place {
                first_vertex: flat.positions.len(),
                vertices: mesh.positions.len(),
                first_primitive: flat.primitives.len() as u32,
                mirrored: is_mirrored(instance),
            });
            flat.place(mesh, instance);
            pad(&mut flat.uvs, &mesh.uvs, mesh, with_uvs, [0.0; 2]);
            pad(&mut flat.second_uvs, &mesh.second_uvs, mesh, with_second_uvs, [0.0; 2]);
            pad(&mut flat.colors, &mesh.colors, mesh, with_colors, [1.0; 4]);
            if mesh.tangents.is_empty() {
                pad(&mut flat.tangents, &[], mesh, with_tangents, [0.0; 4]);
            }
            flat.add_triangles(mesh, instance, first, &triangle_flags);
        }
        Ok(flat)
    }

    /// Adds positions, normals and tangents in world space.
    pub fn place(&mut self, mesh: &Mesh, instance: &Instance) {
        let linear = Mat3::from_cols_array_2d(&instance.transform.columns);
        let shift = Vec3::from(instance.transform.translation);
        let world = |v: Vec3| math::Vec3::from(v.to_array());
        self.positions.extend(mesh.positions.iter().map(|&p| world(linear * Vec3::from(p) + shift)));
        // Normals go by the cofactors: the inverse transpose up to a positive factor, defined for flat transforms too.
        let turn = cofactors(linear) * linear.determinant().signum();
        match mesh.normals.is_empty() {
            true => self.normals.resize(self.positions.len(), math::Vec3::ZERO),
            false => {
                self.normals.extend(mesh.normals.iter().map(|&n| world((turn * Vec3::from(n)).normalize_or_zero())))
            }
        }
        let handed = linear.determinant().signum();
        self.tangents.extend(mesh.tangents.iter().map(|&[x, y, z, w]| {
            let [x, y, z] = (linear * Vec3::new(x, y, z)).normalize_or_zero().to_array();
            [x, y, z, w * handed]
        }));
    }

    fn add_triangles(&mut self, mesh: &Mesh, instance: &Instance, first: u32, triangle_flags: &[u32]) {
        // A mirrored instance turns outside in, unless its triangles turn round too.
        let mirrored = is_mirrored(instance);
        self.primitives.reserve(mesh.triangles.len());
        self.triangles.reserve(mesh.triangles.len());
        for (&[a, b, c], &material) in mesh.triangles.iter().zip(&mesh.materials) {
            let [b, c] = if mirrored { [c, b] } else { [b, c] };
            let vertices = [first + a, first + b, first + c];
            let material = instance.material.unwrap_or(material);
            let index = self.primitives.len() as u32;
            self.primitives.push(Primitive { vertices, material });
            let [v0, v1, v2] = vertices.map(|vertex| self.positions[vertex as usize]);
            self.triangles.push(Triangle::new(v0, v1, v2, index, triangle_flags[material as usize]));
        }
    }
}

/// Refuses instances that do not fit in the memory of this machine once they are in world space, with the nodes of a tree
/// over them. `optional` is what a vertex has beside its position and its normal.
fn check_memory([vertices, triangles]: [usize; 2], optional: usize) -> Result<(), RenderError> {
    const VERTEX: usize = 2 * std::mem::size_of::<math::Vec3>();
    const TRIANGLE: usize = std::mem::size_of::<Primitive>() + std::mem::size_of::<Triangle>() + TREE;
    // A node of a binary tree has its two boxes.
    const TREE: usize = 64;
    let needed = vertices as u64 * (VERTEX + optional) as u64 + triangles as u64 * TRIANGLE as u64;
    match memory::available() {
        Some(available) if needed > available => Err(DeviceError::Memory {
            device: "this machine".to_owned(),
            purpose: "the instances of the scene".to_owned(),
            needed,
            available,
        }
        .into()),
        _ => Ok(()),
    }
}

/// Whether an instance's transform turns left into right.
pub(super) fn is_mirrored(instance: &Instance) -> bool {
    Mat3::from_cols_array_2d(&instance.transform.columns).determinant() < 0.0
}

/// Rows of cross products: `det(m) * inverse(m)^T`.
fn cofactors(m: Mat3) -> Mat3 {
    Mat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

fn pad<T: Copy>(all: &mut Vec<T>, own: &[T], mesh: &Mesh, wanted: bool, missing: T) {
    if wanted && own.is_empty() {
        all.resize(all.len() + mesh.positions.len(), missing);
    } else if wanted {
        all.extend_from_slice(own);
    }
}

/// What shadow and camera rays must know of a triangle without asking its material.
pub(crate) fn flags_of(material: &Material) -> u32 {
    let cutout = if material.alpha == AlphaMode::Opaque { 0 } else { flags::CUTOUT };
    let transparent = if material.transmission == [0.0; 3] { 0 } else { flags::TRANSPARENT };
    cutout | transparent
}

/// The mesh of an instance, once its own indices are in range.
pub(crate) fn check_instance<'a>(scene: &'a Scene, instance: &Instance) -> Result<&'a Mesh, RenderError> {
    let mesh = scene.meshes.get(instance.mesh).ok_or_else(|| wrong(instance, "the mesh index"))?;
    match instance.material {
        Some(material) if material as usize >= scene.materials.len() => Err(wrong(instance, "a material index")),
        _ => Ok(mesh),
    }
}

/// Whether all indices of an instance's mesh are in range: kernels do not look.
pub(crate) fn check_mesh(scene: &Scene, instance: &Instance, mesh: &Mesh) -> Result<(), RenderError> {
    let vertices = mesh.positions.len();
    let fits = |len: usize| len == 0 || len == vertices;
    let lists = [mesh.normals.len(), mesh.uvs.len(), mesh.second_uvs.len(), mesh.colors.len(), mesh.tangents.len()];
    if !lists.into_iter().all(fits) {
        return Err(wrong(instance, "the number of normals, texture coordinates, colours or tangents"));
    }
    if mesh.triangles.iter().flatten().any(|&vertex| vertex as usize >= vertices) {
        return Err(wrong(instance, "a vertex index"));
    }
    if mesh.materials.len() != mesh.triangles.len()
        || mesh.materials.iter().any(|&m| m as usize >= scene.materials.len())
    {
        return Err(wrong(instance, "a material index"));
    }
    Ok(())
}

fn wrong(instance: &Instance, part: &'static str) -> RenderError {
    RenderError::Scene { mesh: format!("the instance '{}'", instance.name), part }
}

/// Low and high corner of all triangles; both zero where there are none.
pub(crate) fn bounds(triangles: &[Triangle]) -> [[f32; 3]; 2] {
    let corners = triangles.iter().flat_map(|t| [t.v0, t.v1, t.v2]);
    corners
        .fold(None, |bounds, v| match bounds {
            None => Some((v, v)),
            Some((low, high)) => Some((v.min(low), v.max(high))),
        })
        .map_or([[0.0; 3]; 2], |(low, high): (math::Vec3, math::Vec3)| [low.to_array(), high.to_array()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Transform;

    fn scene(transform: Transform) -> Scene {
        let mesh = Mesh {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            triangles: vec![[0, 1, 2]],
            materials: vec![0],
            ..Mesh::default()
        };
        let instance = Instance { name: "i".into(), mesh: 0, transform, material: None };
        Scene {
            meshes: vec![mesh],
            instances: vec![instance],
            materials: vec![Material::default()],
            ..Scene::default()
        }
    }

    fn scaled(x: f32, y: f32, z: f32) -> Transform {
        Transform { columns: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], translation: [5.0, 0.0, 0.0] }
    }

    #[test]
    fn positions_move_and_normals_stay_at_right_angles() {
        let flat = Flat::of(&scene(scaled(2.0, 3.0, 0.5))).unwrap();
        assert_eq!(flat.positions[1].to_array(), [7.0, 0.0, 0.0]);
        assert_eq!(flat.normals[0].to_array(), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn instances_beyond_the_memory_of_the_machine_are_refused_before_they_are_made() {
        let mut scene = scene(Transform::IDENTITY);
        scene.meshes[0].triangles = vec![[0, 1, 2]; 1 << 18];
        scene.meshes[0].materials = vec![0; 1 << 18];
        scene.instances = vec![scene.instances[0].clone(); (1 << 14) - 1];
        // More than half a terabyte.
        if memory::available().is_none_or(|bytes| bytes > 1 << 39) {
            return;
        }
        let Err(RenderError::Device(error)) = Flat::of(&scene) else { panic!("it fits") };
        assert!(matches!(&error, DeviceError::Memory { needed, available, .. } if needed > available), "{error}");
        assert!(error.to_string().contains("for the instances of the scene"), "{error}");
    }

    #[test]
    fn a_mirrored_instance_keeps_its_outside() {
        let flat = Flat::of(&scene(scaled(-1.0, 1.0, 1.0))).unwrap();
        let t = flat.triangles[0];
        let outward = (t.v1 - t.v0).cross(t.v2 - t.v0).normalize();
        assert_eq!(outward.to_array(), [0.0, 0.0, 1.0]);
        assert_eq!(flat.normals[0].to_array(), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn indices_out_of_range_are_an_error() {
        for damage in [
            (|s: &mut Scene| s.instances[0].mesh = 1) as fn(&mut Scene),
            |s| s.meshes[0].triangles[0][2] = 3,
            |s| s.meshes[0].materials[0] = 1,
            |s| s.instances[0].material = Some(9),
            |s| s.meshes[0].normals.truncate(1),
        ] {
            let mut broken = scene(Transform::IDENTITY);
            damage(&mut broken);
            assert!(matches!(Flat::of(&broken), Err(RenderError::Scene { .. })));
        }
    }
}
