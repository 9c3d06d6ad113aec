//! Every hit along a ray: in order, each once, in little memory.
//!
//! A structure may show a triangle more than once (a k-d tree does, and so does a hierarchy with spatial splits), and in
//! no strict order. So the next few hits after a given one are collected into a small sorted buffer, which drops what it
//! holds already; then the ray is traced again from the last of them, until a buffer is not full. What comes out is the
//! same for every structure: sorted by distance, then by primitive.

use super::{Counter, Structure, Visitor, START};
use crate::ray::{Hit, Ray};
use crate::triangle::{Across, Triangle};

/// Takes hits one after the other.
pub trait Keep {
    /// The hit of this index along the ray.
    fn keep(&mut self, index: u32, hit: &Hit);
}

/// Nobody keeps the hits: they are only counted.
pub struct Uncollected;

impl Keep for Uncollected {
    #[inline(always)]
    fn keep(&mut self, _: u32, _: &Hit) {}
}

/// Gives the first `limit` hits of a ray to `keep`, in order (see [`Hit::precedes`]), and returns their number.
///
/// Two triangles at the same distance are two hits; what is shown twice with the same distance and primitive is one.
/// `K` hits are found in each pass through the structure, and held in registers.
#[inline(always)]
pub fn all<const K: usize>(
    structure: &impl Structure,
    ray: &Ray,
    limit: u32,
    counter: &mut impl Counter,
    keep: &mut impl Keep,
) -> u32 {
    counter.ray();
    let (mut previous, mut found) = (START, 0);
    while found < limit {
        let next = following::<K>(structure, ray, &previous, counter);
        for hit in &next {
            if hit.is_miss() || found == limit {
                return found;
            }
            keep.keep(found, hit);
            found += 1;
        }
        previous = next[K - 1];
    }
    found
}

/// The first `K` hits after `previous`; misses where there are fewer.
#[inline(always)]
fn following<const K: usize>(
    structure: &impl Structure,
    ray: &Ray,
    previous: &Hit,
    counter: &mut impl Counter,
) -> [Hit; K] {
    let ray = ray.after(previous);
    let (t_min, hits) = (ray.t_min, [Hit { t: ray.t_max, ..Hit::NONE }; K]);
    let mut collected = Collected { previous, t_min, hits };
    structure.traverse(&ray, counter, &mut collected);
    collected.hits
}

/// The first hits after another, sorted; places not yet taken hold misses at the end of the ray.
struct Collected<'a, const K: usize> {
    previous: &'a Hit,
    t_min: f32,
    hits: [Hit; K],
}

impl<const K: usize> Collected<'_, K> {
    /// Moves what comes later one place on. The loop is as long as the array, so that it can be unrolled and the array
    /// kept in registers.
    #[inline(always)]
    fn insert(&mut self, mut hit: Hit) {
        for place in &mut self.hits {
            if hit.t == place.t && hit.primitive == place.primitive {
                return;
            }
            if hit.precedes(place) {
                core::mem::swap(&mut hit, place);
            }
        }
    }
}

impl<const K: usize> Visitor for Collected<'_, K> {
    const ENDS: bool = false;

    #[inline(always)]
    fn visit(&mut self, across: &Across, triangle: &Triangle) -> f32 {
        triangle.if_hit(across, |hit| {
            if hit.t >= self.t_min && self.previous.precedes(&hit) {
                self.insert(hit);
            }
        });
        self.hits[K - 1].t
    }
}
