//! What can be launched: each kernel is its parameter block, and one thread of it a plain function.

use core::marker::PhantomData;

use crate::arch;
use crate::camera::{pixel_centre, Camera};
use crate::film::Pixel;
use crate::math::Vec3;
use crate::name::Name;
use crate::ray::{Hit, HitArrays, Ray};
use crate::sample::{combine, stratified};
use crate::shade::whitted::{trace, visible, Limits};
use crate::surface::Scene;
use crate::traversal::query::{query, AnyHit, ClosestHit};
use crate::traversal::{all, Keep, NullStatistics, RecordedStatistics, Stage, Structure, Uncollected, START};
use crate::view::{View, ViewMut};
use crate::wavefront::{Shadow, Visible};

/// Which thread of a launch this is: column and row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Thread {
    /// From 0, to the right.
    pub x: u32,
    /// From 0, downwards.
    pub y: u32,
}

/// A kernel: its parameters, and what one of its threads does.
///
/// # Safety
/// `NAME` is the entry point that takes this very block by value.
pub unsafe trait Kernel: Copy + Send + Sync {
    /// Name of the entry point in the PTX.
    const NAME: &'static str;

    /// Work of one thread. Threads beyond the edge of the launch do nothing.
    ///
    /// # Safety
    /// The views in the block are good for this launch (see [`View::new`]), and no other call of it has this index.
    unsafe fn thread(&self, thread: Thread);
}

/// Which part of a picture a launch computes, and how finely.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Where the rays come from.
    pub camera: Camera,
    /// First column, row of this launch within the picture.
    pub origin: [u32; 2],
    /// Columns, rows of this launch.
    pub extent: [u32; 2],
    /// Column of the film's first pixel within the picture, its row, and the film's width.
    pub film: [u32; 3],
    /// First sample of this launch, the one after its last, and how many a pixel gets in all.
    pub samples: [u32; 3],
    /// Changes the random numbers.
    pub seed: u32,
}

impl Frame {
    /// The thread's pixel in the picture and its index in the film; none beyond the edge.
    #[inline(always)]
    fn pixel(&self, thread: Thread) -> Option<(u32, u32, u32)> {
        let (x, y) = (self.origin[0] + thread.x, self.origin[1] + thread.y);
        let inside = thread.x < self.extent[0] && thread.y < self.extent[1];
        inside.then(|| (x, y, (y - self.film[1]) * self.film[2] + (x - self.film[0])))
    }
}

/// Adds samples of the paper's shading to the film, one thread a pixel.
#[repr(C)]
pub struct Whitted<S, C: RecordedStatistics> {
    /// Where to find hits.
    pub structure: S,
    /// What is there.
    pub scene: Scene,
    /// Which pixels and samples.
    pub frame: Frame,
    /// Bounces, shadows.
    pub limits: Limits,
    /// Sums, read and written.
    pub film: ViewMut<Pixel>,
    /// What `C` counts, read and written.
    pub counts: ViewMut<C::Record>,
    /// Time that the pixel's thread took, see [`arch::clock`], read and written where `C` counts.
    pub ticks: ViewMut<u32>,
    /// Whether to count.
    pub counter: PhantomData<C>,
}

impl<S: Structure, C: RecordedStatistics> Whitted<S, C> {
    #[inline(always)]
    fn run(&self, thread: Thread) {
        let Some((x, y, index)) = self.frame.pixel(thread) else { return };
        // SAFETY: one thread a pixel.
        let Some(mut pixel) = (unsafe { self.film.get(index) }) else { return };
        let [first, end, count] = self.frame.samples;
        let key = combine(combine(self.frame.seed, x), y);
        let mut counter = C::default();
        let start = if C::COUNTS { arch::clock() } else { 0 };
        for sample in first..end {
            counter.stage(Stage::Generation);
            let (dx, dy) = stratified(sample, count, key);
            let ray = self.frame.camera.ray(x as f32 + dx, y as f32 + dy);
            counter.stage(Stage::Shading);
            let (radiance, any) = trace(&self.structure, &self.scene, &self.limits, &ray, &mut counter);
            pixel.radiance += radiance;
            pixel.hits += any as u32 as f32;
            counter.stage(Stage::Shading);
        }
        // SAFETY: one thread a pixel.
        unsafe { self.film.set(index, pixel) };
        if C::COUNTS {
            self.keep(index, &counter, arch::clock().wrapping_sub(start));
        }
    }

