//! Rays that go on: over all bounces in one thread, or a bounce at a time through queues (Laine, Karras and Aila 2013).
//!
//! A surface sends a ray on as a mirror or in a random direction. Both ways give the same [`Trail`]s: a path's rays depend
//! on its number alone.

use super::form::{Form, WhileWhile};
use super::search::Search;
use raywarp_core::arch;
use raywarp_core::kernels::Thread;
use raywarp_core::ray::{Hit, Ray};
use raywarp_core::sample::{combine, cosine};
use raywarp_core::shade::optics::reflect;
use raywarp_core::traversal::bvh2::{Bvh2, MAX_DEPTH};
use raywarp_core::traversal::query::ClosestHit;
use raywarp_core::traversal::NullStatistics;
use raywarp_core::triangle::Triangle;
use raywarp_core::view::{View, ViewMut};

/// Where paths go, and how far.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// Where to find hits.
    pub tree: Bvh2,
    /// In the order of their numbers: what was hit.
    pub triangles: View<Triangle>,
    /// How far rays start above a surface, in scene units.
    pub offset: f32,
    /// 0: every surface is a mirror; 1: every direction is random, cosine-weighted.
    pub diffuse: u32,
    /// Rays after the first one.
    pub bounces: u32,
}

/// A path so far.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trail {
    /// Rays traced.
    pub rays: u32,
    /// What the last of them hit.
    pub primitive: u32,
    /// Its distance.
    pub t: f32,
}

impl Way {
    /// The hit of a ray.
    #[inline(always)]
    fn trace(&self, search: &mut Search<ClosestHit>, ray: &Ray) -> Hit {
        search.begin(ray);
        while !search.is_over() {
            WhileWhile::turn(search, &mut NullStatistics);
        }
        search.answer()
    }

    /// The ray that goes on after bounce `bounce` of a path, if any does.
    #[inline(always)]
    fn next(&self, ray: &Ray, hit: &Hit, path: u32, bounce: u32) -> Option<Ray> {
        if hit.is_miss() || bounce >= self.bounces {
            return None;
        }
        let triangle = self.triangles.load(hit.primitive);
        let shear = (triangle.v1 - triangle.v0).cross(triangle.v2 - triangle.v0);
        let normal = if shear.is_zero() { -ray.direction } else { shear.normalize() };
        let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        let direction = match self.diffuse {
            0 => reflect(ray.direction, normal),
            _ => cosine(normal, combine(path, bounce)),
        };
        Some(Ray::new(normal.mul_add(self.offset, ray.at(hit.t)), direction))
    }
}

/// Follows each path to its end, one thread a path.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Paths {
    /// Where they go.
    pub way: Way,
    /// The first ray of each.
    pub rays: View<Ray>,
    /// One a path, written.
    pub trails: ViewMut<Trail>,
}

impl Paths {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let path = thread.x;
        if path >= self.rays.len() {
            return;
        }
        let mut storage = [const { core::mem::MaybeUninit::uninit() }; MAX_DEPTH + 1];
        let mut search = Search::idle(&self.way.tree, &mut storage);
        let (mut ray, mut bounce) = (self.rays.load(path), 0);
        loop {
            let hit = self.way.trace(&mut search, &ray);
            match self.way.next(&ray, &hit, path, bounce) {
                Some(next) => (ray, bounce) = (next, bounce + 1),
                None => {
                    let trail = Trail { rays: bounce + 1, primitive: hit.primitive, t: hit.t };
                    // SAFETY: one thread a path.
                    unsafe { self.trails.set(path, trail) };
                    return;
                }
            }
        }
    }
}

/// A ray of a path, in a queue.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waiting {
    /// The ray.
    pub ray: Ray,
    /// Number of its path; the rest makes 48 bytes.
    pub path: u32,
    /// Makes 48 bytes.
    pub unused: [u32; 3],
}

/// One bounce: traces the rays of one queue and puts those that go on into another.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// Where they go.
    pub way: Way,
    /// Bounces before this one.
    pub bounce: u32,
    /// The first rays of all paths, for bounce 0.
    pub rays: View<Ray>,
    /// The rays of this bounce, for others.
    pub queue: View<Waiting>,
    /// Those of the next, written.
    pub next: ViewMut<Waiting>,
    /// Rays of each bounce; all but the first are zero before the first.
    pub counts: ViewMut<u32>,
    /// One a path, written where it ends.
    pub trails: ViewMut<Trail>,
}

impl Bounce {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let Some((ray, path)) = self.taken(thread.x) else { return };
        let mut storage = [const { core::mem::MaybeUninit::uninit() }; MAX_DEPTH + 1];
        let mut search = Search::idle(&self.way.tree, &mut storage);
        let hit = self.way.trace(&mut search, &ray);
        match self.way.next(&ray, &hit, path, self.bounce) {
            Some(ray) => self.put(Waiting { ray, path, unused: [0; 3] }),
            None => {
                let trail = Trail { rays: self.bounce + 1, primitive: hit.primitive, t: hit.t };
                // SAFETY: a path is in one queue, once.
                unsafe { self.trails.set(path, trail) };
            }
        }
    }

    #[inline(always)]
    fn taken(&self, index: u32) -> Option<(Ray, u32)> {
        if self.bounce == 0 {
            return (index < self.rays.len()).then(|| (self.rays.load(index), index));
        }
        // SAFETY: the launch before counted these rays; nothing changes the number now.
        let count = unsafe { self.counts.get(self.bounce) }.unwrap_or(0);
        (index < count).then(|| {
            let waiting = self.queue.load(index);
            (waiting.ray, waiting.path)
        })
    }

    /// The threads that are here together find their places with one addition.
    #[inline(always)]
    fn put(&self, waiting: Waiting) {
        let here = arch::together();
        let rank = (here & arch::lanes_below()).count_ones();
        let mut first = 0;
        if rank == 0 {
            // SAFETY: only ever added to, by this launch.
            first = unsafe { arch::add(self.counts.shared(self.bounce + 1), here.count_ones()) };
        }
        // SAFETY: those of `here` come here together.
        first = unsafe { arch::broadcast(here, first, here.trailing_zeros()) };
        // SAFETY: every place is given out once.
        unsafe { self.next.set(first + rank, waiting) };
    }
}

const _: () = assert!(core::mem::size_of::<Waiting>() == 48);
