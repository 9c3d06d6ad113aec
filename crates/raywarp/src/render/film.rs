//! A picture that grows on its device, for those who look on: sample by sample, in launches as short as they are asked
//! to be, developed where it is.

use raywarp_core::false_color::cost;
use raywarp_core::film::Pixel;
use raywarp_core::kernels::{FirstHit, Frame};
use raywarp_core::screen::{AovRanges, DrawAov, Exposed, Shown, ToneMapFilm};
use raywarp_core::shade::whitted::Limits;
use raywarp_core::traversal::Tests;
use raywarp_core::view::{View, ViewMut};
use raywarp_device::kernels::{Timed, Views};

use super::{camera, passes, RenderError, RenderOptions, Tracer};
use crate::device::{Buffer, Device};
use crate::image::heatmap::{percentile, PERCENT};
use crate::image::Development;
use crate::scene::Camera;

/// Rows of a launch are a multiple of this, which is a multiple of every tile and block.
const ROWS: u32 = 16;

/// Most costs that a percentile is found of: those of every other pixel, or so, where a picture has more.
const MOST_COSTS: usize = 1 << 18;

/// Pixel samples a second of the first launch, before anything is known.
const FIRST_ON_CPU: f64 = 1e6;
const FIRST_ON_GPU: f64 = 2e8;

/// Sums of a picture under way and its pixels as a screen shows them. When all samples are taken, the sums are those of
/// [`Tracer::render`] to the bit, and the screen is its PNG.
#[derive(Debug)]
pub struct Film {
    device: Device,
    size: [u32; 2],
    pixels: Buffer<Pixel>,
    screen: Buffer<u32>,
    samples: u32,
    ahead: u32,
    /// Pixel samples a second of kernel time.
    rate: f64,
}

/// What an exposure did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exposure {
    /// Seconds that the kernels ran.
    pub kernel_seconds: f64,
    /// Pixels times samples that were taken.
    pub pixel_samples: u64,
    /// Whether every pixel has all of its samples.
    pub complete: bool,
}

/// What to show instead of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Shading normals: x, y, z as red, green, blue.
    Normal,
    /// Distance along the camera ray: white in front, dark grey at the far end.
    Depth,
    /// Diffuse colour.
    Albedo,
    /// A colour a triangle.
    Primitive,
    /// A colour a material.
    Material,
    /// Nodes and triangles tested by all rays of a pixel.
    Tests,
    /// Time of the pixel's thread: cycles on a GPU, nanoseconds on a CPU.
    Ticks,
}

/// A painted quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Painted {
    /// Values of the first and of the last colour, for quantities that have a scale.
    pub range: [f32; 2],
    /// Seconds that the kernels ran.
    pub kernel_seconds: f64,
}

