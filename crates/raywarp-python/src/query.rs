//! Questions of batches of rays, answered into arrays that the package made.

use numpy::{PyArray1, PyReadonlyArray2, PyReadwriteArray1};
use pyo3::prelude::*;
use raywarp::query::{AllHits, Batch, Hits, Progress, QueryError};
use std::ops::ControlFlow;

use crate::errors;
use crate::rays::{RayArrays, Rays};
use crate::scene::Scene;
use crate::work::{self, Stop};

/// Arrays of 32-bit integers, as NumPy takes them over.
type Ints<'py> = Bound<'py, PyArray1<i32>>;
/// The same of floats.
type Floats<'py> = Bound<'py, PyArray1<f32>>;
/// Offsets, `t`, `uv`, primitive and geometry of every hit.
type All<'py> = (Bound<'py, PyArray1<i64>>, Floats<'py>, Floats<'py>, Ints<'py>, Ints<'py>);

/// The closest hit of each ray, written to four arrays.
#[pyfunction]
#[pyo3(signature = (scene, origins, directions, ends, t, uv, primitive, geometry, threads))]
#[allow(clippy::too_many_arguments)]
pub fn closest(
    py: Python<'_>,
    scene: &Scene,
    origins: PyReadonlyArray2<'_, f32>,
    directions: Option<PyReadonlyArray2<'_, f32>>,
    ends: (f32, f32),
    mut t: PyReadwriteArray1<'_, f32>,
    mut uv: PyReadwriteArray1<'_, f32>,
    mut primitive: PyReadwriteArray1<'_, i32>,
    mut geometry: PyReadwriteArray1<'_, i32>,
    threads: Option<usize>,
) -> PyResult<()> {
    let arrays = RayArrays::new(origins, directions, ends.0, ends.1);
    let rays = arrays.rays()?;
    let (t, uv) = (t.as_slice_mut()?, uv.as_slice_mut()?);
    let (primitive, geometry) = (primitive.as_slice_mut()?, geometry.as_slice_mut()?);
    for (items, each) in [(t.len(), 1), (uv.len(), 2), (primitive.len(), 1), (geometry.len(), 1)] {
        rays.check_room(items, each)?;
    }
    scene.ask(py, &rays, threads, u32::MAX, |batch, part| {
        let Hits { t: ts, primitive: primitives, geometry: geometries, uv: uvs } = batch.closest()?;
        t[part.clone()].copy_from_slice(&ts);
        uv[2 * part.start..2 * part.end].copy_from_slice(uvs.as_flattened());
        primitive[part.clone()].copy_from_slice(bytemuck::cast_slice(&primitives));
        geometry[part].copy_from_slice(bytemuck::cast_slice(&geometries));
        Ok(())
    })
}

/// Whether each ray hits anything, written to an array.
#[pyfunction]
#[pyo3(signature = (scene, origins, directions, ends, blocked, threads))]
pub fn any(
    py: Python<'_>,
    scene: &Scene,
    origins: PyReadonlyArray2<'_, f32>,
    directions: Option<PyReadonlyArray2<'_, f32>>,
    ends: (f32, f32),
    mut blocked: PyReadwriteArray1<'_, bool>,
    threads: Option<usize>,
) -> PyResult<()> {
    let arrays = RayArrays::new(origins, directions, ends.0, ends.1);
    let rays = arrays.rays()?;
    let blocked = blocked.as_slice_mut()?;
    rays.check_room(blocked.len(), 1)?;
    scene.ask(py, &rays, threads, u32::MAX, |batch, part| {
        blocked[part].copy_from_slice(&batch.any()?);
        Ok(())
    })
}

/// How many hits each ray has, written to an array.
#[pyfunction]
#[pyo3(signature = (scene, origins, directions, ends, max_hits, counts, threads))]
#[allow(clippy::too_many_arguments)]
pub fn count(
    py: Python<'_>,
    scene: &Scene,
    origins: PyReadonlyArray2<'_, f32>,
    directions: Option<PyReadonlyArray2<'_, f32>>,
    ends: (f32, f32),
    max_hits: Option<u32>,
    mut counts: PyReadwriteArray1<'_, i32>,
    threads: Option<usize>,
) -> PyResult<()> {
    let arrays = RayArrays::new(origins, directions, ends.0, ends.1);
    let rays = arrays.rays()?;
    let counts = counts.as_slice_mut()?;
    rays.check_room(counts.len(), 1)?;
    scene.ask(py, &rays, threads, max_hits.unwrap_or(u32::MAX), |batch, part| {
        counts[part].copy_from_slice(bytemuck::cast_slice(&batch.count()?));
        Ok(())
    })
}

/// Every hit of each ray.
#[pyfunction]
#[pyo3(signature = (scene, origins, directions, ends, max_hits, threads))]
pub fn all<'py>(
    py: Python<'py>,
    scene: &Scene,
    origins: PyReadonlyArray2<'_, f32>,
    directions: Option<PyReadonlyArray2<'_, f32>>,
    ends: (f32, f32),
    max_hits: Option<u32>,
    threads: Option<usize>,
) -> PyResult<All<'py>> {
    let arrays = RayArrays::new(origins, directions, ends.0, ends.1);
    let mut found = AllHits::default();
    scene.ask(py, &arrays.rays()?, threads, max_hits.unwrap_or(u32::MAX), |batch, _| {
        found.append(&mut batch.all()?);
        Ok(())
    })?;
    let AllHits { offsets, hits: Hits { t, primitive, geometry, uv } } = found;
    Ok((
        PyArray1::from_vec(py, bytemuck::cast_vec(offsets)),
        PyArray1::from_vec(py, t),
        PyArray1::from_vec(py, bytemuck::cast_vec(uv)),
        PyArray1::from_vec(py, bytemuck::cast_vec(primitive)),
        PyArray1::from_vec(py, bytemuck::cast_vec(geometry)),
    ))
}

impl Scene {
    /// Asks a batch piece by piece; `answer` is told which of the rays each is.
    fn ask(
        &self,
        py: Python<'_>,
        rays: &Rays<'_>,
        threads: Option<usize>,
        limit: u32,
        mut answer: impl FnMut(Batch<'_>, std::ops::Range<usize>) -> Result<(), QueryError> + Send,
    ) -> PyResult<()> {
        let enqueuer = self.enqueuer(py)?;
        let all = |stop: &Stop| -> Result<(), QueryError> {
            for part in rays.pieces() {
                let piece = rays.part(part.clone());
                let mut watch = |_: Progress| match stop.is_asked() {
                    true => ControlFlow::Break(()),
                    false => ControlFlow::Continue(()),
                };
                answer(enqueuer.caster().batch(&piece).max_hits(limit).watched(&mut watch), part)?;
            }
            Ok(())
        };
        work::run(py, threads, all)?.map_err(|error| errors::of_query(&error))
    }
}
