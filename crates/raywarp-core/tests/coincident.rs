//! Every hit along a ray where thousands are at one distance.

use raywarp_core::math::{vec3, Vec3};
use raywarp_core::ray::{Hit, Ray};
use raywarp_core::traversal::{all, Brute, Keep, Tests, Uncollected};
use raywarp_core::triangle::{RayShear, Triangle};
use raywarp_core::view::View;

/// Hits by their index along the ray.
#[derive(Default)]
struct Row(Vec<Option<Hit>>);

impl Keep for Row {
    fn keep(&mut self, index: u32, hit: &Hit) {
        self.0.resize(self.0.len().max(index as usize + 1), None);
        self.0[index as usize] = Some(*hit);
    }
}

const RAY: Ray = Ray { origin: vec3(0.1, 0.1, -1.0), t_min: 0.0, direction: vec3(0.0, 0.0, 1.0), t_max: f32::INFINITY };

/// What is asked, and how many tests the second answer took: the hits, and their number.
fn query(triangles: &[Triangle], limit: u32) -> (Vec<(f32, u32)>, u32) {
    // SAFETY: the slice outlives the view.
    let list = Brute { triangles: unsafe { View::new(triangles.as_ptr(), triangles.len() as u32) } };
    let (mut row, mut cost) = (Row::default(), Tests::default());
    let found = all::<4>(&list, &RAY, limit, &mut Tests::default(), &mut row);
    assert_eq!(all::<8>(&list, &RAY, limit, &mut cost, &mut Uncollected), found);
    assert_eq!(row.0.len() as u32, found);
    (row.0.into_iter().map(|hit| hit.map(|hit| (hit.t, hit.primitive)).unwrap()).collect(), cost.triangles)
}

fn at(z: f32, primitive: u32) -> Triangle {
    Triangle::new(vec3(0.0, 0.0, z), vec3(1.0, 0.0, z), vec3(0.0, 1.0, z), primitive, 0)
}

fn hit(triangle: &Triangle) -> (f32, u32) {
    (triangle.intersect(&RayShear::new(&RAY)).unwrap().t, triangle.primitive)
}

/// A whole number below a bound, from an index.
fn scattered(index: u32, below: u32) -> u32 {
    (index.wrapping_mul(2_654_435_761) ^ index >> 7) % below
}

#[test]
fn coincident_triangles_are_each_found_once_in_order() {
    for layers in [1u32, 3, 7] {
        let mut triangles: Vec<_> = (0..6_000).map(|i| at((i % layers) as f32, scattered(i, 9_000))).collect();
        triangles.push(Triangle::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, 9_001, 0));
        // As a tree does that has split them.
        triangles.extend_from_within(..3_000);
        let mut expected: Vec<_> = triangles[..6_000].iter().map(hit).collect();
        expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
        expected.dedup();
        for limit in [u32::MAX, 5_000, 2_050, 9, 4, 1] {
            let (found, _) = query(&triangles, limit);
            let expected = &expected[..expected.len().min(limit as usize)];
            let differ = found.iter().zip(expected).position(|(a, b)| a != b);
            assert_eq!((found.len(), differ), (expected.len(), None), "{layers} layers, limit {limit}");
        }
    }
}

#[test]
fn the_work_does_not_grow_with_the_square_of_their_number() {
    let triangles: Vec<_> = (0..20_000).map(|i| at(0.0, i)).collect();
    let (found, tests) = query(&triangles, u32::MAX);
    assert_eq!(found.len(), 20_000);
    // One pass for the first hits, one for each 2,048, one to see that there are no more.
    assert_eq!(tests, 12 * 20_000);
}
