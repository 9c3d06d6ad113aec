//! Codes along a curve through space (Morton 1966): triangles whose codes are close are close.

use super::bounds::Bounds;
use super::survey::{can_be_hit, Findings};
use crate::kernels::Thread;
use crate::triangle::Triangle;
use crate::view::{View, ViewMut};

/// The key of a triangle that cannot be hit: after all others.
pub const LAST: u32 = u32::MAX;

/// Cells along an axis.
const CELLS: u32 = 1 << 10;

/// Gives each triangle a key to sort by, with its index, one thread a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct MortonCodes {
    /// As given.
    pub triangles: View<Triangle>,
    /// One.
    pub findings: View<Findings>,
    /// Key and index of each, written.
    pub keys: ViewMut<[u32; 2]>,
}

impl MortonCodes {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.triangles.len() {
            return;
        }
        let triangle = self.triangles.load(thread.x);
        let key = if can_be_hit(&triangle) { self.code(&triangle) } else { LAST };
        // SAFETY: one thread a triangle.
        unsafe { self.keys.set(thread.x, [key, thread.x]) };
    }

    #[inline(always)]
    fn code(&self, triangle: &Triangle) -> u32 {
        let around = self.findings.item(0).centres.bounds();
        let centre = Bounds::of(triangle).centre();
        let cell = |axis| cell(centre[axis], around.low[axis], around.high[axis]);
        spread(cell(0)) | spread(cell(1)) << 1 | spread(cell(2)) << 2
    }
}

/// Which of the cells between two coordinates holds a third. The conversion brings what rounding, overflow or NaN make of
/// it back into range.
#[inline(always)]
fn cell(x: f32, low: f32, high: f32) -> u32 {
    let scale = CELLS as f32 / (high - low);
    (((x - low) * scale) as u32).min(CELLS - 1)
}

/// With two zeros between any two of the ten lowest bits.
#[inline(always)]
fn spread(x: u32) -> u32 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_three_apart() {
        for bit in 0..10 {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread(CELLS - 1).count_ones(), 10);
    }

    #[test]
    fn every_coordinate_has_a_cell() {
        assert_eq!([cell(0.0, 0.0, 1.0), cell(0.5, 0.0, 1.0), cell(1.0, 0.0, 1.0)], [0, 512, 1023]);
        assert_eq!([cell(3.0, 3.0, 3.0), cell(f32::MAX, -f32::MAX, f32::MAX)], [0, 0]);
    }
}
