//! What rays cost in a structure, counted on this machine: the same on every other.

use rayon::prelude::*;
use raywarp_core::traversal::{Tests, START};

use crate::accel::Accel;
use crate::Ray;

/// Means over rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Cost {
    /// Nodes visited.
    pub nodes_per_ray: f64,
    /// Triangles tested, repeated ones included.
    pub triangles_per_ray: f64,
    /// How many rays were counted.
    pub rays: usize,
}

/// Nodes and triangles of each of every n-th ray, with the smallest n that leaves at most `most` rays: of its closest hit,
/// or of whether it hits anything.
pub fn tests(structure: &Accel, rays: &[Ray], any_hit: bool, most: usize) -> Vec<Tests> {
    sampled(rays, most, |ray, tests| match any_hit {
        true => drop(structure.occlusion(ray, tests)),
        false => drop(structure.closest(ray, &START, tests)),
    })
}

/// The same of a structure of others: `trace` asks it about a ray.
pub fn sampled(rays: &[Ray], most: usize, trace: impl Fn(&Ray, &mut Tests) + Sync) -> Vec<Tests> {
    let step = rays.len().div_ceil(most.max(1)).max(1);
    let count = |ray: &Ray| {
        let mut tests = Tests::default();
        trace(ray, &mut tests);
        tests
    };
    rays.par_iter().step_by(step).map(count).collect()
}

impl Cost {
    /// Of every n-th ray, with the smallest n that leaves at most `most` of them: the closest hit of each, or whether
    /// it hits anything.
    pub fn of(structure: &Accel, rays: &[Ray], any_hit: bool, most: usize) -> Self {
        Self::mean(&tests(structure, rays, any_hit, most))
    }

    /// Of rays that were counted.
    pub fn mean(each: &[Tests]) -> Self {
        let sum = |of: fn(&Tests) -> u32| each.iter().map(|tests| u64::from(of(tests))).sum::<u64>();
        let (rays, nodes, triangles) = (each.len() as u64, sum(|tests| tests.nodes), sum(|tests| tests.triangles));
        let mean = |sum: u64| sum as f64 / rays.max(1) as f64;
        Self { nodes_per_ray: mean(nodes), triangles_per_ray: mean(triangles), rays: rays as usize }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::AccelKind;
    use crate::{Triangle, Vec3};

    #[test]
    fn brute_force_tests_every_triangle_of_every_ray_of_the_sample() {
        let wall = |z: f32, primitive| {
            Triangle::new(Vec3::new(-1.0, -1.0, z), Vec3::new(1.0, -1.0, z), Vec3::new(0.0, 1.0, z), primitive, 0)
        };
        let structure = Accel::build(AccelKind::Brute, vec![wall(1.0, 0), wall(2.0, 1)]).unwrap();
        let rays = vec![Ray::new(Vec3::ZERO, Vec3::new(0.0, 0.0, 1.0)); 10];
        let cost = Cost::of(&structure, &rays, false, 4);
        assert_eq!(cost, Cost { nodes_per_ray: 0.0, triangles_per_ray: 2.0, rays: 4 });
        assert_eq!(Cost::of(&structure, &rays, true, 100), Cost { triangles_per_ray: 1.0, rays: 10, ..cost });
        assert_eq!(Cost::of(&structure, &[], false, 4), Cost::default());
    }
}
