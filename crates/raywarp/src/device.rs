//! Where rays are traced: a CUDA device or the CPU, its buffers and streams.

pub use raywarp_device::{
    survey, Buffer, Device, DeviceChoice, DeviceError, DeviceInfo, DriverInfo, Kernel, KernelInfo, Module,
    ParseDeviceError, Plain, PtxInfo, Staging, Stream, Survey, View, ViewMut, MAX_BLOCK,
};
