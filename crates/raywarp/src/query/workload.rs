//! The rays that ray tracers are measured with: of a picture, of its first bounce, and random ones.
//!
//! They follow the custom of the field (Aila and Laine 2009, and the benchmarks since): primary rays come in tiles, the
//! others start where those hit. All are the same on every machine: random numbers are keyed by hit and sample, and
//! nothing calls the platform's mathematics.

use raywarp_core::camera::{self as kernel, pixel_centre};
use raywarp_core::sample::{combine, cosine, number, sphere};
use raywarp_core::shade::optics::reflect;

use super::RayKind;
use crate::accel::drop_degenerate;
use crate::device_scene::flatten;
use crate::render::{camera, RenderError};
use crate::scene::{Camera, Scene};
use crate::{Hit, Ray, Triangle, Vec3};

/// Columns and rows of a tile: 32 rays in a row are one.
const TILE: [u32; 2] = [8, 4];

/// An order of a picture's pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelOrder {
    /// Tiles of 8 columns and 4 rows, less at the edges of the picture, row by row, and so within each.
    Tiles,
    /// Row by row.
    Scan,
    /// Along Morton's curve.
    Morton,
}

/// How far rays start above the surface, in units of the scene's diagonal.
const OFFSET: f32 = 1e-5;

/// Length of ambient-occlusion rays, likewise.
const AO_LENGTH: f32 = 0.1;

/// Where the light of shadow rays is: from the eye, in scene units to the camera's right and up.
const LIGHT: [f32; 2] = [0.5, 0.4];

/// Rays of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Workload {
    /// Where they come from and what is asked of them.
    pub kind: RayKind,
    /// In the order in which they are traced.
    pub rays: Vec<Ray>,
}

/// Makes the rays of a scene.
///
/// ```
/// use raywarp::accel::AccelKind;
/// use raywarp::device::{Device, DeviceChoice};
/// use raywarp::query::{opaque_triangles, RayCaster, RayKind, RaySource};
///
/// let scene = raywarp::scene::load::builtin()?.scene;
/// let triangles = opaque_triangles(&scene)?;
/// let source = RaySource::new(&triangles, &scene.cameras[0], [64, 36])?;
/// let caster = RayCaster::new(triangles.clone(), AccelKind::Bvh, &Device::open(DeviceChoice::Cpu)?)?;
/// let primary = source.primary();
/// let spots = source.spots(&primary.rays, &caster.hits(&primary.rays)?);
/// let diffuse = source.workload(RayKind::Diffuse, &spots, 10_000);
/// assert_eq!((primary.rays.len(), diffuse.rays.len()), (64 * 36, 10_000));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RaySource<'a> {
    triangles: &'a [Triangle],
    bounds: [Vec3; 2],
    camera: kernel::Camera,
    light: Vec3,
    size: [u32; 2],
}

/// Where secondary rays start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// A little above the surface.
    pub origin: Vec3,
    /// Unit geometric normal on the side of the ray that came.
    pub normal: Vec3,
    /// Where that ray went.
    pub came: Vec3,
}

/// The triangles of a scene in world space that a ray can hit, numbered by their place, all of them opaque: what is
/// measured is traversal, and peers know no transparency.
///
/// # Errors
/// The scene's parts do not fit together.
pub fn opaque_triangles(scene: &Scene) -> Result<Vec<Triangle>, RenderError> {
    let (mut triangles, _) = drop_degenerate(flatten::Flat::of(scene)?.triangles);
    for (place, triangle) in (0..).zip(&mut triangles) {
        (triangle.primitive, triangle.flags, triangle.instance) = (place, 0, 0);
    }
    Ok(triangles)
}

impl<'a> RaySource<'a> {
    /// Of triangles that are numbered by their place, seen by a camera in a picture of `size`, in pixels.
    ///
    /// # Errors
    /// A camera that has no view.
    pub fn new(triangles: &'a [Triangle], camera: &Camera, size: [u32; 2]) -> Result<Self, RenderError> {
        let [right, up, _] = camera::axes(camera)?;
        Ok(Self {
            triangles,
            bounds: flatten::bounds(triangles).map(Vec3::from),
            camera: camera::kernel_camera(camera, size)?,
            light: right.mul_add(LIGHT[0], up.mul_add(LIGHT[1], camera.eye.into())),
            size,
        })
    }

    /// The point that shadow rays go to.
    pub fn light(&self) -> Vec3 {
        self.light
    }

    /// Distance of the corners of the scene's bounds.
    pub fn diagonal(&self) -> f32 {
        (self.bounds[1] - self.bounds[0]).length()
    }

    /// How far rays start above a surface, in scene units.
    pub fn offset(&self) -> f32 {
        OFFSET * self.diagonal()
    }

    /// One ray through the middle of each pixel, in the order of [`PixelOrder::Tiles`].
    pub fn primary(&self) -> Workload {
        let pixel = |[x, y]: [u32; 2]| {
            let centre = pixel_centre(x, y);
            self.camera.ray(centre.x, centre.y)
        };
        Workload { kind: RayKind::Primary, rays: tiled(self.size).map(pixel).collect() }
    }

