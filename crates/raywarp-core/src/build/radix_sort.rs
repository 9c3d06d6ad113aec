//! Sorts pairs by their first number, keeping the order of equal ones: by digits of eight bits, from the lowest (Satish,
//! Harris and Garland 2009).
//!
//! For each digit [`CountDigits`] counts the values in each run of [`TILE`] pairs, [`ScanDigits`] adds them up over the runs,
//! and [`ScatterDigits`] moves the pairs.

use super::{ITEMS, TILE};
use crate::arch::{self, Block, SharedWords, BLOCK, THREADS, WARP, WARPS};
use crate::kernels::Thread;
use crate::view::{View, ViewMut};

/// Bits of a digit.
pub const BITS: u32 = 8;

/// Values of a digit.
pub const DIGITS: u32 = 1 << BITS;

/// Warps of a block on a GPU.
const MOST_WARPS: usize = BLOCK as usize / 32;

/// How many pairs of each run have each value of a digit, one block a run.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CountDigits {
    /// To be sorted.
    pub pairs: View<[u32; 2]>,
    /// Bits below the digit.
    pub shift: u32,
    /// Runs.
    pub runs: u32,
    /// By value, then by run; written.
    pub counts: ViewMut<u32>,
}

impl CountDigits {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let Some(block) = Block::of(thread) else { return };
        let counts = SharedWords::<{ DIGITS as usize }>::of_block();
        each_digit(&block, |digit| counts.set(digit, 0));
        // SAFETY: whole blocks are launched, and no thread has left.
        unsafe { arch::barrier() };
        for item in 0..ITEMS {
            let index = block.index * TILE + item * THREADS + block.thread;
            if index < self.pairs.len() {
                counts.add(digit(self.pairs.at(index), self.shift), 1);
            }
        }
        // SAFETY: as above.
        unsafe { arch::barrier() };
        // SAFETY: a place for each value and run.
        each_digit(&block, |digit| unsafe { self.counts.set(digit * self.runs + block.index, counts.get(digit)) });
    }
}

/// Adds the counts of each value up, one block a value.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ScanDigits {
    /// Runs.
    pub runs: u32,
    /// Of [`CountDigits`]; becomes how many pairs of earlier runs have the value.
    pub counts: ViewMut<u32>,
    /// How many pairs have each value, written.
    pub totals: ViewMut<u32>,
}

impl ScanDigits {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let Some(block) = Block::of(thread) else { return };
        let sums = SharedWords::<MOST_WARPS>::of_block();
        let (mut before, mut first) = (0, 0);
        while first < self.runs {
            let run = first + block.thread;
            let place = block.index * self.runs + run;
            let inside = run < self.runs;
            // SAFETY: each count is one thread's.
            let count = if arch::afresh(inside) { unsafe { self.counts.get(place) }.unwrap_or(0) } else { 0 };
            // SAFETY: whole blocks are launched, and all threads go through this loop alike.
            let (mine, all) = unsafe { arch::sums(&block, count, &sums) };
            if arch::afresh(inside) {
                // SAFETY: as above.
                unsafe { self.counts.set(place, before + mine) };
            }
            before += all;
            first += THREADS;
            // SAFETY: as above.
            unsafe { arch::barrier() };
        }
        if block.thread == 0 {
            // SAFETY: one block a value.
            unsafe { self.totals.set(block.index, before) };
        }
    }
}

/// Moves each pair to its place, one block a run.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ScatterDigits {
    /// To be sorted.
    pub pairs: View<[u32; 2]>,
    /// Bits below the digit.
    pub shift: u32,
    /// Runs.
    pub runs: u32,
    /// Of [`ScanDigits`].
    pub counts: View<u32>,
    /// Of [`ScanDigits`].
    pub totals: View<u32>,
    /// Sorted by this digit, written.
    pub sorted: ViewMut<[u32; 2]>,
}

