//! Where things stand: transforms of instances, and which way is up.

use toml::Spanned;

use super::complaint::Complaint;
use super::file::{AxisAngle, Instance, Rotation, Up};
use super::values::{Coordinate, PerAxis};
use crate::load::precision::Rounding;
use crate::{Light, LightKind, Transform};

impl Transform {
    /// Image of a point.
    pub(in crate::load) fn point(&self, point: [f32; 3]) -> [f32; 3] {
        let moved = self.vector(point);
        [0, 1, 2].map(|axis| moved[axis] + self.translation[axis])
    }

    /// Image of a direction.
    pub(super) fn vector(&self, vector: [f32; 3]) -> [f32; 3] {
        let columns = &self.columns;
        [0, 1, 2].map(|axis| (0..3).map(|column| columns[column][axis] * vector[column]).sum())
    }

    /// First `inner`, then this one.
    pub(super) fn after(&self, inner: &Self) -> Self {
        Self { columns: inner.columns.map(|column| self.vector(column)), translation: self.point(inner.translation) }
    }

    fn determinant(&self) -> f64 {
        let [a, b, c] = self.columns.map(|column| column.map(f64::from));
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    }
}

/// What the file's axes are in the scene's, which has +Y up.
pub fn upright(up: Up) -> Transform {
    match up {
        Up::Y => Transform::IDENTITY,
        Up::Z => Transform { columns: [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]], ..Transform::IDENTITY },
    }
}

/// Rows of a matrix.
pub type Rows = Spanned<Vec<[Coordinate; 4]>>;

/// Where something is put.
pub struct Placement<'a> {
    pub translate: Option<[Coordinate; 3]>,
    pub rotate: Option<&'a Rotation>,
    pub scale: Option<PerAxis<3>>,
    pub matrix: Option<&'a Rows>,
}

impl Placement<'_> {
    /// Whether nothing is said.
    pub fn is_empty(&self) -> bool {
        self.translate.is_none() && self.rotate.is_none() && self.scale.is_none() && self.matrix.is_none()
    }
}

impl<'a> From<&'a Instance> for Placement<'a> {
    fn from(entry: &'a Instance) -> Self {
        let (rotate, matrix) = (entry.rotate.as_ref(), entry.matrix.as_ref());
        Self { translate: entry.translate, rotate, scale: entry.scale, matrix }
    }
}

/// The transform; `at` is where the instance is written. What its translation loses goes to `rounding`.
pub fn transform(placement: &Placement, at: usize, rounding: &mut Rounding) -> Result<Transform, Complaint> {
    let Some(rows) = placement.matrix else { return placed(placement, at, rounding) };
    let at = rows.span().start;
    if placement.translate.is_some() || placement.rotate.is_some() || placement.scale.is_some() {
        let read = "a matrix beside translate, rotate or scale";
        return Err(Complaint::new(at, read, "either the matrix or the others"));
    }
    let mut rounded = |[x, y, z, moved]: [Coordinate; 4]| {
        let [x, y, z] = [x, y, z].map(|number| number.0 as f32);
        [x, y, z, rounding.round(moved.0)]
    };
    let rows: Vec<[f32; 4]> = rows.get_ref().iter().map(|&row| rounded(row)).collect();
    let affine = match rows.as_slice() {
        [x, y, z] | [x, y, z, [0.0, 0.0, 0.0, 1.0]] => [x, y, z],
        [_, _, _, _] => return Err(Complaint::new(at, "a matrix that is not affine", "the last row [0, 0, 0, 1]")),
        _ => return Err(Complaint::new(at, format!("a matrix of {} rows", rows.len()), "3 or 4 rows of 4 numbers")),
    };
    let column = |index: usize| affine.map(|row| row[index]);
    let transform = Transform { columns: [column(0), column(1), column(2)], translation: column(3) };
    let determinant = transform.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        return Err(Complaint::new(at, "a matrix that flattens space", "one with a determinant other than 0"));
    }
    Ok(transform)
}

/// Scaled, then turned, then moved.
fn placed(placement: &Placement, at: usize, rounding: &mut Rounding) -> Result<Transform, Complaint> {
    let mut transform = Transform::IDENTITY;
    if let Some(scale) = placement.scale {
        for (axis, factor) in scale.0.into_iter().enumerate() {
            transform.columns[axis][axis] = factor;
        }
    }
    match placement.rotate {
        Some(Rotation::Euler(angles)) => {
            for (axis, angle) in angles.iter().enumerate() {
                let mut direction = [0.0; 3];
                direction[axis] = 1.0;
                transform = rotation(direction, angle.0).after(&transform);
            }
        }
        Some(Rotation::About(AxisAngle { axis, degrees })) => {
            let axis = axis.map(|number| number.0);
            if axis == [0.0; 3] {
                return Err(Complaint::new(at, "an axis of rotation without length", "a direction"));
            }
            transform = rotation(axis, degrees.0).after(&transform);
        }
        None => {}
    }
    let translation = placement.translate.map(|vector| vector.map(|number| rounding.round(number.0)));
    transform.translation = translation.unwrap_or_default();
    Ok(transform)
}

/// By Rodrigues' formula.
fn rotation(axis: [f32; 3], degrees: f32) -> Transform {
    let axis = axis.map(f64::from);
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|coordinate| coordinate / length);
    let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
    let rest = 1.0 - cos;
    let columns = [
        [cos + x * x * rest, y * x * rest + z * sin, z * x * rest - y * sin],
        [x * y * rest - z * sin, cos + y * y * rest, z * y * rest + x * sin],
        [x * z * rest + y * sin, y * z * rest - x * sin, cos + z * z * rest],
    ];
    Transform { columns: columns.map(|column| column.map(|number| number as f32)), ..Transform::IDENTITY }
}

/// A light in other coordinates. How it falls off stays as it is.
pub fn moved_light(light: &Light, transform: &Transform) -> Light {
    let kind = match light.kind {
        LightKind::Point { position } => LightKind::Point { position: transform.point(position) },
        LightKind::Directional { direction } => LightKind::Directional { direction: transform.vector(direction) },
        LightKind::Spot { position, direction, inner, outer } => LightKind::Spot {
            position: transform.point(position),
            direction: transform.vector(direction),
            inner,
            outer,
        },
    };
    Light { kind, ..light.clone() }
}

/// A camera in other coordinates. Its field of view or height stays as it is.
pub fn moved_camera(camera: &crate::Camera, transform: &Transform) -> crate::Camera {
    crate::Camera {
        eye: transform.point(camera.eye),
        target: transform.point(camera.target),
        up: transform.vector(camera.up),
        ..camera.clone()
    }
}
