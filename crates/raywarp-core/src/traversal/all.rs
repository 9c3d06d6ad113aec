//! Every hit along a ray: in order, each once, in little memory.
//!
//! A structure may show a triangle more than once (a k-d tree does, and so does a hierarchy with spatial splits), and in
//! no strict order. So the next few hits after a given one are collected into a small sorted buffer, which drops what it
//! holds already; then the ray is traced again from the last of them, until a buffer is not full. What comes out is the
//! same for every structure: sorted by distance, then by instance and primitive.
//!
//! Where a buffer is full of hits at one distance, there may be thousands: coincident triangles, which no pass could
//! leave out. Those are [numbered](coincident), many a pass.

use super::{Counter, Structure, Visitor, START};
use crate::ray::{Hit, Ray, MISS};
use crate::triangle::{RayShear, Triangle};

/// Takes hits.
pub trait Keep {
    /// Whether anything is done with them.
    const KEEPS: bool = true;

    /// The hit of this index along the ray. Of hits at one distance the same may come again, and a later one before an
    /// earlier one.
    fn keep(&mut self, index: u32, hit: &Hit);
}

/// Nobody keeps the hits: they are only counted.
pub struct Uncollected;

impl Keep for Uncollected {
    const KEEPS: bool = false;

    #[inline(always)]
    fn keep(&mut self, _: u32, _: &Hit) {}
}

/// Gives the first `limit` hits of a ray to `keep`, in order (see [`Hit::precedes`]), and returns their number.
///
/// Two triangles at the same distance are two hits; what is shown twice at the same distance is one.
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
        if next[0].t == previous.t {
            found = coincident(structure, ray, &previous, found, limit, counter, keep);
            (previous.instance, previous.primitive) = (MISS, MISS);
        }
    }
    found
}

/// Gives `keep` all hits at the distance of `previous` that come after it, of which `found` hits come before, and returns
/// the number with them.
///
/// The triangles are taken window by window: a pass marks those that are hit, each once, however often the structure shows
/// it; the marks before one say which hit it is, so a second pass can keep them in any order.
#[cold]
#[cfg_attr(target_arch = "nvptx64", inline(never))]
fn coincident<K: Keep>(
    structure: &impl Structure,
    ray: &Ray,
    previous: &Hit,
    mut found: u32,
    limit: u32,
    counter: &mut impl Counter,
    keep: &mut K,
) -> u32 {
    let ray = Ray { t_min: previous.t, t_max: previous.t, ..*ray };
    let mut window = Window::new(previous.t, (previous.instance, previous.primitive + 1), WIDTH);
    while found < limit {
        structure.traverse(&ray, counter, &mut window);
        let count = window.before(window.end());
        if K::KEEPS && count > 0 {
            structure.traverse(&ray, counter, &mut Numbered { window: &window, found, limit, keep });
        }
        found += count.min(limit - found);
        match window.next(count) {
            Some(next) => window = next,
            None => break,
        }
    }
    found
}

/// Words of a window's marks: as much memory as a traversal's stack.
const WORDS: usize = 64;

/// Triangles of a window.
const WIDTH: u32 = WORDS as u32 * 32;

/// Which of some triangles in a row are hit at a distance: `row` primitives of an instance, then the first `row` of the next
/// one, and so on.
struct Window {
    t: f32,
    /// Instance and primitive of the first.
    first: (u32, u32),
    /// A power of two, at most [`WIDTH`].
    row: u32,
    /// A bit each.
    hit: [u32; WORDS],
    /// The first triangle that is hit and has no place here; [`MISS`] for none. What comes behind it is of no account.
    beyond: (u32, u32),
}

impl Window {
    #[inline(always)]
    fn new(t: f32, first: (u32, u32), row: u32) -> Self {
        Self { t, first, row, hit: [0; WORDS], beyond: (MISS, MISS) }
    }

    /// The place of a hit at the distance, from the window's first triangle on.
    #[inline(always)]
    fn place(&self, hit: &Hit) -> Option<u32> {
        let rows = hit.instance - self.first.0;
        let column = if rows == 0 { hit.primitive - self.first.1 } else { hit.primitive };
        (column < self.row && rows < WIDTH / self.row).then(|| rows * self.row + column)
    }

    #[inline(always)]
    fn takes(&self, hit: &Hit) -> bool {
        hit.t == self.t && hit.id() >= self.first
    }

    /// Places of triangles that come before what is beyond are below this.
    #[inline(always)]
    fn end(&self) -> u32 {
        let rows = self.beyond.0 - self.first.0;
        if self.beyond.0 == MISS || rows >= WIDTH / self.row {
            WIDTH
        } else {
            (rows + 1) * self.row
        }
    }

    /// How many of the first `end` triangles are hit.
    #[inline(always)]
    fn before(&self, end: u32) -> u32 {
        let whole = self.hit.iter().take(end as usize / 32).map(|word| word.count_ones()).sum::<u32>();
        let part = self.hit.get(end as usize / 32).map_or(0, |word| (word & ((1 << (end % 32)) - 1)).count_ones());
        whole + part
    }

    /// The window of what is beyond this one, in which `count` were hit. Its rows are longer where this one's were too short,
    /// and shorter where few places were taken: many instances may lie on each other as well as many triangles of one.
    #[inline(always)]
    fn next(&self, count: u32) -> Option<Self> {
        let row = if self.beyond.0 == self.first.0 || self.beyond.1 >= self.row {
            (self.row * 4).min(WIDTH)
        } else if count < WIDTH / 4 {
            (self.row / 4).max(1)
        } else {
            self.row
        };
        (self.beyond.0 != MISS).then(|| Self::new(self.t, self.beyond, row))
    }
}

impl Visitor for Window {
    const ORDERED: bool = false;
    const ENDS: bool = false;

    #[inline(always)]
    fn visit(&mut self, shear: &RayShear, triangle: &Triangle) -> f32 {
        triangle.if_hit(shear, |hit| {
            if self.takes(&hit) {
                match self.place(&hit) {
                    Some(place) => self.hit[place as usize / 32] |= 1 << (place % 32),
                    None if hit.id() < self.beyond => self.beyond = hit.id(),
                    None => (),
                }
            }
        });
        self.t
    }
}

/// Keeps the hits of a window that is complete.
struct Numbered<'a, K> {
    window: &'a Window,
    /// Hits before those of the window.
    found: u32,
    limit: u32,
    keep: &'a mut K,
}

impl<K: Keep> Visitor for Numbered<'_, K> {
    const ORDERED: bool = false;
    const ENDS: bool = false;

    #[inline(always)]
    fn visit(&mut self, shear: &RayShear, triangle: &Triangle) -> f32 {
        triangle.if_hit(shear, |hit| {
            let place = if self.window.takes(&hit) { self.window.place(&hit) } else { None };
            if let Some(place) = place.filter(|&place| place < self.window.end()) {
                let index = self.found + self.window.before(place);
                if index < self.limit {
                    self.keep.keep(index, &hit);
                }
            }
        });
        self.window.t
    }
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
            if hit.t == place.t && hit.id() == place.id() {
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
    fn visit(&mut self, shear: &RayShear, triangle: &Triangle) -> f32 {
        triangle.if_hit(shear, |hit| {
            if hit.t >= self.t_min && self.previous.precedes(&hit) {
                self.insert(hit);
            }
        });
        self.hits[K - 1].t
    }
}
