//! Kernels that turn what was traced into pixels of a screen, where it was traced: a picture of a screen's bytes is a
//! quarter of the sums that it comes from, and a viewer fetches one for every frame.

use crate::display::{rgba, Tone};
use crate::false_color::{self, is_miss};
use crate::film::Pixel;
use crate::kernels::{FirstHit, Thread};
use crate::math::Vec3;
use crate::traversal::Tests;
use crate::view::{View, ViewMut};

/// Sums of a picture under way: the rows are exposed from the top, sample by sample.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Exposed {
    /// Sums, row by row.
    pub pixels: View<Pixel>,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Samples of every pixel.
    pub samples: u32,
    /// Rows from the top that have one sample more.
    pub ahead: u32,
}

impl Exposed {
    /// No picture.
    pub const NONE: Self = Self { pixels: View::EMPTY, size: [0; 2], samples: 0, ahead: 0 };

    /// Mean radiance of a pixel; nothing before its first sample.
    #[inline(always)]
    fn mean(&self, x: u32, y: u32) -> Option<Vec3> {
        let samples = self.samples + (y < self.ahead) as u32;
        if samples == 0 || self.pixels.is_empty() {
            return None;
        }
        Some(self.pixels.load(y * self.size[0] + x).mean(samples as f32).unwrap_or(Vec3::ZERO))
    }
}

/// Develops a film, one thread a pixel.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ToneMapFilm {
    /// What to show.
    pub film: Exposed,
    /// Of any size, shown where `film` has no sample yet.
    pub under: Exposed,
    /// Exposure and curve.
    pub tone: Tone,
    /// One a pixel of `film`, written.
    pub screen: ViewMut<u32>,
}

impl ToneMapFilm {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let Thread { x, y } = thread;
        let [width, height] = self.film.size;
        if x >= width || y >= height {
            return;
        }
        let radiance = self.film.mean(x, y).or_else(|| self.below(x, y)).unwrap_or(Vec3::ZERO);
        // SAFETY: one thread a pixel.
        unsafe { self.screen.set(y * width + x, rgba(self.tone.color(radiance))) };
    }

    /// The nearest pixel of the picture below. A picture's side is at most 2^16 pixels, so products fit 32 bits.
    #[inline(always)]
    fn below(&self, x: u32, y: u32) -> Option<Vec3> {
        let nearest = |i: u32, own: u32, other: u32| ((2 * i as u64 + 1) * other as u64 / (2 * own as u64)) as u32;
        let [width, height] = self.under.size;
        self.under.mean(nearest(x, self.film.size[0], width), nearest(y, self.film.size[1], height))
    }
}

/// What a debug view shows, one of [`quantity`].
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// One of [`quantity`].
    pub quantity: u32,
    /// One a pixel, for those that are about what the camera sees.
    pub first_hits: View<FirstHit>,
    /// One a pixel, for the cost in tests.
    pub tests: View<Tests>,
    /// One a pixel, for the cost in time.
    pub ticks: View<u32>,
}

/// What can be shown instead of a picture.
pub mod quantity {
    /// Shading normals.
    pub const NORMAL: u32 = 0;
    /// Distance along the camera ray.
    pub const DEPTH: u32 = 1;
    /// Diffuse colour.
    pub const ALBEDO: u32 = 2;
    /// A colour a triangle.
    pub const PRIMITIVE: u32 = 3;
    /// A colour a material.
    pub const MATERIAL: u32 = 4;
    /// Nodes and triangles tested.
    pub const TESTS: u32 = 5;
    /// Time that the pixel's thread took.
    pub const TICKS: u32 = 6;
}

impl Shown {
    /// The pixel's place in a range, for quantities that have one.
    #[inline(always)]
    fn value(&self, index: u32) -> Option<f32> {
        match self.quantity {
            quantity::TESTS => Some(false_color::cost(&self.tests.at(index)) as f32),
            quantity::TICKS => Some(self.ticks.at(index) as f32),
            _ => {
                let first_hit = self.first_hits.item(index);
                (!is_miss(first_hit) && first_hit.depth.is_finite()).then_some(first_hit.depth)
            }
        }
    }

    #[inline(always)]
    fn color(&self, index: u32, low: f32, high: f32) -> [u8; 3] {
        if self.quantity >= quantity::TESTS {
            return false_color::heat(false_color::share(self.value(index).unwrap_or(low), low, high));
        }
        let first_hit = self.first_hits.item(index);
        if is_miss(first_hit) {
            return false_color::NOTHING;
        }
        match self.quantity {
            quantity::NORMAL => false_color::normal(first_hit.normal),
            quantity::DEPTH => false_color::depth(false_color::share(first_hit.depth, low, high)),
            quantity::ALBEDO => false_color::albedo(first_hit.albedo),
            quantity::PRIMITIVE => false_color::triangle(first_hit.instance, first_hit.primitive),
            _ => false_color::index(first_hit.material),
        }
    }
}

/// Smallest and largest value of each row, one thread a row; inverted where there is none.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AovRanges {
    /// Of what.
    pub shown: Shown,
    /// Columns and rows.
    pub size: [u32; 2],
    /// One a row, written.
    pub ranges: ViewMut<[f32; 2]>,
}

impl AovRanges {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let [width, height] = self.size;
        if thread.x >= height {
            return;
        }
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for x in 0..width {
            if let Some(value) = self.shown.value(thread.x * width + x) {
                range = [crate::arch::min(range[0], value), crate::arch::max(range[1], value)];
            }
        }
        // SAFETY: one thread a row.
        unsafe { self.ranges.set(thread.x, range) };
    }
}

/// Shows a quantity in false colours, one thread a pixel.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DrawAov {
    /// Which.
    pub shown: Shown,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Values of the first and of the last colour.
    pub range: [f32; 2],
    /// One a pixel, written.
    pub screen: ViewMut<u32>,
}

impl DrawAov {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let [width, height] = self.size;
        if thread.x >= width || thread.y >= height {
            return;
        }
        let index = thread.y * width + thread.x;
        let color = self.shown.color(index, self.range[0], self.range[1]);
        // SAFETY: one thread a pixel.
        unsafe { self.screen.set(index, rgba(color)) };
    }
}
