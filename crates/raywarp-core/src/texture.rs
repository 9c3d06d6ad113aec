//! Images sampled by the shared code, so that both machines agree to the bit.

use crate::arch;
use crate::math::{clamp, Vec3};
use crate::view::View;

/// The index of a texture that is not there.
pub const NO_TEXTURE: u32 = u32::MAX;

/// Bits of [`Texture::mode`].
pub mod mode {
    /// Along u: repeat where neither this nor `MIRROR_U` is set.
    pub const CLAMP_U: u32 = 1;
    /// Back and forth along u.
    pub const MIRROR_U: u32 = 2;
    /// As `CLAMP_U`, along v.
    pub const CLAMP_V: u32 = 4;
    /// As `MIRROR_U`, along v.
    pub const MIRROR_V: u32 = 8;
    /// The texel that the point lies in, instead of four mixed.
    pub const NEAREST: u32 = 16;
    /// Red, green and blue are decoded from sRGB before they are mixed.
    pub const SRGB: u32 = 32;
    /// Laid out by the second set of texture coordinates of a mesh.
    pub const SECOND_UVS: u32 = 64;
    /// Three bits from here: 0 for colour as it is, else the channel that is spread: 1 red, 2 green, 3 blue, 4 alpha,
    /// 5 luminance.
    pub const CHANNEL_SHIFT: u32 = 8;
}

/// How an image is sampled.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture {
    /// Index of the image's first texel, its upper left one.
    pub first: u32,
    /// Texels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// See [`mode`].
    pub mode: u32,
    /// First row of the map from mesh to image coordinates.
    pub u_row: Vec3,
    /// Second row.
    pub v_row: Vec3,
    /// The colour becomes `base + gain * colour`.
    pub base: f32,
    /// See `base`.
    pub gain: f32,
}

/// A sampled colour with its alpha, linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texel {
    /// Red, green and blue.
    pub color: Vec3,
    /// Coverage.
    pub alpha: f32,
}

impl Texel {
    #[inline(always)]
    fn scale(self, weight: f32) -> Self {
        Self { color: self.color * weight, alpha: self.alpha * weight }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self { color: self.color + other.color, alpha: self.alpha + other.alpha }
    }
}

/// All images of a scene.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Textures {
    /// How each is sampled.
    pub list: View<Texture>,
    /// RGBA bytes, red lowest, image after image.
    pub texels: View<u32>,
    /// Linear value of each of the 256 sRGB bytes.
    pub decode: View<f32>,
}

impl Textures {
    /// The colour of texture `index` at mesh coordinates (u, v), v up.
    // Not inlined on the GPU: a surface may sample five textures, and code that is not in the cache is slow. Inlined on
    // the CPU, as only what is inlined into the tile loop may use its fused multiply-add.
    #[cfg_attr(target_arch = "nvptx64", inline(never))]
    #[cfg_attr(not(target_arch = "nvptx64"), inline(always))]
    pub fn sample(&self, index: u32, u: f32, v: f32) -> Texel {
        let texture = self.list.at(index);
        let (x, y) = texture.position(u, v);
        let texel = if texture.mode & mode::NEAREST != 0 {
            self.texel(&texture, arch::floor(x), arch::floor(y))
        } else {
            self.bilinear(&texture, x - 0.5, y - 0.5)
        };
        texture.finish(texel)
    }

    #[inline(always)]
    fn bilinear(&self, texture: &Texture, x: f32, y: f32) -> Texel {
        let (left, top) = (arch::floor(x), arch::floor(y));
        let (fx, fy) = (x - left, y - top);
        let a = self.texel(texture, left, top).scale((1.0 - fx) * (1.0 - fy));
        let b = self.texel(texture, left + 1.0, top).scale(fx * (1.0 - fy));
        let c = self.texel(texture, left, top + 1.0).scale((1.0 - fx) * fy);
        let d = self.texel(texture, left + 1.0, top + 1.0).scale(fx * fy);
        a.plus(b).plus(c).plus(d)
    }

    /// Slope of the luminance, in full range a texel, to the right and upwards in the image; for height maps.
    #[cfg_attr(target_arch = "nvptx64", inline(never))]
    #[cfg_attr(not(target_arch = "nvptx64"), inline(always))]
    pub fn slope(&self, index: u32, u: f32, v: f32) -> (f32, f32) {
        let texture = self.list.at(index);
        let (x, y) = texture.position(u, v);
        let height = |dx: f32, dy: f32| {
            let texel = texture.finish(self.bilinear(&texture, x + dx - 0.5, y + dy - 0.5));
            luminance(texel.color)
        };
        (0.5 * (height(1.0, 0.0) - height(-1.0, 0.0)), 0.5 * (height(0.0, -1.0) - height(0.0, 1.0)))
    }

