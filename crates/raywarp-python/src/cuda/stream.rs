//! The stream that a call works on.

use std::ffi::c_void;

use dlpark::ffi::{DLDevice, DLDeviceType};
use dlpark::python::consumer::stream;
use dlpark::python::{DlpackStream, StreamArg};
use pyo3::prelude::*;
use raywarp::device::{Device, Stream};

use crate::errors;

/// A stream of a library, by the handle that it gave: 0 and 1 are the legacy default stream.
#[derive(Clone)]
pub struct CallStream {
    pub device: Device,
    pub handle: usize,
    pub stream: Stream,
}

impl CallStream {
    /// Of a handle that a library gave for the device. That it is one, and that it is not destroyed meanwhile, is the library's
    /// promise, as it is where CUDA's own functions are called with it.
    pub fn new(device: &Device, handle: usize) -> Self {
        let handle = if handle == 1 { 0 } else { handle };
        // SAFETY: as the comment says.
        let stream = unsafe { device.borrow_stream(handle) };
        Self { device: device.clone(), handle, stream }
    }

    /// What comes next waits for another stream, unless it is this.
    ///
    /// # Errors
    /// The device fails.
    pub fn wait_for(&self, handle: usize) -> PyResult<()> {
        let other = Self::new(&self.device, handle);
        if other.handle == self.handle {
            return Ok(());
        }
        self.stream.wait_for(&other.stream).map_err(|error| errors::of_device(&error))
    }
}

// SAFETY: the stream is the library's, and alive during its call.
unsafe impl DlpackStream for CallStream {
    fn as_python_arg(&self, _: Python<'_>, device: DLDevice) -> PyResult<StreamArg> {
        Ok(match device.device_type {
            DLDeviceType::CPU => stream::none(),
            _ => stream::cuda(self.handle as *mut c_void),
        })
    }

    unsafe fn wait_for_producer(&self, _: DLDevice, producer: *mut c_void) -> PyResult<bool> {
        self.wait_for(producer as usize).map(|()| true)
    }
}
