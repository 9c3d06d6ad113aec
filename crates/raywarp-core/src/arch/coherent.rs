//! What threads of a launch tell each other by memory: who comes second sees what who came first has written.

/// Puts a number in the place of another; what was there. Whoever reads what another thread put here also sees, by
/// [`load_coherent`], what that thread had written before.
///
/// # Safety
/// `number` is valid for the launch, in which only this touches it.
#[inline(always)]
pub unsafe fn exchange(number: *mut u32, new: u32) -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let before: u32;
        // SAFETY: the caller's promise.
        unsafe {
            core::arch::asm!("atom.acq_rel.gpu.global.exch.b32 {r}, [{p}], {v};", r = out(reg32) before,
                p = in(reg64) number, v = in(reg32) new, options(nostack));
        }
        before
    }
    #[cfg(not(target_arch = "nvptx64"))]
    // SAFETY: the caller's promise; a `u32` in memory is an atomic one.
    unsafe { core::sync::atomic::AtomicU32::from_ptr(number) }.swap(new, core::sync::atomic::Ordering::AcqRel)
}

/// Adds one to a number; what it was. Whoever comes later also sees, by [`load_coherent`], what this thread had written.
///
/// # Safety
/// `number` is valid for the launch, in which only this touches it while threads may still come.
#[inline(always)]
pub unsafe fn arrive(number: *mut u32) -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let before: u32;
        // SAFETY: the caller's promise.
        unsafe {
            core::arch::asm!("atom.acq_rel.gpu.global.add.u32 {r}, [{p}], 1;", r = out(reg32) before,
                p = in(reg64) number, options(nostack));
        }
        before
    }
    #[cfg(not(target_arch = "nvptx64"))]
    // SAFETY: the caller's promise; a `u32` in memory is an atomic one.
    unsafe { core::sync::atomic::AtomicU32::from_ptr(number) }.fetch_add(1, core::sync::atomic::Ordering::AcqRel)
}

/// Makes what this thread wrote visible to whoever learns of it by a later [`exchange`] of its warp.
#[inline(always)]
pub fn publish() {
    #[cfg(target_arch = "nvptx64")]
    // SAFETY: has no precondition.
    unsafe {
        core::arch::asm!("fence.acq_rel.gpu;", options(nostack))
    };
}

/// Raises a number to at least this; other threads do so as well, in any order.
///
/// # Safety
/// `number` is valid for the launch, in which only this touches it.
#[inline(always)]
pub unsafe fn raise(number: *mut u32, least: u32) {
    #[cfg(target_arch = "nvptx64")]
    // SAFETY: the caller's promise.
    unsafe {
        core::arch::asm!("red.relaxed.gpu.global.max.u32 [{p}], {v};", p = in(reg64) number, v = in(reg32) least,
            options(nostack));
    }
    #[cfg(not(target_arch = "nvptx64"))]
    // SAFETY: the caller's promise; a `u32` in memory is an atomic one.
    unsafe { core::sync::atomic::AtomicU32::from_ptr(number) }.fetch_max(least, core::sync::atomic::Ordering::Relaxed);
}

/// Reads what another thread of this launch has written, from where all multiprocessors see the same: their own caches
/// may hold what was there before.
///
/// # Safety
/// `from` points to a valid `T`, which nothing writes at this time; `T` is a multiple of 16 bytes in size and alignment,
/// at most 128 bytes, and any bits are a valid `T`.
#[inline(always)]
pub unsafe fn load_coherent<T: Copy>(from: *const T) -> T {
    const { assert!(core::mem::size_of::<T>().is_multiple_of(16) && core::mem::align_of::<T>().is_multiple_of(16)) };
    #[cfg(target_arch = "nvptx64")]
    {
        let mut item = core::mem::MaybeUninit::<T>::uninit();
        let (source, target) = (from as *const [u32; 4], item.as_mut_ptr() as *mut [u32; 4]);
        let mut granule = 0;
        while granule < core::mem::size_of::<T>() / 16 {
            let (x, y, z, w): (u32, u32, u32, u32);
            // SAFETY: both pointers stay within the `T` that the caller vouches for.
            unsafe {
                core::arch::asm!("ld.relaxed.gpu.global.v4.b32 {{{x}, {y}, {z}, {w}}}, [{p}];",
                    p = in(reg64) source.add(granule), x = out(reg32) x, y = out(reg32) y, z = out(reg32) z,
                    w = out(reg32) w, options(nostack));
                target.add(granule).write([x, y, z, w]);
            }
            granule += 1;
        }
        // SAFETY: every granule was written, and any bits are a valid `T`.
        unsafe { item.assume_init() }
    }
    #[cfg(not(target_arch = "nvptx64"))]
    // SAFETY: the caller's promise.
    return unsafe { *from };
}

/// The same of a number.
///
/// # Safety
/// `from` points to a number, which nothing writes at this time.
#[inline(always)]
pub unsafe fn load_word_coherent(from: *const u32) -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let word: u32;
        // SAFETY: the caller's promise.
        unsafe {
            core::arch::asm!("ld.relaxed.gpu.global.b32 {w}, [{p}];", p = in(reg64) from, w = out(reg32) word,
                options(nostack));
        }
        word
    }
    #[cfg(not(target_arch = "nvptx64"))]
    // SAFETY: the caller's promise.
    return unsafe { *from };
}
