//! The one place where the two machines differ. Every item has its twin and both give the same bits.

mod block;
mod coherent;
mod lanes;
mod links;
mod shared_slots;
mod warp;

pub use block::{barrier, sums, Block, SharedWords, BLOCK, THREADS, WARPS};
pub use coherent::{arrive, exchange, load_coherent, load_word_coherent, publish, raise};
pub use lanes::{in_each_lane, lanes_where, Lanes, Shuffle, LANES};
pub use links::{Links, Meeting};
pub use shared_slots::SharedSlots;
pub use warp::{afresh, alike, all, ballot, broadcast, lane, lanes_below, syncwarp, together, uniform, WARP};

/// `a * b + c`, rounded once. A CPU without the instruction computes it in software: slower, the same result.
#[inline(always)]
pub fn fma(a: f32, b: f32, c: f32) -> f32 {
    #[cfg(target_arch = "nvptx64")]
    return core::intrinsics::fmaf32(a, b, c);
    #[cfg(not(target_arch = "nvptx64"))]
    return a.mul_add(b, c);
}

/// One over `x`, correctly rounded where both are normal; elsewhere the GPU may give zero or NaN.
///
/// A division there first looks whether they are, and calls a function where they are not.
#[inline(always)]
pub fn reciprocal(x: f32) -> f32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let y: f32;
        // SAFETY: an operation on registers.
        unsafe {
            core::arch::asm!("rcp.approx.ftz.f32 {y}, {x};", x = in(reg32) x, y = out(reg32) y,
                options(pure, nomem, nostack));
        }
        fma(y, -fma(x, y, -1.0), y)
    }
    #[cfg(not(target_arch = "nvptx64"))]
    return 1.0 / x;
}

/// Square root, correctly rounded.
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(target_arch = "nvptx64")]
    return core::f32::math::sqrt(x);
    #[cfg(not(target_arch = "nvptx64"))]
    return x.sqrt();
}

/// The largest integer not above `x`.
#[inline(always)]
pub fn floor(x: f32) -> f32 {
    #[cfg(target_arch = "nvptx64")]
    return core::f32::math::floor(x);
    #[cfg(not(target_arch = "nvptx64"))]
    return x.floor();
}

/// The smaller number; the other one where one is NaN.
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    a.min(b)
}

/// The larger number; the other one where one is NaN.
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    a.max(b)
}

/// Reads an item of 16-byte granules.
///
/// On the GPU each granule is one 128-bit load through the read-only path.
///
/// # Safety
/// `from` points to a valid `T` that nothing writes while the kernel runs; `T` is a multiple of 16 bytes in size and
/// alignment, at most 128 bytes, and any bits are a valid `T`.
#[inline(always)]
pub unsafe fn load<T: Copy>(from: *const T) -> T {
    const { assert!(core::mem::size_of::<T>().is_multiple_of(16) && core::mem::align_of::<T>().is_multiple_of(16)) };
    #[cfg(target_arch = "nvptx64")]
    // SAFETY: the caller's promise; the granules lie within the `T`.
    return unsafe { load_granules(from) };
    #[cfg(not(target_arch = "nvptx64"))]
    // SAFETY: the caller's promise.
    return unsafe { *from };
}

#[cfg(target_arch = "nvptx64")]
#[inline(always)]
unsafe fn load_granules<T: Copy>(from: *const T) -> T {
    let mut item = core::mem::MaybeUninit::<T>::uninit();
    let source = from as *const [f32; 4];
    let target = item.as_mut_ptr() as *mut [f32; 4];
    let mut granule = 0;
    while granule < core::mem::size_of::<T>() / 16 {
        let (x, y, z, w): (f32, f32, f32, f32);
        // SAFETY: both pointers stay within the `T` that the caller vouches for.
        unsafe {
            core::arch::asm!("ld.global.nc.v4.f32 {{{x}, {y}, {z}, {w}}}, [{p}];", p = in(reg64) source.add(granule),
                x = out(reg32) x, y = out(reg32) y, z = out(reg32) z, w = out(reg32) w,
                options(pure, readonly, nostack));
            target.add(granule).write([x, y, z, w]);
        }
        granule += 1;
    }
    // SAFETY: every granule was written, and any bits are a valid `T`.
    unsafe { item.assume_init() }
}

/// Where the item at `index` of an array is.
///
/// On the GPU, for items of 2^n bytes, by a shift and an addition, which take the array's address from where a kernel has
/// its parameters. The compiler would multiply, which cannot, and fetch the address before every node, with the ray waiting
/// for it.
///
/// # Safety
/// The array has such an item.
#[inline(always)]
pub unsafe fn item<T>(array: *const T, index: u32) -> *const T {
    #[cfg(target_arch = "nvptx64")]
    if const { size_of::<T>().is_power_of_two() } {
        let address;
        // SAFETY: arithmetic on registers.
        unsafe {
            core::arch::asm!("{{ .reg .b64 o; cvt.u64.u32 o, {i}; shl.b64 o, o, {s}; add.u64 {p}, {a}, o; }}",
                i = in(reg32) index, s = const size_of::<T>().trailing_zeros(), a = in(reg64) array,
                p = out(reg64) address, options(pure, nomem, nostack));
        }
        return address;
    }
    // SAFETY: the caller's promise.
    unsafe { array.add(index as usize) }
}

/// Has what lies at an address of the device brought closer, for a thread that will read it later; nothing on a CPU,
/// which sees by itself what is read in order.
#[inline(always)]
pub fn prefetch<T>(address: *const T) {
    #[cfg(target_arch = "nvptx64")]
    // SAFETY: reads nothing; an address where nothing is does no harm.
    unsafe {
        core::arch::asm!("prefetch.global.L2 [{p}];", p = in(reg64) address, options(nostack))
    };
    #[cfg(not(target_arch = "nvptx64"))]
    let _ = address;
}

