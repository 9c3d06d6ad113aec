//! CUDA devices, through the driver alone: `libcuda` is loaded at run time, the kernels come as PTX.

mod buffer;
mod foreign;
mod pinned;
mod ptx;
mod stream;

use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use cudarc::driver::{sys, CudaContext, CudaFunction, CudaStream, DriverError, LaunchConfig};
use cudarc::nvrtc::Ptx;
use raywarp_core::kernels::Kernel;

use super::{DeviceError, DeviceInfo, KernelInfo, Module};
pub(super) use buffer::CudaBuffer;
pub(super) use pinned::Pinned;
pub(super) use ptx::info as ptx_info;
pub(super) use stream::{CudaMark, Stream, BLOCK_ROW};

/// A CUDA device with the kernels that were needed so far.
#[derive(Clone)]
pub(super) struct Cuda {
    shared: Arc<Shared>,
}

struct Shared {
    name: String,
    index: usize,
    stream: Arc<CudaStream>,
    context: Arc<CudaContext>,
    /// Of others than this crate.
    modules: &'static [Module],
    kernels: Mutex<HashMap<&'static str, CudaFunction>>,
}

impl fmt::Debug for Cuda {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Cuda({})", self.description())
    }
}

impl Cuda {
    /// # Errors
    /// No driver, no such device, or one that is too old.
    pub fn open(index: usize, modules: &'static [Module]) -> Result<Self, DeviceError> {
        let count = device_count()?;
        if count == 0 {
            return Err(DeviceError::NoDevice);
        }
        if index >= count {
            return Err(DeviceError::NoSuchDevice { index, count });
        }
        let context = CudaContext::new(index).map_err(driver_error)?;
        let name = context.name().map_err(driver_error)?;
        let (major, minor) = context.compute_capability().map_err(driver_error)?;
        if (major, minor) < (7, 5) {
            return Err(DeviceError::TooOld { device: name, has: (major as u32, minor as u32) });
        }
        // One stream copies, clears and frees in order, so there is nothing for the events of cudarc's own bookkeeping
        // to order. Kernels on other streams wait for this one, and the host for them, see `stream::Stream`.
        // SAFETY: this stream alone touches the buffers of this context while no such kernel runs.
        unsafe { context.disable_event_tracking() };
        let stream = context.new_stream().map_err(driver_error)?;
        let shared = Shared { name, index, stream, context, modules, kernels: Mutex::new(HashMap::new()) };
        Ok(Self { shared: Arc::new(shared) })
    }

    /// The first device that opens and takes the kernels, or why the first one does not.
    pub fn open_any(modules: &'static [Module]) -> Result<Self, DeviceError> {
        let usable = |index| Self::open(index, modules).and_then(|gpu| gpu.function(SMALLEST_KERNEL).map(|_| gpu));
        let first = usable(0);
        if first.is_ok() {
            return first;
        }
        (1..device_count()?).find_map(|index| usable(index).ok()).map_or(first, Ok)
    }

    pub fn index(&self) -> usize {
        self.shared.index
    }

    pub fn description(&self) -> String {
        format!("{} (CUDA device {})", self.shared.name, self.shared.index)
    }

    pub fn context(&self) -> &Arc<CudaContext> {
        &self.shared.context
    }

    pub fn stream(&self) -> &Arc<CudaStream> {
        &self.shared.stream
    }

    /// Bytes that can still be had.
    pub fn free_memory(&self) -> Result<u64, DeviceError> {
        // What was freed in the order of the stream is free only once the stream got there.
        self.stream().synchronize().map_err(|e| self.failed("finished its work", e))?;
        let (free, _) = self.context().mem_get_info().map_err(|e| self.failed("told its free memory", e))?;
        Ok(free as u64)
    }

    /// The sentence for a driver call that failed.
    pub fn failed(&self, action: &str, error: DriverError) -> DeviceError {
        DeviceError::Failed { device: self.description(), action: action.to_owned(), reason: explain(error) }
    }

