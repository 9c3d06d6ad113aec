//! Where rays are traced: a CUDA device or the CPU, its buffers and streams.

pub use raywarp_device::{
    survey, Buffer, Device, DeviceChoice, DeviceError, DeviceInfo, DriverInfo, KernelInfo, Module, ParseDeviceError,
    PtxInfo, Staging, Stream, Survey, MAX_BLOCK,
};
