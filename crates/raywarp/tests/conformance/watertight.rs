//! No ray passes between triangles that share an edge or a corner.

use raywarp::accel::AccelKind;
use raywarp::query::RayCaster;
use raywarp::{Ray, Triangle, Vec3};

use super::{device, scaled, Random};

/// A closed surface: a sphere of `n` x `2n` patches, dented at random, whose neighbours share exact corners.
fn dented_sphere(n: u32, centre: Vec3) -> (Vec<Triangle>, Vec<Vec3>) {
    let columns = 2 * n;
    let corner = |row: u32, column: u32| {
        // Poles and the seam are one point each, whatever the angle.
        let column = if row == 0 || row == n { 0 } else { column % columns };
        let theta = std::f32::consts::PI * row as f32 / n as f32;
        let phi = std::f32::consts::TAU * column as f32 / columns as f32;
        let dent = 1.0 + 0.05 * Random(row * columns + column).signed();
        centre + Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()) * dent
    };
    let mut triangles = Vec::new();
    for (row, column) in (0..n).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let [a, b] = [corner(row, column), corner(row, column + 1)];
        let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
        for [p, q, r] in [[a, b, c], [b, d, c]] {
            if p != q && q != r && r != p {
                triangles.push(Triangle::new(p, q, r, triangles.len() as u32, 0));
            }
        }
    }
    let corners = triangles.iter().flat_map(|t| [t.v0, t.v1, t.v2]).collect();
    (triangles, corners)
}

/// Rays from inside, exactly at corners and at points of edges: each must hit.
fn aimed_rays(centre: Vec3, corners: &[Vec3], count: usize) -> Vec<Ray> {
    let mut random = Random(11);
    (0..count)
        .map(|index| {
            let triangle = random.bits() as usize % (corners.len() / 3) * 3;
            let (a, b) = (corners[triangle], corners[triangle + 1 + index % 2]);
            let share = if index % 3 == 0 { 0.0 } else { 0.5 + 0.5 * random.signed() };
            let origin = centre + random.vector() * 0.4;
            Ray::new(origin, a + (b - a) * share - origin)
        })
        .collect()
}

#[test]
fn no_ray_escapes_from_a_closed_surface() {
    for (kind, count) in [(AccelKind::Bvh, 10_000_000), (AccelKind::Kd, 5_000_000), (AccelKind::Brute, 200_000)] {
        for centre in [Vec3::ZERO, Vec3::new(1000.0, -300.0, 50.0)] {
            let (triangles, corners) = dented_sphere(40, centre);
            let rays = aimed_rays(centre, &corners, scaled(count));
            let hits = RayCaster::new(triangles, kind, &device()).unwrap().hits(&rays).unwrap();
            let escaped = hits.iter().filter(|hit| hit.is_miss()).count();
            assert_eq!(escaped, 0, "{kind} around {centre:?}: of {count} rays");
        }
    }
}
