//! Memory that the threads of a warp share.

#[cfg(target_arch = "nvptx64")]
use core::marker::PhantomData;
use core::mem::MaybeUninit;

/// Most threads of a block of the kernels that have trays: `cargo xtask ptx` allows them no more.
#[cfg(target_arch = "nvptx64")]
const SLOTS: u32 = 128;

/// Bytes of an item: three 128-bit words.
#[cfg(target_arch = "nvptx64")]
const ITEM: u32 = 48;

/// A place for a `T` of 48 bytes in memory that the threads of a warp share.
pub struct SharedSlots<T> {
    /// Address of the first place of this warp.
    #[cfg(target_arch = "nvptx64")]
    first: u32,
    #[cfg(target_arch = "nvptx64")]
    item: PhantomData<T>,
    #[cfg(not(target_arch = "nvptx64"))]
    item: MaybeUninit<T>,
}

impl<T: Copy> SharedSlots<T> {
    /// Of this thread, in a block of at most 128 threads. A kernel asks once.
    #[inline(always)]
    pub fn mine() -> Self {
        const { assert!(core::mem::size_of::<T>() == 48 && core::mem::align_of::<T>() == 16) };
        #[cfg(target_arch = "nvptx64")]
        {
            let block: u32;
            // SAFETY: names memory of the block, and changes nothing.
            unsafe {
                core::arch::asm!("{{ .shared .align 16 .b8 slots[{size}]; mov.u32 {a}, slots; }}", a = out(reg32) block,
                    size = const SLOTS * ITEM, options(nomem, nostack));
            }
            // SAFETY: reading special registers has no precondition.
            let thread = unsafe {
                use core::arch::nvptx::*;
                (_thread_idx_y() * _block_dim_x() + _thread_idx_x()) as u32
            };
            Self { first: block + (thread & (SLOTS - 32)) * ITEM, item: PhantomData }
        }
        #[cfg(not(target_arch = "nvptx64"))]
        Self { item: MaybeUninit::uninit() }
    }

    /// Puts an item into this thread's place.
    ///
    /// # Safety
    /// No other thread reads it before the next [`meet`](super::syncwarp).
    #[inline(always)]
    pub unsafe fn put(&mut self, item: &T) {
        #[cfg(target_arch = "nvptx64")]
        {
            let words = item as *const T as *const [f32; 4];
            let mut i = 0;
            while i < 3 {
                // SAFETY: an item is three such words, and a place holds one.
                unsafe {
                    let [x, y, z, w] = *words.add(i);
                    core::arch::asm!("st.shared.v4.f32 [{p}], {{{x}, {y}, {z}, {w}}};",
                        p = in(reg32) self.first + super::lane() * ITEM + 16 * i as u32, x = in(reg32) x,
                        y = in(reg32) y, z = in(reg32) z, w = in(reg32) w, options(nostack));
                }
                i += 1;
            }
        }
        #[cfg(not(target_arch = "nvptx64"))]
        {
            self.item.write(*item);
        }
    }

    /// The item that a thread of this warp has put into its place.
    ///
    /// # Safety
    /// It has, before the last [`meet`](super::syncwarp) with this one; any bits are a `T`.
    #[inline(always)]
    pub unsafe fn get(&self, lane: u32) -> T {
        #[cfg(target_arch = "nvptx64")]
        {
            let mut item = MaybeUninit::<T>::uninit();
            let words = item.as_mut_ptr() as *mut [f32; 4];
            let mut i = 0;
            while i < 3 {
                let (x, y, z, w): (f32, f32, f32, f32);
                // SAFETY: as in `put`.
                unsafe {
                    core::arch::asm!("ld.shared.v4.f32 {{{x}, {y}, {z}, {w}}}, [{p}];",
                        p = in(reg32) self.first + lane * ITEM + 16 * i as u32, x = out(reg32) x, y = out(reg32) y,
                        z = out(reg32) z, w = out(reg32) w, options(nostack));
                    words.add(i).write([x, y, z, w]);
                }
                i += 1;
            }
            // SAFETY: all three words were written, and any bits are a `T`.
            unsafe { item.assume_init() }
        }
        #[cfg(not(target_arch = "nvptx64"))]
        {
            let _ = lane;
            // SAFETY: the caller's promise.
            unsafe { self.item.assume_init() }
        }
    }
}
