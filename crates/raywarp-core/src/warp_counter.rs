//! Numbers that all threads of a launch add to: how much of something there is, or is done.

use crate::arch;
use crate::view::ViewMut;

/// Such a number.
#[derive(Clone, Copy)]
pub struct WarpCounter(*mut u32);

impl WarpCounter {
    /// Of a number that nothing but tallies touch during the launch.
    #[inline(always)]
    pub fn new(numbers: &ViewMut<u32>, index: u32) -> Self {
        Self(numbers.shared(index))
    }

    /// The number at an address, which nothing but tallies touch during the launch.
    #[inline(always)]
    pub fn at(number: *mut u32) -> Self {
        Self(number)
    }

    /// One thread of the warp adds; all get what the number was. All threads of the warp are here.
    #[inline(always)]
    pub fn take(&self, count: u32) -> u32 {
        let mut before = 0;
        if arch::lane() == 0 {
            // SAFETY: the promise of whoever launches.
            before = unsafe { arch::add(self.0, count) };
        }
        // SAFETY: all threads of the warp are here.
        unsafe { arch::broadcast(u32::MAX, before, 0) }
    }

    /// What the number is about now, to one thread of the warp; all get it. All threads of the warp are here.
    #[inline(always)]
    pub fn look(&self) -> u32 {
        let mut now = 0;
        if arch::lane() == 0 {
            // SAFETY: the promise of whoever launches.
            now = unsafe { arch::read(self.0) };
        }
        // SAFETY: all threads of the warp are here.
        unsafe { arch::broadcast(u32::MAX, now, 0) }
    }

    /// Sets the number back, once no other thread will touch it in this launch.
    #[inline(always)]
    pub fn clear(&self) {
        // SAFETY: the promise of whoever launches.
        unsafe {
            let now = arch::read(self.0);
            arch::add(self.0, now.wrapping_neg());
        }
    }
}
