//! What is under the pointer.

use std::fmt;

use glam::Vec3;
use raywarp::query::{intersect, world_triangle};
use raywarp::render::{self, RenderError, RenderOptions, Tracer};
use raywarp::scene::{Camera, Mesh, Scene};
use raywarp::{Hit, Ray};

/// A point of a surface, and whose it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Pick {
    /// Index of the instance.
    pub instance: usize,
    /// Index of its mesh.
    pub mesh: usize,
    /// Index of the triangle within the mesh.
    pub triangle: u32,
    /// Index of the triangle's material, the instance's own if it has one.
    pub material: usize,
    /// Distance along the ray in units of its direction: scene units for rays of cameras. None once the object has moved.
    pub distance: Option<f32>,
    /// Weights of the triangle's vertices, in the mesh's order.
    pub weights: [f32; 3],
    /// World position.
    pub position: [f32; 3],
    /// Unit normal of the triangle in world space, on the side that is seen.
    pub normal: [f32; 3],
    /// Names of instance, mesh and material, as the files give them.
    pub names: [String; 3],
}

impl Pick {
    /// What a pixel of a picture of this size shows; nothing for the sky. The renderer's own choice where surfaces are cut
    /// out by a texture. `scene` is as the tracer has it, edits included; its meshes are given apart, so that it may be
    /// the one of the [edits](super::edits::Edits::scene).
    ///
    /// # Errors
    /// [`RenderError`] for a camera that cannot be rendered from, a pixel outside of the picture, or where the device
    /// fails.
    pub fn at(
        tracer: &Tracer,
        meshes: &[Mesh],
        scene: &Scene,
        camera: &Camera,
        size: [u32; 2],
        [x, y]: [u32; 2],
    ) -> Result<Option<Self>, RenderError> {
        let crop = Some([x, y, x.saturating_add(1), y.saturating_add(1)]);
        let first_hits = tracer.layers(camera, &RenderOptions { size, crop, ..RenderOptions::default() })?;
        let ray = render::ray(camera, size, [x as f32 + 0.5, y as f32 + 0.5])?;
        Ok(first_hits.first().and_then(|first_hit| {
            let id = [first_hit.instance, first_hit.primitive];
            Self::of(meshes, scene, &ray, &intersect(meshes, &scene.instances, &ray, id)?)
        }))
    }

    /// Of a hit that a ray found in a scene; nothing for a miss, and for a hit in another scene.
    pub fn of(meshes: &[Mesh], scene: &Scene, ray: &Ray, hit: &Hit) -> Option<Self> {
        let Hit { u, v, primitive, .. } = *hit;
        let instance = scene.instances.get(hit.instance as usize)?;
        let mesh = meshes.get(instance.mesh)?;
        let material = instance.material.or(mesh.materials.get(primitive as usize).copied())? as usize;
        let triangle = world_triangle(meshes, &scene.instances, hit.instance, primitive)?;
        let [v0, v1, v2] = [triangle.v0, triangle.v1, triangle.v2].map(|corner| Vec3::from(corner.to_array()));
        let direction = Vec3::from(ray.direction.to_array());
        let normal = face_normal([v0, v1, v2]);
        let corners = v0 * (1.0 - u - v) + v1 * u + v2 * v;
        Some(Self {
            instance: hit.instance as usize,
            mesh: instance.mesh,
            triangle: primitive,
            material,
            distance: Some(hit.t),
            weights: [1.0 - u - v, u, v],
            position: corners.into(),
            normal: if normal.dot(direction) > 0.0 { -normal } else { normal }.into(),
            names: [
                instance.name.clone(),
                mesh.name.clone(),
                scene.materials.get(material).map(|material| material.name.clone())?,
            ],
        })
    }

    /// Goes with its object, which has moved.
    pub fn follow(&mut self, meshes: &[Mesh], scene: &Scene) {
        if let Some((position, normal)) = self.place(meshes, scene).filter(|(position, _)| *position != self.position) {
            let side = if dot(normal, self.normal) < 0.0 { -1.0 } else { 1.0 };
            (self.position, self.normal, self.distance) = (position, normal.map(|x| side * x), None);
        }
    }