    #[inline(always)]
    fn keep(&self, index: u32, counter: &C, ticks: u32) {
        // SAFETY: one thread a pixel.
        if let Some(sum) = unsafe { self.ticks.get(index) } {
            // SAFETY: one thread a pixel.
            unsafe { self.ticks.set(index, sum.saturating_add(ticks)) };
        }
        // SAFETY: one thread a pixel.
        if let Some(record) = unsafe { self.counts.get(index) } {
            // SAFETY: one thread a pixel.
            unsafe { self.counts.set(index, counter.add_to(record, ticks)) };
        }
    }
}

/// What the ray through a pixel's centre meets first: the layers beside the picture.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Distance along the ray in scene units; infinite for a miss.
    pub depth: f32,
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Index of the triangle in its mesh, [`MISS`](crate::ray::MISS) for none.
    pub primitive: u32,
    /// Unit shading normal, on the side that is seen.
    pub normal: Vec3,
    /// Index of the material, [`MISS`](crate::ray::MISS) for none.
    pub material: u32,
    /// Diffuse colour with textures.
    pub albedo: Vec3,
    /// Index of the instance, [`MISS`](crate::ray::MISS) for none.
    pub instance: u32,
    /// World position.
    pub position: Vec3,
    /// Coverage of the surface, 0 for a miss.
    pub coverage: f32,
}

impl FirstHit {
    /// Nothing there.
    pub const NONE: Self = Self {
        depth: f32::INFINITY,
        uv: [0.0; 2],
        primitive: crate::ray::MISS,
        normal: Vec3::ZERO,
        material: crate::ray::MISS,
        albedo: Vec3::ZERO,
        instance: crate::ray::MISS,
        position: Vec3::ZERO,
        coverage: 0.0,
    };
}

/// Finds the first hit of each pixel.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FirstHits<S> {
    /// Where to find hits.
    pub structure: S,
    /// What is there.
    pub scene: Scene,
    /// Which pixels.
    pub frame: Frame,
    /// One a pixel, written.
    pub first_hits: ViewMut<FirstHit>,
}

impl<S: Structure> FirstHits<S> {
    #[inline(always)]
    fn run(&self, thread: Thread) {
        let Some((x, y, index)) = self.frame.pixel(thread) else { return };
        let centre = pixel_centre(x, y);
        let ray = self.frame.camera.ray(centre.x, centre.y);
        let hit = visible(&self.structure, &self.scene, &ray, &START, &mut NullStatistics);
        // SAFETY: one thread a pixel.
        unsafe { self.first_hits.set(index, self.first_hit(&ray, &hit)) };
    }

    #[inline(always)]
    fn first_hit(&self, ray: &Ray, hit: &Hit) -> FirstHit {
        if hit.is_miss() {
            return FirstHit::NONE;
        }
        let index = self.scene.material_index::<S::Space>(hit);
        let material = self.scene.materials.item(index);
        let surface = self.scene.surface::<S::Space>(ray, hit, material);
        FirstHit {
            depth: hit.t,
            uv: surface.uv,
            primitive: hit.primitive,
            normal: surface.normal,
            material: index,
            albedo: material.diffuse * surface.tint,
            instance: hit.instance,
            position: surface.point,
            coverage: surface.coverage,
        }
    }
}

/// A thread has the ray brought closer that comes so many after its own: on large GPUs the next threads to run are those
/// of about that ray, and they would all begin by waiting for the slowest memory.
const AHEAD: u32 = 1 << 16;

/// The thread's ray of a batch; none beyond the end.
#[inline(always)]
fn ray_of(rays: &View<Ray>, thread: Thread) -> Option<Ray> {
    rays.prefetch(thread.x.saturating_add(AHEAD));
    (thread.x < rays.len()).then(|| rays.load(thread.x).within_range())
}

