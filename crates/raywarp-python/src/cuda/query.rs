//! Questions of rays on a device: enqueued on the stream of the rays, with answers in arrays there.

use numpy::PyArray1;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use raywarp::query::enqueue::Question;
use raywarp::query::Coherence;
use raywarp_core::ray::HitArrays;

use super::rays::{DeviceRays, Rows};
use super::stream::CallStream;
use super::tensor::{Kind, Tensor};
use crate::errors;
use crate::scene::Scene;

/// The closest hit of each ray: `t`, `u`, `v` and the bits of the primitive in `records`, 4 floats a ray.
#[pyfunction]
pub fn enqueue_closest(
    py: Python<'_>,
    scene: &Scene,
    rays: &DeviceRays,
    records: &Bound<'_, PyAny>,
    geometry: &Bound<'_, PyAny>,
    coherent: bool,
) -> PyResult<()> {
    enqueue(py, scene, rays, coherent, |stream| {
        let count = rays.view().len() as usize;
        let (tensors, hits) = hit_arrays(records, geometry, count, stream)?;
        Ok((tensors, Question::Closest(hits)))
    })
}

/// Whether each ray hits anything: 0 or 1 in `numbers`.
#[pyfunction]
pub fn enqueue_any(
    py: Python<'_>,
    scene: &Scene,
    rays: &DeviceRays,
    numbers: &Bound<'_, PyAny>,
    coherent: bool,
) -> PyResult<()> {
    enqueue(py, scene, rays, coherent, |stream| {
        let numbers = integers(numbers, "answers", stream)?;
        let count = rays.view().len() as usize;
        let blocked = numbers.room(count, count)?;
        Ok((vec![numbers], Question::Any(blocked)))
    })
}

/// How many hits each ray has, in `numbers`.
#[pyfunction]
pub fn enqueue_count(
    py: Python<'_>,
    scene: &Scene,
    rays: &DeviceRays,
    max_hits: Option<u32>,
    numbers: &Bound<'_, PyAny>,
) -> PyResult<()> {
    enqueue(py, scene, rays, false, |stream| {
        let numbers = integers(numbers, "counts", stream)?;
        let count = rays.view().len() as usize;
        let counts = numbers.room(count, count)?;
        Ok((vec![numbers], Question::Count { limit: max_hits.unwrap_or(u32::MAX), counts }))
    })
}

/// Every hit of each ray, where `offsets` say, which ascend to the number of records.
#[pyfunction]
pub fn enqueue_all(
    py: Python<'_>,
    scene: &Scene,
    rays: &DeviceRays,
    offsets: &super::DeviceArray,
    numbers: &Bound<'_, PyAny>,
    records: &Bound<'_, PyAny>,
    geometry: &Bound<'_, PyAny>,
) -> PyResult<()> {
    enqueue(py, scene, rays, false, |stream| {
        let count = rays.view().len() as usize;
        let (offsets, hits) = offsets.offsets(count)?;
        let numbers = integers(numbers, "counts", stream)?;
        let counts = numbers.room(count, count)?;
        let (mut tensors, hits) = hit_arrays(records, geometry, hits, stream)?;
        tensors.push(numbers);
        Ok((tensors, Question::All { offsets, counts, hits }))
    })
}

/// The closest point to each of an array of (..., 3), at most `limit` away: the distance, the weights of vertices 1 and 2 and the bits of
/// the primitive in `records`, 4 floats a point.
#[pyfunction]
#[pyo3(signature = (scene, points, limit, records, geometry, stream, threads))]
#[allow(clippy::too_many_arguments)]
pub fn enqueue_nearest(
    py: Python<'_>,
    scene: &Scene,
    points: &Bound<'_, PyAny>,
    limit: f32,
    records: &Bound<'_, PyAny>,
    geometry: &Bound<'_, PyAny>,
    stream: usize,
    threads: Option<usize>,
) -> PyResult<()> {
    let asked = scene.closest_points(py, threads)?;
    let stream = CallStream::new(scene.device(), stream);
    let restored = scene.device().restoring_context(|| {
        let points = Tensor::import(points, "points", &stream)?;
        let rows = Rows::of(&points)?;
        if rows.columns != 3 {
            return Err(PyValueError::new_err(format!(
                "points have the shape {:?}, and (..., 3) is expected",
                points.shape
            )));
        }
        let (_tensors, found) = hit_arrays(records, geometry, rows.count, &stream)?;
        let size = [rows.stride, rows.count as u32];
        // SAFETY: points and answers were looked at: they are in memory of this device, and as many as they have to be. They are held until
        // this is enqueued, and behind that their libraries keep the order of the stream, as with kernels of their own.
        unsafe { asked.enqueue(&stream.stream, rows.numbers(&points, 0)?, size, limit, found) }
            .map_err(|error| errors::of_query(&error))
    });
    restored.map_err(|error| errors::of_device(&error))?
}

