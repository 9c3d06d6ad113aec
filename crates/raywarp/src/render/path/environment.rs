//! The environment of a scene and the table by which it is sampled.

use raywarp_core::background::Background;
use raywarp_core::lights::Environment;
use raywarp_core::math::Vec3;
use raywarp_core::sampling::{AliasEntry, AliasTable};
use raywarp_core::texture::luminance;
use raywarp_core::view::View;
use raywarp_device::kernels::Views;

use super::alias;
use crate::device::{Buffer, Device, DeviceError};
use crate::render::framing::turn_to;
use crate::scene;

/// Cells that a sky is sampled by: it is linear, so few will do.
const SKY_CELLS: [u32; 2] = [16, 16];

/// An environment on a device.
pub struct ResidentEnvironment {
    header: Environment,
    texels: Buffer<Vec3>,
    table: Buffer<AliasEntry>,
    /// Mean luminance over the sphere.
    pub mean: f64,
}

impl ResidentEnvironment {
    /// A sky.
    pub fn of_sky(device: &Device, sky: Background) -> Result<Self, DeviceError> {
        let header = Environment {
            rows: about(sky.up),
            texels: View::EMPTY,
            size: [0; 2],
            sky,
            strength: 1.0,
            cells: SKY_CELLS,
            table: AliasTable { entries: View::EMPTY },
        };
        let [columns, rows] = SKY_CELLS;
        let luminance = |cell: u32| {
            // Linear in the sine of the elevation, and so is its mean between two of them.
            let (above, below) = band(cell / columns, rows);
            let sine = (0.5 * (above + below)) as f32;
            let pole = if sine < 0.0 { sky.ground } else { sky.zenith };
            f64::from(luminance(sky.horizon + (pole - sky.horizon) * sine.abs()))
        };
        Self::upload(device, header, &[], luminance)
    }

    /// A picture, upwards being a direction of the world.
    pub fn of_picture(
        device: &Device,
        environment: &scene::Environment,
        up: Vec3,
        sky: Background,
    ) -> Result<Self, DeviceError> {
        let scene::Radiance { width, height, texels, .. } = &*environment.picture;
        let cells = [*width, *height];
        let [x, y, z] = about(up).map(|axis| glam::Vec3::from(axis.to_array()));
        let turn = glam::Quat::from_axis_angle(y, environment.rotation);
        let header = Environment {
            rows: [turn * x, y, turn * z].map(|axis| axis.to_array().into()),
            texels: View::EMPTY,
            size: cells,
            sky,
            strength: environment.strength,
            cells,
            table: AliasTable { entries: View::EMPTY },
        };
        let texels: Vec<Vec3> = texels.iter().map(|&texel| texel.into()).collect();
        let strength = f64::from(environment.strength);
        let mean = |cell: u32| strength * mean_of_cell(&texels, cells, cell);
        Self::upload(device, header, &texels, mean)
    }

    fn upload(
        device: &Device,
        header: Environment,
        texels: &[Vec3],
        luminance: impl Fn(u32) -> f64,
    ) -> Result<Self, DeviceError> {
        let [columns, rows] = header.cells;
        let solid_angle = |cell: u32| {
            let (above, below) = band(cell / columns, rows);
            (above - below) * std::f64::consts::TAU / f64::from(columns)
        };
        let weights: Vec<f64> = (0..columns * rows).map(|cell| usable(luminance(cell)) * solid_angle(cell)).collect();
        let mut table = alias::table(&weights);
        for (entry, cell) in table.iter_mut().zip(0..) {
            entry.density = (f64::from(entry.density) / solid_angle(cell)) as f32;
        }
        let mean = weights.iter().sum::<f64>() / (2.0 * std::f64::consts::TAU);
        Ok(Self { header, texels: device.upload(texels)?, table: device.upload(&table)?, mean })
    }

    /// For kernels.
    pub fn view(&self) -> Environment {
        Environment { texels: self.texels.view(), table: AliasTable { entries: self.table.view() }, ..self.header }
    }
}

/// Mean luminance over a texel of what is interpolated between it and its neighbours, even over longitude and latitude: along
/// each axis an eighth, three quarters and an eighth.
fn mean_of_cell(texels: &[Vec3], [width, height]: [u32; 2], cell: u32) -> f64 {
    let (column, row) = (cell % width, cell / width);
    let columns = [(column + width - 1) % width, column, (column + 1) % width];
    let rows = [row.saturating_sub(1), row, (row + 1).min(height - 1)];
    let shares = [0.125, 0.75, 0.125];
    let mut sum = 0.0;
    for (row, by_row) in rows.into_iter().zip(shares) {
        for (column, by_column) in columns.into_iter().zip(shares) {
            sum += by_row * by_column * f64::from(luminance(texels[(row * width + column) as usize]));
        }
    }
    sum
}

/// Cosines of the angles from the pole between which a row lies.
fn band(row: u32, rows: u32) -> (f64, f64) {
    let cosine = |row: u32| (f64::from(row) / f64::from(rows) * std::f64::consts::PI).cos();
    (cosine(row), cosine(row + 1))
}

fn usable(luminance: f64) -> f64 {
    if luminance > 0.0 && luminance < f64::INFINITY {
        luminance
    } else {
        0.0
    }
}

/// Axes of which the second is a direction.
fn about(up: Vec3) -> [Vec3; 3] {
    let turn = turn_to(up.to_array()).as_mat3();
    [turn.x_axis, turn.y_axis, turn.z_axis].map(|axis| axis.to_array().into())
}
