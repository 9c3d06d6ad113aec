//! Rays on a device.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use raywarp::device::View;
use raywarp::Ray;
use raywarp_core::gather::GatherRays;

use super::stream::CallStream;
use super::tensor::{Kind, Tensor};
use crate::errors;
use crate::scene::Scene;

/// A batch of rays on a device, as kernels take them, on a stream.
#[pyclass(frozen, module = "raywarp._raywarp")]
pub struct DeviceRays {
    rays: View<Ray>,
    pub stream: CallStream,
    /// Keep the rays where they are.
    _tensors: Vec<Tensor>,
}

#[pymethods]
impl DeviceRays {
    /// Of arrays as people have them. Where the rays are not whole, they are put together in `room`, 8 floats each.
    #[new]
    #[pyo3(signature = (scene, rays, directions, ends, room, stream))]
    fn new(
        py: Python<'_>,
        scene: &Scene,
        rays: &Bound<'_, PyAny>,
        directions: Option<&Bound<'_, PyAny>>,
        ends: (f32, f32),
        room: Option<&Bound<'_, PyAny>>,
        stream: usize,
    ) -> PyResult<Self> {
        let stream = CallStream::new(scene.device(), stream);
        let restored = scene.device().restoring_context(|| {
            let what = if directions.is_some() { "origins" } else { "rays" };
            let rays = Tensor::import(rays, what, &stream)?;
            let directions = directions.map(|object| Tensor::import(object, "directions", &stream)).transpose()?;
            let room = room.map(|object| Tensor::import(object, "room for rays", &stream)).transpose()?;
            Self::on(py, scene, rays, directions, [ends.0, ends.1], room, stream.clone())
        });
        restored.map_err(|error| errors::of_device(&error))?
    }

    /// How many there are.
    fn __len__(&self) -> usize {
        self.rays.len() as usize
    }
}

impl DeviceRays {
    pub fn view(&self) -> View<Ray> {
        self.rays
    }

    #[allow(clippy::too_many_arguments)]
    fn on(
        py: Python<'_>,
        scene: &Scene,
        rays: Tensor,
        directions: Option<Tensor>,
        ends: [f32; 2],
        room: Option<Tensor>,
        stream: CallStream,
    ) -> PyResult<Self> {
        let first = Rows::of(&rays)?;
        let second = directions.as_ref().map(Rows::of).transpose()?;
        let view = match (&room, &second, first.columns) {
            (None, None, 8) if first.stride == 8 || first.count <= 1 => rays.view(0, first.count)?,
            (None, _, _) => {
                return Err(PyTypeError::new_err("rays of 8 numbers on a device have to lie one after the other"))
            }
            (Some(room), None, 6) => {
                let (origins, directions) = (first.numbers(&rays, 0)?, first.numbers(&rays, 3)?);
                gather(py, scene, &stream, room, first.count, [origins, directions], [first.stride; 2], ends)?
            }
            (Some(room), Some(second), 3) if second.columns == 3 && first.pairs(second).is_some() => {
                let (Some(directions), Some(count)) = (&directions, first.pairs(second)) else {
                    unreachable!("there are rows of it, and as many pairs")
                };
                let arrays = [first.numbers(&rays, 0)?, second.numbers(directions, 0)?];
                gather(py, scene, &stream, room, count, arrays, [first.step(), second.step()], ends)?
            }
            _ => {
                let directions = directions.as_ref().map(|directions| &directions.shape);
                return Err(PyValueError::new_err(format!(
                    "arrays of the shape {:?} and {directions:?} on a device are no rays: (..., 6), (..., 8), or origins (..., 3) and \
                     as many directions are expected",
                    rays.shape
                )));
            }
        };
        let tensors = [Some(rays), directions, room].into_iter().flatten().collect();
        Ok(Self { rays: view, stream, _tensors: tensors })
    }
}

/// Enqueues the making of rays.
#[allow(clippy::too_many_arguments)]
fn gather(
    py: Python<'_>,
    scene: &Scene,
    stream: &CallStream,
    room: &Tensor,
    count: usize,
    [origins, directions]: [View<f32>; 2],
    strides: [u32; 2],
    ends: [f32; 2],
) -> PyResult<View<Ray>> {
    room.check_kind(&[Kind::FLOAT])?;
    let rays = room.room::<Ray>(8 * count, count)?;
    let kernel = GatherRays { origins, directions, strides, ends, rays };
    // SAFETY: the room is as long as the rays are many, their rows are in range, and the tensors are held as long as the rays are; behind
    // that their libraries keep the order of the stream, as with kernels of their own.
    unsafe { scene.enqueuer(py)?.gather(&stream.stream, &kernel) }.map_err(|error| errors::of_query(&error))?;
    room.view(0, count)
}

/// An array as rows of as many numbers each, the same distance apart.
pub struct Rows {
    pub count: usize,
    pub columns: usize,
    /// Numbers from the beginning of one to the next.
    pub stride: u32,
}

impl Rows {
    /// Of floats.
    ///
    /// # Errors
    /// The rows do not lie so.
    pub fn of(tensor: &Tensor) -> PyResult<Self> {
        tensor.check_kind(&[Kind::FLOAT])?;
        let refused = |problem: &str| {
            Err(PyValueError::new_err(format!("an array of the shape {:?} on a device {problem}", tensor.shape)))
        };
        let (Some((&columns, axes)), Some((&step, strides))) = (tensor.shape.split_last(), tensor.strides.split_last())
        else {
            return refused("is a single number, and no rays");
        };
        let count: usize = axes.iter().product();
        if count > 0 && columns > 1 && step != 1 {
            return refused("has rows whose numbers lie apart: copy it first");
        }
        // Axes of length 1 are of no matter; the others have to be one axis, seen together.
        let axes: Vec<(usize, usize)> =
            axes.iter().copied().zip(strides.iter().copied()).filter(|axis| axis.0 != 1).collect();
        if count > 0 && axes.windows(2).any(|pair| pair[0].1 != pair[1].0 * pair[1].1) {
            return refused("has rows that lie at different distances: copy it first");
        }
        let stride = axes.last().map_or(columns, |axis| axis.1);
        match u32::try_from(stride) {
            Ok(stride) => Ok(Self { count, columns, stride }),
            Err(_) => refused("has rows that lie too far apart"),
        }
    }

    /// How many pairs these and others make, where a single row goes with each of the others.
    fn pairs(&self, others: &Self) -> Option<usize> {
        match (self.count, others.count) {
            (1, count) | (count, 1) => Some(count),
            (count, other) => (count == other).then_some(count),
        }
    }

    /// Numbers from the row of one pair to that of the next.
    fn step(&self) -> u32 {
        if self.count == 1 {
            0
        } else {
            self.stride
        }
    }

    /// The numbers from a column on, to the end of the last row.
    pub fn numbers(&self, tensor: &Tensor, column: usize) -> PyResult<View<f32>> {
        match self.count {
            0 => Ok(View::EMPTY),
            count => tensor.view(column, (count - 1) * self.stride as usize + self.columns - column),
        }
    }
}
