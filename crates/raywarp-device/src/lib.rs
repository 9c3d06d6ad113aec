//! Where kernels run: one interface over the CPU and CUDA devices.
//!
//! A [`Device`] makes [`Buffer`]s, and [launches](Device::launch) kernels over a grid of threads. Everything above this
//! crate is written once for both. [`kernels`] is for crates that launch kernels of their own.

mod buffer;
mod choice;
mod cpu;
mod cuda;
mod error;
mod foreign;
mod kernel_info;
pub mod kernels;
mod launchable;
mod mark;
mod module;
mod pace;
mod staging;
mod stream;
mod survey;

use std::time::Instant;

pub use buffer::Buffer;
pub use choice::{DeviceChoice, ParseDeviceError};
pub use error::DeviceError;
pub use kernel_info::KernelInfo;
pub use mark::Mark;
use mark::Point;
pub use module::Module;
pub use raywarp_core::kernels::Kernel;
pub use raywarp_core::view::{Plain, View, ViewMut};
pub use staging::Staging;
pub use stream::Stream;
pub use survey::{survey, DeviceInfo, DriverInfo, PtxInfo, Survey};

/// Most threads of a block: what those kernels are compiled for that are tried with several; others take half of it.
pub const MAX_BLOCK: u32 = 256;

/// A machine that runs kernels. Cloning gives another handle to the same one.
#[derive(Clone, Debug)]
pub struct Device {
    machine: Machine,
    /// Why this is not a GPU although one was welcome.
    fallback: Option<DeviceError>,
    /// Columns and rows of a block, where they are not to be the usual ones.
    block: Option<[u32; 2]>,
}

#[derive(Clone, Debug)]
enum Machine {
    Cpu,
    Cuda(cuda::Cuda),
}

impl Device {
    /// Opens a device. `Auto` takes the first CUDA device that works, else the CPU, and
    /// [`fallback`](Self::fallback) then tells why.
    ///
    /// # Errors
    /// [`DeviceError`] where a CUDA device was asked for by name and cannot be used. There is no silent way down.
    pub fn open(choice: DeviceChoice) -> Result<Self, DeviceError> {
        Self::open_with(choice, &[])
    }

    /// The same with other kernels than raywarp's own: for structures and kernels of other crates.
    ///
    /// # Errors
    /// As for [`open`](Self::open).
    pub fn open_with(choice: DeviceChoice, modules: &'static [Module]) -> Result<Self, DeviceError> {
        let (machine, fallback) = match choice {
            DeviceChoice::Cpu => (Machine::Cpu, None),
            DeviceChoice::Cuda(index) => (Machine::Cuda(cuda::Cuda::open(index, modules)?), None),
            DeviceChoice::Auto => match cuda::Cuda::open_any(modules) {
                Ok(gpu) => (Machine::Cuda(gpu), None),
                Err(error) => (Machine::Cpu, Some(error)),
            },
        };
        Ok(Self { machine, fallback, block: None })
    }

    /// Whether a kernel can be launched here: on the CPU always, on a CUDA device where there is PTX of it.
    pub fn has_kernel<K: Kernel>(&self) -> bool {
        match &self.machine {
            Machine::Cpu => true,
            Machine::Cuda(gpu) => gpu.source(K::NAME).is_some(),
        }
    }

    /// The same device, whose kernels are launched in blocks of so many columns and rows, on the CPU in tiles; without any,
    /// of the usual shape.
    ///
    /// # Errors
    /// [`DeviceError::Block`] for none or more than [`MAX_BLOCK`] threads, or on CUDA for rows that do not fill warps.
    pub fn with_block(&self, block: Option<[u32; 2]>) -> Result<Self, DeviceError> {
        let Some(block) = block else { return Ok(Self { block: None, ..self.clone() }) };
        let threads = u64::from(block[0]) * u64::from(block[1]);
        if threads == 0 || threads > u64::from(MAX_BLOCK) || (self.is_cuda() && threads % 32 != 0) {
            return Err(DeviceError::Block { block, most: MAX_BLOCK });
        }
        Ok(Self { block: Some(block), ..self.clone() })
    }