    /// Where rays hit, in their order; without misses, and without triangles too small to have a normal.
    pub fn spots(&self, rays: &[Ray], hits: &[Hit]) -> Vec<Spot> {
        let offset = self.offset();
        let spot = |(ray, hit): (&Ray, &Hit)| {
            let normal = normal(self.triangles.get(hit.primitive as usize)?)?;
            let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
            Some(Spot { origin: normal.mul_add(offset, ray.at(hit.t)), normal, came: ray.direction })
        };
        rays.iter().zip(hits).filter_map(spot).collect()
    }

    /// The rays of a kind. Of those that start where primary ones hit, one from each spot, and then again from the first
    /// spot on until there are `least`; without a spot there are none. `least` random rays; primary ones as they are.
    pub fn workload(&self, kind: RayKind, spots: &[Spot], least: usize) -> Workload {
        let keyed = |make: &dyn Fn(&Spot, u32) -> Ray| -> Vec<Ray> {
            let count = if spots.is_empty() { 0 } else { spots.len().max(least) };
            let key = |index: usize| combine((index % spots.len()) as u32, (index / spots.len()) as u32);
            (0..count).map(|index| make(&spots[index % spots.len()], key(index))).collect()
        };
        let rays = match kind {
            RayKind::Primary => return self.primary(),
            RayKind::Random => return self.random(least),
            RayKind::Shadow => keyed(&|spot, _| towards(spot.origin, self.light)),
            RayKind::Reflected => keyed(&|spot, _| Ray::new(spot.origin, reflect(spot.came, spot.normal))),
            RayKind::Diffuse => keyed(&|spot, key| Ray::new(spot.origin, cosine(spot.normal, key))),
            RayKind::Ao => {
                let t_max = AO_LENGTH * self.diagonal();
                keyed(&|spot, key| Ray { t_max, ..Ray::new(spot.origin, cosine(spot.normal, key)) })
            }
        };
        Workload { kind, rays }
    }

    /// Rays from points evenly in the scene's bounds, in directions evenly over the sphere.
    pub fn random(&self, count: usize) -> Workload {
        let [low, high] = self.bounds;
        let ray = |index: usize| {
            let key = combine(index as u32, RANDOM);
            let place = Vec3::new(number(key, 0), number(key, 1), number(key, 2));
            Ray::new((low + (high - low) * place).min(high), sphere(key))
        };
        Workload { kind: RayKind::Random, rays: (0..count).map(ray).collect() }
    }
}

/// Keeps random rays apart from those of the spots.
const RANDOM: u32 = 0x7a6d;

impl PixelOrder {
    /// Every order.
    pub const ALL: [Self; 3] = [Self::Tiles, Self::Scan, Self::Morton];

    /// All pixels of a picture.
    pub fn pixels(self, [width, height]: [u32; 2]) -> Vec<[u32; 2]> {
        let rows = || (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        match self {
            Self::Tiles => tiled([width, height]).collect(),
            Self::Scan => rows().collect(),
            Self::Morton => {
                let mut pixels: Vec<[u32; 2]> = rows().collect();
                pixels.sort_by_key(|&[x, y]| spread(x) | spread(y) << 1);
                pixels
            }
        }
    }
}

/// The bits of a number with a zero between any two.
fn spread(x: u32) -> u64 {
    (0..32).fold(0, |bits, i| bits | u64::from(x >> i & 1) << (2 * i))
}

/// Pixels of a picture, tile by tile, each tile row by row.
fn tiled([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let tiles = move |y: u32| (0..width.div_ceil(TILE[0])).map(move |x| [x * TILE[0], y * TILE[1]]);
    let corners = (0..height.div_ceil(TILE[1])).flat_map(tiles);
    let pixels = |[x0, y0]: [u32; 2]| (0..TILE[1]).flat_map(move |y| (0..TILE[0]).map(move |x| [x0 + x, y0 + y]));
    corners.flat_map(pixels).filter(move |&[x, y]| x < width && y < height)
}

/// Of unit length; in double precision, where the product of two edges neither overflows nor vanishes.
fn normal(triangle: &Triangle) -> Option<Vec3> {
    let [a, b, c] = [triangle.v0, triangle.v1, triangle.v2].map(|v| v.to_array().map(f64::from));
    let edge = |to: [f64; 3]| [to[0] - a[0], to[1] - a[1], to[2] - a[2]];
    let (e, f) = (edge(b), edge(c));
    let cross = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    let length = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| cross.map(|x| (x / length) as f32).into())
}

/// A ray that ends at a point.
fn towards(origin: Vec3, point: Vec3) -> Ray {
    let way = point - origin;
    Ray { t_max: way.length(), ..Ray::new(origin, way.normalize()) }
}

#[cfg(test)]
mod tests;