    /// Position and normal by the instance's transform.
    fn place(&self, meshes: &[Mesh], scene: &Scene) -> Option<([f32; 3], [f32; 3])> {
        let (transform, mesh) = (scene.instances.get(self.instance)?.transform, meshes.get(self.mesh)?);
        let [x, y, z] = transform.columns.map(Vec3::from);
        let corner = |index: u32| {
            let p = mesh.positions.get(index as usize)?;
            Some(x * p[0] + y * p[1] + z * p[2] + Vec3::from(transform.translation))
        };
        let [a, b, c] = mesh.triangles.get(self.triangle as usize)?.map(corner);
        let corners = [a?, b?, c?];
        let position = corners.iter().zip(self.weights).map(|(corner, weight)| *corner * weight).sum::<Vec3>();
        Some((position.into(), face_normal(corners).into()))
    }

    /// For the lines over the picture: what, and its value.
    pub fn lines(&self) -> Vec<(String, String)> {
        let [instance, mesh, material] = &self.names;
        let [w, u, v] = self.weights;
        [
            ("instance", named(self.instance, instance)),
            ("mesh", named(self.mesh, mesh)),
            ("material", named(self.material, material)),
            ("triangle", self.triangle.to_string()),
            ("distance", self.distance.map(|distance| Short(distance).to_string()).unwrap_or_default()),
            ("w, u, v", [w, u, v].map(share).join(", ")),
            ("position", triple(self.position)),
            ("normal", self.normal.map(share).join(", ")),
        ]
        .into_iter()
        .filter(|(_, value)| !value.is_empty())
        .map(|(what, value)| (what.to_owned(), value))
        .collect()
    }
}

/// World bounds of an instance; nothing where there is no such instance or it has no vertices.
pub fn instance_bounds(meshes: &[Mesh], scene: &Scene, index: usize) -> Option<[[f32; 3]; 2]> {
    let instance = scene.instances.get(index)?;
    let [x, y, z] = instance.transform.columns.map(Vec3::from);
    let shift = Vec3::from(instance.transform.translation);
    let corners = meshes.get(instance.mesh)?.positions.iter().map(|p| x * p[0] + y * p[1] + z * p[2] + shift);
    let finite = corners.filter(|corner| corner.is_finite());
    finite.map(|corner| (corner, corner)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).map(|(a, b)| [a.into(), b.into()])
}

/// At right angles to a triangle, whatever its size: products of small edges would vanish.
fn face_normal([v0, v1, v2]: [Vec3; 3]) -> Vec3 {
    let [a, b] = [v1 - v0, v2 - v0].map(|edge| edge.as_dvec3());
    a.cross(b).normalize_or_zero().as_vec3()
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    Vec3::from(a).dot(Vec3::from(b))
}

fn named(index: usize, name: &str) -> String {
    if name.is_empty() {
        index.to_string()
    } else {
        format!("{index} '{name}'")
    }
}

/// A number of about 1 in three decimals, without the sign of a zero.
fn share(x: f32) -> String {
    format!("{:.3}", (1000.0 * x).round() / 1000.0 + 0.0)
}

fn triple(v: [f32; 3]) -> String {
    v.map(|x| Short(x).to_string()).join(", ")
}