/// Four bytes out of eight, those of `a` being 0 to 3 and those of `b` 4 to 7: each digit of `selector`, from the lowest,
/// names the next byte of the result.
#[inline(always)]
pub fn permute(a: u32, b: u32, selector: u32) -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let result: u32;
        // SAFETY: an operation on registers.
        unsafe {
            core::arch::asm!("prmt.b32 {r}, {a}, {b}, {s};", r = out(reg32) result, a = in(reg32) a, b = in(reg32) b,
                s = in(reg32) selector, options(pure, nomem, nostack));
        }
        result
    }
    #[cfg(not(target_arch = "nvptx64"))]
    {
        let bytes = (b as u64) << 32 | a as u64;
        let byte = |i: u32| ((bytes >> (8 * (selector >> (4 * i) & 7))) as u32 & 0xff) << (8 * i);
        byte(0) | byte(1) | byte(2) | byte(3)
    }
}

/// Adds to a number that other threads add to as well; returns what it was.
///
/// # Safety
/// `number` is valid for the launch, in which only this and [`read`] touch it.
#[inline(always)]
pub unsafe fn add(number: *mut u32, more: u32) -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let before: u32;
        // SAFETY: the caller's promise.
        unsafe {
            core::arch::asm!("atom.global.add.u32 {r}, [{p}], {v};", r = out(reg32) before, p = in(reg64) number,
                v = in(reg32) more, options(nostack));
        }
        before
    }
    #[cfg(not(target_arch = "nvptx64"))]
    // SAFETY: the caller's promise; a `u32` in memory is an atomic one.
    unsafe { core::sync::atomic::AtomicU32::from_ptr(number) }.fetch_add(more, core::sync::atomic::Ordering::AcqRel)
}

/// Reads a number that other threads may be adding to.
///
/// # Safety
/// As for [`add`].
#[inline(always)]
pub unsafe fn read(number: *mut u32) -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let now: u32;
        // SAFETY: the caller's promise.
        unsafe {
            core::arch::asm!("ld.volatile.global.u32 {r}, [{p}];", r = out(reg32) now, p = in(reg64) number,
                options(nostack));
        }
        now
    }
    #[cfg(not(target_arch = "nvptx64"))]
    // SAFETY: the caller's promise.
    unsafe { core::sync::atomic::AtomicU32::from_ptr(number) }.load(core::sync::atomic::Ordering::Acquire)
}

/// `1 + b / 2^15` for byte `INDEX` of `word`, counted from the lowest: one byte permutation puts it into a mantissa.
#[inline(always)]
pub fn fraction_of_byte<const INDEX: u32>(word: u32) -> f32 {
    const { assert!(INDEX < 4) };
    #[cfg(target_arch = "nvptx64")]
    {
        let bits: u32;
        // SAFETY: arithmetic on registers. From high to low: two bytes of 1.0, the one asked for, zero.
        unsafe {
            core::arch::asm!("prmt.b32 {bits}, {word}, {one}, {select};", bits = out(reg32) bits, word = in(reg32) word,
                one = in(reg32) ONE, select = const 0x7604 | INDEX << 4, options(pure, nomem, nostack));
        }
        f32::from_bits(bits)
    }
    #[cfg(not(target_arch = "nvptx64"))]
    f32::from_bits(ONE | (word >> (8 * INDEX) & 0xff) << 8)
}

/// The bits of 1.0.
const ONE: u32 = 0x3f80_0000;

/// Bit `i` of the result says whether `a[i] <= b[i]`.
#[inline(always)]
pub fn at_most(a: &[f32; 8], b: &[f32; 8]) -> u32 {
    #[cfg(target_arch = "x86_64")]
    {
        use core::arch::x86_64::{_mm_cmple_ps, _mm_loadu_ps, _mm_movemask_ps};
        // SAFETY: four items from `first` on are in both arrays; every x86-64 processor has these instructions.
        let half = |first: usize| unsafe {
            _mm_movemask_ps(_mm_cmple_ps(_mm_loadu_ps(&a[first]), _mm_loadu_ps(&b[first]))) as u32
        };
        half(0) | half(4) << 4
    }
    #[cfg(not(target_arch = "x86_64"))]
    (0..8).fold(0, |bits, i| bits | ((a[i] <= b[i]) as u32) << i)
}

/// A clock whose differences say how long a thread took, modulo 2^32: cycles of the multiprocessor on a GPU,
/// nanoseconds on a CPU.
#[inline(always)]
pub fn clock() -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let ticks: u32;
        // SAFETY: reads a special register; volatile, as `pure` is not among the options.
        unsafe { core::arch::asm!("mov.u32 {t}, %clock;", t = out(reg32) ticks, options(nomem, nostack)) };
        ticks
    }
    #[cfg(not(target_arch = "nvptx64"))]
    {
        static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
        START.get_or_init(std::time::Instant::now).elapsed().as_nanos() as u32
    }
}

/// Which thread of the launch this is, on the GPU. On the CPU the launch loop supplies it.
#[cfg(target_arch = "nvptx64")]
#[inline(always)]
pub fn thread() -> crate::kernels::Thread {
    use core::arch::nvptx::*;
    // SAFETY: reading special registers has no precondition.
    unsafe {
        crate::kernels::Thread {
            x: (_block_idx_x() * _block_dim_x() + _thread_idx_x()) as u32,
            y: (_block_idx_y() * _block_dim_y() + _thread_idx_y()) as u32,
        }
    }
}