/// The closest hit of each ray of a batch.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Closest<S> {
    /// Where to find hits.
    pub structure: S,
    /// The batch.
    pub rays: View<Ray>,
    /// One a ray, written.
    pub hits: HitArrays,
}

impl<S: Structure> Closest<S> {
    #[inline(always)]
    fn run(&self, thread: Thread) {
        if let Some(ray) = ray_of(&self.rays, thread) {
            let hit = query::<ClosestHit>(&self.structure, &ray);
            // SAFETY: one thread a ray.
            unsafe { self.hits.set(thread.x, &hit) };
        }
    }
}

/// Whether each ray of a batch is stopped before its end; every triangle counts as opaque.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Occluded<S> {
    /// Where to find hits.
    pub structure: S,
    /// The batch.
    pub rays: View<Ray>,
    /// 0 or 1 a ray, written.
    pub occluded: ViewMut<u32>,
}

impl<S: Structure> Occluded<S> {
    #[inline(always)]
    fn run(&self, thread: Thread) {
        if let Some(ray) = ray_of(&self.rays, thread) {
            let occluded = query::<AnyHit>(&self.structure, &ray);
            // SAFETY: one thread a ray.
            unsafe { self.occluded.set(thread.x, occluded) };
        }
    }
}

/// Hits that are collected at once; see [`all`]. More take more registers, fewer more passes through the structure.
const COLLECTED: usize = 4;

/// Hits that are counted at once: of these only distance and primitive take registers.
const COUNTED: usize = 8;

/// How many hits each ray of a batch has.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Count<S> {
    /// Where to find hits.
    pub structure: S,
    /// The batch.
    pub rays: View<Ray>,
    /// Counting ends here.
    pub limit: u32,
    /// One a ray, written.
    pub counts: ViewMut<u32>,
}

impl<S: Structure> Count<S> {
    #[inline(always)]
    fn run(&self, thread: Thread) {
        if let Some(ray) = ray_of(&self.rays, thread) {
            let count = all::<COUNTED>(&self.structure, &ray, self.limit, &mut NullStatistics, &mut Uncollected);
            // SAFETY: one thread a ray.
            unsafe { self.counts.set(thread.x, count) };
        }
    }
}

/// The hits of each ray of a batch, in order.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct All<S> {
    /// Where to find hits.
    pub structure: S,
    /// The batch.
    pub rays: View<Ray>,
    /// Place of each ray's first hit, and after the last ray that of the end: ascending, one more than there are rays.
    /// Empty: the hits of ray `i` begin at `i * limit`.
    pub offsets: View<u32>,
    /// Most hits of a ray.
    pub limit: u32,
    /// One a ray, written.
    pub counts: ViewMut<u32>,
    /// Written; what a ray does not fill stays as it was.
    pub hits: HitArrays,
}

impl<S: Structure> All<S> {
    #[inline(always)]
    fn run(&self, thread: Thread) {
        if let Some(ray) = ray_of(&self.rays, thread) {
            let (first, storage) = self.place(thread.x);
            let mut row = Row { hits: self.hits, first };
            let count = all::<COLLECTED>(&self.structure, &ray, storage, &mut NullStatistics, &mut row);
            // SAFETY: one thread a ray.
            unsafe { self.counts.set(thread.x, count) };
        }
    }

    /// Where a ray's hits go, and how many fit.
    #[inline(always)]
    fn place(&self, ray: u32) -> (u32, u32) {
        if self.offsets.is_empty() {
            return (ray * self.limit, self.limit);
        }
        let first = self.offsets.at(ray);
        (first, self.offsets.at(ray + 1) - first)
    }
}

/// Room for the hits of one ray.
struct Row {
    hits: HitArrays,
    first: u32,
}

impl Keep for Row {
    #[inline(always)]
    fn keep(&mut self, index: u32, hit: &Hit) {
        // SAFETY: whoever launches gives each ray a place of its own, at least as long as `index` becomes.
        unsafe { self.hits.set(self.first + index, hit) };
    }
}

