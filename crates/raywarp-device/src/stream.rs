//! Queues beside the one that a device has itself.

use std::fmt;
use std::time::Instant;

use raywarp_core::kernels::Kernel;

use super::mark::Point;
use super::{cpu, cuda, DeviceError, Machine, Mark};

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

    pub(crate) fn on_cpu() -> Self {
        Self { queue: Queue::Cpu }
    }

    pub(crate) fn on_cuda(stream: cuda::Stream) -> Self {
        Self { queue: Queue::Cuda(stream) }
    }

    pub(crate) fn on_cuda_stream(&self) -> Option<&cuda::Stream> {
        match &self.queue {
            Queue::Cpu => None,
            Queue::Cuda(stream) => Some(stream),
        }
    }

    /// Whether this is a queue of that device.
    pub(crate) fn is_on(&self, machine: &Machine) -> bool {
        match (&self.queue, machine) {
            (Queue::Cpu, Machine::Cpu) => true,
            (Queue::Cuda(stream), Machine::Cuda(gpu)) => stream.gpu().is(gpu),
            _ => false,
        }
    }

    /// What comes next on this stream waits for all that the device has been told so far.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn follow(&self) -> Result<(), DeviceError> {
        match &self.queue {
            Queue::Cpu => Ok(()),
            Queue::Cuda(stream) => stream.follow(),
        }
    }

    /// A point in the order of what this stream has been told.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn mark(&self) -> Result<Mark, DeviceError> {
        Ok(Mark::new(match &self.queue {
            Queue::Cpu => Point::Passed(Instant::now()),
            Queue::Cuda(stream) => Point::Cuda(stream.mark()?),
        }))
    }

    /// Enqueues a kernel after those launched before on this stream, and on nothing else but what the stream was told to
    /// [follow](Self::follow). On the CPU it is over when this returns.
    ///
    /// # Safety
    /// As for [`Device::launch`](super::Device::launch), and until a [`mark`](Self::mark) behind it was waited for nothing
    /// else touches what the kernel writes, nor frees what it reads.
    ///
    /// # Errors
    /// [`DeviceError`] where the launch fails.
    pub unsafe fn launch<K: Kernel>(&self, kernel: &K, extent: [u32; 2]) -> Result<(), DeviceError> {
        match &self.queue {
            Queue::Cpu => {
                // SAFETY: the caller's promise.
                unsafe { cpu::launch(kernel, extent, None) };
                Ok(())
            }
            // SAFETY: the caller's promise.
            Queue::Cuda(stream) => unsafe { stream.launch(kernel, extent) },
        }
    }
}
