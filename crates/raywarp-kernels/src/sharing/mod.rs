//! How the rays of a batch are shared out among threads: variations of one traversal, over the same tree.
//!
//! A [`search`] is one ray's way through a `bvh2`, which can be put aside after any step; a [`form`] is the order in which
//! the threads of a warp take steps to nodes and to triangles; a [`question`] is what is asked. The kernels differ in
//! where a thread gets its rays from: [`direct`] gives each its own, [`queued`] has warps take units of work from queues and
//! from each other's, [`refill`] gives a new ray to each lane that is done. [`paths`] follows rays over several bounces, and
//! [`sort`] puts rays in order between them.
//!
//! What renders is [`traverse`](crate::traverse); this is for measuring what it could be (`raywarp study`).

pub mod direct;
pub mod form;
pub mod paths;
pub mod question;
pub mod queued;
pub mod refill;
pub mod search;
pub mod sort;

/// Work units and queues on the device: numbers that all threads of a launch add to.
#[derive(Clone, Copy)]
pub(crate) struct Tally(*mut u32);

impl Tally {
    /// Of a number that nothing but tallies touch during the launch.
    #[inline(always)]
    pub fn new(numbers: &crate::view::ViewMut<u32>, index: u32) -> Self {
        Self(numbers.shared(index))
    }

    /// One thread of the warp adds; all get what the number was. All threads of the warp are here.
    #[inline(always)]
    pub fn take(&self, count: u32) -> u32 {
        let mut before = 0;
        if crate::arch::lane() == 0 {
            // SAFETY: the promise of whoever launches.
            before = unsafe { crate::arch::add(self.0, count) };
        }
        // SAFETY: all threads of the warp are here.
        unsafe { crate::arch::broadcast(u32::MAX, before, 0) }
    }

    /// What the number is about now, to one thread of the warp; all get it. All threads of the warp are here.
    #[inline(always)]
    pub fn look(&self) -> u32 {
        let mut now = 0;
        if crate::arch::lane() == 0 {
            // SAFETY: the promise of whoever launches.
            now = unsafe { crate::arch::read(self.0) };
        }
        // SAFETY: all threads of the warp are here.
        unsafe { crate::arch::broadcast(u32::MAX, now, 0) }
    }

    /// Sets the number back, once no other thread will touch it in this launch.
    #[inline(always)]
    pub fn clear(&self) {
        // SAFETY: the promise of whoever launches.
        unsafe {
            let now = crate::arch::read(self.0);
            crate::arch::add(self.0, now.wrapping_neg());
        }
    }
}
