//! The closest points of a scene to those of an array, and where points of its surface are.

use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use raywarp::query::{world_triangle, QueryError};

use crate::errors;
use crate::scene::Scene;
use crate::work;

/// Points that are asked at once, between two looks whether to stop.
const PIECE: usize = 1 << 18;

/// The closest point to each of these, at most `limit` away, written to four arrays.
#[pyfunction]
#[pyo3(signature = (scene, points, limit, distance, uv, primitive, geometry, threads))]
#[allow(clippy::too_many_arguments)]
pub fn nearest(
    py: Python<'_>,
    scene: &Scene,
    points: PyReadonlyArray2<'_, f32>,
    limit: f32,
    mut distance: PyReadwriteArray1<'_, f32>,
    mut uv: PyReadwriteArray1<'_, f32>,
    mut primitive: PyReadwriteArray1<'_, i32>,
    mut geometry: PyReadwriteArray1<'_, i32>,
    threads: Option<usize>,
) -> PyResult<()> {
    let asked = scene.closest_points(py, threads)?;
    let points: &[[f32; 3]] = bytemuck::cast_slice(points.as_slice()?);
    let (distance, uv) = (distance.as_slice_mut()?, uv.as_slice_mut()?);
    let (primitive, geometry) = (primitive.as_slice_mut()?, geometry.as_slice_mut()?);
    let lengths = [distance.len(), uv.len() / 2, primitive.len(), geometry.len()];
    if lengths != [points.len(); 4] {
        return Err(PyValueError::new_err(format!("{} points need as many answers, not {lengths:?}", points.len())));
    }
    let all = |stop: &work::Stop| -> Result<(), QueryError> {
        for (piece, first) in points.chunks(PIECE).zip((0..).step_by(PIECE)) {
            if stop.is_asked() {
                return Err(QueryError::Stopped { done: first, total: points.len() });
            }
            for (hit, index) in asked.closest(piece, limit)?.iter().zip(first..) {
                distance[index] = hit.t;
                uv[2 * index..2 * index + 2].copy_from_slice(&[hit.u, hit.v]);
                primitive[index] = hit.primitive as i32;
                geometry[index] = hit.instance as i32;
            }
        }
        Ok(())
    };
    work::run(py, threads, all)?.map_err(|error| errors::of_query(&error))
}

/// Where points of triangles are, by the weights of vertices 1 and 2; NaN where there is no such triangle.
#[pyfunction]
pub fn surface_points(
    py: Python<'_>,
    scene: &Scene,
    primitive: PyReadonlyArray1<'_, i32>,
    geometry: PyReadonlyArray1<'_, i32>,
    uv: PyReadonlyArray1<'_, f32>,
    mut points: PyReadwriteArray1<'_, f32>,
    threads: Option<usize>,
) -> PyResult<()> {
    let (primitives, geometries, uvs) = (primitive.as_slice()?, geometry.as_slice()?, uv.as_slice()?);
    let points = points.as_slice_mut()?;
    if [geometries.len(), uvs.len() / 2, points.len() / 3] != [primitives.len(); 3] {
        return Err(PyValueError::new_err("the arrays of points and of the triangles' numbers have different lengths"));
    }
    work::run(py, threads, |_| {
        scene.with_geometry(|meshes, instances| {
            let numbers = primitives.par_iter().zip(geometries).zip(uvs.par_chunks_exact(2));
            points.par_chunks_exact_mut(3).zip(numbers).for_each(|(point, ((&primitive, &geometry), uv))| {
                // What is negative is no index, as an unsigned number either.
                let triangle = world_triangle(meshes, instances, geometry as u32, primitive as u32);
                let at = triangle.map(|triangle| {
                    let (b, c) = (triangle.v1 - triangle.v0, triangle.v2 - triangle.v0);
                    c.mul_add(uv[1], b.mul_add(uv[0], triangle.v0))
                });
                point.copy_from_slice(&at.map_or([f32::NAN; 3], |at| [at.x, at.y, at.z]));
            });
        });
    })
}
