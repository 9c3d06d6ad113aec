//! What every reader does with numbers that no surface can have.

use crate::Mesh;

/// Drops the triangles that use a vertex with a NaN or infinite coordinate, and says how many.
///
/// Such vertices are moved onto a sound one, so that they do not spoil the bounds of the mesh.
pub(super) fn drop_non_finite(mesh: &mut Mesh) -> usize {
    let finite = |position: &[f32; 3]| position.iter().all(|coordinate| coordinate.is_finite());
    if mesh.positions.iter().all(finite) {
        return 0;
    }
    let before = mesh.triangles.len();
    let sound: Vec<bool> = mesh.positions.iter().map(finite).collect();
    let keep: Vec<bool> = mesh.triangles.iter().map(|triangle| triangle.iter().all(|&v| sound[v as usize])).collect();
    retain(&mut mesh.triangles, &keep);
    retain(&mut mesh.materials, &keep);
    let substitute = mesh.positions.iter().copied().find(finite).unwrap_or_default();
    for position in mesh.positions.iter_mut().filter(|position| !finite(position)) {
        *position = substitute;
    }
    before - mesh.triangles.len()
}

fn retain<T>(list: &mut Vec<T>, keep: &[bool]) {
    let mut flags = keep.iter();
    list.retain(|_| flags.next().copied().unwrap_or(true));
}

/// The vector at length 1; zero, which stands for the flat normal, if it has no direction.
pub(crate) fn unit_or_zero(vector: [f32; 3]) -> [f32; 3] {
    // In f64 no finite f32 overflows or vanishes when squared.
    let length = vector.iter().map(|&x| f64::from(x) * f64::from(x)).sum::<f64>().sqrt();
    match length.is_finite() && length > 0.0 {
        true => vector.map(|x| (f64::from(x) / length) as f32),
        false => [0.0; 3],
    }
}
