//! The closest points of a scene to given ones: distances, and where on the surface they are.

use rayon::prelude::*;
use raywarp_core::closest_point::ClosestPoint;
use raywarp_core::ray::HitArrays;
use raywarp_core::traversal::Bvh2;
use raywarp_core::view::View;
use raywarp_device::kernels::{Timed, Views};

use super::{HitBuffers, QueryError};
use crate::accel::{bvh2_build, Resident, ResidentBvh2};
use crate::device::{Device, Stream};
use crate::device_scene::{world_triangles, SceneError};
use crate::scene::settings::Quality;
use crate::scene::Scene;
use crate::Hit;

/// Triangles on a device, ready to be asked which of their points is closest. When it is dropped it waits for the device.
///
/// ```
/// use raywarp::device::{Device, DeviceChoice};
/// use raywarp::query::ClosestPoints;
///
/// let scene = raywarp::scene::load::builtin()?.scene;
/// let device = Device::open(DeviceChoice::Cpu)?;
/// let caster = ClosestPoints::from_scene(&scene, Default::default(), &device)?;
/// let found = caster.closest(&[[0.0, 1.0, 0.0], [0.0, 100.0, 0.0]], 10.0)?;
/// assert!(found[0].t < 2.0 && found[1].is_miss());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ClosestPoints {
    device: Device,
    tree: ResidentBvh2,
}

impl ClosestPoints {
    /// Builds a tree over the triangles of all instances, in world space, and copies it to a device.
    ///
    /// # Errors
    /// The scene has indices out of range, or too many triangles for the tree or for the device's memory.
    pub fn from_scene(scene: &Scene, quality: Quality, device: &Device) -> Result<Self, QueryError> {
        let triangles = world_triangles(scene, &scene.instances, &scene.materials)?;
        let tree = bvh2_build::build(triangles, quality).map_err(SceneError::from)?;
        device.reserve(tree.stats().bytes as u64, "the scene")?;
        let tree = ResidentBvh2::upload(device, &tree)?;
        device.load::<ClosestPoint>()?;
        // What was copied is there, whichever stream asks.
        device.synchronize()?;
        Ok(Self { device: device.clone(), tree })
    }

    /// The closest point to each of these, at most `limit` away: `t` is the distance, and a miss where there is none. Of several at the
    /// same distance that of the smallest instance and primitive.
    ///
    /// # Errors
    /// The device fails, or has no room.
    pub fn closest(&self, points: &[[f32; 3]], limit: f32) -> Result<Vec<Hit>, QueryError> {
        let points = self.device.upload(points.as_flattened())?;
        let count = points.len() / 3;
        let mut found = HitBuffers::new(&self.device, count as usize)?;
        let kernel = self.kernel(points.view(), 3, count, limit, found.arrays());
        // SAFETY: the buffers are this device's, as long as the points are many, and held until the launch is over. The builder keeps the
        // tree's indices in range.
        unsafe { Timed::launch(&self.device, &kernel, [count, 1]) }?.wait()?;
        let (hits, instances) = (found.hits.to_vec()?, found.instances.to_vec()?);
        Ok(hits.par_iter().zip(&instances).map(|(hit, &instance)| hit.of_instance(instance)).collect())
    }

    /// Enqueues the same after all that a stream was told before, for points in rows of `stride` numbers.
    ///
    /// # Safety
    /// Points and answers are in memory of the device, as many as `count`, and until the stream has done this, or each time that a graph does
    /// it, they stay there and nothing else touches the answers or writes the points.
    ///
    /// # Errors
    /// The launch fails.
    pub unsafe fn enqueue(
        &self,
        stream: &Stream,
        points: View<f32>,
        [stride, count]: [u32; 2],
        limit: f32,
        found: HitArrays,
    ) -> Result<(), QueryError> {
        // SAFETY: the caller's promise; the tree is held by this, which waits before it lets go.
        Ok(unsafe { stream.launch(&self.kernel(points, stride, count, limit, found), [count, 1]) }?)
    }