    /// How many threads of a kernel can be on the device at once: as many as threads that take work from queues need to
    /// be. On the CPU, enough to keep every thread busy.
    ///
    /// # Errors
    /// [`DeviceError`] where the driver cannot load the kernel or does not answer.
    pub fn resident_threads<K: Kernel>(&self) -> Result<u32, DeviceError> {
        match &self.machine {
            Machine::Cpu => Ok(cpu::resident_threads()),
            Machine::Cuda(gpu) => gpu.resident_threads::<K>(self.block),
        }
    }

    /// Threads of a warp, and of a block of a single row.
    pub fn warp_and_block(&self) -> (u32, u32) {
        match &self.machine {
            Machine::Cpu => (1, cpu::BATCH),
            Machine::Cuda(_) => (32, self.block.map_or(cuda::BLOCK_ROW, |block| block[0] * block[1])),
        }
    }

    /// Name and kind, for people: "NVIDIA H200 (CUDA device 0)" or "CPU, 2 threads".
    pub fn description(&self) -> String {
        match &self.machine {
            Machine::Cpu => cpu::description(),
            Machine::Cuda(gpu) => gpu.description(),
        }
    }

    /// Why a CPU stands in for a GPU, where `Auto` chose.
    pub fn fallback(&self) -> Option<&DeviceError> {
        self.fallback.as_ref()
    }

    /// Whether this is a CUDA device.
    pub fn is_cuda(&self) -> bool {
        self.cuda_index().is_some()
    }

    /// N of `cuda:N`, for a CUDA device.
    pub fn cuda_index(&self) -> Option<usize> {
        match &self.machine {
            Machine::Cpu => None,
            Machine::Cuda(gpu) => Some(gpu.index()),
        }
    }

    /// Checks that `bytes` more fit before they are asked for.
    ///
    /// # Errors
    /// [`DeviceError::Memory`] with both numbers.
    pub fn reserve(&self, bytes: u64, purpose: &str) -> Result<(), DeviceError> {
        match self.available_memory()? {
            Some(available) if bytes > available => Err(DeviceError::Memory {
                device: self.description(),
                purpose: purpose.to_owned(),
                needed: bytes,
                available,
            }),
            _ => Ok(()),
        }
    }