/// An array on a device as bytes of the host, with its type and shape, once the stream has made it.
#[pyfunction]
pub fn fetch<'py>(
    py: Python<'py>,
    scene: &Scene,
    array: &Bound<'py, PyAny>,
    stream: usize,
) -> PyResult<(Bound<'py, PyArray1<u32>>, String, Vec<usize>)> {
    let stream = CallStream::new(scene.device(), stream);
    let restored = scene.device().restoring_context(|| {
        let tensor = Tensor::import(array, "numbers", &stream)?;
        if !tensor.kind.is_number() || tensor.kind.bytes() % 4 != 0 || !tensor.is_compact() {
            return Err(PyTypeError::new_err(format!(
                "arrays on a device have to be numbers of 4 or 8 bytes, one after the other, and are {} of the shape {:?}",
                tensor.kind, tensor.shape
            )));
        }
        let words = tensor.view::<u32>(0, tensor.len() * tensor.kind.bytes() / 4)?;
        // SAFETY: the array is held until this returns, and its library was asked for it on this stream.
        let words = py.detach(|| unsafe { stream.stream.read(words) }).map_err(|error| errors::of_device(&error))?;
        Ok((PyArray1::from_vec(py, words), tensor.kind.text(), tensor.shape.clone()))
    });
    restored.map_err(|error| errors::of_device(&error))?
}

/// Enqueues a question whose answers go to arrays that are held until it is enqueued; behind that their libraries keep the order of
/// the stream, as with kernels of their own.
fn enqueue(
    py: Python<'_>,
    scene: &Scene,
    rays: &DeviceRays,
    coherent: bool,
    question: impl FnOnce(&CallStream) -> PyResult<(Vec<Tensor>, Question)>,
) -> PyResult<()> {
    let coherence = if coherent { Coherence::Coherent } else { Coherence::Incoherent };
    let restored = scene.device().restoring_context(|| {
        let (_tensors, question) = question(&rays.stream)?;
        let CallStream { handle, stream, .. } = &rays.stream;
        // SAFETY: rays and answers were looked at: they are in memory of this device, and as many as they have to be. That they stay there
        // is as the comment says.
        unsafe { scene.enqueuer(py)?.enqueue(stream, *handle, rays.view(), question, coherence) }
            .map_err(|error| errors::of_query(&error))
    });
    restored.map_err(|error| errors::of_device(&error))?
}

/// Room for so many hits.
fn hit_arrays(
    records: &Bound<'_, PyAny>,
    geometry: &Bound<'_, PyAny>,
    count: usize,
    stream: &CallStream,
) -> PyResult<(Vec<Tensor>, HitArrays)> {
    let records = Tensor::import(records, "records", stream)?;
    records.check_kind(&[Kind::FLOAT])?;
    let geometry = integers(geometry, "geometry", stream)?;
    let arrays = HitArrays { hits: records.room(4 * count, count)?, instances: geometry.room(count, count)? };
    Ok((vec![records, geometry], arrays))
}

fn integers(object: &Bound<'_, PyAny>, what: &'static str, stream: &CallStream) -> PyResult<Tensor> {
    let tensor = Tensor::import(object, what, stream)?;
    tensor.check_kind(&[Kind::INT])?;
    Ok(tensor)
}
