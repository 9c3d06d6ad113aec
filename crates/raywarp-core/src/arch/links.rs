//! A binary tree's nodes that are put aside.

/// A stack of links to nodes that are still to be visited, with [`Links::END`] at its bottom.
///
/// A search uses [`descend`](Self::descend), [`pop`](Self::pop) and [`pop_if`](Self::pop_if), or
/// [`descend_either`](Self::descend_either) and [`pop_either`](Self::pop_either), but never both: on the GPU the former keep
/// the last link in a register, so that nobody waits for what was put aside, and the latter keep it in memory, which takes
/// less of a search that soon ends.
///
/// There the stack is addressed within the thread's local memory, and its every step is predicated: as plain code each
/// would be a branch, where the threads of a warp part.
pub struct Links<'a, const N: usize> {
    #[cfg(target_arch = "nvptx64")]
    top: u32,
    /// What `descend` put aside last, or `END`; it is not in memory yet.
    #[cfg(target_arch = "nvptx64")]
    last: u32,
    #[cfg(not(target_arch = "nvptx64"))]
    top: usize,
    storage: &'a mut [core::mem::MaybeUninit<u32>; N],
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
    pub fn new(storage: &'a mut [core::mem::MaybeUninit<u32>; N]) -> Self {
        #[cfg(target_arch = "nvptx64")]
        {
            let top: u32;
            // SAFETY: the room is on the thread's stack, which is local memory; its address there fits 32 bits.
            unsafe {
                core::arch::asm!(
                    "{{ .reg .b64 a; cvta.to.local.u64 a, {p}; cvt.u32.u64 {s}, a; st.local.u32 [{s}], -1; add.u32 {s}, {s}, 4; }}",
                    p = in(reg64) storage.as_mut_ptr(), s = out(reg32) top, options(nostack));
            }
            Self { top, last: Self::END, storage }
        }
        #[cfg(not(target_arch = "nvptx64"))]
        {
            storage[0].write(Self::END);
            Self { top: 1, storage }
        }
    }

    /// With nothing on it again, whatever was.
    #[inline(always)]
    pub fn clear(&mut self) {
        #[cfg(target_arch = "nvptx64")]
        {
            self.last = Self::END;
            // SAFETY: as in `new`, whose `END` is still at the bottom.
            unsafe {
                core::arch::asm!(
                    "{{ .reg .b64 a; cvta.to.local.u64 a, {p}; cvt.u32.u64 {s}, a; add.u32 {s}, {s}, 4; }}",
                    p = in(reg64) self.storage.as_mut_ptr(), s = out(reg32) self.top, options(nostack));
            }
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
                    "setp.lt.f32 q, {fb}, {fa};",
                    "not.pred any, a;",
                    "and.pred both, a, b;",
                    "and.pred q, q, b;",
                    "or.pred q, q, any;",
                    "or.pred any, a, b;",
                    "selp.b32 {n}, {cb}, {ca}, q;",
                    "selp.b32 f, {ca}, {cb}, q;",
                    "@both st.local.u32 [{top}], {last};",
                    "@both add.u32 {top}, {top}, 4;",
                    "selp.b32 {n}, {n}, {last}, any;",
                    "selp.b32 {last}, f, {last}, both;",
                    "@!any sub.u32 {top}, {top}, 4;",
                    "@!any ld.local.u32 {last}, [{top}]; }}",
                    fa = in(reg32) a.first, la = in(reg32) a.last, fb = in(reg32) b.first, lb = in(reg32) b.last,
                    ca = in(reg32) a.link, cb = in(reg32) b.link, n = out(reg32) next, top = inout(reg32) self.top,
                    last = inout(reg32) self.last, options(nostack));
            }
            next
        }
        #[cfg(not(target_arch = "nvptx64"))]
        {
            let (met_a, met_b) = (a.first <= a.last, b.first <= b.last);
            if !met_a && !met_b {
                // SAFETY: the caller's promise.
                return unsafe { self.read_back() };
            }
            let (near, far) = if met_b && (!met_a || b.first < a.first) { (b, a) } else { (a, b) };
            if met_a && met_b {
                // SAFETY: the caller's promise.
                unsafe { self.push(far.link) };
            }
            near.link
        }
    }

    /// Of two children the first one that is met, after putting the other aside where both are met; where neither is, the
    /// last link put aside.
    ///
    /// # Safety
    /// As for [`descend`](Self::descend).
    #[inline(always)]
    pub unsafe fn descend_either(&mut self, a: Meeting, b: Meeting) -> u32 {
        #[cfg(target_arch = "nvptx64")]
        {
            let next: u32;
            // SAFETY: as in `descend`.
            unsafe {
                core::arch::asm!("{{ .reg .pred a, b, both, any;",
                    "setp.le.f32 a, {fa}, {la};",
                    "setp.le.f32 b, {fb}, {lb};",
                    "and.pred both, a, b;",
                    "or.pred any, a, b;",
                    "selp.b32 {n}, {ca}, {cb}, a;",
                    "@both st.local.u32 [{top}], {cb};",
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
            match (a.first <= a.last, b.first <= b.last) {
                // SAFETY: the caller's promise.
                (false, false) => unsafe { self.read_back() },
                (false, true) => b.link,
                (true, false) => a.link,
                (true, true) => {
                    // SAFETY: the caller's promise.
                    unsafe { self.push(b.link) };
                    a.link
                }
            }
        }
    }

    /// The last link put aside by [`descend`](Self::descend), or [`END`](Self::END), once.
    ///
    /// # Safety
    /// `END` was not popped before.
    #[inline(always)]
    pub unsafe fn pop(&mut self) -> u32 {
        #[cfg(target_arch = "nvptx64")]
        {
            let link = self.last;
            // SAFETY: the caller's promise keeps `top` within the room.
            self.last = unsafe { self.read_back() };
            link
        }
        #[cfg(not(target_arch = "nvptx64"))]
        // SAFETY: the caller's promise.
        unsafe {
            self.read_back()
        }
    }

    /// As [`pop`](Self::pop) where `back` says so, and `other` where it does not. On the GPU without a branch: where the
    /// threads join again what is popped would be copied, and they would wait for it.
    ///
    /// # Safety
    /// As for [`pop`](Self::pop), where `back` says so.
    #[inline(always)]
    pub unsafe fn pop_if(&mut self, back: bool, other: u32) -> u32 {
        #[cfg(target_arch = "nvptx64")]
        {
            let next: u32;
            // SAFETY: the caller's promise keeps `top` within the room.
            unsafe {
                core::arch::asm!("{{ .reg .pred p;", "setp.ne.u32 p, {back}, 0;", "selp.b32 {n}, {last}, {other}, p;",
                    "@p sub.u32 {top}, {top}, 4;", "@p ld.local.u32 {last}, [{top}]; }}",
                    back = in(reg32) back as u32, other = in(reg32) other, n = out(reg32) next,
                    last = inout(reg32) self.last, top = inout(reg32) self.top, options(nostack));
            }
            next
        }
        #[cfg(not(target_arch = "nvptx64"))]
        if back {
            // SAFETY: the caller's promise.
            unsafe { self.read_back() }
        } else {
            other
        }
    }

    /// The last link put aside by [`descend_either`](Self::descend_either), or [`END`](Self::END), once.
    ///
    /// # Safety
    /// `END` was not popped before.
    #[inline(always)]
    pub unsafe fn pop_either(&mut self) -> u32 {
        // SAFETY: the caller's promise.
        unsafe { self.read_back() }
    }

    /// What was written last, taken off.
    ///
    /// # Safety
    /// Something is left in the room.
    #[inline(always)]
    unsafe fn read_back(&mut self) -> u32 {
        #[cfg(target_arch = "nvptx64")]
        {
            let link: u32;
            // SAFETY: the caller's promise keeps `top` within the room.
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
            unsafe { self.storage.get_unchecked(self.top).assume_init() }
        }
    }

    /// # Safety
    /// There is room for one more.
    #[cfg(not(target_arch = "nvptx64"))]
    #[inline(always)]
    unsafe fn push(&mut self, link: u32) {
        // SAFETY: the caller's promise.
        unsafe { self.storage.get_unchecked_mut(self.top) }.write(link);
        self.top += 1;
    }
}