impl Film {
    /// Without a sample yet.
    ///
    /// # Errors
    /// [`RenderError`] for an impossible size, or a device without room.
    pub fn new(device: &Device, size: [u32; 2]) -> Result<Self, RenderError> {
        let window = RenderOptions { size, ..RenderOptions::default() }.check()?;
        let count = window.pixels();
        let bytes = count * (std::mem::size_of::<Pixel>() + std::mem::size_of::<u32>());
        device.reserve(bytes as u64, "the picture")?;
        let rate = if device.is_cuda() { FIRST_ON_GPU } else { FIRST_ON_CPU };
        let (pixels, screen) = (device.zeroed(count)?, device.zeroed(count)?);
        Ok(Self { device: device.clone(), size, pixels, screen, samples: 0, ahead: 0, rate })
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Samples that every pixel has.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Pixel samples a second, as learnt from the last exposures: for whoever chooses the size of the next picture.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Starts from the rate that another film has learnt.
    pub fn learn(&mut self, rate: f64) {
        self.rate = rate;
    }

    /// Forgets all samples.
    ///
    /// # Errors
    /// [`RenderError`] where the device fails.
    pub fn clear(&mut self) -> Result<(), RenderError> {
        self.pixels.clear()?;
        (self.samples, self.ahead) = (0, 0);
        Ok(())
    }

    /// The pixels as last developed or painted: red, green, blue, 255 from the lowest byte on, sRGB, top row first.
    pub fn screen(&self) -> &Buffer<u32> {
        &self.screen
    }

    /// Makes the screen's pixels from the samples so far. Where there is none yet, those of another film show.
    ///
    /// # Errors
    /// [`RenderError`] where the device fails.
    pub fn tone_map_film(&mut self, development: &Development, under: Option<&Film>) -> Result<f64, RenderError> {
        if let Some(under) = under {
            self.device.check(&under.pixels, "the film below")?;
        }
        let under = under.map_or(Exposed::NONE, Film::exposed);
        let kernel =
            ToneMapFilm { film: self.exposed(), under, tone: development.tone(), screen: self.screen.view_mut() };
        // SAFETY: all buffers are of this device and borrowed while this waits; both films know their sizes.
        Ok(unsafe { Timed::launch(&self.device, &kernel, self.size) }?.wait()?)
    }

    fn exposed(&self) -> Exposed {
        Exposed { pixels: self.pixels.view(), size: self.size, samples: self.samples, ahead: self.ahead }
    }

    /// The next launch for about so many seconds: rows, and samples.
    fn next(&self, spp: u32, seconds: f64) -> Step {
        let [width, height] = self.size;
        let (affordable, pixels) = (self.rate * seconds, f64::from(width) * f64::from(height));
        if self.ahead == 0 && affordable >= pixels {
            let samples = ((affordable / pixels) as u32).clamp(1, spp - self.samples);
            return Step { rows: [0, height], samples };
        }
        let rows = (affordable / f64::from(width)) as u32 / ROWS * ROWS;
        let end = (self.ahead + rows.max(ROWS)).min(height);
        Step { rows: [self.ahead, end], samples: 1 }
    }

    fn took(&mut self, step: Step, seconds: f64) {
        if step.rows[1] == self.size[1] {
            (self.samples, self.ahead) = (self.samples + step.samples, 0);
        } else {
            self.ahead = step.rows[1];
        }
        let rate = step.pixel_samples(self.size[0]) as f64 / seconds.max(1e-6);
        // Launches differ in what they see: half of each new finding, and never a leap.
        self.rate = (0.5 * (self.rate + rate)).clamp(self.rate * 0.25, self.rate * 4.0).max(1.0);
    }
}

#[derive(Clone, Copy)]
struct Step {
    rows: [u32; 2],
    samples: u32,
}

impl Step {
    fn pixel_samples(&self, width: u32) -> u64 {
        u64::from(width) * u64::from(self.rows[1] - self.rows[0]) * u64::from(self.samples)
    }
}

impl Tracer {
    /// Takes more samples for about so many seconds; at least some rows of one. Of the options, `size` is the film's
    /// own, and `crop` and `count_tests` do not count. Camera, depth, shadows, seed and `spp` must stay the same from the
    /// first exposure of a film to the last.
    ///
    /// # Errors
    /// As for [`render`](Self::render).
    pub fn accumulate(
        &self,
        film: &mut Film,
        camera: &Camera,
        options: &RenderOptions,
        seconds: f64,
    ) -> Result<Exposure, RenderError> {
        let options = RenderOptions { size: film.size, crop: None, ..*options };
        options.check()?;
        self.device.check(&film.pixels, "the film")?;
        let mut exposure = Exposure { complete: film.samples >= options.spp, ..Exposure::default() };
        if exposure.complete {
            return Ok(exposure);
        }
        let step = film.next(options.spp, seconds);
        let [width, height] = film.size;
        let lights = self.scene.appearance()?.lighting.upload(&self.device, camera)?;
        let pass = passes::Pass {
            scene: self.scene.appearance()?.view(&lights),
            frame: Frame {
                camera: camera::kernel_camera(camera, film.size)?,
                origin: [0, step.rows[0]],
                extent: [width, step.rows[1] - step.rows[0]],
                film: [0, 0, width],
                samples: [film.samples, film.samples + step.samples, options.spp],
                seed: options.seed,
            },
            limits: Limits { depth: options.max_depth, shadows: options.shadows as u32 },
            film: film.pixels.view_mut(),
            tests: ViewMut::EMPTY,
            ticks: ViewMut::EMPTY,
        };
        exposure.kernel_seconds = self.take_samples(options.integrator, &pass)?.wait()?;
        exposure.pixel_samples = step.pixel_samples(width);
        film.took(step, exposure.kernel_seconds);
        exposure.complete = film.samples >= options.spp && step.rows[1] == height;
        Ok(exposure)
    }

