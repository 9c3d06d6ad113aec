//! Making the shading normals that a file leaves out.
//!
//! A vertex normal is the sum of its triangles' unit normals, each weighted by the triangle's angle at that vertex
//! (Thürmer and Wüthrich 1998): unlike equal or area weights, it does not depend on how a flat polygon was cut.

use super::Mesh;

/// Gives a mesh smooth normals over its shared vertices, in place of any it had.
///
/// Triangles without an area or with a vertex that is not finite have no say. A vertex that no triangle contributes to,
/// or whose contributions cancel, gets the zero normal, which means flat (see [`Mesh::normals`]).
pub fn smooth(mesh: &mut Mesh) {
    let mut sums = NormalSums::new(mesh.positions.len());
    for &triangle in &mesh.triangles {
        sums.add(triangle.map(|vertex| mesh.positions[vertex as usize]), triangle);
    }
    mesh.normals = sums.normals();
}

/// Normals under construction. What shares a normal is the caller's choice: a vertex, or a smoothing class of several.
pub struct NormalSums {
    sums: Vec<WeightedSum>,
}

#[derive(Clone, Copy, Default)]
struct WeightedSum {
    normals: [f64; 3],
    weight: f64,
}

impl NormalSums {
    /// A target that takes no share in a sum.
    pub const NONE: u32 = u32::MAX;

    /// Sums for the targets `0..count`, all zero.
    pub fn new(count: usize) -> Self {
        Self { sums: vec![WeightedSum::default(); count] }
    }

    /// Adds one triangle's normal to the target of each of its corners; a target of [`Self::NONE`] is passed over.
    ///
    /// # Panics
    /// Where a target is neither below the count nor `NONE`.
    pub fn add(&mut self, corners: [[f32; 3]; 3], targets: [u32; 3]) {
        let Some((normal, angles)) = normal_and_angles(corners) else { return };
        for (target, angle) in targets.into_iter().zip(angles) {
            if target != Self::NONE {
                self.sums[target as usize].add(normal, angle);
            }
        }
    }

    /// The unit normal of each target, zero where nothing contributed.
    pub fn normals(&self) -> Vec<[f32; 3]> {
        self.sums.iter().map(WeightedSum::normal).collect()
    }
}

/// Contributions that cancel to less than this share of their weight leave only rounding errors: no direction.
const CANCELLED: f64 = 1e-6;

impl WeightedSum {
    fn add(&mut self, normal: [f64; 3], weight: f64) {
        for (sum, part) in self.normals.iter_mut().zip(normal) {
            *sum += weight * part;
        }
        self.weight += weight;
    }

    fn normal(&self) -> [f32; 3] {
        let length = dot(self.normals, self.normals).sqrt();
        if length > CANCELLED * self.weight {
            self.normals.map(|sum| (sum / length) as f32)
        } else {
            [0.0; 3]
        }
    }
}

/// The unit normal and the angle at each corner. `None` where there is no area or a corner is not finite.
///
/// In `f64`, no product of finite `f32` coordinates overflows or vanishes.
fn normal_and_angles(corners: [[f32; 3]; 3]) -> Option<([f64; 3], [f64; 3])> {
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let edges = [sub(b, a), sub(c, b), sub(a, c)];
    let cross = cross(edges[0], edges[1]);
    let area = dot(cross, cross).sqrt();
    if !(area.is_finite() && area > 0.0) {
        return None;
    }
    let angle = |into: usize, out: usize| area.atan2(-dot(edges[into], edges[out]));
    Some((cross.map(|x| x / area), [angle(2, 0), angle(0, 1), angle(1, 2)]))
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn smoothed(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
        let mut mesh = Mesh { positions: positions.to_vec(), triangles: triangles.to_vec(), ..Mesh::default() };
        smooth(&mut mesh);
        mesh.normals
    }

    /// The corner of a cube: equal right angles, so the diagonal, although one of the faces is two triangles.
    #[test]
    fn angles_weigh_and_cuts_do_not() {
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]];
        let triangles = [[0, 1, 4], [0, 4, 2], [0, 2, 3], [0, 3, 1]];
        let expected = 1.0 / 3.0_f32.sqrt();
        for x in smoothed(&positions, &triangles)[0] {
            assert!((x - expected).abs() < 1e-6, "{x}");
        }
    }

    #[test]
    fn what_has_no_area_has_no_say() {
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [f32::NAN, 0.0, 0.0]];
        let normals = smoothed(&positions, &[[0, 1, 2], [0, 1, 3], [0, 1, 4], [1, 1, 2]]);
        assert_eq!(normals[0], [0.0, 0.0, 1.0]);
        assert_eq!(normals[3], [0.0; 3]);
        assert_eq!(normals[4], [0.0; 3]);
    }

    #[test]
    fn opposite_triangles_cancel_to_zero() {
        let positions = [[0.1, 0.3, 0.7], [1.3, 0.1, 0.2], [0.4, 1.7, 0.9]];
        assert_eq!(smoothed(&positions, &[[0, 1, 2], [0, 2, 1]]), [[0.0; 3]; 3]);
    }

    #[test]
    fn tiny_and_huge_triangles_count_alike() {
        for scale in [1e-38_f32, 1.0, 1e38] {
            let positions = [[0.0, 0.0, 0.0], [scale, 0.0, 0.0], [0.0, scale, 0.0]];
            assert_eq!(smoothed(&positions, &[[0, 1, 2]]), [[0.0, 0.0, 1.0]; 3], "at {scale}");
        }
    }

    #[test]
    fn targets_share_what_vertices_do_not() {
        let mut sums = NormalSums::new(1);
        sums.add([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [0, NormalSums::NONE, NormalSums::NONE]);
        sums.add([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0, NormalSums::NONE, NormalSums::NONE]);
        let half = 0.5_f32.sqrt();
        assert_eq!(sums.normals(), [[half, 0.0, half]]);
    }
}
