//! Rays as NumPy has them.

use std::borrow::Cow;
use std::ops::Range;

use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use rayon::prelude::*;
use raywarp::{Ray, Vec3};

/// Rays that are asked and answered at once: 128 MiB of them.
const PIECE: usize = 1 << 22;

/// The arrays of a batch: `origins` with 6 or 8 columns, or with 3 and as many `directions`, or with a single row of 3 for all of them.
pub struct RayArrays<'py> {
    origins: PyReadonlyArray2<'py, f32>,
    directions: Option<PyReadonlyArray2<'py, f32>>,
    ends: [f32; 2],
}

impl<'py> RayArrays<'py> {
    /// Of a call's arguments.
    pub fn new(
        origins: PyReadonlyArray2<'py, f32>,
        directions: Option<PyReadonlyArray2<'py, f32>>,
        t_min: f32,
        t_max: f32,
    ) -> Self {
        Self { origins, directions, ends: [t_min, t_max] }
    }

    /// The rays in them.
    ///
    /// # Errors
    /// The package prepares the arrays, so these tell of a mistake in it.
    pub fn rays(&self) -> PyResult<Rays<'_>> {
        let [rows, columns] = [0, 1].map(|axis| self.origins.shape()[axis]);
        let layout = match (&self.directions, columns) {
            (None, 6 | 8) => Layout::Whole { numbers: self.origins.as_slice()?, columns },
            (Some(directions), 3) if directions.shape()[1] == 3 && (rows == 1 || rows == directions.shape()[0]) => {
                Layout::Parts { origins: self.origins.as_slice()?, directions: directions.as_slice()? }
            }
            _ => return Err(PyTypeError::new_err(format!("{rows} rows of {columns} columns are no rays"))),
        };
        Ok(Rays { layout, ends: self.ends })
    }
}

/// Rays in memory of Python, which is not to write there meanwhile.
pub struct Rays<'a> {
    layout: Layout<'a>,
    /// `t_min` and `t_max` of those that have none of their own.
    ends: [f32; 2],
}

enum Layout<'a> {
    /// Origin and direction, or origin, `t_min`, direction and `t_max`.
    Whole { numbers: &'a [f32], columns: usize },
    /// As many origins as directions, or one.
    Parts { origins: &'a [f32], directions: &'a [f32] },
}

impl Rays<'_> {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self.layout {
            Layout::Whole { numbers, columns } => numbers.len() / columns,
            Layout::Parts { directions, .. } => directions.len() / 3,
        }
    }

    /// Refuses room for another number of answers.
    ///
    /// # Errors
    /// The package makes that room, so this tells of a mistake in it.
    pub fn check_room(&self, items: usize, each: usize) -> PyResult<()> {
        let rays = self.len();
        if items == rays * each {
            return Ok(());
        }
        Err(PyValueError::new_err(format!(
            "{rays} rays need room for {} numbers, and there is room for {items}",
            rays * each
        )))
    }

    /// Parts of the batch that are asked one after the other, so that memory is bounded.
    pub fn pieces(&self) -> impl Iterator<Item = Range<usize>> {
        let len = self.len();
        (0..len).step_by(PIECE).map(move |start| start..len.min(start + PIECE))
    }

    /// Some of the rays: where they lie if they are as kernels take them.
    pub fn part(&self, range: Range<usize>) -> Cow<'_, [Ray]> {
        if let Layout::Whole { numbers, columns: 8 } = self.layout {
            // SAFETY: a ray is eight floats of any value, and `align_to` looks to it that they lie where one may.
            let (before, rays, after) = unsafe { numbers[range.start * 8..range.end * 8].align_to::<Ray>() };
            if before.is_empty() && after.is_empty() {
                return Cow::Borrowed(rays);
            }
        }
        Cow::Owned(range.into_par_iter().map(|index| self.ray(index)).collect())
    }

    fn ray(&self, index: usize) -> Ray {
        let [t_min, t_max] = self.ends;
        let vector = |numbers: &[f32], at: usize| Vec3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
        match self.layout {
            Layout::Whole { numbers, columns: 6 } => {
                let (origin, direction) = (vector(numbers, 6 * index), vector(numbers, 6 * index + 3));
                Ray { origin, t_min, direction, t_max }
            }
            Layout::Whole { numbers, .. } => {
                let at = 8 * index;
                let (origin, direction) = (vector(numbers, at), vector(numbers, at + 4));
                Ray { origin, t_min: numbers[at + 3], direction, t_max: numbers[at + 7] }
            }
            Layout::Parts { origins, directions } => {
                let origin = vector(origins, if origins.len() == 3 { 0 } else { 3 * index });
                Ray { origin, t_min, direction: vector(directions, 3 * index), t_max }
            }
        }
    }
}
