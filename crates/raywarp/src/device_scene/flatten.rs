//! A scene in arrays as the kernels read them: instances brought to world space, or shared meshes as they are.

use std::ops::Range;

use glam::{BVec3, Mat3, Vec3};
use raywarp_core::math;
use raywarp_core::surface::{self, Primitive};
use raywarp_core::triangle::{flags, Triangle};

use super::SceneError;
use crate::device::DeviceError;
use crate::scene::{memory, AlphaMode, Instance, Material, Mesh, Scene, Transform};
use crate::MISS;

/// A scene in arrays. Optional vertex data is either there for all vertices or for none.
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
    pub instances: Vec<surface::Instance>,
    /// Of each instance in world space.
    pub vertices: Vec<Range<usize>>,
    layout: Layout,
}

/// Which optional vertex data there is.
#[derive(Clone, Copy, Debug, Default)]
struct Layout {
    uvs: bool,
    second_uvs: bool,
    colors: bool,
    tangents: bool,
}

impl Layout {
    /// Bytes of a vertex.
    fn bytes(&self) -> usize {
        let there = [(self.uvs, 8), (self.second_uvs, 8), (self.colors, 16), (self.tangents, 16)];
        there.into_iter().filter(|(there, _)| *there).map(|(_, bytes)| bytes).sum()
    }

    fn of(scene: &Scene, instances: &[Instance]) -> Self {
        let any = |has: fn(&Mesh) -> bool| instances.iter().filter_map(|i| scene.meshes.get(i.mesh)).any(has);
        Self {
            // The second ones lie behind the first.
            uvs: any(|mesh| !mesh.uvs.is_empty() || !mesh.second_uvs.is_empty()),
            second_uvs: any(|mesh| !mesh.second_uvs.is_empty()),
            colors: any(|mesh| !mesh.colors.is_empty()),
            tangents: any(|mesh| !mesh.tangents.is_empty()),
        }
    }
}

impl Flat {
    /// # Errors
    /// [`SceneError::Part`] for an index out of range.
    pub fn of(scene: &Scene) -> Result<Self, SceneError> {
        Self::with(scene, &scene.instances, &scene.materials)
    }

    /// With these instances and materials instead of the scene's own.
    ///
    /// # Errors
    /// As for [`of`](Self::of).
    pub fn with(scene: &Scene, instances: &[Instance], materials: &[Material]) -> Result<Self, SceneError> {
        Self::sharing(scene, instances, materials, |_| false)
    }

    /// The same, where meshes of instances that share them stay in a space of their own. Such have no
    /// [`triangles`](Self::triangles).
    ///
    /// # Errors
    /// As for [`of`](Self::of).
    pub fn sharing(
        scene: &Scene,
        instances: &[Instance],
        materials: &[Material],
        is_shared: impl Fn(usize) -> bool,
    ) -> Result<Self, SceneError> {
        let layout = Layout::of(scene, instances);
        let totals = totals(scene, instances, &is_shared);
        if let Some(&len) = totals.iter().find(|&&len| u32::try_from(len).is_err()) {
            return Err(DeviceError::TooMany { len }.into());
        }
        check_memory(totals, layout.bytes())?;
        let mut flat = Self { layout, ..Self::default() };
        let triangle_flags: Vec<u32> = materials.iter().map(flags_of).collect();
        let mut shared = vec![None; scene.meshes.len()];
        for (index, instance) in instances.iter().enumerate() {
            let mesh = check_instance(scene, instance)?;
            if !is_shared(index) {
                check_mesh(scene, instance, mesh)?;
                flat.add_in_world(mesh, instance, &triangle_flags);
                continue;
            }
            let first_primitive = match shared[instance.mesh] {
                Some(first) => first,
                None => {
                    check_mesh(scene, instance, mesh)?;
                    *shared[instance.mesh].insert(flat.add_mesh(mesh))
                }
            };
            flat.add_instance(instance, first_primitive);
        }
        Ok(flat)
    }