    fn kernel(&self, points: View<f32>, stride: u32, count: u32, limit: f32, found: HitArrays) -> ClosestPoint {
        let tree: Bvh2 = self.tree.short();
        ClosestPoint { tree, points, stride, count, limit, found }
    }
}

impl Drop for ClosestPoints {
    fn drop(&mut self) {
        // Of a device that fails nothing can be learned here; it runs no kernels either.
        let _ = self.device.synchronize();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::device::DeviceChoice;
    use crate::scene::{Instance, Material, Mesh, Transform};

    fn scene(corners: &[[[f32; 3]; 3]]) -> Scene {
        let mesh = Mesh {
            positions: corners.as_flattened().to_vec(),
            triangles: (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            materials: vec![0; corners.len()],
            ..Mesh::default()
        };
        let instance = Instance { name: String::new(), mesh: 0, transform: Transform::IDENTITY, material: None };
        Scene {
            meshes: vec![mesh],
            instances: vec![instance],
            materials: vec![Material::default()],
            ..Scene::default()
        }
    }

    /// Each triangle by itself, in a tree of its own.
    fn brute_force(corners: &[[[f32; 3]; 3]], points: &[[f32; 3]], limit: f32, device: &Device) -> Vec<Hit> {
        let mut best = vec![Hit::NONE; points.len()];
        for (corner, primitive) in corners.iter().zip(0..) {
            let single = ClosestPoints::from_scene(&scene(&[*corner]), Quality::Fast, device).unwrap();
            for (best, found) in best.iter_mut().zip(single.closest(points, limit).unwrap()) {
                if !found.is_miss() && found.t < best.t {
                    *best = Hit { primitive, ..found };
                }
            }
        }
        best
    }

    fn point(size: f32) -> impl Strategy<Value = [f32; 3]> {
        prop::array::uniform3(-size..size)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn trees_find_what_brute_force_finds(
            corners in prop::collection::vec((point(4.0), point(0.7), point(0.7)), 0..60),
            points in prop::collection::vec(point(6.0), 1..40),
            limit in prop::sample::select(vec![0.0, 0.5, 2.0, f32::INFINITY]),
        ) {
            let place = |(a, b, c): &([f32; 3], [f32; 3], [f32; 3])| {
                let beside = |by: &[f32; 3]| [0, 1, 2].map(|axis| a[axis] + by[axis]);
                [*a, beside(b), beside(c)]
            };
            let corners: Vec<_> = corners.iter().map(place).collect();
            let device = Device::open(DeviceChoice::Cpu).unwrap();
            let expected = brute_force(&corners, &points, limit, &device);
            for quality in Quality::ALL {
                let tree = ClosestPoints::from_scene(&scene(&corners), quality, &device).unwrap();
                prop_assert_eq!(&tree.closest(&points, limit).unwrap(), &expected);
            }
        }
    }

    #[test]
    fn odd_points_are_closest_to_nothing() {
        let device = Device::open(DeviceChoice::Cpu).unwrap();
        let corners = [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]; 2];
        let tree = ClosestPoints::from_scene(&scene(&corners), Quality::Medium, &device).unwrap();
        let odd = [[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0], [0.0, 0.0, 1e30]];
        assert!(tree.closest(&odd, f32::INFINITY).unwrap().iter().all(Hit::is_miss));
        assert!(tree.closest(&[[0.0; 3]], f32::NAN).unwrap()[0].is_miss());
        assert_eq!(
            tree.closest(&[[0.25, 0.25, 2.0]], 2.0).unwrap()[0],
            Hit { t: 2.0, u: 0.25, v: 0.25, primitive: 0, instance: 0 }
        );
        assert!(tree.closest(&[[0.25, 0.25, 2.0]], 1.999).unwrap()[0].is_miss());
    }
}
