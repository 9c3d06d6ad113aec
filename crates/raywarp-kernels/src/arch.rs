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

/// Whether all threads that run together have the same value; on the CPU each runs alone.
#[inline(always)]
pub fn uniform(value: u32) -> bool {
    #[cfg(target_arch = "nvptx64")]
    {
        let same: u32;
        // SAFETY: `activemask` names exactly the threads that take part.
        unsafe {
            core::arch::asm!(
                "{{ .reg .pred p; .reg .b32 m, d; activemask.b32 m; match.all.sync.b32 d|p, {v}, m; selp.u32 {r}, 1, 0, p; }}",
                v = in(reg32) value, r = out(reg32) same, options(nostack));
        }
        same != 0
    }
    #[cfg(not(target_arch = "nvptx64"))]
    {
        let _ = value;
        true
    }
}

/// Threads that run together, in step where they can: 32 on a GPU, one on the CPU.
pub const WARP: u32 = if cfg!(target_arch = "nvptx64") { 32 } else { 1 };

/// Which thread of its warp this is.
#[inline(always)]
pub fn lane() -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let lane: u32;
        // SAFETY: reads a special register.
        unsafe { core::arch::asm!("mov.u32 {l}, %laneid;", l = out(reg32) lane, options(pure, nomem, nostack)) };
        lane
    }
    #[cfg(not(target_arch = "nvptx64"))]
    0
}

/// The threads of the warp that are together here and now, a bit each.
#[inline(always)]
pub fn together() -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let mask: u32;
        // SAFETY: has no precondition; volatile, as the answer changes from place to place.
        unsafe { core::arch::asm!("activemask.b32 {m};", m = out(reg32) mask, options(nomem, nostack)) };
        mask
    }
    #[cfg(not(target_arch = "nvptx64"))]
    1
}

/// Which threads of a warp say yes, a bit each.
///
/// # Safety
/// All threads of `mask` come here with the same mask, and this is one of them.
#[inline(always)]
pub unsafe fn ballot(mask: u32, value: bool) -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let votes: u32;
        // SAFETY: the caller's promise.
        unsafe {
            core::arch::asm!(
                "{{ .reg .pred p; setp.ne.u32 p, {v}, 0; vote.sync.ballot.b32 {r}, p, {m}; }}",
                v = in(reg32) value as u32, m = in(reg32) mask, r = out(reg32) votes, options(nostack));
        }
        votes
    }
    #[cfg(not(target_arch = "nvptx64"))]
    {
        mask & value as u32
    }
}

/// Whether all threads that are together here say yes.
#[inline(always)]
pub fn all(value: bool) -> bool {
    let here = together();
    // SAFETY: those that are together come here together.
    unsafe { ballot(here, !value) == 0 }
}

/// The value that another thread of the warp has.
///
/// # Safety
/// As for [`ballot`]; `lane` is a thread of `mask`.
#[inline(always)]
pub unsafe fn broadcast(mask: u32, value: u32, lane: u32) -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let result: u32;
        // SAFETY: the caller's promise.
        unsafe {
            core::arch::asm!("shfl.sync.idx.b32 {r}, {v}, {l}, 31, {m};", r = out(reg32) result, v = in(reg32) value,
                l = in(reg32) lane, m = in(reg32) mask, options(nostack));
        }
        result
    }
    #[cfg(not(target_arch = "nvptx64"))]
    {
        let _ = (mask, lane);
        value
    }
}

/// Waits for threads of the warp; what each wrote to memory before, all see after.
///
/// # Safety
/// As for [`ballot`].
#[inline(always)]
pub unsafe fn meet(mask: u32) {
    #[cfg(target_arch = "nvptx64")]
    // SAFETY: the caller's promise.
    unsafe {
        core::arch::asm!("bar.warp.sync {m};", m = in(reg32) mask, options(nostack))
    };
    #[cfg(not(target_arch = "nvptx64"))]
    let _ = mask;
}

/// The threads of the warp with smaller numbers than this one, a bit each.
#[inline(always)]
pub fn lanes_below() -> u32 {
    (1 << lane()) - 1
}

/// Most threads of a block of the kernels that have trays: `cargo xtask ptx` allows them no more.
#[cfg(target_arch = "nvptx64")]
const TRAYS: u32 = 128;

/// A place for a triangle in memory that the threads of a warp share.
pub struct Tray {
    #[cfg(target_arch = "nvptx64")]
    first: u32,
    #[cfg(not(target_arch = "nvptx64"))]
    triangle: core::mem::MaybeUninit<crate::triangle::Triangle>,
}

