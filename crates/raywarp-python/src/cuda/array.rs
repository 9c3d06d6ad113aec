//! Arrays of raywarp's own on a device, for libraries that do not make theirs to be written by others.

use std::ffi::c_void;
use std::sync::Arc;

use dlpark::ffi::{DLDataType, DLDataTypeCode, DLDevice, DLManagedTensor, DLManagedTensorVersioned};
use dlpark::metadata::Dynamic;
use dlpark::python::{export_dlpack, CudaStreamRequest, DlpackExporter, ExportRequest};
use dlpark::{DlpackFlags, Managed, ManagedTensorBase};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::{PyBufferError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use raywarp::device::{Buffer, Device, View};
use raywarp_device::kernels::Views;

use super::stream::CallStream;
use crate::errors;
use crate::scene::Scene;

/// An array on a device. Other libraries take it by DLPack or the CUDA array interface; it lives as long as anyone has it.
#[pyclass(frozen, module = "raywarp._raywarp")]
pub struct DeviceArray {
    memory: Arc<Memory>,
    /// Items from the beginning of the memory.
    first: usize,
    shape: Vec<i64>,
    /// Items from one to the next, along each axis.
    strides: Vec<i64>,
    kind: Kind,
    /// On which it is written.
    stream: CallStream,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Float32,
    Int32,
    Int64,
}

struct Memory {
    device: Device,
    /// Until it is dropped.
    words: Option<Buffer<u32>>,
    address: usize,
    /// Where the hits of each ray begin and end, if that is what it holds: how many rays and hits.
    offsets: Option<(usize, usize)>,
    /// What is read by the kernel that writes it.
    _holds: Vec<Py<PyAny>>,
}

impl Drop for Memory {
    fn drop(&mut self) {
        // Nobody says when the last kernel is done that uses it, so all are waited for. Of a device that fails nothing can be learned.
        let _ = self.device.synchronize();
        let words = self.words.take();
        let _ = self.device.restoring_context(|| drop(words));
    }
}

impl Kind {
    fn of(text: &str) -> PyResult<Self> {
        match text {
            "float32" => Ok(Self::Float32),
            "int32" => Ok(Self::Int32),
            "int64" => Ok(Self::Int64),
            _ => Err(PyTypeError::new_err(format!("there are no arrays of {text}"))),
        }
    }

    fn words(self) -> usize {
        if self == Self::Int64 {
            2
        } else {
            1
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Float32 => "<f4",
            Self::Int32 => "<i4",
            Self::Int64 => "<i8",
        }
    }

    fn dlpack(self) -> DLDataType {
        let code = if self == Self::Float32 { 2 } else { 0 };
        DLDataType { code: DLDataTypeCode(code), bits: 32 * self.words() as u8, lanes: 1 }
    }
}

#[pymethods]
impl DeviceArray {
    /// Of words of the host, or of zeros, for kernels on a stream. `holds` are objects that live as long.
    #[new]
    #[pyo3(signature = (scene, shape, kind, stream, words=None, holds=Vec::new()))]
    fn new(
        scene: &Scene,
        shape: Vec<usize>,
        kind: &str,
        stream: usize,
        words: Option<PyReadonlyArray1<'_, u32>>,
        holds: Vec<Py<PyAny>>,
    ) -> PyResult<Self> {
        let kind = Kind::of(kind)?;
        let count = shape.iter().product::<usize>() * kind.words();
        let words = words.as_ref().map(PyReadonlyArray1::as_slice).transpose()?;
        if words.is_some_and(|words| words.len() != count) {
            return Err(PyValueError::new_err("the words do not fill the shape"));
        }
        let device = scene.device();
        let stream = CallStream::new(device, stream);
        let last = words.filter(|words| words.is_sorted()).and_then(<[u32]>::split_last);
        let offsets = last.map(|(&last, before)| (before.len(), last as usize));
        let made = device.restoring_context(|| {
            let mut words = match words {
                Some(words) => device.upload(words),
                None => device.zeroed(count),
            }?;
            stream.stream.follow()?;
            let address = if count == 0 { 0 } else { words.view_mut().shared(0) as usize };
            Ok(Memory { device: device.clone(), words: Some(words), address, offsets, _holds: holds })
        });
        let memory = made.and_then(|made| made).map_err(|error| errors::of_device(&error))?;
        let strides = (0..shape.len()).map(|axis| shape[axis + 1..].iter().product::<usize>() as i64).collect();
        let shape = shape.iter().map(|&len| len as i64).collect();
        Ok(Self { memory: Arc::new(memory), first: 0, shape, strides, kind, stream })
    }

    /// The same memory as another type of the same size.
    fn view(&self, kind: &str) -> PyResult<Self> {
        let kind = Kind::of(kind)?;
        if kind.words() != self.kind.words() {
            return Err(PyTypeError::new_err("the types have different sizes"));
        }
        Ok(Self { kind, ..self.again() })
    }

    /// Some of the last axis: from one on so many, or that one alone.
    #[pyo3(signature = (first, count=None))]
    fn columns(&self, first: usize, count: Option<usize>) -> PyResult<Self> {
        let (Some((&columns, shape)), Some((&step, strides))) = (self.shape.split_last(), self.strides.split_last())
        else {
            return Err(PyValueError::new_err("a single number has no columns"));
        };
        if (first + count.unwrap_or(1)) as i64 > columns {
            return Err(PyValueError::new_err(format!("there are {columns} columns")));
        }
        let (mut shape, mut strides) = (shape.to_vec(), strides.to_vec());
        if let Some(count) = count {
            shape.push(count as i64);
            strides.push(step);
        }
        Ok(Self { first: self.first + first * step as usize, shape, strides, ..self.again() })
    }

    #[getter]
    fn shape(&self) -> Vec<i64> {
        self.shape.clone()
    }

    #[pyo3(signature = (*, stream=None, max_version=None, dl_device=None, copy=None))]
    fn __dlpack__<'py>(
        &self,
        py: Python<'py>,
        stream: Option<&Bound<'py, PyAny>>,
        max_version: Option<(u32, u32)>,
        dl_device: Option<(u32, i32)>,
        copy: Option<bool>,
    ) -> PyResult<Py<PyAny>> {
        export_dlpack(self, py, ExportRequest::parse(stream, max_version, dl_device, copy)?)
    }

    fn __dlpack_device__(&self) -> (u32, i32) {
        let device = self.device();
        (device.device_type.0, device.device_id)
    }

    #[getter]
    fn __cuda_array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let interface = PyDict::new(py);
        interface.set_item("shape", pyo3::types::PyTuple::new(py, &self.shape)?)?;
        interface.set_item("typestr", self.kind.text())?;
        let size = 4 * self.kind.words();
        interface.set_item("data", (self.address(), false))?;
        let strides = self.strides.iter().map(|&items| items * size as i64);
        interface.set_item("strides", pyo3::types::PyTuple::new(py, strides.collect::<Vec<_>>())?)?;
        interface.set_item("stream", self.stream.handle.max(1))?;
        interface.set_item("version", 3)?;
        Ok(interface)
    }
}

