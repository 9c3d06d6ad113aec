//! Whether a scene's meshes are placed by instances of a structure, or brought to world space one by one.

use super::{check_instance, check_mesh, flags_of, SceneError};
use crate::accel::two_level::{Placement, Plan, TwoLevel};
use crate::accel::Quality;
use crate::scene::{Instance, Material, Mesh, Scene};
use crate::Triangle;

/// One structure over all triangles of the world, or one for each mesh under one of the instances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Levels {
    /// Two where that halves what a large scene takes: a million triangles in the world or more, at most half of them
    /// different. Else one, which is faster to trace.
    #[default]
    Auto,
    /// Every instance's triangles in world space.
    One,
    /// Each mesh once, however often it is placed.
    Two,
}

/// Triangles of the world from which on memory matters.
const LARGE: u64 = 1 << 20;

impl Levels {
    /// Whether two levels are meant for this scene.
    pub fn are_two(self, scene: &Scene) -> bool {
        match self {
            Self::One => false,
            Self::Two => true,
            Self::Auto => {
                let mut uses = vec![0; scene.meshes.len()];
                for instance in scene.instances.iter().filter(|instance| instance.mesh < scene.meshes.len()) {
                    uses[instance.mesh] += 1;
                }
                let counts = || scene.meshes.iter().map(|mesh| mesh.triangles.len() as u64).zip(&uses);
                let seen: u64 = counts().map(|(count, &uses)| count * uses).sum();
                let different: u64 = counts().map(|(count, &uses)| count * uses.min(1)).sum();
                seen >= LARGE && seen >= 2 * different
            }
        }
    }
}

/// The structure of two levels over a scene.
///
/// # Errors
/// [`SceneError::Part`] for an index out of range.
pub fn two_level(scene: &Scene, quality: Quality) -> Result<TwoLevel, SceneError> {
    Ok(plan(scene, &scene.instances, &scene.materials)?.build(quality)?)
}

/// What that is, with these instances and materials instead of the scene's own, and which of them it bakes.
///
/// # Errors
/// As for [`two_level`].
pub(crate) fn plan(scene: &Scene, instances: &[Instance], materials: &[Material]) -> Result<Plan, SceneError> {
    let flags: Vec<u32> = materials.iter().map(flags_of).collect();
    let mut placements = Vec::with_capacity(instances.len());
    let mut placed = vec![false; scene.meshes.len()];
    for (instance, index) in instances.iter().zip(0..) {
        let mesh = check_instance(scene, instance)?;
        if !std::mem::replace(&mut placed[instance.mesh], true) {
            check_mesh(scene, instance, mesh)?;
        }
        placements.push(Placement {
            mesh: instance.mesh,
            transform: instance.transform,
            instance: index,
            flags: instance.material.map(|material| flags[material as usize]),
        });
    }
    let mesh = |(mesh, &placed): (&Mesh, &bool)| if placed { triangles(mesh, &flags) } else { Vec::new() };
    Ok(Plan::new(scene.meshes.iter().zip(&placed).map(mesh).collect(), placements)?)
}

/// In the space of the mesh, whose indices were checked.
fn triangles(mesh: &Mesh, flags: &[u32]) -> Vec<Triangle> {
    let triangle = |((corners, &material), index): ((&[u32; 3], &u32), u32)| {
        let [a, b, c] = corners.map(|vertex| mesh.positions[vertex as usize].into());
        Triangle::new(a, b, c, index, flags[material as usize])
    };
    mesh.triangles.iter().zip(&mesh.materials).zip(0..).map(triangle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::{Device, DeviceChoice};
    use crate::device_scene::Structure;
    use crate::query::RayCaster;
    use crate::scene::Transform;
    use crate::{Ray, Vec3};

    /// Level strips of `triangles` triangles side by side, each a step higher than the one before.
    fn scene(count: usize, triangles: u32) -> Scene {
        let corner = |i: u32| [(i % 2) as f32, 0.0, (i / 2) as f32 * 0.1];
        let mesh = Mesh {
            positions: (0..triangles + 2).map(corner).collect(),
            triangles: (0..triangles).map(|i| [i, i + 1, i + 2]).collect(),
            materials: vec![0; triangles as usize],
            ..Mesh::default()
        };
        let place = |i: usize| {
            let translation = [2.0 * i as f32, i as f32, 0.0];
            let transform = Transform { translation, ..Transform::IDENTITY };
            Instance { name: format!("{i}"), mesh: 0, transform, material: None }
        };
        let instances = (0..count).map(place).collect();
        Scene { meshes: vec![mesh], instances, materials: vec![Material::default()], ..Scene::default() }
    }

    #[test]
    fn hits_say_instance_and_primitive() {
        let scene = scene(5, 10);
        let tree = two_level(&scene, Quality::default()).unwrap();
        assert_eq!(tree.validate(), Ok(()));
        let device = Device::open(DeviceChoice::Cpu).unwrap();
        let caster = RayCaster::of_structure(Structure::of_instances(&tree, &device).unwrap(), &device);
        let down = |i: usize| Ray::new(Vec3::new(2.0 * i as f32 + 0.1, 10.0, 0.01), Vec3::new(0.0, -1.0, 0.0));
        let rays: Vec<Ray> = (0..6).map(down).collect();
        let hits = caster.hits(&rays).unwrap();
        for (i, hit) in hits[..5].iter().enumerate() {
            assert_eq!([hit.instance, hit.primitive], [i as u32, 0]);
            assert!((hit.t - (10.0 - i as f32)).abs() < 1e-5, "{hit:?}");
        }
        assert!(hits[5].is_miss());
        assert_eq!(caster.any(&rays).unwrap(), [true, true, true, true, true, false]);
    }

    #[test]
    fn two_levels_are_for_large_scenes_of_copies() {
        assert!(!Levels::Auto.are_two(&scene(1, 2 << 20)));
        assert!(!Levels::Auto.are_two(&scene(100, 100)));
        let copies = scene(2, 1 << 19);
        assert!(Levels::Auto.are_two(&copies) && Levels::Two.are_two(&copies) && !Levels::One.are_two(&copies));
    }

    #[test]
    fn what_is_out_of_range_is_an_error() {
        for damage in [
            (|s: &mut Scene| s.instances[1].mesh = 1) as fn(&mut Scene),
            |s| s.instances[1].material = Some(1),
            |s| s.meshes[0].triangles[3][0] = 99,
            |s| s.meshes[0].materials[3] = 1,
        ] {
            let mut broken = scene(2, 10);
            damage(&mut broken);
            assert!(matches!(two_level(&broken, Quality::default()), Err(SceneError::Part { .. })));
        }
    }
}