// Derived copies would ask the same of the marker types.
impl<S: Copy, C: RecordedStatistics> Clone for Whitted<S, C> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Copy, C: RecordedStatistics> Copy for Whitted<S, C> {}

macro_rules! of_structures {
    ($($name:literal: $kernel:ident<$structure:ident $(, $counter:ident)?>, $suffix:expr;)*) => {$(
        // SAFETY: `for_each_kernel` gives the PTX its entry points by the names that are put together here, and so do the
        // lists of other crates; a test of each compares them.
        unsafe impl<$structure: Structure $(, $counter: RecordedStatistics)?> Kernel for $kernel<$structure $(, $counter)?> {
            const NAME: &'static str = const { &Name::of([$name, $structure::NAME, $suffix]) }.text();
            #[inline(always)]
            unsafe fn thread(&self, thread: Thread) {
                self.run(thread)
            }
        }
    )*};
}

of_structures! {
    "visible_": Visible<S>, "";
    "shadow_": Shadow<S>, "";
    "whitted_": Whitted<S, C>, C::SUFFIX;
    "first_hits_": FirstHits<S>, "";
    "closest_": Closest<S>, "";
    "occluded_": Occluded<S>, "";
    "count_": Count<S>, "";
    "all_": All<S>, "";
}

/// Gives `$use` the list of every kernel with the name of its entry point. The PTX has these and no others.
#[macro_export]
macro_rules! for_each_kernel {
    ($use:ident) => {
        $crate::for_each_other_kernel! {
            $use,
            whitted_brute: $crate::kernels::Whitted<$crate::traversal::Brute, $crate::traversal::NullStatistics>,
            whitted_kd: $crate::kernels::Whitted<$crate::traversal::KdTree, $crate::traversal::NullStatistics>,
            whitted_bvh2: $crate::kernels::Whitted<$crate::traversal::Bvh2, $crate::traversal::NullStatistics>,
            whitted_brute_counted: $crate::kernels::Whitted<$crate::traversal::Brute, $crate::traversal::Tests>,
            whitted_kd_counted: $crate::kernels::Whitted<$crate::traversal::KdTree, $crate::traversal::Tests>,
            whitted_bvh2_counted: $crate::kernels::Whitted<$crate::traversal::Bvh2, $crate::traversal::Tests>,
            whitted_two_level: $crate::kernels::Whitted<$crate::traversal::TwoLevel, $crate::traversal::NullStatistics>,
            whitted_two_level_counted: $crate::kernels::Whitted<$crate::traversal::TwoLevel, $crate::traversal::Tests>,
            first_hits_brute: $crate::kernels::FirstHits<$crate::traversal::Brute>,
            first_hits_kd: $crate::kernels::FirstHits<$crate::traversal::KdTree>,
            first_hits_bvh2: $crate::kernels::FirstHits<$crate::traversal::Bvh2>,
            first_hits_two_level: $crate::kernels::FirstHits<$crate::traversal::TwoLevel>,
            closest_brute: $crate::kernels::Closest<$crate::traversal::Brute>,
            closest_kd: $crate::kernels::Closest<$crate::traversal::KdTree>,
            closest_bvh2: $crate::kernels::Closest<$crate::traversal::Bvh2>,
            closest_two_level: $crate::kernels::Closest<$crate::traversal::TwoLevel>,
            closest_bvh: $crate::kernels::Closest<$crate::traversal::DualBvh2>,
            occluded_brute: $crate::kernels::Occluded<$crate::traversal::Brute>,
            occluded_kd: $crate::kernels::Occluded<$crate::traversal::KdTree>,
            occluded_bvh2: $crate::kernels::Occluded<$crate::traversal::Bvh2>,
            occluded_two_level: $crate::kernels::Occluded<$crate::traversal::TwoLevel>,
            occluded_bvh: $crate::kernels::Occluded<$crate::traversal::DualBvh2>,
            count_brute: $crate::kernels::Count<$crate::traversal::Brute>,
            count_kd: $crate::kernels::Count<$crate::traversal::KdTree>,
            count_bvh2: $crate::kernels::Count<$crate::traversal::Bvh2>,
            count_two_level: $crate::kernels::Count<$crate::traversal::TwoLevel>,
            all_brute: $crate::kernels::All<$crate::traversal::Brute>,
            all_kd: $crate::kernels::All<$crate::traversal::KdTree>,
            all_bvh2: $crate::kernels::All<$crate::traversal::Bvh2>,
            all_two_level: $crate::kernels::All<$crate::traversal::TwoLevel>,
            visible_brute: $crate::wavefront::Visible<$crate::traversal::Brute>,
            visible_kd: $crate::wavefront::Visible<$crate::traversal::KdTree>,
            visible_bvh2: $crate::wavefront::Visible<$crate::traversal::Bvh2>,
            visible_two_level: $crate::wavefront::Visible<$crate::traversal::TwoLevel>,
            shadow_brute: $crate::wavefront::Shadow<$crate::traversal::Brute>,
            shadow_kd: $crate::wavefront::Shadow<$crate::traversal::KdTree>,
            shadow_bvh2: $crate::wavefront::Shadow<$crate::traversal::Bvh2>,
            shadow_two_level: $crate::wavefront::Shadow<$crate::traversal::TwoLevel>,
        }
    };
}

