//! An array of another library, by DLPack or the CUDA array interface.

use std::fmt;

use dlpark::ffi::{DLDataType, DLDeviceType};
use dlpark::python::{ImportRequest, ImportedDlpack};
use dlpark::DlpackFlags;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use raywarp::device::{Plain, View, ViewMut};

use super::stream::CallStream;
use crate::errors;

/// The type of an array's items.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// `f`, `i`, `u`, or `?` for another.
    letter: char,
    bytes: usize,
}

impl Kind {
    pub const FLOAT: Self = Self { letter: 'f', bytes: 4 };
    pub const INT: Self = Self { letter: 'i', bytes: 4 };

    fn of_dlpack(kind: DLDataType) -> Self {
        let letter = match (kind.code.0, kind.lanes) {
            (0, 1) => 'i',
            (1, 1) => 'u',
            (2, 1) => 'f',
            _ => '?',
        };
        Self { letter, bytes: usize::from(kind.bits) / 8 }
    }

    /// Of text as "<f4".
    fn of_text(text: &str) -> Self {
        let letter = text.chars().nth(1).filter(|letter| "fiu".contains(*letter) && !text.starts_with('>'));
        let bytes = text.get(2..).and_then(|digits| digits.parse().ok());
        match (letter, bytes) {
            (Some(letter), Some(bytes)) => Self { letter, bytes },
            _ => Self { letter: '?', bytes: 0 },
        }
    }

    /// As NumPy writes it.
    pub fn text(self) -> String {
        format!("<{}{}", self.letter, self.bytes)
    }

    pub fn bytes(self) -> usize {
        self.bytes
    }

    pub fn is_number(self) -> bool {
        self.letter != '?'
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.letter {
            'f' => "float",
            'i' => "int",
            'u' => "uint",
            _ => return f.write_str("of another type"),
        };
        write!(f, "{name}{}", 8 * self.bytes)
    }
}

/// Where an array lies in memory of the device, and whoever keeps it there.
pub struct Tensor {
    what: &'static str,
    address: usize,
    pub shape: Vec<usize>,
    /// Items from one to the next, along each axis.
    pub strides: Vec<usize>,
    pub kind: Kind,
    writable: bool,
    _owner: Owner,
}

