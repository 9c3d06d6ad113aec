//! The PTX entry points: one a kernel of `raywarp-lab-core`, and nothing else.
#![no_std]
#![feature(abi_ptx)]

use raywarp_core::arch;
use raywarp_core::kernels::Kernel;

// The compiler asks for one, though a panic becomes a trap where it happens.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

macro_rules! entry_points {
    ($($name:ident: $kernel:ty),* $(,)?) => {$(
        /// # Safety
        /// The views in the parameter block are those that the host made for this launch.
        #[no_mangle]
        pub unsafe extern "ptx-kernel" fn $name(kernel: $kernel) {
            // SAFETY: the caller's promise; the hardware gives each thread its own index.
            unsafe { kernel.thread(arch::thread()) }
        }
    )*};
}

raywarp_lab_core::for_each_lab_kernel!(entry_points);
