//! A batch of rays that go different ways, for GPUs.
//!
//! With a ray a thread, most lanes of a warp would wait: for those that still visit nodes, that test the triangles of a
//! longer leaf, or that are not done. Here as many warps as fit on the device stay until the batch is answered, and lanes
//! that are done get new rays (Aila and Laine 2009). The warp keeps together for a few nodes at a time, and tests the
//! triangles of all its rays together, a lane a triangle.
//!
//! Answers are those of [`closest`](crate::traversal::closest) and [`occlusion`](crate::traversal::occlusion), to the bit. Where
//! neighbours go the same way they keep together by themselves, and a ray a thread is faster.

mod redistribute;
mod search;

use core::mem::MaybeUninit;

use crate::arch::{self, SharedSlots, WARP};
use crate::kernels::Thread;
use crate::queue::Queue;
use crate::ray::{Hit, Ray, MISS};
use crate::traversal::bvh2::{Child, MAX_DEPTH};
use crate::traversal::query::Query;
use crate::traversal::QuantizedBvh2;
use crate::triangle::RayShear;
use crate::view::{View, ViewMut};
use redistribute::LeafRedistribution;
use search::Search;

/// Lanes with a leaf that are enough to test triangles, while others still have nodes to visit. This and the next by
/// measurement, see `docs/bench`.
const ENOUGH: u32 = if WARP > 1 { 6 } else { 1 };

/// Lanes without a ray that are enough to begin new ones.
const REFILL: u32 = if WARP > 1 { 12 } else { 1 };

/// Answers a batch by as many threads as fit on the device at once.
#[repr(C)]
pub struct Persistent<Q: Query> {
    /// Where to find hits.
    pub tree: QuantizedBvh2,
    /// The batch.
    pub rays: View<Ray>,
    /// One a ray, written.
    pub answers: Q::Answers,
    /// Rays that were taken, and warps that are done; zeros before and after.
    pub taken: ViewMut<u32>,
    /// Warps of the launch.
    pub warps: u32,
}

impl<Q: Query> Persistent<Q> {
    /// Numbers that `taken` holds.
    pub const NUMBERS: usize = 2;

    #[inline(always)]
    pub(crate) fn run(&self, _: Thread) {
        let mut slots = SharedSlots::<RayShear>::mine();
        let mut storage = [const { MaybeUninit::uninit() }; MAX_DEPTH + 1];
        let mut search = Search::idle(&self.tree, &mut storage);
        let queue = Queue::new(&self.taken, self.rays.len());
        // The lane's ray, and whether there may be more in the batch.
        let (mut index, mut more) = (MISS, true);
        loop {
            if search.is_called() {
                let ray = self.rays.load(index).within_range();
                // SAFETY: this lane's last ray was answered, and all lanes meet before they read.
                unsafe { slots.put(&RayShear::new(&ray)) };
                search.begin(&self.tree, &ray);
            }
            // Together again. Where threads meet that parted is up to the compiler otherwise, and they would go on apart.
            // SAFETY: no thread leaves this loop before all of its warp do.
            unsafe { arch::syncwarp(ALL) };
            search.descend::<Q>();
            let leaf = search.leaf();
            let (nodes, leaves) = (vote(search.is_at_node()), vote(leaf.is_some()));
            let idle = ALL & !(nodes | leaves);
            let refill = if more { idle.count_ones() >= REFILL } else { idle == ALL };
            if refill {
                if search.is_over() && index != MISS {
                    // SAFETY: every ray is taken once.
                    unsafe { Q::write(&self.answers, index, self.answer(&search, &slots)) };
                    index = MISS;
                }
                if !more {
                    break;
                }
                let mine;
                (mine, more) = queue.take(idle);
                if search.is_over() && mine < self.rays.len() {
                    index = mine;
                    search.call();
                }
            } else if leaves.count_ones() >= ENOUGH || nodes == 0 {
                let triangles = self.tree.triangles;
                let share = LeafRedistribution::new(leaf);
                let t = share
                    .test
                    .and_then(|(lane, triangle)| {
                        // SAFETY: that lane has a leaf, so it has put its ray there.
                        let shear = unsafe { slots.get(lane) };
                        triangles.load(triangle).intersect(&shear)
                    })
                    .map_or(f32::INFINITY, |hit| hit.t);
                let first = leaf.map_or(0, Child::index);
                let id = |triangle| {
                    let triangle = triangles.item(triangle);
                    (triangle.instance, triangle.primitive)
                };
                share.collect(t, |t, nth| search.hit::<Q>(t, first + nth, |a, b| id(a) < id(b)));
                search.after_leaf::<Q>(leaf, leaf.and_then(|leaf| share.rest(leaf)));
            }
        }
        queue.leave(self.warps);
    }

    /// The answer of a search that is over.
    #[inline(always)]
    fn answer(&self, search: &Search, slots: &SharedSlots<RayShear>) -> Q::Answer {
        if search.best == MISS {
            return Q::from_hit(Hit::NONE);
        }
        if !Q::ORDERED {
            return Q::from_hit(Hit { primitive: search.best, ..Hit::NONE });
        }
        // SAFETY: this lane has put its ray there.
        let shear = unsafe { slots.get(arch::lane()) };
        // As it was found, so there is one.
        Q::from_hit(self.tree.triangles.load(search.best).intersect(&shear).unwrap_or(Hit::NONE))
    }
}

/// All threads of a warp, a bit each.
const ALL: u32 = u32::MAX >> (32 - WARP);

/// Which threads of the warp say yes, a bit each. All of them are here.
#[inline(always)]
fn vote(value: bool) -> u32 {
    // SAFETY: no thread leaves the loop before all of its warp do.
    unsafe { arch::ballot(ALL, value) }
}

/// The value that a lane has; of a lane that there is not, any. All threads of the warp are here.
#[inline(always)]
fn from(value: u32, lane: u32) -> u32 {
    // SAFETY: as in `vote`.
    unsafe { arch::broadcast(ALL, value, lane) }
}

impl<Q: Query> Clone for Persistent<Q> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<Q: Query> Copy for Persistent<Q> {}