    /// Whether both are handles to the same device, whose buffers the same stream orders.
    pub fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared)
    }

    /// # Safety
    /// As for [`Device::launch`](super::Device::launch).
    pub unsafe fn launch<K: Kernel>(
        &self,
        kernel: &K,
        extent: [u32; 2],
        block: Option<[u32; 2]>,
    ) -> Result<(), DeviceError> {
        // SAFETY: the caller's promise.
        unsafe { stream::launch(self, self.stream(), kernel, stream::configuration(extent, block)) }
    }

    pub fn mark(&self) -> Result<CudaMark, DeviceError> {
        CudaMark::new(self, self.stream())
    }

    /// See [`stream::time`].
    ///
    /// # Safety
    /// As for [`Device::launch`](super::Device::launch).
    pub unsafe fn time<K: Kernel>(
        &self,
        kernel: &K,
        extent: [u32; 2],
        block: Option<[u32; 2]>,
        times: [u32; 2],
    ) -> Result<Vec<f64>, DeviceError> {
        // SAFETY: the caller's promise.
        unsafe { stream::time(self, kernel, stream::configuration(extent, block), times) }
    }

    /// What a kernel takes when it is launched over `extent`.
    pub fn kernel_info<K: Kernel>(&self, extent: [u32; 2], block: Option<[u32; 2]>) -> Result<KernelInfo, DeviceError> {
        use sys::CUdevice_attribute::CU_DEVICE_ATTRIBUTE_MAX_THREADS_PER_MULTIPROCESSOR;
        let function = self.function(K::NAME)?;
        let (columns, rows, _) = stream::configuration(extent, block).block_dim;
        let block_threads = columns * rows;
        let query = || -> Result<KernelInfo, DriverError> {
            let registers = function.num_regs()? as u32;
            let most = self.context().attribute(CU_DEVICE_ATTRIBUTE_MAX_THREADS_PER_MULTIPROCESSOR)?;
            let blocks = function.occupancy_max_active_blocks_per_multiprocessor(block_threads, 0, None)?;
            Ok(KernelInfo {
                name: K::NAME,
                registers,
                local_bytes: function.local_size_bytes()? as u32,
                shared_bytes: function.shared_size_bytes()? as u32,
                block_threads,
                occupancy: f64::from(blocks * block_threads) / f64::from(most.max(1)),
            })
        };
        query().map_err(|error| self.failed(&format!("described the kernel {}", K::NAME), error))
    }

    /// Refuses blocks that are larger than a kernel was compiled for.
    pub fn check_block(&self, function: &CudaFunction, configuration: &LaunchConfig) -> Result<(), DeviceError> {
        use sys::CUfunction_attribute::CU_FUNC_ATTRIBUTE_MAX_THREADS_PER_BLOCK;
        let (columns, rows, _) = configuration.block_dim;
        let most = function.get_attribute(CU_FUNC_ATTRIBUTE_MAX_THREADS_PER_BLOCK);
        let most = most.map_err(|error| self.failed("described a kernel", error))?.max(0) as u32;
        match columns * rows > most {
            true => Err(DeviceError::Block { block: [columns, rows], most }),
            false => Ok(()),
        }
    }

    /// Threads of a kernel that are on the device at once, launched in a single row.
    pub fn resident_threads<K: Kernel>(&self, block: Option<[u32; 2]>) -> Result<u32, DeviceError> {
        use sys::CUdevice_attribute::CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT;
        let function = self.function(K::NAME)?;
        let configuration = stream::configuration([1, 1], block);
        self.check_block(&function, &configuration)?;
        let (columns, rows, _) = configuration.block_dim;
        let query = || -> Result<u32, DriverError> {
            let blocks = function.occupancy_max_active_blocks_per_multiprocessor(columns * rows, 0, None)?;
            let multiprocessors = self.context().attribute(CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT)?;
            Ok(blocks * columns * rows * multiprocessors.max(1) as u32)
        };
        query().map_err(|error| self.failed(&format!("described the kernel {}", K::NAME), error))
    }

    /// The PTX of a kernel, if there is any.
    pub fn source(&self, name: &str) -> Option<&'static str> {
        let mut modules = ptx::MODULES.iter().chain(self.shared.modules);
        modules.find(|module| module.name == name).map(|module| module.source)
    }

    /// Loads a kernel the first time that it is needed: the driver compiles PTX when it loads it, which takes a moment
    /// unless its own cache has it.
    pub fn function(&self, name: &'static str) -> Result<CudaFunction, DeviceError> {
        let kernels = || self.shared.kernels.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(function) = kernels().get(name) {
            return Ok(function.clone());
        }
        let refused = |reason: String| DeviceError::Ptx {
            device: self.description(),
            kernel: name.to_owned(),
            reason,
            isa: ptx::info().isa,
        };
        let source = self.source(name).ok_or_else(|| refused("it is not among the kernels".to_owned()))?;
        let module = self.context().load_module(Ptx::from_src(source)).map_err(|e| refused(explain(e)))?;
        let function = module.load_function(name).map_err(|e| refused(explain(e)))?;
        // Not locked meanwhile: others go on with the kernels that they have. If two load the same, the first one stays.
        Ok(kernels().entry(name).or_insert(function).clone())
    }
}

