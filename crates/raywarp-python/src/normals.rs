//! Which way the triangles of hits look.

use numpy::{PyReadonlyArray1, PyReadwriteArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use raywarp::query::world_triangle;
use raywarp::Triangle;

use crate::scene::Scene;
use crate::work;

/// The unit normals of triangles by their numbers, written to an array; zero where there is no such triangle.
#[pyfunction]
pub fn normals(
    py: Python<'_>,
    scene: &Scene,
    primitive: PyReadonlyArray1<'_, i32>,
    geometry: PyReadonlyArray1<'_, i32>,
    mut normals: PyReadwriteArray1<'_, f32>,
    threads: Option<usize>,
) -> PyResult<()> {
    let (primitives, geometries) = (primitive.as_slice()?, geometry.as_slice()?);
    let normals = normals.as_slice_mut()?;
    if primitives.len() != geometries.len() || normals.len() != 3 * primitives.len() {
        return Err(PyValueError::new_err(
            "the arrays of normals and of the triangles' numbers have different lengths",
        ));
    }
    work::run(py, threads, |_| {
        scene.with_geometry(|meshes, instances| {
            let numbers = primitives.par_iter().zip(geometries);
            normals.par_chunks_exact_mut(3).zip(numbers).for_each(|(normal, (&primitive, &geometry))| {
                // What is negative is no index, as an unsigned number either.
                let triangle = world_triangle(meshes, instances, geometry as u32, primitive as u32);
                normal.copy_from_slice(&triangle.map_or([0.0; 3], |triangle| unit_normal(&triangle)));
            });
        });
    })
}

/// In double precision, so that small and large triangles have one too.
fn unit_normal(triangle: &Triangle) -> [f32; 3] {
    let [a, b, c] = [triangle.v0, triangle.v1, triangle.v2].map(|corner| [corner.x, corner.y, corner.z].map(f64::from));
    let side = |to: [f64; 3]| [0, 1, 2].map(|axis| to[axis] - a[axis]);
    let ([x, y, z], [u, v, w]) = (side(b), side(c));
    let normal = [y * w - z * v, z * u - x * w, x * v - y * u];
    let length = normal.map(|component| component * component).iter().sum::<f64>().sqrt();
    normal.map(|component| if length > 0.0 { (component / length) as f32 } else { 0.0 })
}