    /// Adds a mesh brought to world space, and its instance.
    fn add_in_world(&mut self, mesh: &Mesh, instance: &Instance, flags: &[u32]) {
        let (first, first_primitive) = (self.positions.len(), self.primitives.len() as u32);
        self.place(mesh, instance);
        self.add_attributes(mesh);
        self.add_triangles(mesh, instance, first as u32, flags);
        self.vertices.push(first..self.positions.len());
        let flags = surface::IN_WORLD | handedness(&instance.transform);
        self.instances.push(surface::Instance { first_primitive, flags, ..surface::Instance::IN_PLACE });
    }

    /// Adds a mesh as it is; tells where its primitives begin.
    fn add_mesh(&mut self, mesh: &Mesh) -> u32 {
        let (first, first_primitive) = (self.positions.len() as u32, self.primitives.len() as u32);
        self.place(mesh, &Instance { name: String::new(), mesh: 0, transform: Transform::IDENTITY, material: None });
        self.add_attributes(mesh);
        let primitive = |(corners, &material): (&[u32; 3], &u32)| Primitive {
            vertices: corners.map(|vertex| first + vertex),
            material,
        };
        self.primitives.extend(mesh.triangles.iter().zip(&mesh.materials).map(primitive));
        first_primitive
    }

    /// Adds an instance of a mesh that stays where it is.
    fn add_instance(&mut self, instance: &Instance, first_primitive: u32) {
        self.vertices.push(0..0);
        self.instances.push(placed(instance, first_primitive));
    }

    /// Adds what a mesh has at its vertices beside what [`place`](Self::place) adds.
    fn add_attributes(&mut self, mesh: &Mesh) {
        let layout = self.layout;
        pad(&mut self.uvs, &mesh.uvs, mesh, layout.uvs, [0.0; 2]);
        pad(&mut self.second_uvs, &mesh.second_uvs, mesh, layout.second_uvs, [0.0; 2]);
        pad(&mut self.colors, &mesh.colors, mesh, layout.colors, [1.0; 4]);
        if mesh.tangents.is_empty() {
            pad(&mut self.tangents, &[], mesh, layout.tangents, [0.0; 4]);
        }
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
        let placed = self.instances.len() as u32;
        self.primitives.reserve(mesh.triangles.len());
        self.triangles.reserve(mesh.triangles.len());
        for ((corners, &material), primitive) in mesh.triangles.iter().zip(&mesh.materials).zip(0..) {
            let vertices = corners.map(|vertex| first + vertex);
            let material = instance.material.unwrap_or(material);
            self.primitives.push(Primitive { vertices, material });
            let [v0, v1, v2] = vertices.map(|vertex| self.positions[vertex as usize]);
            let flags = triangle_flags[material as usize];
            self.triangles.push(Triangle { instance: placed, ..Triangle::new(v0, v1, v2, primitive, flags) });
        }
    }
}

/// An instance of a mesh that stays in a space of its own.
fn placed(instance: &Instance, first_primitive: u32) -> surface::Instance {
    let material = instance.material.unwrap_or(MISS);
    let mut placed = surface::Instance { first_primitive, material, flags: 0, ..surface::Instance::IN_PLACE };
    set_transform(&mut placed, &instance.transform);
    placed
}

/// Puts such an instance elsewhere; one in world space stays as it is.
pub(super) fn set_transform(placed: &mut surface::Instance, transform: &Transform) {
    if placed.flags & surface::IN_WORLD == 0 {
        let ([x, y, z], t) = (transform.columns, transform.translation);
        placed.rows = [0, 1, 2].map(|i| [x[i], y[i], z[i], t[i]]);
        placed.flags = handedness(transform);
    }
}

/// [`MIRRORED`](surface::MIRRORED) where a transform turns left into right.
pub(super) fn handedness(transform: &Transform) -> u32 {
    match Mat3::from_cols_array_2d(&transform.columns).determinant() < 0.0 {
        true => surface::MIRRORED,
        false => 0,
    }
}