enum Owner {
    /// Whose deleter runs when it is dropped.
    Dlpack(#[allow(dead_code)] ImportedDlpack),
    Interface(#[allow(dead_code)] Py<PyAny>),
}

impl Tensor {
    /// Of an object that is an array on the stream's device. What comes next on the stream waits for what its library still does
    /// with it.
    ///
    /// # Errors
    /// The object is no such array.
    pub fn import(object: &Bound<'_, PyAny>, what: &'static str, stream: &CallStream) -> PyResult<Self> {
        match object.hasattr(pyo3::intern!(object.py(), "__dlpack__"))? {
            true => Self::by_dlpack(object, what, stream),
            false => Self::by_interface(object, what, stream),
        }
    }

    fn by_dlpack(object: &Bound<'_, PyAny>, what: &'static str, stream: &CallStream) -> PyResult<Self> {
        let request = ImportRequest::new(object.as_borrowed())?;
        let device = request.device()?;
        // On the CPU all is as on a GPU but for the order of streams: so that is tested without one.
        let is_here = match (device.device_type, stream.device.cuda_index()) {
            (DLDeviceType::CUDA | DLDeviceType::CUDAMANAGED, Some(index)) => {
                usize::try_from(device.device_id) == Ok(index)
            }
            (DLDeviceType::CPU, None) => true,
            _ => false,
        };
        if !is_here {
            return Err(elsewhere(what, stream));
        }
        let imported = request.import(Some(stream), None)?;
        let invalid = |error: dlpark::tensor::Error| PyValueError::new_err(format!("{what}: {error}"));
        let writable = !imported.flags().contains(DlpackFlags::READ_ONLY);
        let tensor = imported.validate().map_err(invalid)?;
        let lengths =
            |numbers: &[i64]| numbers.iter().map(|&number| length(number, what)).collect::<PyResult<Vec<_>>>();
        let address = match tensor.num_elements() {
            0 => 0,
            // SAFETY: the address is not followed here; that it is one is the library's promise.
            _ => unsafe { tensor.offset_bytes_ptr() }.map_err(invalid)? as usize,
        };
        let (shape, strides) = (lengths(tensor.shape())?, lengths(&tensor.strides_or_compact().map_err(invalid)?)?);
        let kind = Kind::of_dlpack(tensor.dtype());
        Ok(Self { what, address, shape, strides, kind, writable, _owner: Owner::Dlpack(imported) })
    }

    fn by_interface(object: &Bound<'_, PyAny>, what: &'static str, stream: &CallStream) -> PyResult<Self> {
        let interface = object.getattr("__cuda_array_interface__")?.cast_into::<PyDict>()?;
        let item = |name: &str| interface.get_item(name);
        let missing = |name: &str| PyTypeError::new_err(format!("the CUDA array interface of {what} has no {name}"));
        let shape: Vec<usize> = item("shape")?.ok_or_else(|| missing("shape"))?.extract()?;
        let text: String = item("typestr")?.ok_or_else(|| missing("typestr"))?.extract()?;
        let (address, read_only): (usize, bool) = item("data")?.ok_or_else(|| missing("data"))?.extract()?;
        let kind = Kind::of_text(&text);
        let strides: Option<Vec<i64>> = item("strides")?.map(|strides| strides.extract()).transpose()?.flatten();
        let strides = match strides {
            Some(bytes) => bytes
                .iter()
                .map(|&bytes| length(bytes, what).map(|bytes| bytes / kind.bytes.max(1)))
                .collect::<PyResult<_>>()?,
            None => compact(&shape),
        };
        let device = &stream.device;
        if !device.is_cuda() || (address != 0 && !device.holds(address).map_err(|error| errors::of_device(&error))?) {
            return Err(elsewhere(what, stream));
        }
        if let Some(producer) = item("stream")?.map(|handle| handle.extract::<Option<usize>>()).transpose()?.flatten() {
            stream.wait_for(producer)?;
        }
        let owner = Owner::Interface(object.clone().unbind());
        Ok(Self { what, address, shape, strides, kind, writable: !read_only, _owner: owner })
    }

    /// How many items there are.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Refuses another type of items.
    pub fn check_kind(&self, wanted: &[Kind]) -> PyResult<()> {
        if wanted.contains(&self.kind) {
            return Ok(());
        }
        let Self { what, kind, .. } = self;
        Err(PyTypeError::new_err(format!("{what} on a device have to be {}, and are {kind}", wanted[0])))
    }

    /// Whether its items lie one after the other.
    pub fn is_compact(&self) -> bool {
        let mut expected = 1;
        self.len() == 0
            || self.shape.iter().zip(&self.strides).rev().all(|(&len, &stride)| {
                let fits = len == 1 || stride == expected;
                expected *= len;
                fits
            })
    }

    /// The items from one on, for kernels to read.
    pub fn view<T: Plain>(&self, first: usize, len: usize) -> PyResult<View<T>> {
        let address = self.address + first * self.kind.bytes;
        self.check_address::<T>(address)?;
        let len = u32::try_from(len).map_err(|_| too_many(self.what, len))?;
        // SAFETY: so many items are there by the promise of their library, which this holds to it; kernels are told that they outlive
        // a launch where it is launched.
        Ok(unsafe { View::new(address as *const T, len) })
    }

    /// Room for answers: `len` items of `T`, one after the other, in `numbers` of its own.
    pub fn room<T: Plain>(&self, numbers: usize, len: usize) -> PyResult<ViewMut<T>> {
        let Self { what, .. } = self;
        if self.len() != numbers || !self.is_compact() {
            return Err(PyValueError::new_err(format!(
                "{what} have the shape {:?}, and {numbers} numbers one after the other are expected",
                self.shape
            )));
        }
        if !self.writable {
            return Err(PyValueError::new_err(format!("{what} are read-only")));
        }
        self.check_address::<T>(self.address)?;
        let len = u32::try_from(len).map_err(|_| too_many(what, len))?;
        // SAFETY: as for `view`; whoever made a call wants it written.
        Ok(unsafe { ViewMut::new(self.address as *mut T, len) })
    }

    fn check_address<T>(&self, address: usize) -> PyResult<()> {
        if address.is_multiple_of(align_of::<T>()) {
            return Ok(());
        }
        let Self { what, .. } = self;
        Err(PyValueError::new_err(format!(
            "{what} begin at an address that is no multiple of {} bytes",
            align_of::<T>()
        )))
    }
}

fn compact(shape: &[usize]) -> Vec<usize> {
    (0..shape.len()).map(|axis| shape[axis + 1..].iter().product()).collect()
}

fn length(number: i64, what: &str) -> PyResult<usize> {
    usize::try_from(number)
        .map_err(|_| PyValueError::new_err(format!("{what} run backwards in memory: copy them first")))
}

fn too_many(what: &str, len: usize) -> PyErr {
    PyValueError::new_err(format!("{len} {what} are more than the {} that can be asked at once", u32::MAX))
}

fn elsewhere(what: &str, stream: &CallStream) -> PyErr {
    let device = stream.device.cuda_index().map_or("cpu".to_owned(), |index| format!("cuda:{index}"));
    PyValueError::new_err(format!("{what} are in the memory of another device than the scene, which is on {device}"))
}
