//! A ray tracer for CUDA that needs nothing but the driver, and runs on the CPU without one.

pub mod accel;
pub mod backend;
pub mod image;
pub mod render;
pub mod scene;
