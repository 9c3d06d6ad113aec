//! The one place where the two machines differ. Every item has its twin and both give the same bits.

/// `a * b + c`, rounded once. A CPU without the instruction computes it in software: slower, the same result.
#[inline(always)]
pub fn fma(a: f32, b: f32, c: f32) -> f32 {
    #[cfg(target_arch = "nvptx64")]
    return core::intrinsics::fmaf32(a, b, c);
    #[cfg(not(target_arch = "nvptx64"))]
    return a.mul_add(b, c);
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