impl Tray {
    /// Of this thread, in a block of at most 128 threads.
    #[inline(always)]
    pub fn mine() -> Self {
        #[cfg(target_arch = "nvptx64")]
        {
            let block: u32;
            // SAFETY: names memory of the block, and changes nothing.
            unsafe {
                core::arch::asm!("{{ .shared .align 16 .b8 tray[{size}]; mov.u32 {a}, tray; }}", a = out(reg32) block,
                    size = const TRAYS * 48, options(pure, nomem, nostack));
            }
            // SAFETY: reading special registers has no precondition.
            let thread = unsafe {
                use core::arch::nvptx::*;
                (_thread_idx_y() * _block_dim_x() + _thread_idx_x()) as u32
            };
            Self { first: block + (thread & (TRAYS - 32)) * 48 }
        }
        #[cfg(not(target_arch = "nvptx64"))]
        Self { triangle: core::mem::MaybeUninit::uninit() }
    }

    /// Puts a triangle into this thread's place.
    ///
    /// # Safety
    /// No other thread reads it before the next [`meet`].
    #[inline(always)]
    pub unsafe fn put(&mut self, triangle: &crate::triangle::Triangle) {
        #[cfg(target_arch = "nvptx64")]
        {
            let words = triangle as *const crate::triangle::Triangle as *const [f32; 4];
            let mut i = 0;
            while i < 3 {
                // SAFETY: a triangle is three such words, and a place holds one.
                unsafe {
                    let [x, y, z, w] = *words.add(i);
                    core::arch::asm!("st.shared.v4.f32 [{p}], {{{x}, {y}, {z}, {w}}};",
                        p = in(reg32) self.first + lane() * 48 + 16 * i as u32, x = in(reg32) x, y = in(reg32) y,
                        z = in(reg32) z, w = in(reg32) w, options(nostack));
                }
                i += 1;
            }
        }
        #[cfg(not(target_arch = "nvptx64"))]
        {
            self.triangle.write(*triangle);
        }
    }

    /// The triangle that a thread of this warp has put into its place.
    ///
    /// # Safety
    /// It has, before the last [`meet`] with this one.
    #[inline(always)]
    pub unsafe fn get(&self, lane: u32) -> crate::triangle::Triangle {
        #[cfg(target_arch = "nvptx64")]
        {
            let mut triangle = core::mem::MaybeUninit::<crate::triangle::Triangle>::uninit();
            let words = triangle.as_mut_ptr() as *mut [f32; 4];
            let mut i = 0;
            while i < 3 {
                let (x, y, z, w): (f32, f32, f32, f32);
                // SAFETY: as in `put`.
                unsafe {
                    core::arch::asm!("ld.shared.v4.f32 {{{x}, {y}, {z}, {w}}}, [{p}];",
                        p = in(reg32) self.first + lane * 48 + 16 * i as u32, x = out(reg32) x, y = out(reg32) y,
                        z = out(reg32) z, w = out(reg32) w, options(nostack));
                    words.add(i).write([x, y, z, w]);
                }
                i += 1;
            }
            // SAFETY: all three words were written, and any bits are a triangle.
            unsafe { triangle.assume_init() }
        }
        #[cfg(not(target_arch = "nvptx64"))]
        {
            let _ = lane;
            // SAFETY: the caller's promise.
            unsafe { self.triangle.assume_init() }
        }
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

/// A stack of links to nodes that are still to be visited, with [`Links::END`] at its bottom.
///
/// On the GPU it is addressed within the thread's local memory, and its every step is predicated: as plain code each
/// would be a branch, where the threads of a warp part.
pub struct Links<'a, const N: usize> {
    #[cfg(target_arch = "nvptx64")]
    top: u32,
    #[cfg(not(target_arch = "nvptx64"))]
    top: usize,
    room: &'a mut [core::mem::MaybeUninit<u32>; N],
}

/// A box as a ray meets it: from `first` to `last`, and not at all where `first > last`; and what is in it.
#[derive(Clone, Copy)]
pub struct Meeting {
    /// Distance to where it is entered.
    pub first: f32,
    /// Distance to where it is left.
    pub last: f32,
    /// What is in it, as the stack keeps it.
    pub link: u32,
}

impl<'a, const N: usize> Links<'a, N> {
    /// No link is left.
    pub const END: u32 = u32::MAX;

