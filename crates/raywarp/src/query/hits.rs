//! Hits as arrays.

use rayon::prelude::*;

use crate::Hit;
#[cfg(doc)]
use crate::MISS;

/// Hits as arrays, one item a hit.
///
/// A miss is `t = inf`, `primitive` and `geometry` [`MISS`], `uv` zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hits {
    /// Distance in units of the ray's direction.
    pub t: Vec<f32>,
    /// Index of the triangle within the mesh of its instance, or the number that the triangle was given.
    pub primitive: Vec<u32>,
    /// Index of the instance in the scene, 0 where there was no scene.
    pub geometry: Vec<u32>,
    /// Barycentric weights of vertices 1 and 2; vertex 0 weighs `1 - u - v`.
    pub uv: Vec<[f32; 2]>,
}

impl Hits {
    /// Number of items, misses included.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// Room for so many more.
    pub(super) fn reserve(&mut self, more: usize) {
        self.t.reserve(more);
        self.primitive.reserve(more);
        self.geometry.reserve(more);
        self.uv.reserve(more);
    }

    /// Adds what a kernel found.
    pub(super) fn extend(&mut self, found: &[Hit]) {
        self.t.par_extend(found.par_iter().map(|hit| hit.t));
        self.primitive.par_extend(found.par_iter().map(|hit| hit.primitive));
        self.geometry.par_extend(found.par_iter().map(|hit| hit.instance));
        self.uv.par_extend(found.par_iter().map(|hit| [hit.u, hit.v]));
    }

    /// Adds the items of `more` at the end.
    pub fn append(&mut self, more: &mut Self) {
        self.t.append(&mut more.t);
        self.primitive.append(&mut more.primitive);
        self.geometry.append(&mut more.geometry);
        self.uv.append(&mut more.uv);
    }
}

/// Every hit of each ray of a batch: those of ray `i` are the items `offsets[i]..offsets[i + 1]` of [`hits`](Self::hits),
/// by distance, then by primitive.
#[derive(Clone, Debug, PartialEq)]
pub struct AllHits {
    /// Ascending from 0; one more than there are rays.
    pub offsets: Vec<u64>,
    /// The hits of all rays, without misses.
    pub hits: Hits,
}

impl Default for AllHits {
    fn default() -> Self {
        Self { offsets: vec![0], hits: Hits::default() }
    }
}

impl AllHits {
    /// Adds the rays of `more` at the end.
    pub fn append(&mut self, more: &mut Self) {
        let before = self.offsets.last().copied().unwrap_or(0);
        self.offsets.extend(more.offsets.drain(..).skip(1).map(|offset| before + offset));
        self.hits.append(&mut more.hits);
        *more = Self::default();
    }
}