/// Vertices and triangles of all instances, those of a shared mesh once.
fn totals(scene: &Scene, instances: &[Instance], is_shared: impl Fn(usize) -> bool) -> [usize; 2] {
    let mut counted = vec![false; scene.meshes.len()];
    let mut own = |(index, instance): (usize, &Instance)| {
        let mesh = scene.meshes.get(instance.mesh)?;
        let again = is_shared(index) && std::mem::replace(&mut counted[instance.mesh], true);
        (!again).then_some([mesh.positions.len(), mesh.triangles.len()])
    };
    instances.iter().enumerate().filter_map(&mut own).fold([0; 2], |[v, t], [own_v, own_t]| [v + own_v, t + own_t])
}

/// Refuses instances that do not fit in the memory of this machine once they are in world space, with the nodes of a tree
/// over them. `optional` is what a vertex has beside its position and its normal.
fn check_memory([vertices, triangles]: [usize; 2], optional: usize) -> Result<(), SceneError> {
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
pub(crate) fn check_instance<'a>(scene: &'a Scene, instance: &Instance) -> Result<&'a Mesh, SceneError> {
    let mesh = scene.meshes.get(instance.mesh).ok_or_else(|| wrong(instance, "the mesh index"))?;
    match instance.material {
        Some(material) if material as usize >= scene.materials.len() => Err(wrong(instance, "a material index")),
        _ => Ok(mesh),
    }
}

/// Whether all indices of an instance's mesh are in range: kernels do not look.
pub(crate) fn check_mesh(scene: &Scene, instance: &Instance, mesh: &Mesh) -> Result<(), SceneError> {
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

fn wrong(instance: &Instance, part: &'static str) -> SceneError {
    SceneError::Part { mesh: format!("the instance '{}'", instance.name), part }
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

/// Low and high corner around the box of each mesh in each of its places, whose indices were checked; both zero where there
/// are none.
pub(crate) fn bounds_of_instances(scene: &Scene) -> [[f32; 3]; 2] {
    let around = |points: &mut dyn Iterator<Item = Vec3>| points.map(|p| (p, p)).reduce(join);
    let boxes: Vec<_> = scene.meshes.iter().map(|mesh| around(&mut mesh.positions.iter().map(|&p| p.into()))).collect();
    let placed = |instance: &Instance| {
        let (low, high) = boxes[instance.mesh]?;
        let linear = Mat3::from_cols_array_2d(&instance.transform.columns);
        let corner = |i: u32| Vec3::select(BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), low, high);
        around(&mut (0..8).map(|i| linear * corner(i) + Vec3::from(instance.transform.translation)))
    };
    let all = scene.instances.iter().filter_map(placed).reduce(join);
    all.map_or([[0.0; 3]; 2], |(low, high)| [low.into(), high.into()])
}

fn join((low, high): (Vec3, Vec3), (a, b): (Vec3, Vec3)) -> (Vec3, Vec3) {
    (low.min(a), high.max(b))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let Err(SceneError::Device(error)) = Flat::of(&scene) else { panic!("it fits") };
        assert!(matches!(&error, DeviceError::Memory { needed, available, .. } if needed > available), "{error}");
        assert!(error.to_string().contains("for the instances of the scene"), "{error}");
    }

    #[test]
    fn a_mirrored_instance_keeps_its_outside() {
        let flat = Flat::of(&scene(scaled(-1.0, 1.0, 1.0))).unwrap();
        let t = flat.triangles[0];
        let wound = (t.v1 - t.v0).cross(t.v2 - t.v0).normalize();
        assert_eq!(
            (wound.to_array(), flat.instances[0].flags & surface::MIRRORED),
            ([0.0, 0.0, -1.0], surface::MIRRORED)
        );
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
            assert!(matches!(Flat::of(&broken), Err(SceneError::Part { .. })));
        }
    }
}
