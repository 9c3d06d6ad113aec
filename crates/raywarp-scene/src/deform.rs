//! Meshes out of the shape that they were modelled in: morph targets, and skins by linear blending (Magnenat-Thalmann,
//! Laperrière and Thalmann 1988), as glTF 2.0 defines both.

use glam::{DMat3, DVec3};

use crate::load::repair::unit_or_zero;
use crate::{Mesh, Transform};

/// Displacements of a mesh's vertices: each list is one a vertex, or empty.
#[derive(Clone, Debug, Default)]
pub struct MorphTarget {
    /// Of positions.
    pub positions: Vec<[f32; 3]>,
    /// Of normals.
    pub normals: Vec<[f32; 3]>,
    /// Of tangents.
    pub tangents: Vec<[f32; 3]>,
}

/// Adds so much of each target to a mesh. Normals and tangents are of unit length afterwards.
pub fn morph(mesh: &mut Mesh, targets: &[(f32, MorphTarget)]) {
    for (weight, target) in targets {
        add(&mut mesh.positions, &target.positions, *weight);
        add(&mut mesh.normals, &target.normals, *weight);
        for (tangent, displacement) in mesh.tangents.iter_mut().zip(&target.tangents) {
            (0..3).for_each(|axis| tangent[axis] += weight * displacement[axis]);
        }
    }
    for normal in &mut mesh.normals {
        *normal = unit_or_zero(*normal);
    }
    for [x, y, z, _] in &mut mesh.tangents {
        [*x, *y, *z] = unit_or_zero([*x, *y, *z]);
    }
}

fn add(vectors: &mut [[f32; 3]], displacements: &[[f32; 3]], weight: f32) {
    for (vector, displacement) in vectors.iter_mut().zip(displacements) {
        (0..3).for_each(|axis| vector[axis] += weight * displacement[axis]);
    }
}

/// Which joints move the vertices of a mesh, and how much.
#[derive(Clone, Debug, Default)]
pub struct Influences {
    /// Joints that each vertex has a place for.
    pub per_vertex: usize,
    /// Indices of joints, `per_vertex` a vertex.
    pub joints: Vec<u32>,
    /// Their weights, 0 or more. Those of a vertex need not add up to 1: they count as if they did.
    pub weights: Vec<f32>,
}

impl Influences {
    fn of(&self, vertex: usize) -> impl Iterator<Item = (u32, f32)> + '_ {
        let range = vertex * self.per_vertex..(vertex + 1) * self.per_vertex;
        self.joints[range.clone()].iter().copied().zip(self.weights[range].iter().copied())
    }
}

/// Brings a mesh to the space of its joints: each maps the mesh's own space to where the joint has it.
///
/// A vertex without any weight follows its first joint. Indices are below `joints.len()` wherever a weight is not 0, and
/// for the first joint of a vertex.
pub fn skin(mesh: &mut Mesh, influences: &Influences, joints: &[Transform]) {
    let mut mirrored = Vec::with_capacity(mesh.positions.len());
    for vertex in 0..mesh.positions.len() {
        let (linear, shift) = blend(influences, vertex, joints);
        let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
        mirrored.push(sign < 0.0);
        let position = wide(mesh.positions[vertex]);
        mesh.positions[vertex] = (linear * position + shift).to_array().map(|x| x as f32);
        if let Some(normal) = mesh.normals.get_mut(vertex) {
            *normal = direction(cofactors(linear) * sign, *normal);
        }
        if let Some([x, y, z, handedness]) = mesh.tangents.get_mut(vertex) {
            [*x, *y, *z] = direction(linear, [*x, *y, *z]);
            *handedness *= sign as f32;
        }
    }
    // Where left becomes right, triangles turn round: outside stays outside.
    for triangle in mesh.triangles.iter_mut().filter(|triangle| triangle.iter().all(|&v| mirrored[v as usize])) {
        triangle.swap(1, 2);
    }
}

/// The weighted mean of the joints of a vertex.
fn blend(influences: &Influences, vertex: usize, joints: &[Transform]) -> (DMat3, DVec3) {
    let total: f64 = influences.of(vertex).map(|(_, weight)| f64::from(weight)).sum();
    let (mut linear, mut shift) = (DMat3::ZERO, DVec3::ZERO);
    for (place, (joint, weight)) in influences.of(vertex).enumerate() {
        let weight = match total > 0.0 {
            true => f64::from(weight) / total,
            false => f64::from(u8::from(place == 0)),
        };
        if weight != 0.0 {
            let joint = &joints[joint as usize];
            linear += DMat3::from_cols_array_2d(&joint.columns.map(|column| column.map(f64::from))) * weight;
            shift += wide(joint.translation) * weight;
        }
    }
    (linear, shift)
}

fn direction(map: DMat3, vector: [f32; 3]) -> [f32; 3] {
    unit_or_zero((map * wide(vector)).to_array().map(|x| x as f32))
}

fn wide(vector: [f32; 3]) -> DVec3 {
    DVec3::from_array(vector.map(f64::from))
}

/// Rows of cross products: the inverse transpose up to its sign and a factor, defined for flat maps too.
fn cofactors(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Mesh {
        Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            triangles: vec![[0, 1, 2]],
            materials: vec![0],
            ..Mesh::default()
        }
    }

    fn moved(x: f32) -> Transform {
        Transform { translation: [x, 0.0, 0.0], ..Transform::IDENTITY }
    }

    #[test]
    fn targets_add_up_by_their_weights() {
        let mut mesh = triangle();
        let target = |positions, normals| MorphTarget { positions, normals, ..MorphTarget::default() };
        let targets = [
            (0.5, target(vec![[2.0, 0.0, 0.0]; 3], vec![])),
            (2.0, target(vec![[0.0, 0.0, 1.0]; 3], vec![[0.5, 0.0, 0.0]; 3])),
        ];
        morph(&mut mesh, &targets);
        assert_eq!(mesh.positions[1], [2.0, 0.0, 2.0]);
        assert!((mesh.normals[0][0] - 0.5f32.sqrt()).abs() < 1e-6, "{:?}", mesh.normals[0]);
    }

    #[test]
    fn a_vertex_follows_its_joints_by_weight() {
        let mut mesh = triangle();
        let influences = Influences {
            per_vertex: 2,
            joints: vec![0, 1, 0, 1, 1, 0],
            // Weights that add up to 2 count as half; those that add up to nothing leave it to the first joint.
            weights: vec![1.0, 0.0, 1.0, 1.0, 0.0, 0.0],
        };
        skin(&mut mesh, &influences, &[moved(10.0), moved(20.0)]);
        assert_eq!(mesh.positions, [[10.0, 0.0, 0.0], [16.0, 0.0, 0.0], [20.0, 1.0, 0.0]]);
        assert_eq!((mesh.normals[0], mesh.triangles[0]), ([0.0, 0.0, 1.0], [0, 1, 2]));
    }

    #[test]
    fn a_mirrored_joint_keeps_the_outside() {
        let mut mesh = triangle();
        let influences = Influences { per_vertex: 1, joints: vec![0; 3], weights: vec![1.0; 3] };
        let mirror = Transform { columns: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };
        skin(&mut mesh, &influences, &[mirror]);
        assert_eq!((mesh.positions[1], mesh.triangles[0]), ([-1.0, 0.0, 0.0], [0, 2, 1]));
        assert_eq!(mesh.normals[0], [0.0, 0.0, 1.0]);
    }
}
