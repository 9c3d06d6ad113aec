//! What lies beyond the scene, as a light: a picture all around in longitude and latitude, or a sky.
//!
//! A table of cells chooses directions in proportion to the radiance that shines through each; within a cell they are even
//! over the sphere. Whoever makes the table gives each cell the density per solid angle.

use core::f32::consts::{FRAC_1_PI, PI};

use super::Incidence;
use crate::arch;
use crate::background::Background;
use crate::math::{acos, atan2, sin_cos_of_turns, vec3, Vec3};
use crate::sampling::{AliasTable, Pair};
use crate::view::View;

/// A picture around the scene. Its middle is seen towards +x, its right edge towards -x past +z, its upper edge at +y.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Environment {
    /// Turns the world to these axes, row by row: orthonormal.
    pub rows: [Vec3; 3],
    /// Radiance of each texel, from the upper left one; empty: the sky below.
    pub texels: View<Vec3>,
    /// Columns and rows of the texels.
    pub size: [u32; 2],
    /// What is seen where there are no texels.
    pub sky: Background,
    /// Multiplies the texels.
    pub strength: f32,
    /// Columns and rows of the cells.
    pub cells: [u32; 2],
    /// The cells, from the upper left one, with the density per solid angle of each.
    pub table: AliasTable,
}

impl Environment {
    /// Radiance from a direction, which is a unit vector.
    #[inline(always)]
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        if self.texels.is_empty() {
            return self.sky.radiance(direction);
        }
        let [u, v] = coordinates(self.in_own_axes(direction));
        self.bilinear(u * self.size[0] as f32 - 0.5, v * self.size[1] as f32 - 0.5) * self.strength
    }

    #[inline(always)]
    fn bilinear(&self, x: f32, y: f32) -> Vec3 {
        let (left, top) = (arch::floor(x), arch::floor(y));
        let (fx, fy) = (x - left, y - top);
        let row = |y: f32| self.texel(left, y) * (1.0 - fx) + self.texel(left + 1.0, y) * fx;
        row(top) * (1.0 - fy) + row(top + 1.0) * fy
    }

    /// Around in longitude, to the pole in latitude.
    #[inline(always)]
    fn texel(&self, x: f32, y: f32) -> Vec3 {
        let [width, height] = self.size.map(|side| side as i32);
        let (column, row) = ((x as i32).rem_euclid(width), (y as i32).clamp(0, height - 1));
        self.texels.at((row * width + column) as u32)
    }

    /// A direction by chance, with its density.
    #[inline(always)]
    pub fn sample(&self, at: Pair) -> Incidence {
        let (cell, [x, y]) = self.table.sample(at);
        let [columns, rows] = self.cells;
        let (column, row) = (cell % columns, cell / columns);
        // Even over the sphere: in longitude, and in the cosine of the angle from the pole.
        let (_, above) = sin_cos_of_turns(row as f32 * 0.5 / rows as f32);
        let (_, below) = sin_cos_of_turns((row + 1) as f32 * 0.5 / rows as f32);
        let cosine = arch::fma(below - above, y, above);
        let sine = arch::sqrt(arch::max((1.0 - cosine) * (1.0 + cosine), 0.0));
        let (z, x) = sin_cos_of_turns((column as f32 + x) / columns as f32 - 0.5);
        let towards = self.in_world_axes(vec3(x * sine, cosine, z * sine)).normalize();
        Incidence {
            towards,
            t_max: f32::INFINITY,
            radiance: self.radiance(towards),
            density: self.table.density(cell),
            delta: false,
        }
    }

    /// Probability per solid angle with which [`sample`](Self::sample) finds a direction.
    #[inline(always)]
    pub fn density(&self, direction: Vec3) -> f32 {
        let [u, v] = coordinates(self.in_own_axes(direction));
        let [columns, rows] = self.cells;
        let column = core::cmp::min((u * columns as f32) as u32, columns - 1);
        let row = core::cmp::min((v * rows as f32) as u32, rows - 1);
        self.table.density(row * columns + column)
    }

    #[inline(always)]
    fn in_own_axes(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.rows;
        vec3(x.dot(v), y.dot(v), z.dot(v))
    }

    #[inline(always)]
    fn in_world_axes(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.rows;
        x.mul_add(v.x, y.mul_add(v.y, z * v.z))
    }
}

/// Where a direction is in the picture, from 0 to 1 to the right and downwards.
#[inline(always)]
fn coordinates(direction: Vec3) -> [f32; 2] {
    [arch::fma(atan2(direction.z, direction.x), 0.5 * FRAC_1_PI, 0.5), acos(direction.y) * (1.0 / PI)]
}
