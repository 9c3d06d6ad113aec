//! Launches that are waited for later.

use std::fmt;

use raywarp_core::kernels::Kernel;

use super::{cpu, cuda, DeviceError, Machine};

/// A queue of kernels: those of one stream run one after the other, those of several may run at once.
#[derive(Clone)]
pub struct Stream {
    queue: Queue,
}

#[derive(Clone)]
enum Queue {
    Cpu,
    Cuda(cuda::Stream),
}

impl fmt::Debug for Stream {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.queue {
            Queue::Cpu => write!(f, "Stream(CPU)"),
            Queue::Cuda(stream) => write!(f, "Stream({})", stream.gpu().description()),
        }
    }
}

impl Stream {
    pub(crate) fn new(machine: &Machine) -> Result<Self, DeviceError> {
        let queue = match machine {
            Machine::Cpu => Queue::Cpu,
            Machine::Cuda(gpu) => Queue::Cuda(cuda::Stream::new(gpu)?),
        };
        Ok(Self { queue })
    }

    /// Whether this is a queue of that device.
    pub(crate) fn is_on(&self, machine: &Machine) -> bool {
        match (&self.queue, machine) {
            (Queue::Cpu, Machine::Cpu) => true,
            (Queue::Cuda(stream), Machine::Cuda(gpu)) => stream.gpu().is(gpu),
            _ => false,
        }
    }

    /// Starts a kernel after those launched before, once the device has done what it was told before.
    ///
    /// # Safety
    /// As for [`Device::launch`](super::Device::launch), until the launch has been waited for.
    ///
    /// # Errors
    /// [`DeviceError`] where the launch fails.
    pub unsafe fn launch<K: Kernel>(&self, kernel: &K, extent: [u32; 2]) -> Result<Launch, DeviceError> {
        Ok(match &self.queue {
            // SAFETY: the caller's promise.
            Queue::Cpu => Launch::done(unsafe { cpu::launch(kernel, extent, None) }),
            // SAFETY: the caller's promise.
            Queue::Cuda(stream) => Launch(State::Running(unsafe { stream.launch(kernel, extent) }?)),
        })
    }
}

/// A kernel under way, or done.
#[derive(Debug)]
pub struct Launch(State);

#[derive(Debug)]
enum State {
    /// After so many seconds.
    Done(f64),
    Running(cuda::CudaLaunch),
}

impl Launch {
    /// One that took so many seconds.
    pub fn done(seconds: f64) -> Self {
        Self(State::Done(seconds))
    }

    /// Waits for the kernel; returns the seconds it took on the device.
    ///
    /// # Errors
    /// [`DeviceError`] where the kernel failed.
    pub fn wait(&self) -> Result<f64, DeviceError> {
        match &self.0 {
            State::Done(seconds) => Ok(*seconds),
            State::Running(launch) => launch.wait(),
        }
    }
}