    #[cfg_attr(target_arch = "nvptx64", inline(never))]
    #[cfg_attr(not(target_arch = "nvptx64"), inline(always))]
    fn texel(&self, texture: &Texture, x: f32, y: f32) -> Texel {
        let column = wrap(x, texture.width, texture.mode & 3);
        let row = wrap(y, texture.height, texture.mode >> 2 & 3);
        let [r, g, b, a] = self.texels.at(texture.first + row * texture.width + column).to_le_bytes();
        let linear = |byte: u8| {
            if texture.mode & mode::SRGB != 0 {
                self.decode.at(byte as u32)
            } else {
                byte as f32 * (1.0 / 255.0)
            }
        };
        Texel { color: Vec3::new(linear(r), linear(g), linear(b)), alpha: a as f32 * (1.0 / 255.0) }
    }
}

impl Texture {
    /// Position in texels from the upper left corner. Coordinates without a meaning count as 0.
    #[inline(always)]
    fn position(&self, u: f32, v: f32) -> (f32, f32) {
        // Beyond 2^20 repeats single precision holds no fraction of a texel worth having.
        let bound = |x: f32| clamp(if x.is_nan() { 0.0 } else { x }, -1_048_576.0, 1_048_576.0);
        let x = bound(arch::fma(self.u_row.x, u, arch::fma(self.u_row.y, v, self.u_row.z)));
        let y = bound(arch::fma(self.v_row.x, u, arch::fma(self.v_row.y, v, self.v_row.z)));
        (x * self.width as f32, (1.0 - y) * self.height as f32)
    }

    /// A direction in the image, to the right and upwards, as seen along the u and v of the mesh: the transform may
    /// turn or mirror what is painted. Its scale does not count, as relief is painted in texels.
    #[inline(always)]
    pub fn to_mesh(&self, x: f32, y: f32) -> (f32, f32) {
        let along = |dx: f32, dy: f32| {
            let length = arch::sqrt(arch::fma(dx, dx, dy * dy));
            if length > 0.0 {
                arch::fma(x, dx, y * dy) / length
            } else {
                0.0
            }
        };
        (along(self.u_row.x, self.v_row.x), along(self.u_row.y, self.v_row.y))
    }

    #[inline(always)]
    fn finish(&self, texel: Texel) -> Texel {
        let color = match self.mode >> mode::CHANNEL_SHIFT & 7 {
            0 => texel.color,
            1 => Vec3::splat(texel.color.x),
            2 => Vec3::splat(texel.color.y),
            3 => Vec3::splat(texel.color.z),
            4 => Vec3::splat(texel.alpha),
            _ => Vec3::splat(luminance(texel.color)),
        };
        Texel { color: color.mul_add(self.gain, Vec3::splat(self.base)), alpha: texel.alpha }
    }
}

/// Rec. 709 luminance of a linear colour.
#[inline(always)]
pub fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// A texel index for a whole number that may lie outside of the image.
#[inline(always)]
fn wrap(at: f32, size: u32, mode: u32) -> u32 {
    let at = at as i32;
    let size = size as i32;
    let inside = match mode {
        mode::CLAMP_U => at.clamp(0, size - 1),
        mode::MIRROR_U => {
            let period = at.rem_euclid(2 * size);
            if period < size {
                period
            } else {
                2 * size - 1 - period
            }
        }
        _ => at.rem_euclid(size),
    };
    inside as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two texels: black left, white right; alpha 0 and 255.
    fn sample(mode: u32, u: f32) -> Texel {
        let texels = [0x0000_0000u32, 0xffff_ffff];
        let row = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let list = [Texture {
            first: 0,
            width: 2,
            height: 1,
            mode,
            u_row: row(1.0, 0.0),
            v_row: row(0.0, 1.0),
            base: 0.0,
            gain: 1.0,
        }];
        // SAFETY: the arrays outlive the sampling below.
        let textures = unsafe {
            Textures { list: View::new(list.as_ptr(), 1), texels: View::new(texels.as_ptr(), 2), decode: View::EMPTY }
        };
        textures.sample(0, u, 0.5)
    }

    #[test]
    fn texel_centres_are_exact_and_between_them_it_is_linear() {
        assert_eq!(sample(0, 0.25).color.x, 0.0);
        assert_eq!(sample(0, 0.75).alpha, 1.0);
        assert_eq!(sample(0, 0.5).color, Vec3::splat(0.5));
        assert_eq!(sample(mode::NEAREST, 0.49).color.x, 0.0);
        assert_eq!(sample(mode::NEAREST, 0.51).color.x, 1.0);
    }

    #[test]
    fn wrap_modes_differ_beyond_the_edge() {
        assert_eq!(sample(0, 1.25).color.x, 0.0);
        assert_eq!(sample(mode::CLAMP_U, 1.25).color.x, 1.0);
        assert_eq!(sample(mode::MIRROR_U, 1.25).color.x, 1.0);
        assert_eq!(sample(mode::MIRROR_U, 1.75).color.x, 0.0);
        assert_eq!(sample(0, -0.25).color.x, 1.0);
        assert_eq!(sample(mode::CLAMP_U, -3.0).color.x, 0.0);
    }

    #[test]
    fn meaningless_coordinates_do_no_harm() {
        for u in [f32::NAN, f32::INFINITY, -1e30] {
            assert!(sample(0, u).color.x.is_finite());
        }
    }
}
