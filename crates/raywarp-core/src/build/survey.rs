//! What is known of all triangles together: which can be hit, and the box around the centres of those.

use super::bounds::{of_ordered, ordered, Bounds};
use super::hittable::{has_area, is_finite};
use super::{ITEMS, TILE};
use crate::arch::{self, Block};
use crate::kernels::Thread;
use crate::math::{vec3, Vec3};
use crate::triangle::Triangle;
use crate::view::{View, ViewMut};

/// Least and largest coordinates as numbers that only grow, from zeros on.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extremes {
    /// The complements of [`ordered`] coordinates.
    pub low: [u32; 3],
    /// [`ordered`] coordinates.
    pub high: [u32; 3],
}

impl Extremes {
    #[inline(always)]
    fn add(&mut self, low: Vec3, high: Vec3) {
        for axis in 0..3 {
            self.low[axis] = self.low[axis].max(!ordered(low[axis as u32]));
            self.high[axis] = self.high[axis].max(ordered(high[axis as u32]));
        }
    }

    /// The box; zeros where nothing was added.
    #[inline(always)]
    pub fn bounds(&self) -> Bounds {
        if self.high[0] == 0 {
            return Bounds { low: Vec3::ZERO, high: Vec3::ZERO };
        }
        let ([a, b, c], [d, e, f]) = (self.low, self.high);
        Bounds {
            low: vec3(of_ordered(!a), of_ordered(!b), of_ordered(!c)),
            high: vec3(of_ordered(d), of_ordered(e), of_ordered(f)),
        }
    }
}

/// What a build finds out. Zeros before it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    /// Of the centres of triangles that can be hit.
    pub centres: Extremes,
    /// Of their corners.
    pub corners: Extremes,
    /// Triangles with a coordinate that is NaN or infinite.
    pub not_finite: u32,
    /// Other triangles whose corners coincide or lie on a line.
    pub without_area: u32,
    /// Subtrees that a thread each writes, see [`FindSubtrees`](super::subtrees::FindSubtrees).
    pub subtrees: u32,
    /// Makes 64 bytes.
    pub unused: u32,
}

const _: () = assert!(size_of::<Findings>() == 64);

impl Findings {
    /// How many of so many triangles can be hit.
    #[inline(always)]
    pub fn hittable(&self, given: u32) -> u32 {
        given - self.not_finite - self.without_area
    }
}

/// Whether a triangle can be hit.
#[inline(always)]
pub(super) fn can_be_hit(triangle: &Triangle) -> bool {
    is_finite(triangle) && has_area(triangle)
}

/// Fills in the [`Findings`], one block a [`TILE`].
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Survey {
    /// As given.
    pub triangles: View<Triangle>,
    /// One, written.
    pub findings: ViewMut<Findings>,
}

impl Survey {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let Some(block) = Block::of(thread) else { return };
        let mut mine = Findings::default();
        for item in 0..ITEMS {
            let index = block.index * TILE + item * arch::THREADS + block.thread;
            if index < self.triangles.len() {
                add(&mut mine, &self.triangles.load(index));
            }
        }
        self.give(&mine);
    }

    /// Adds what a warp found. All its threads are here.
    #[inline(always)]
    fn give(&self, mine: &Findings) {
        let all = self.findings.shared(0);
        for axis in 0..3 {
            // SAFETY: in this launch the findings are touched here alone, and by atomic additions and maxima alone.
            unsafe {
                raise(&raw mut (*all).centres.low[axis], mine.centres.low[axis]);
                raise(&raw mut (*all).centres.high[axis], mine.centres.high[axis]);
                raise(&raw mut (*all).corners.low[axis], mine.corners.low[axis]);
                raise(&raw mut (*all).corners.high[axis], mine.corners.high[axis]);
            }
        }
        // SAFETY: as above.
        unsafe {
            if mine.not_finite > 0 {
                arch::add(&raw mut (*all).not_finite, mine.not_finite);
            }
            if mine.without_area > 0 {
                arch::add(&raw mut (*all).without_area, mine.without_area);
            }
        }
    }
}

#[inline(always)]
fn add(findings: &mut Findings, triangle: &Triangle) {
    if !is_finite(triangle) {
        findings.not_finite += 1;
    } else if !has_area(triangle) {
        findings.without_area += 1;
    } else {
        let centre = Bounds::of(triangle).centre();
        findings.centres.add(centre, centre);
        let (low, high) =
            (triangle.v0.min(triangle.v1).min(triangle.v2), triangle.v0.max(triangle.v1).max(triangle.v2));
        findings.corners.add(low, high);
    }
}

/// Raises a number to the largest that any thread of the warp has. All its threads are here.
///
/// # Safety
/// As for [`arch::raise`].
#[inline(always)]
unsafe fn raise(number: *mut u32, mine: u32) {
    let largest = largest(mine);
    if arch::lane() == 0 && largest > 0 {
        // SAFETY: the caller's promise.
        unsafe { arch::raise(number, largest) };
    }
}

#[inline(always)]
fn largest(mine: u32) -> u32 {
    let (mut largest, mut by) = (mine, arch::WARP / 2);
    while by > 0 {
        // SAFETY: all threads of the warp are here.
        largest = largest.max(unsafe { arch::broadcast(u32::MAX, largest, arch::lane() ^ by) });
        by /= 2;
    }
    largest
}