    /// Bytes that can still be had without swapping; none where the system does not tell.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn available_memory(&self) -> Result<Option<u64>, DeviceError> {
        match &self.machine {
            Machine::Cpu => Ok(raywarp_scene::memory::available()),
            Machine::Cuda(gpu) => gpu.free_memory().map(Some),
        }
    }

    /// Refuses a buffer of another device; `what` says what is in it: "rays".
    ///
    /// # Errors
    /// [`DeviceError::OtherDevice`].
    pub fn check<T: Plain>(&self, buffer: &Buffer<T>, what: &'static str) -> Result<(), DeviceError> {
        if buffer.is_on(&self.machine) {
            return Ok(());
        }
        Err(DeviceError::OtherDevice { device: self.description(), what })
    }

    /// Refuses a stream of another device.
    ///
    /// # Errors
    /// [`DeviceError::OtherDevice`].
    pub fn check_stream(&self, stream: &Stream) -> Result<(), DeviceError> {
        if stream.is_on(&self.machine) {
            return Ok(());
        }
        Err(DeviceError::OtherDevice { device: self.description(), what: "launches of this stream" })
    }

    /// A queue for kernels that run while the host goes on, beside those of other streams. On the CPU a launch is over
    /// when it returns.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn stream(&self) -> Result<Stream, DeviceError> {
        Stream::new(&self.machine)
    }

    /// Copies `items` to the device. An empty slice makes an empty buffer.
    ///
    /// # Errors
    /// [`DeviceError`] where the device has no room.
    pub fn upload<T: Plain>(&self, items: &[T]) -> Result<Buffer<T>, DeviceError> {
        Buffer::upload(&self.machine, items)
    }

    /// Room for `len` items, all zero.
    ///
    /// # Errors
    /// [`DeviceError`] where the device has no room.
    pub fn zeroed<T: Plain>(&self, len: usize) -> Result<Buffer<T>, DeviceError> {
        Buffer::zeroed(&self.machine, len)
    }

    /// What a kernel takes of a CUDA device when it is launched over `extent`; nothing on the CPU.
    ///
    /// # Errors
    /// [`DeviceError`] where the driver cannot load the kernel or does not answer.
    pub fn kernel_info<K: Kernel>(&self, _kernel: &K, extent: [u32; 2]) -> Result<Option<KernelInfo>, DeviceError> {
        match &self.machine {
            Machine::Cpu => Ok(None),
            Machine::Cuda(gpu) => gpu.kernel_info::<K>(extent, self.block).map(Some),
        }
    }

    /// Has the driver of a CUDA device compile a kernel, which takes a moment where its own cache does not have it.
    ///
    /// # Errors
    /// [`DeviceError`] where the driver refuses it.
    pub fn load<K: Kernel>(&self) -> Result<(), DeviceError> {
        match &self.machine {
            Machine::Cpu => Ok(()),
            Machine::Cuda(gpu) => gpu.function(K::NAME).map(drop),
        }
    }

    /// A point in the order of what this device has been told.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn mark(&self) -> Result<Mark, DeviceError> {
        Ok(Mark::new(match &self.machine {
            Machine::Cpu => Point::Passed(Instant::now()),
            Machine::Cuda(gpu) => Point::Cuda(gpu.mark()?),
        }))
    }

    /// Enqueues a kernel, one thread for each column and row of `extent`, after all that the device was told before; on the
    /// CPU it is over when this returns. Copies, clears and frees of buffers are told in the same order, so they wait for
    /// it; that it failed is told by the next call that waits. [`Timed`](kernels::Timed) waits and takes the time.
    ///
    /// # Safety
    /// The views in the kernel are of buffers of this device, none of which is freed before the call returns; no kernel of
    /// another stream touches those that it writes meanwhile, and the indices that they hold are in range.
    ///
    /// # Errors
    /// [`DeviceError`] where the launch fails.
    pub unsafe fn launch<K: Kernel>(&self, kernel: &K, extent: [u32; 2]) -> Result<(), DeviceError> {
        match &self.machine {
            Machine::Cpu => {
                // SAFETY: the caller's promise.
                unsafe { cpu::launch(kernel, extent, self.block) };
                Ok(())
            }
            // SAFETY: the caller's promise.
            Machine::Cuda(gpu) => unsafe { gpu.launch(kernel, extent, self.block) },
        }
    }

    /// Runs a kernel `warmup` times, and then `repeats` times of which each is timed: seconds on the device. What the
    /// host does between launches of a CUDA device is no part of them.
    ///
    /// # Safety
    /// As for [`launch`](Self::launch).
    ///
    /// # Errors
    /// [`DeviceError`] where a launch fails.
    pub unsafe fn time<K: Kernel>(
        &self,
        kernel: &K,
        extent: [u32; 2],
        warmup: u32,
        repeats: u32,
    ) -> Result<Vec<f64>, DeviceError> {
        match &self.machine {
            Machine::Cpu => {
                // SAFETY: the caller's promise.
                let seconds = (0..warmup + repeats).map(|_| unsafe { cpu::launch(kernel, extent, self.block) });
                Ok(seconds.skip(warmup as usize).collect())
            }
            // SAFETY: the caller's promise.
            Machine::Cuda(gpu) => unsafe { gpu.time(kernel, extent, self.block, [warmup, repeats]) },
        }
    }
}