    /// With nothing on it. `N` is one more than the links that are ever put aside at once.
    #[inline(always)]
    pub fn new(room: &'a mut [core::mem::MaybeUninit<u32>; N]) -> Self {
        #[cfg(target_arch = "nvptx64")]
        {
            let top: u32;
            // SAFETY: the room is on the thread's stack, which is local memory; its address there fits 32 bits.
            unsafe {
                core::arch::asm!(
                    "{{ .reg .b64 a; cvta.to.local.u64 a, {p}; cvt.u32.u64 {s}, a; st.local.u32 [{s}], -1; add.u32 {s}, {s}, 4; }}",
                    p = in(reg64) room.as_mut_ptr(), s = out(reg32) top, options(nostack));
            }
            Self { top, room }
        }
        #[cfg(not(target_arch = "nvptx64"))]
        {
            room[0].write(Self::END);
            Self { top: 1, room }
        }
    }

    /// With nothing on it again, whatever was.
    #[inline(always)]
    pub fn clear(&mut self) {
        #[cfg(target_arch = "nvptx64")]
        // SAFETY: as in `new`, whose `END` is still at the bottom.
        unsafe {
            core::arch::asm!(
                "{{ .reg .b64 a; cvta.to.local.u64 a, {p}; cvt.u32.u64 {s}, a; add.u32 {s}, {s}, 4; }}",
                p = in(reg64) self.room.as_mut_ptr(), s = out(reg32) self.top, options(nostack));
        }
        #[cfg(not(target_arch = "nvptx64"))]
        {
            self.top = 1;
        }
    }

    /// Of two children the one that is met first, after putting the other aside where both are met; where neither is,
    /// the last link put aside.
    ///
    /// # Safety
    /// At most `N - 1` links are ever put aside at once.
    #[inline(always)]
    pub unsafe fn descend(&mut self, a: Meeting, b: Meeting) -> u32 {
        #[cfg(target_arch = "nvptx64")]
        {
            let next: u32;
            // SAFETY: `top` stays within the room: `END` is popped at most once, and the caller bounds the rest.
            unsafe {
                core::arch::asm!("{{ .reg .pred a, b, q, both, any; .reg .b32 f;",
                    "setp.le.f32 a, {fa}, {la};",
                    "setp.le.f32 b, {fb}, {lb};",
                    "setp.lt.and.f32 q, {fb}, {fa}, b;",
                    "not.pred any, a;",
                    "or.pred q, q, any;",
                    "and.pred both, a, b;",
                    "or.pred any, a, b;",
                    "selp.b32 {n}, {cb}, {ca}, q;",
                    "selp.b32 f, {ca}, {cb}, q;",
                    "@both st.local.u32 [{top}], f;",
                    "@both add.u32 {top}, {top}, 4;",
                    "@!any sub.u32 {top}, {top}, 4;",
                    "@!any ld.local.u32 {n}, [{top}]; }}",
                    fa = in(reg32) a.first, la = in(reg32) a.last, fb = in(reg32) b.first, lb = in(reg32) b.last,
                    ca = in(reg32) a.link, cb = in(reg32) b.link, n = out(reg32) next, top = inout(reg32) self.top,
                    options(nostack));
            }
            next
        }
        #[cfg(not(target_arch = "nvptx64"))]
        {
            let (met_a, met_b) = (a.first <= a.last, b.first <= b.last);
            if !met_a && !met_b {
                // SAFETY: the caller's promise.
                return unsafe { self.pop() };
            }
            let (near, far) = if met_b && (!met_a || b.first < a.first) { (b, a) } else { (a, b) };
            if met_a && met_b {
                // SAFETY: the caller's promise.
                unsafe { self.room.get_unchecked_mut(self.top) }.write(far.link);
                self.top += 1;
            }
            near.link
        }
    }

    /// The last link put aside, or [`END`](Self::END), once.
    ///
    /// # Safety
    /// `END` was not popped before.
    #[inline(always)]
    pub unsafe fn pop(&mut self) -> u32 {
        #[cfg(target_arch = "nvptx64")]
        {
            let link: u32;
            // SAFETY: the caller's promise keeps `top` above the bottom.
            unsafe {
                core::arch::asm!("sub.u32 {top}, {top}, 4;", "ld.local.u32 {n}, [{top}];", n = out(reg32) link,
                    top = inout(reg32) self.top, options(nostack));
            }
            link
        }
        #[cfg(not(target_arch = "nvptx64"))]
        {
            self.top -= 1;
            // SAFETY: the caller's promise; everything below the former top was written.
            unsafe { self.room.get_unchecked(self.top).assume_init() }
        }
    }
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
