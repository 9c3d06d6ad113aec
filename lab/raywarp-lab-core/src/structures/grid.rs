//! Boxes on the grid of a node: planes of eight bits, and a ray made ready for them.
//!
//! A node has an origin and the distance between planes; byte `q` stands for the plane at `origin + q * spacing`, exactly.
//! Builders see to it that the box between such planes holds the child's.

use raywarp_core::arch::{self, fraction_of_byte};
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::ray::Ray;
use raywarp_core::traversal::binary::SLACK;

/// A ray, before it meets a node.
pub(crate) struct GridRay {
    origin: Vec3,
    inverse: Vec3,
    /// 2^15 times `inverse`: what a step is multiplied by, see [`Grid`].
    fine: Vec3,
    negative: [bool; 3],
    t_min: f32,
}

/// A ray in the grid of one node: each plane costs one fused step.
pub(crate) struct Grid {
    /// Time from one plane to the next, times 2^15.
    step: Vec3,
    /// When plane 2^15 below the first is met, rounded towards earlier; for planes where a box is entered.
    enter: Vec3,
    /// The same rounded towards later; for planes where a box is left.
    leave: Vec3,
    t_min: f32,
}

impl GridRay {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let inverse = ray.inverse_direction();
        Self {
            origin: ray.origin,
            inverse,
            fine: inverse * 32_768.0,
            negative: [inverse.x < 0.0, inverse.y < 0.0, inverse.z < 0.0],
            t_min: ray.t_min,
        }
    }

    /// What to flip in a slot's number so that the first slot for this ray comes out as 7.
    #[inline(always)]
    pub fn octant(&self) -> u32 {
        let [x, y, z] = self.negative;
        7 ^ (x as u32 | (y as u32) << 1 | (z as u32) << 2)
    }

    /// The words of the planes where boxes are entered, and those of the planes where they are left.
    #[inline(always)]
    pub fn sides<T: Copy>(&self, low: [T; 3], high: [T; 3]) -> ([T; 3], [T; 3]) {
        let [x, y, z] = self.negative;
        let ((near_x, far_x), (near_y, far_y)) = (swapped(x, low[0], high[0]), swapped(y, low[1], high[1]));
        let (near_z, far_z) = swapped(z, low[2], high[2]);
        ([near_x, near_y, near_z], [far_x, far_y, far_z])
    }

    /// In the grid of a node. Bytes are read as `1 + q / 2^15`, hence the 2^15 and the shift by one step.
    #[inline(always)]
    pub fn grid(&self, origin: Vec3, spacing: Vec3) -> Grid {
        let step = self.fine * spacing;
        let shift = (origin - self.origin) * self.inverse;
        let slack = vec3(slack(shift.x, step.x), slack(shift.y, step.y), slack(shift.z, step.z));
        let shift = shift - step;
        Grid { step, enter: shift - slack, leave: shift + slack, t_min: self.t_min }
    }
}

#[inline(always)]
fn swapped<T>(swap: bool, a: T, b: T) -> (T, T) {
    if swap {
        (b, a)
    } else {
        (a, b)
    }
}

/// The words of slots 0 to 3, or of slots 4 to 7.
#[inline(always)]
pub(crate) fn half<const I: usize>(planes: [[u32; 2]; 3]) -> [u32; 3] {
    [planes[0][I], planes[1][I], planes[2][I]]
}

/// Rounding of the terms of a distance: see [`Grid::enter`]. The least normal number stands for that of subnormal ones.
#[inline(always)]
fn slack(shift: f32, step: f32) -> f32 {
    arch::fma(shift.abs() + step.abs(), SLACK, f32::MIN_POSITIVE)
}

impl Grid {
    /// Where the ray enters the box between byte `INDEX` of the words of `near` and that of `far`, if it does before
    /// `t_far`.
    ///
    /// Conservative, after Ize 2013. A distance is `(1 + q / 2^15) * step + shift - step`: its terms are off by at most
    /// three roundings of the shift, three of the step, and two more where they are added; the distance itself by two,
    /// of which one is the inverse direction's. `enter` and `leave` hold the former, the end holds the latter. For the
    /// step that is 1/32 of the distance between planes. Where a step or a shift overflows, so does the slack, and the
    /// axis sets no limit: infinite one way, or NaN.
    #[inline(always)]
    pub fn enter<const INDEX: u32>(&self, near: [u32; 3], far: [u32; 3], t_far: f32) -> Option<f32> {
        let first = arch::max(
            arch::max(
                arch::fma(fraction_of_byte::<INDEX>(near[0]), self.step.x, self.enter.x),
                arch::fma(fraction_of_byte::<INDEX>(near[1]), self.step.y, self.enter.y),
            ),
            arch::max(arch::fma(fraction_of_byte::<INDEX>(near[2]), self.step.z, self.enter.z), self.t_min),
        );
        let last = arch::min(
            arch::min(
                arch::fma(fraction_of_byte::<INDEX>(far[0]), self.step.x, self.leave.x),
                arch::fma(fraction_of_byte::<INDEX>(far[1]), self.step.y, self.leave.y),
            ),
            arch::min(arch::fma(fraction_of_byte::<INDEX>(far[2]), self.step.z, self.leave.z), t_far),
        );
        (first <= later(last)).then_some(first)
    }
}

/// A distance and a few roundings: what is entered later is behind it for certain.
#[inline(always)]
pub(crate) fn later(t: f32) -> f32 {
    arch::fma(t.abs(), SLACK, t)
}