impl DeviceArray {
    /// Where the hits of so many rays begin and end, and how many hits there are.
    pub fn offsets(&self, rays: usize) -> PyResult<(View<u32>, usize)> {
        match (self.memory.offsets, &self.memory.words) {
            (Some((count, hits)), Some(words)) if count == rays && self.kind == Kind::Int32 => Ok((words.view(), hits)),
            _ => Err(PyValueError::new_err("the array does not say where the hits of each ray are")),
        }
    }

    /// The same.
    fn again(&self) -> Self {
        let Self { memory, first, shape, strides, kind, stream } = self;
        let (shape, strides) = (shape.clone(), strides.clone());
        Self { memory: Arc::clone(memory), first: *first, shape, strides, kind: *kind, stream: stream.clone() }
    }

    /// Of the first item; 0 where there is none.
    fn address(&self) -> usize {
        match self.shape.contains(&0) {
            true => 0,
            false => self.memory.address + 4 * self.kind.words() * self.first,
        }
    }

    fn managed<M: ManagedTensorBase>(&self) -> PyResult<Managed<M>> {
        let prepared = Dynamic::new(self.shape.as_slice(), self.strides.as_slice()).prepare_as::<M>();
        let prepared = prepared.map_err(|error| PyBufferError::new_err(error.to_string()))?;
        let mut tensor = prepared.initialize(Arc::clone(&self.memory));
        tensor.set_data(self.address() as *mut c_void).set_dtype(self.kind.dlpack()).set_device(self.device());
        // SAFETY: as many items lie there as the shape says, for as long as the tensor holds the memory.
        Ok(unsafe { tensor.finish() })
    }
}

impl DlpackExporter for DeviceArray {
    fn device(&self) -> DLDevice {
        self.memory.device.cuda_index().map_or(DLDevice::CPU, |index| DLDevice::cuda(index as _))
    }

    fn flags(&self) -> DlpackFlags {
        DlpackFlags::empty()
    }

    fn prepare_export(&self, _: Python<'_>, request: &ExportRequest<'_>) -> PyResult<()> {
        let consumer = match request.cuda_stream()? {
            CudaStreamRequest::NoSync => return Ok(()),
            CudaStreamRequest::Omitted | CudaStreamRequest::LegacyDefault => 0,
            CudaStreamRequest::PerThreadDefault => 2,
            CudaStreamRequest::Pointer(handle) => handle,
        };
        let device = &self.memory.device;
        let ordered = device.restoring_context(|| CallStream::new(device, consumer).wait_for(self.stream.handle));
        ordered.map_err(|error| errors::of_device(&error))?
    }

    fn export_legacy(&self, _: Python<'_>) -> PyResult<Managed<DLManagedTensor>> {
        self.managed()
    }

    fn export_versioned(&self, _: Python<'_>) -> PyResult<Managed<DLManagedTensorVersioned>> {
        self.managed()
    }
}
