//! What a lane of persistent threads has on its way.

use crate::math::Vec3;
use crate::ray::{Ray, MISS};
use crate::traversal::binary::{step, Aside, Boxes, Storage, LEAVES};
use crate::traversal::bvh2::Child;
use crate::traversal::bvh2_quantized::OnGrid;
use crate::traversal::query::Query;
use crate::traversal::QuantizedBvh2;

/// No link.
const END: u32 = Aside::END;

/// No link either: a ray is about to begin. Leaves that would have this number end beyond the last triangle that there
/// may be.
const CALLED: u32 = END - 1;

/// Nodes that a lane visits before the warp looks what its lanes have come to, an even number; by measurement, see
/// `docs/bench`.
const STEPS: u32 = 4;

/// A ray's way through the small nodes.
pub(super) struct Search<'a> {
    boxes: OnGrid,
    links: Aside<'a>,
    /// Distances between which a hit counts.
    t_min: f32,
    t_far: f32,
    /// The next node or leaf.
    next: u32,
    /// Index among the tree's triangles of the nearest one hit, or of any; [`MISS`] for none.
    pub best: u32,
}

impl<'a> Search<'a> {
    /// Without a ray: it is over.
    #[inline(always)]
    pub fn idle(tree: &QuantizedBvh2, storage: &'a mut Storage) -> Self {
        let boxes = OnGrid::new(tree, &Ray::new(Vec3::ZERO, Vec3::ZERO));
        Self { boxes, links: Aside::new(storage), t_min: 0.0, t_far: 0.0, next: END, best: MISS }
    }

    /// Says that a ray is about to begin. The search that was is over.
    #[inline(always)]
    pub fn call(&mut self) {
        self.next = CALLED;
    }

    /// Whether a ray is about to begin.
    #[inline(always)]
    pub fn is_called(&self) -> bool {
        self.next == CALLED
    }

    /// Begins a ray at the root.
    #[inline(always)]
    pub fn begin(&mut self, tree: &QuantizedBvh2, ray: &Ray) {
        self.boxes = OnGrid::new(tree, ray);
        self.links.clear();
        (self.t_min, self.t_far) = (ray.t_min, ray.t_max);
        (self.next, self.best) = (0, MISS);
    }

    #[inline(always)]
    pub fn is_over(&self) -> bool {
        self.next == END
    }

    #[inline(always)]
    pub fn is_at_node(&self) -> bool {
        self.next < LEAVES
    }

    /// The leaf that is next.
    #[inline(always)]
    pub fn leaf(&self) -> Option<Child> {
        (!self.is_at_node() && !self.is_over()).then(|| Child::of_bits(self.next))
    }

    /// Visits a few nodes, or as many as there are before a leaf. Two at a time: the count is looked at half as often.
    #[inline(always)]
    pub fn descend<Q: Query>(&mut self) {
        let mut steps = 0;
        while self.is_at_node() {
            self.visit::<Q>();
            if !self.is_at_node() {
                break;
            }
            self.visit::<Q>();
            steps += 2;
            if steps >= STEPS {
                break;
            }
        }
    }

    /// Visits the node that is next.
    #[inline(always)]
    fn visit<Q: Query>(&mut self) {
        let [a, b] = self.boxes.children(self.next, self.t_min, self.t_far);
        self.next = step(&mut self.links, Q::ORDERED, a, b);
    }

    /// A triangle is hit at `t`; `before` says whether it comes before another one at the same distance.
    #[inline(always)]
    pub fn hit<Q: Query>(&mut self, t: f32, triangle: u32, before: impl Fn(u32, u32) -> bool) {
        let wins_tie = || self.best == MISS || !Q::ORDERED || before(triangle, self.best);
        if t >= self.t_min && (t < self.t_far || (t == self.t_far && wins_tie())) {
            (self.t_far, self.best) = (t, triangle);
        }
    }

    /// Goes on after a leaf of which `rest` is left; after no leaf it stays.
    #[inline(always)]
    pub fn after_leaf<Q: Query>(&mut self, leaf: Option<Child>, rest: Option<Child>) {
        if Q::ORDERED {
            let back = leaf.is_some() && rest.is_none();
            let next = rest.map_or(self.next, Child::bits);
            // SAFETY: a search with a leaf is not over, so the end was not popped.
            self.next = unsafe { self.links.pop_if(back, next) };
        } else if leaf.is_some() {
            self.next = match rest {
                _ if self.best != MISS => END,
                Some(rest) => rest.bits(),
                // SAFETY: as above.
                None => unsafe { self.links.pop_either() },
            };
        }
    }
}