impl ScatterDigits {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let Some(block) = Block::of(thread) else { return };
        // By warp, then by value: how many pairs, and then where the next one goes.
        let places = SharedWords::<{ MOST_WARPS * DIGITS as usize }>::of_block();
        self.count_by_warp(&block, &places);
        self.find_places(&block, &places);
        for item in 0..ITEMS {
            let index = self.index(&block, item);
            let inside = index < self.pairs.len();
            let (pair, value) = match arch::afresh(inside) {
                true => (self.pairs.at(index), digit(self.pairs.at(index), self.shift)),
                false => ([0; 2], DIGITS),
            };
            // SAFETY: all threads of the warp go through this loop alike.
            let peers = unsafe { arch::alike(u32::MAX >> (32 - WARP), value) };
            let mine = (peers & arch::lanes_below()).count_ones();
            let slot = block.warp() * DIGITS + value % DIGITS;
            let first = places.get(slot);
            // SAFETY: as above; no thread changes the place before all have read it, nor reads it before that.
            unsafe { arch::syncwarp(u32::MAX >> (32 - WARP)) };
            if arch::afresh(inside && mine == 0) {
                places.set(slot, first + peers.count_ones());
            }
            if arch::afresh(inside) {
                // SAFETY: every pair has a place of its own.
                unsafe { self.sorted.set(first + mine, pair) };
            }
            // SAFETY: as above.
            unsafe { arch::syncwarp(u32::MAX >> (32 - WARP)) };
        }
    }

    /// Each warp has a part of the run, and takes it in order.
    #[inline(always)]
    fn index(&self, block: &Block, item: u32) -> u32 {
        block.index * TILE + (block.warp() * ITEMS + item) * WARP + arch::lane()
    }

    #[inline(always)]
    fn count_by_warp(&self, block: &Block, counts: &SharedWords<{ MOST_WARPS * DIGITS as usize }>) {
        if WARPS == 1 {
            return;
        }
        each_digit(block, |digit| (0..WARPS).for_each(|warp| counts.set(warp * DIGITS + digit, 0)));
        // SAFETY: whole blocks are launched, and no thread has left.
        unsafe { arch::barrier() };
        for item in 0..ITEMS {
            let index = self.index(block, item);
            if index < self.pairs.len() {
                counts.add(block.warp() * DIGITS + digit(self.pairs.at(index), self.shift), 1);
            }
        }
        // SAFETY: as above.
        unsafe { arch::barrier() };
    }

    /// From the counts of each warp to where its first pair of each value goes.
    #[inline(always)]
    fn find_places(&self, block: &Block, places: &SharedWords<{ MOST_WARPS * DIGITS as usize }>) {
        let sums = SharedWords::<MOST_WARPS>::of_block();
        let (mut smaller, mut first) = (0, 0);
        while first < DIGITS {
            let value = first + block.thread;
            // SAFETY: whole blocks are launched, and all threads go through this loop alike.
            let (before, all) = unsafe { arch::sums(block, self.totals.at(value), &sums) };
            let mut place = smaller + before + self.counts.at(value * self.runs + block.index);
            for warp in 0..WARPS {
                let count = places.get(warp * DIGITS + value);
                places.set(warp * DIGITS + value, place);
                place += count;
            }
            smaller += all;
            first += THREADS;
            // SAFETY: as above.
            unsafe { arch::barrier() };
        }
    }
}

/// The digit of a pair's first number.
#[inline(always)]
fn digit(pair: [u32; 2], shift: u32) -> u32 {
    pair[0] >> shift & (DIGITS - 1)
}

/// Calls `then` for each value of a digit, in one thread of the block.
#[inline(always)]
fn each_digit(block: &Block, mut then: impl FnMut(u32)) {
    let mut value = block.thread;
    while value < DIGITS {
        then(value);
        value += THREADS;
    }
}

const _: () = assert!(DIGITS.is_multiple_of(THREADS));
