//! Kernels that run while the host goes on.

use std::fmt;
use std::sync::Arc;

use cudarc::driver::{sys, CudaEvent, CudaStream, DeviceRepr, DriverError, LaunchConfig, PushKernelArg};
use raywarp_core::kernels::Kernel;

use super::{driver_error, Cuda, DeviceError};

/// Threads of a block: columns and rows. A warp is then a tile of 8 x 4 pixels. Chosen by `lab/docs/study`.
const BLOCK: [u32; 2] = [8, 8];

/// Threads of a block of a launch with a single row.
pub(crate) const BLOCK_ROW: u32 = 128;

/// A kernel's parameter block, passed by value.
#[repr(transparent)]
struct Parameters<K>(K);

// SAFETY: a kernel is a `repr(C)` block of numbers and views, the same on host and device.
unsafe impl<K: Kernel> DeviceRepr for Parameters<K> {}

/// A queue of kernels beside the device's own stream.
#[derive(Clone)]
pub(crate) struct Stream {
    gpu: Cuda,
    stream: Arc<CudaStream>,
}

impl Stream {
    pub fn new(gpu: &Cuda) -> Result<Self, DeviceError> {
        let stream = gpu.context().new_stream().map_err(driver_error)?;
        Ok(Self { gpu: gpu.clone(), stream })
    }

    /// Of that device.
    pub fn of(gpu: &Cuda, stream: Arc<CudaStream>) -> Self {
        Self { gpu: gpu.clone(), stream }
    }

    pub fn queue(&self) -> &CudaStream {
        &self.stream
    }

    pub fn gpu(&self) -> &Cuda {
        &self.gpu
    }

    /// What comes next waits for all that the device's own stream has been told: it may still be clearing what a kernel
    /// is about to use.
    pub fn follow(&self) -> Result<(), DeviceError> {
        let after = self.stream.join(self.gpu.stream());
        after.map_err(|error| self.gpu.failed("put its streams in order", error))
    }

    pub fn mark(&self) -> Result<CudaMark, DeviceError> {
        CudaMark::new(&self.gpu, &self.stream)
    }

    /// # Safety
    /// As for [`launch`].
    pub unsafe fn launch<K: Kernel>(&self, kernel: &K, extent: [u32; 2]) -> Result<(), DeviceError> {
        // SAFETY: the caller's promise.
        unsafe { launch(&self.gpu, &self.stream, kernel, configuration(extent, None)) }
    }
}

/// Enqueues a kernel.
///
/// # Safety
/// As for [`Device::launch`](crate::Device::launch).
pub(super) unsafe fn launch<K: Kernel>(
    gpu: &Cuda,
    stream: &CudaStream,
    kernel: &K,
    configuration: LaunchConfig,
) -> Result<(), DeviceError> {
    if is_empty(&configuration) {
        return Ok(());
    }
    let function = gpu.function(K::NAME)?;
    gpu.check_block(&function, &configuration)?;
    let parameters = Parameters(*kernel);
    let mut launch = stream.launch_builder(&function);
    launch.arg(&parameters);
    // SAFETY: the entry point takes exactly this parameter block; its views are the caller's promise.
    let launched = unsafe { launch.launch(configuration) };
    launched.map(drop).map_err(|error| gpu.failed(&format!("launched the kernel {}", K::NAME), error))
}

/// Queues all launches at once, the warm-up first, with an event after each that is timed: what the host does between them is then no part
/// of the time. Returns the seconds of each of the `repeats`.
///
/// # Safety
/// As for [`Device::launch`](crate::Device::launch).
pub(super) unsafe fn time<K: Kernel>(
    gpu: &Cuda,
    kernel: &K,
    configuration: LaunchConfig,
    [warmup, repeats]: [u32; 2],
) -> Result<Vec<f64>, DeviceError> {
    if is_empty(&configuration) {
        return Ok(vec![0.0; repeats as usize]);
    }
    let function = gpu.function(K::NAME)?;
    gpu.check_block(&function, &configuration)?;
    let parameters = Parameters(*kernel);
    let launch = || -> Result<(), DriverError> {
        let mut launch = gpu.stream().launch_builder(&function);
        launch.arg(&parameters);
        // SAFETY: the entry point takes exactly this parameter block; its views are the caller's promise.
        unsafe { launch.launch(configuration) }.map(drop)
    };
    let run = || -> Result<Vec<f64>, DriverError> {
        let timing = Some(sys::CUevent_flags::CU_EVENT_DEFAULT);
        let new_event = |_| gpu.context().new_event(timing);
        let events = (0..=repeats).map(new_event).collect::<Result<Vec<_>, _>>()?;
        (0..warmup).try_for_each(|_| launch())?;
        for (index, event) in events.iter().enumerate() {
            if index > 0 {
                launch()?;
            }
            event.record(gpu.stream())?;
        }
        gpu.stream().synchronize()?;
        events.windows(2).map(|pair| Ok(f64::from(pair[0].elapsed_ms(&pair[1])?) * 1e-3)).collect()
    };
    run().map_err(|error| gpu.failed(&format!("ran the kernel {}", K::NAME), error))
}

fn is_empty(configuration: &LaunchConfig) -> bool {
    configuration.grid_dim.0 == 0 || configuration.grid_dim.1 == 0
}

/// Enough blocks for `extent`, of the usual shape if none is given; of a single row for a single row.
pub(super) fn configuration(extent: [u32; 2], block: Option<[u32; 2]>) -> LaunchConfig {
    let block = match (extent[1], block) {
        (1, block) => [block.map_or(BLOCK_ROW, |[columns, rows]| columns * rows), 1],
        (_, block) => block.unwrap_or(BLOCK),
    };
    LaunchConfig {
        grid_dim: (extent[0].div_ceil(block[0]), extent[1].div_ceil(block[1]), 1),
        block_dim: (block[0], block[1], 1),
        shared_mem_bytes: 0,
    }
}

/// An event that a stream comes by.
pub(crate) struct CudaMark {
    gpu: Cuda,
    event: CudaEvent,
}

impl fmt::Debug for CudaMark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "CudaMark({})", self.gpu.description())
    }
}

impl CudaMark {
    pub fn new(gpu: &Cuda, stream: &CudaStream) -> Result<Self, DeviceError> {
        let mark = || -> Result<CudaEvent, DriverError> {
            let event = gpu.context().new_event(Some(sys::CUevent_flags::CU_EVENT_DEFAULT))?;
            // Whoever cannot mark the end of a kernel cannot wait for it: it must not outlive this call.
            event.record(stream).or_else(|error| stream.synchronize().and(Err(error)))?;
            Ok(event)
        };
        let event = mark().map_err(|error| gpu.failed("took the time", error))?;
        Ok(Self { gpu: gpu.clone(), event })
    }

    /// Waits until the stream has come by.
    pub fn wait(&self) -> Result<(), DeviceError> {
        self.event.synchronize().map_err(|error| self.gpu.failed("ran its kernels", error))
    }

    /// Seconds since an earlier one, once both were waited for.
    pub fn seconds_since(&self, earlier: &Self) -> Result<f64, DeviceError> {
        let milliseconds = earlier.event.elapsed_ms(&self.event);
        Ok(f64::from(milliseconds.map_err(|error| self.gpu.failed("took the time", error))?) * 1e-3)
    }
}
