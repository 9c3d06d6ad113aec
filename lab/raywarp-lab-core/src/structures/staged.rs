//! Every triangle, for every ray, a handful at a time through memory that the threads of a warp share.
//!
//! The usual form of brute force on a GPU stages triangles by blocks, and all threads of a block wait for each other. Rays of
//! a picture part: a thread that shades is not there to wait. So here the threads that come together stage for each other,
//! and nobody else has to be there: each brings one triangle into a place of its own, and all test what was brought.

use raywarp_core::arch;
use raywarp_core::ray::Ray;
use raywarp_core::traversal::{Counter, Structure, Visitor, WorldSpace};
use raywarp_core::triangle::{RayShear, Triangle};
use raywarp_core::view::View;

/// All triangles in a row.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Staged {
    /// In the order of the scene.
    pub triangles: View<Triangle>,
}

impl Structure for Staged {
    const NAME: &'static str = "staged";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        let shear = RayShear::new(ray);
        let mut slots = arch::SharedSlots::mine();
        let here = arch::together();
        let rank = (here & arch::lanes_below()).count_ones();
        let (width, count) = (here.count_ones(), self.triangles.len());
        let mut first = 0;
        let mut over = false;
        while first < count {
            // SAFETY: the threads of `here` have the same triangles and go through these loops together: none leaves
            // before all of them are over. A place belongs to one thread, so other threads of the warp use others.
            unsafe {
                if first + rank < count {
                    slots.put(&self.triangles.load(first + rank));
                }
                arch::syncwarp(here);
                let mut left = here;
                let mut index = first;
                while left != 0 && index < count {
                    let triangle: Triangle = slots.get(left.trailing_zeros());
                    left &= left - 1;
                    index += 1;
                    if !over {
                        counter.triangle();
                        over = visitor.visit(&shear, &triangle) < ray.t_min;
                    }
                }
                // Nobody overwrites what another still reads, in this search or in the next.
                arch::syncwarp(here);
                if arch::ballot(here, !over) == 0 {
                    return;
                }
            }
            first += width;
        }
    }
}
