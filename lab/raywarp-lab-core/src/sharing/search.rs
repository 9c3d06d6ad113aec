//! One ray on its way through a tree, which can be put aside after any step.

use raywarp_core::ray::Ray;
use raywarp_core::traversal::binary::{step, step_back, Aside, Boxes, Storage, LEAVES};
use raywarp_core::traversal::bvh2::{Bvh2, Child, Full, ANY};
use raywarp_core::traversal::query::Query;
use raywarp_core::traversal::Counter;
use raywarp_core::triangle::RayShear;

/// No link: the bottom of the stack, or no leaf in hand.
const NONE: u32 = Aside::END;

/// A ray's search.
pub struct Search<'a, Q: Query> {
    tree: Bvh2,
    boxes: Full<ANY>,
    shear: RayShear,
    query: Q,
    links: Aside<'a>,
    t_min: f32,
    t_far: f32,
    /// Where to go next: a node, a leaf, or nowhere.
    next: u32,
    /// A leaf in hand that was put off, or none.
    held: u32,
}

impl<'a, Q: Query> Search<'a, Q> {
    /// Without a ray: it is over.
    #[inline(always)]
    pub fn idle(tree: &Bvh2, storage: &'a mut Storage) -> Self {
        let ray = Ray::new(raywarp_core::math::Vec3::ZERO, raywarp_core::math::Vec3::ZERO);
        Self {
            tree: *tree,
            boxes: Full::new(tree, &ray),
            shear: RayShear::new(&ray),
            query: Q::about(&ray),
            links: Aside::new(storage),
            t_min: 0.0,
            t_far: 0.0,
            next: NONE,
            held: NONE,
        }
    }

    /// Begins a ray at the root.
    #[inline(always)]
    pub fn begin(&mut self, ray: &Ray) {
        let ray = ray.within_range();
        self.boxes = Full::new(&self.tree, &ray);
        self.shear = RayShear::new(&ray);
        self.query = Q::about(&ray);
        self.links.clear();
        (self.t_min, self.t_far) = (ray.t_min, ray.t_max);
        (self.next, self.held) = (0, NONE);
    }

    /// Whether nothing is left to visit.
    #[inline(always)]
    pub fn is_over(&self) -> bool {
        self.next == NONE && self.held == NONE
    }

    /// Whether the next step is to a node.
    #[inline(always)]
    pub fn is_at_node(&self) -> bool {
        self.next < LEAVES
    }

    /// Whether the next step is to a leaf.
    #[inline(always)]
    pub fn is_at_leaf(&self) -> bool {
        self.next >= LEAVES && self.next != NONE
    }

    /// Whether a leaf was put off.
    #[inline(always)]
    pub fn holds_leaf(&self) -> bool {
        self.held != NONE
    }

    /// The answer so far; that of the ray once the search is over.
    #[inline(always)]
    pub fn answer(&self) -> Q::Answer {
        self.query.answer()
    }

    /// Visits the node that is next.
    #[inline(always)]
    pub fn visit(&mut self, counter: &mut impl Counter) {
        counter.node();
        let [a, b] = self.boxes.children(self.next, self.t_min, self.t_far);
        self.next = step(&mut self.links, Q::ORDERED, a, b);
    }

    /// Puts the leaf that is next off, and goes on with what comes after it.
    #[inline(always)]
    pub fn hold(&mut self) {
        self.held = self.next;
        // SAFETY: a leaf is not the bottom of the stack, which so was not popped.
        self.next = unsafe { step_back(&mut self.links, Q::ORDERED) };
    }

    /// Tests all triangles of the leaf that is next.
    #[inline(always)]
    pub fn test_next(&mut self, counter: &mut impl Counter) {
        self.hold();
        self.test_held(counter);
    }

    /// Tests all triangles of the leaf in hand.
    #[inline(always)]
    pub fn test_held(&mut self, counter: &mut impl Counter) {
        while self.held != NONE {
            self.test_one(counter);
        }
    }

    /// Tests the first triangle of the leaf in hand, and takes it from there.
    #[inline(always)]
    pub fn test_one(&mut self, counter: &mut impl Counter) {
        counter.triangle();
        let leaf = Child::of_bits(self.held);
        let triangle = self.tree.triangles.load(leaf.index());
        self.held = if leaf.count() > 1 { Child::leaf(leaf.index() + 1, leaf.count() - 1).bits() } else { NONE };
        self.t_far = self.query.visit(&self.shear, &triangle);
        if self.t_far < self.t_min {
            (self.next, self.held) = (NONE, NONE);
        }
    }
}