    /// Paints a quantity on the film's screen; its samples stay. Without a range, that of the picture: of distances, and of
    /// costs from 0 to what [`PERCENT`] percent of the pixels do not exceed.
    ///
    /// # Errors
    /// As for [`render`](Self::render).
    pub fn draw_aov(
        &self,
        film: &mut Film,
        camera: &Camera,
        options: &RenderOptions,
        quantity: Quantity,
        range: Option<[f32; 2]>,
    ) -> Result<Painted, RenderError> {
        let options = RenderOptions { size: film.size, crop: None, spp: 1, ..*options };
        let window = options.check()?;
        let costs = matches!(quantity, Quantity::Tests | Quantity::Ticks);
        let (seen, counted) = if costs { (0, window.pixels()) } else { (window.pixels(), 0) };
        let mut first_hits = self.device.zeroed::<FirstHit>(seen)?;
        let mut tests = self.device.zeroed::<Tests>(counted)?;
        let mut ticks = self.device.zeroed::<u32>(counted)?;
        let mut unseen = self.device.zeroed::<Pixel>(counted)?;
        let lights = self.scene.appearance()?.lighting.upload(&self.device, camera)?;
        let pass = passes::Pass {
            film: unseen.view_mut(),
            tests: tests.view_mut(),
            ticks: ticks.view_mut(),
            ..self.whole(camera, &options, window, &lights)?
        };
        let launch = if costs {
            passes::shade(&self.device, self.kernels(), &pass)?
        } else {
            passes::first_hits(&self.device, self.kernels(), &pass, first_hits.view_mut())?
        };
        let mut seconds = launch.wait()?;
        let shown = Shown {
            quantity: quantity as u32,
            first_hits: first_hits.view(),
            tests: if quantity == Quantity::Tests { tests.view() } else { View::EMPTY },
            ticks: ticks.view(),
        };
        let range = match range {
            Some(range) => range,
            None => match quantity {
                Quantity::Tests => costs_range(tests.items()?.iter().map(|tests| cost(tests) as f32)),
                Quantity::Ticks => costs_range(ticks.items()?.iter().map(|&ticks| ticks as f32)),
                Quantity::Depth => self.depths(&shown, film.size, &mut seconds)?,
                _ => [0.0; 2],
            },
        };
        let draw_aov = DrawAov { shown, size: film.size, range, screen: film.screen.view_mut() };
        // SAFETY: the buffers are borrowed while this waits, and as long as the film has pixels.
        seconds += unsafe { Timed::launch(&self.device, &draw_aov, film.size) }?.wait()?;
        Ok(Painted { range, kernel_seconds: seconds })
    }

    /// The smallest and the largest distance.
    fn depths(&self, shown: &Shown, size: [u32; 2], seconds: &mut f64) -> Result<[f32; 2], RenderError> {
        let mut rows = self.device.zeroed::<[f32; 2]>(size[1] as usize)?;
        let ranges = AovRanges { shown: *shown, size, ranges: rows.view_mut() };
        // SAFETY: as in `draw_aov`.
        *seconds += unsafe { Timed::launch(&self.device, &ranges, [size[1], 1]) }?.wait()?;
        let all = rows.download()?.into_iter().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        Ok(all.filter(|[low, high]| low <= high).unwrap_or([0.0, 1.0]))
    }
}

/// From 0 to what [`PERCENT`] percent of the pixels do not exceed, or of as many of them as are looked at.
fn costs_range(costs: impl ExactSizeIterator<Item = f32>) -> [f32; 2] {
    let step = costs.len().div_ceil(MOST_COSTS).max(1) | 1;
    // Costs are not negative: their bits are in their order.
    let mut bits: Vec<u32> = costs.step_by(step).map(f32::to_bits).collect();
    [0.0, percentile(&mut bits, PERCENT).map_or(1.0, f32::from_bits).max(1.0)]
}

const _: () = {
    use raywarp_core::screen::quantity;
    assert!(Quantity::Normal as u32 == quantity::NORMAL && Quantity::Depth as u32 == quantity::DEPTH);
    assert!(Quantity::Albedo as u32 == quantity::ALBEDO && Quantity::Primitive as u32 == quantity::PRIMITIVE);
    assert!(Quantity::Material as u32 == quantity::MATERIAL && Quantity::Tests as u32 == quantity::TESTS);
    assert!(Quantity::Ticks as u32 == quantity::TICKS);
};
