//! What the threads of a warp tell each other.

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
pub unsafe fn syncwarp(mask: u32) {
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

/// Which threads of the warp have the same value as this one, a bit each.
///
/// # Safety
/// As for [`ballot`].
#[inline(always)]
pub unsafe fn alike(mask: u32, value: u32) -> u32 {
    #[cfg(target_arch = "nvptx64")]
    {
        let same: u32;
        // SAFETY: the caller's promise.
        unsafe {
            core::arch::asm!("match.any.sync.b32 {r}, {v}, {m};", r = out(reg32) same, v = in(reg32) value,
                m = in(reg32) mask, options(nostack));
        }
        same
    }
    #[cfg(not(target_arch = "nvptx64"))]
    {
        let _ = value;
        mask
    }
}

/// The same answer, of which the compiler knows nothing. Where threads ask the same twice, and all of them meet in between, it
/// would compile what is in between once for each answer: threads that part would wait for each other in different places.
#[inline(always)]
pub fn afresh(value: bool) -> bool {
    #[cfg(target_arch = "nvptx64")]
    {
        let same: u32;
        // SAFETY: copies a register; volatile, so that no two of them are taken for one.
        unsafe {
            core::arch::asm!("mov.b32 {r}, {v};", r = out(reg32) same, v = in(reg32) value as u32, options(nomem, nostack));
        }
        same != 0
    }
    #[cfg(not(target_arch = "nvptx64"))]
    value
}