/// As [`for_each_kernel`], of these kernels and those that are not of any structure.
#[doc(hidden)]
#[macro_export]
macro_rules! for_each_other_kernel {
    ($use:ident, $($others:tt)*) => {
        $use! {
            $($others)*
            closest_bvh_persistent: $crate::persistent::Persistent<$crate::traversal::query::ClosestHit>,
            occluded_bvh_persistent: $crate::persistent::Persistent<$crate::traversal::query::AnyHit>,
            tone_map_film: $crate::screen::ToneMapFilm,
            aov_ranges: $crate::screen::AovRanges,
            draw_aov: $crate::screen::DrawAov,
            closest_point: $crate::closest_point::ClosestPoint,
            gather_rays: $crate::gather::GatherRays,
            reshape: $crate::refit::Reshape,
            refit: $crate::refit::Refit,
            find_parents: $crate::refit::FindParents,
            survey_triangles: $crate::build::survey::Survey,
            morton_codes: $crate::build::morton::MortonCodes,
            count_digits: $crate::build::radix_sort::CountDigits,
            scan_digits: $crate::build::radix_sort::ScanDigits,
            scatter_digits: $crate::build::radix_sort::ScatterDigits,
            hploc: $crate::build::hploc::Hploc,
            emit_nodes: $crate::build::emit::EmitNodes,
            gather_triangles: $crate::build::gather::GatherTriangles,
            camera_rays: $crate::wavefront::CameraRays,
            shade: $crate::wavefront::Shade,
            add_light: $crate::wavefront::AddLight,
            add_to_film: $crate::wavefront::AddToFilm,
            emitter_powers: $crate::lights::EmitterPowers,
        }
    };
}

macro_rules! implement {
    ($($name:ident: $kernel:ty),* $(,)?) => {$(
        // SAFETY: `for_each_kernel` gives the PTX its entry points by the same names and types.
        unsafe impl Kernel for $kernel {
            const NAME: &'static str = stringify!($name);
            #[inline(always)]
            unsafe fn thread(&self, thread: Thread) {
                self.run(thread)
            }
        }
    )*};
}

for_each_other_kernel!(implement,);

macro_rules! names {
    ($($name:ident: $kernel:ty),* $(,)?) => {
        /// Every entry point of the PTX.
        pub const NAMES: &[&str] = &[$(stringify!($name)),*];
    };
}

for_each_kernel!(names);

#[cfg(test)]
mod tests {
    use super::Kernel;

    macro_rules! check {
        ($($name:ident: $kernel:ty),* $(,)?) => {
            #[test]
            fn kernels_have_the_names_of_their_entry_points() {
                $(assert_eq!(<$kernel as Kernel>::NAME, stringify!($name));)*
            }
        };
    }

    for_each_kernel!(check);
}