/// A length in five digits, whatever the units.
struct Short(f32);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 {
            f.write_str("0")
        } else if (1e-3..1e5).contains(&size) {
            let decimals = (4 - size.max(1e-3).log10().floor() as i32).clamp(0, 7) as usize;
            write!(f, "{:.decimals$}", self.0)
        } else {
            write!(f, "{:.4e}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use raywarp::accel::AccelKind;
    use raywarp::device::{Device, DeviceChoice};
    use raywarp::render::framing;
    use raywarp::scene::{Instance, Material, Transform};
    use raywarp::MISS;

    use super::*;

    /// Three placements of two meshes: one as it is, one mirrored with a material of its own, one empty between them.
    fn scene() -> Scene {
        let mesh = Mesh {
            name: "roof".into(),
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, -0.5]],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            materials: vec![0, 1],
            ..Mesh::default()
        };
        let at = |name: &str, mesh, x: f32, shift, material| Instance {
            name: name.into(),
            mesh,
            transform: Transform {
                columns: [[x, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                translation: [shift, 0.0, 0.0],
            },
            material,
        };
        let material = |name: &str| Material { name: name.into(), ..Material::default() };
        Scene {
            meshes: vec![mesh, Mesh::default()],
            instances: vec![
                at("plain", 0, 1.0, 0.0, None),
                at("nothing", 1, 1.0, 0.0, None),
                at("mirrored", 0, -1.5, -0.1, Some(2)),
            ],
            materials: vec![material("red"), material("blue"), material("glass")],
            ..Scene::default()
        }
    }

    #[test]
    fn what_is_picked_is_what_the_layers_show() {
        let scene = scene();
        let device = Device::open(DeviceChoice::Cpu).unwrap();
        let tracer = Tracer::new(&scene, AccelKind::Bvh2, &device).unwrap();
        let camera = framing(tracer.report().bounds);
        let size = [48, 32];
        let options = RenderOptions { size, ..RenderOptions::default() };
        let first_hits = tracer.layers(&camera, &options).unwrap();
        let mut seen = std::collections::BTreeSet::new();
        for (i, first_hit) in first_hits.iter().enumerate() {
            let pixel = [i as u32 % size[0], i as u32 / size[0]];
            let pick = Pick::at(&tracer, &scene.meshes, &scene, &camera, size, pixel).unwrap();
            assert_eq!(pick.is_none(), first_hit.primitive == MISS);
            let Some(pick) = pick else { continue };
            seen.insert((pick.instance, pick.triangle));
            assert_eq!(pick.distance.map(f32::to_bits), Some(first_hit.depth.to_bits()));
            assert_eq!(pick.material, first_hit.material as usize);
            // The weights give the place back in the mesh's own order of vertices.
            let instance = &scene.instances[pick.instance];
            let mesh = &scene.meshes[pick.mesh];
            let corners = mesh.triangles[pick.triangle as usize].map(|v| Vec3::from(mesh.positions[v as usize]));
            let local: Vec3 = (0..3).map(|i| corners[i] * pick.weights[i]).sum();
            let [x, y, z] = instance.transform.columns.map(Vec3::from);
            let world = x * local.x + y * local.y + z * local.z + Vec3::from(instance.transform.translation);
            assert!(world.distance(first_hit.position.to_array().into()) < 1e-5);
            assert!(world.distance(pick.position.into()) < 1e-5);
            assert!(Vec3::from(pick.normal).distance(first_hit.normal.to_array().into()) < 1e-5);
            assert_eq!(pick.names[0], instance.name);
        }
        assert_eq!(seen.into_iter().collect::<Vec<_>>(), [(0, 0), (0, 1), (2, 0), (2, 1)]);
        assert!(Pick::at(&tracer, &scene.meshes, &scene, &camera, size, [48, 0]).is_err());
        assert!(Pick::at(&tracer, &scene.meshes, &scene, &camera, size, [u32::MAX, 0]).is_err());
    }

    #[test]
    fn lines_name_what_has_a_name() {
        let scene = scene();
        let ray = Ray::new([-0.5, 0.2, 5.0].into(), [0.0, 0.0, -2.0].into());
        let hit = intersect(&scene.meshes, &scene.instances, &ray, [2, 0]).unwrap();
        let pick = Pick::of(&scene.meshes, &scene, &ray, &hit).unwrap();
        let lines = pick.lines();
        let value = |what: &str| lines.iter().find(|line| line.0 == what).map(|line| line.1.as_str());
        assert_eq!(value("instance"), Some("2 'mirrored'"));
        assert_eq!(value("material"), Some("2 'glass'"));
        assert_eq!(value("distance"), Some("2.5000"));
        assert_eq!(value("position"), Some("-0.50000, 0.20000, 0"));
        assert_eq!(value("normal"), Some("0.000, 0.000, 1.000"));
        assert_eq!(Pick::of(&scene.meshes, &scene, &ray, &Hit::NONE), None);
        assert_eq!(Pick::of(&[], &Scene::default(), &ray, &hit), None);
    }

    #[test]
    fn lengths_have_five_digits_in_any_unit() {
        for (length, text) in
            [(0.0, "0"), (1.0, "1.0000"), (12.345_67, "12.346"), (99_999.0, "99999"), (1.5e-5, "1.5000e-5")]
        {
            assert_eq!(Short(length).to_string(), text, "{length}");
        }
    }

    #[test]
    fn bounds_are_those_of_the_placed_mesh() {
        let scene = scene();
        assert_eq!(instance_bounds(&scene.meshes, &scene, 2), Some([[-1.6, 0.0, -0.5], [-0.1, 1.0, 0.0]]));
        assert_eq!(
            (instance_bounds(&scene.meshes, &scene, 1), instance_bounds(&scene.meshes, &scene, 9)),
            (None, None)
        );
    }
}