/// How many devices the driver shows.
///
/// # Errors
/// No driver, or one that does not start.
pub(super) fn device_count() -> Result<usize, DeviceError> {
    // cudarc panics when the library is missing: ask for it first.
    // SAFETY: loading NVIDIA's driver runs its initialisers, as any CUDA program does.
    if !unsafe { sys::is_culib_present() } {
        return Err(DeviceError::NoDriver);
    }
    match CudaContext::device_count() {
        Ok(count) => Ok(count.max(0) as usize),
        Err(DriverError(sys::CUresult::CUDA_ERROR_NO_DEVICE)) => Ok(0),
        Err(error) => Err(driver_error(error)),
    }
}

/// Version of the driver's CUDA interface: (13, 0) for CUDA 13.0.
pub(super) fn driver_version() -> Result<(u32, u32), DeviceError> {
    device_count()?;
    let mut version = 0;
    // SAFETY: the library is there, and the pointer is valid for the call.
    unsafe { sys::cuDriverGetVersion(&mut version) }.result().map_err(driver_error)?;
    Ok((version as u32 / 1000, version as u32 % 1000 / 10))
}

pub(super) fn driver_error(error: DriverError) -> DeviceError {
    DeviceError::Driver { reason: explain(error) }
}

/// The driver's own words, with the name of the error.
fn explain(error: DriverError) -> String {
    let words = error.error_string().map(|text| text.to_string_lossy().into_owned());
    match words {
        Ok(words) => format!("{words} ({:?})", error.0),
        Err(_) => format!("{:?}", error.0),
    }
}

/// What the driver tells about a device, and whether a kernel loads on it.
pub(super) fn device_info(index: usize) -> Result<DeviceInfo, DeviceError> {
    use sys::CUdevice_attribute::{CU_DEVICE_ATTRIBUTE_CLOCK_RATE, CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT};
    let context = CudaContext::new(index).map_err(driver_error)?;
    let query = || -> Result<DeviceInfo, DriverError> {
        let (major, minor) = context.compute_capability()?;
        let (free, total) = context.mem_get_info()?;
        Ok(DeviceInfo {
            index,
            name: context.name()?,
            compute_capability: (major as u32, minor as u32),
            memory_total: total as u64,
            memory_free: free as u64,
            multiprocessors: context.attribute(CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT)? as u32,
            clock_mhz: context.attribute(CU_DEVICE_ATTRIBUTE_CLOCK_RATE)? as u32 / 1000,
            ptx: Ok(()),
        })
    };
    let mut info = query().map_err(driver_error)?;
    info.ptx = Cuda::open(index, &[]).and_then(|gpu| gpu.function(SMALLEST_KERNEL).map(drop));
    Ok(info)
}

/// Loads in a moment, and shows whether the driver reads the PTX.
const SMALLEST_KERNEL: &str = "closest_brute";
