//! Threads that work in blocks: their numbers, the memory that they share, and their barrier.
//!
//! A block is [`BLOCK`] threads on a GPU. On a CPU its first thread does the work of all, so that what is written for
//! [`THREADS`] threads and their warps holds for the one: there is nothing to share then, and nobody to wait for.

use super::{Shuffle, WARP};
use crate::kernels::Thread;

/// Indices of a launch that belong to a block.
pub const BLOCK: u32 = 128;

/// Threads that a block's work is divided by.
pub const THREADS: u32 = if cfg!(target_arch = "nvptx64") { BLOCK } else { 1 };

/// Warps among them.
pub const WARPS: u32 = THREADS / WARP;

/// A thread as one of its block.
#[derive(Clone, Copy)]
pub struct Block {
    /// Which block of the launch.
    pub index: u32,
    /// Which thread of it, below [`THREADS`].
    pub thread: u32,
}

impl Block {
    /// Of a launch in a single row of whole blocks; none for threads whose work another one does.
    #[inline(always)]
    pub fn of(thread: Thread) -> Option<Self> {
        let block = Self { index: thread.x / BLOCK, thread: thread.x % BLOCK };
        (block.thread < THREADS).then_some(block)
    }

    /// Which warp of the block this thread is in.
    #[inline(always)]
    pub fn warp(&self) -> u32 {
        self.thread / WARP
    }
}

/// Waits for all threads of the block; what each wrote to memory that they share, all see after.
///
/// # Safety
/// All threads of the block come here.
#[inline(always)]
pub unsafe fn barrier() {
    #[cfg(target_arch = "nvptx64")]
    // SAFETY: the caller's promise.
    unsafe {
        core::arch::nvptx::_syncthreads()
    };
}

/// `N` numbers that the threads of a block share. Their first values are anything.
pub struct SharedWords<const N: usize> {
    /// Their address in shared memory.
    #[cfg(target_arch = "nvptx64")]
    first: u32,
    #[cfg(not(target_arch = "nvptx64"))]
    words: [core::cell::Cell<u32>; N],
}

impl<const N: usize> SharedWords<N> {
    /// Of this block. A kernel asks once for each that it needs.
    #[inline(always)]
    pub fn of_block() -> Self {
        #[cfg(target_arch = "nvptx64")]
        {
            let first: u32;
            // SAFETY: names memory of the block, and changes nothing.
            unsafe {
                core::arch::asm!("{{ .shared .align 16 .b8 shared_words_{size}[{size}]; mov.u32 {a}, shared_words_{size}; }}",
                    a = out(reg32) first, size = const 4 * N, options(nomem, nostack));
            }
            Self { first }
        }
        #[cfg(not(target_arch = "nvptx64"))]
        Self { words: [const { core::cell::Cell::new(0) }; N] }
    }

    /// A number.
    #[inline(always)]
    pub fn get(&self, index: u32) -> u32 {
        debug_assert!((index as usize) < N);
        #[cfg(target_arch = "nvptx64")]
        {
            let word: u32;
            // SAFETY: in range, as whoever calls vouches.
            unsafe {
                core::arch::asm!("ld.shared.u32 {w}, [{p}];", w = out(reg32) word, p = in(reg32) self.first + 4 * index,
                    options(nostack));
            }
            word
        }
        #[cfg(not(target_arch = "nvptx64"))]
        self.words[index as usize].get()
    }

    /// Changes a number that no other thread touches before the next barrier.
    #[inline(always)]
    pub fn set(&self, index: u32, word: u32) {
        debug_assert!((index as usize) < N);
        #[cfg(target_arch = "nvptx64")]
        // SAFETY: in range, as whoever calls vouches.
        unsafe {
            core::arch::asm!("st.shared.u32 [{p}], {w};", w = in(reg32) word, p = in(reg32) self.first + 4 * index,
                options(nostack));
        }
        #[cfg(not(target_arch = "nvptx64"))]
        self.words[index as usize].set(word);
    }

    /// Adds to a number that others may be adding to.
    #[inline(always)]
    pub fn add(&self, index: u32, more: u32) {
        debug_assert!((index as usize) < N);
        #[cfg(target_arch = "nvptx64")]
        // SAFETY: in range, as whoever calls vouches.
        unsafe {
            core::arch::asm!("red.shared.add.u32 [{p}], {w};", w = in(reg32) more, p = in(reg32) self.first + 4 * index,
                options(nostack));
        }
        #[cfg(not(target_arch = "nvptx64"))]
        self.words[index as usize].set(self.words[index as usize].get() + more);
    }
}

/// The sum of `value` over the threads of the block before this one, and over all of them.
///
/// # Safety
/// All threads of the block come here, and nothing else uses `totals` since the barrier before and until the next one.
#[inline(always)]
pub unsafe fn sums(block: &Block, value: u32, totals: &SharedWords<{ BLOCK as usize / 32 }>) -> (u32, u32) {
    let mut sum = value;
    let mut by = 1;
    while by < WARP {
        let before = sum.of_lane(super::lane().wrapping_sub(by));
        sum += if super::lane() >= by { before } else { 0 };
        by *= 2;
    }
    if super::lane() == WARP - 1 {
        totals.set(block.warp(), sum);
    }
    // SAFETY: the caller's promise.
    unsafe { barrier() };
    let (mut before, mut all) = (sum - value, 0);
    for warp in 0..WARPS {
        let total = totals.get(warp);
        before += if warp < block.warp() { total } else { 0 };
        all += total;
    }
    (before, all)
}
