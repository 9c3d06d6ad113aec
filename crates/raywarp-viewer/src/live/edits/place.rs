//! Where an instance is moved to.

use glam::{DMat3, DVec3, EulerRot};
use raywarp::scene::{Instance, Mesh, Transform};

/// A move of an instance: scaled, turned about its middle, then shifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shift {
    /// World units.
    pub translate: [f32; 3],
    /// Degrees about the world's x axis, then y, then z, as in a scene file.
    pub rotate: [f32; 3],
    pub scale: f32,
}

impl Shift {
    pub const NONE: Self = Self { translate: [0.0; 3], rotate: [0.0; 3], scale: 1.0 };

    /// A transform after the move; `middle` is a point of the mesh's own space that stays in place but for the shift. In
    /// double precision: the middle of a scene far from the origin does not jitter.
    pub fn of(&self, transform: &Transform, middle: [f32; 3]) -> Transform {
        if *self == Self::NONE {
            return *transform;
        }
        let double = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let linear = DMat3::from_cols_array_2d(&transform.columns.map(|column| column.map(f64::from)));
        let middle = double(middle);
        let world = linear * middle + double(transform.translation);
        let [x, y, z] = self.rotate.map(|degrees| f64::from(degrees).to_radians());
        let linear = DMat3::from_euler(EulerRot::ZYX, z, y, x) * f64::from(self.scale) * linear;
        let translation = world + double(self.translate) - linear * middle;
        Transform {
            columns: linear.to_cols_array_2d().map(|column| column.map(|x| x as f32)),
            translation: translation.as_vec3().to_array(),
        }
    }
}

/// The box of a mesh in its own space; both corners at the origin where there is none.
pub(super) fn bounds(mesh: &Mesh) -> [[f32; 3]; 2] {
    let finite = mesh.positions.iter().filter(|p| p.iter().all(|x| x.is_finite())).map(|&p| [p, p]);
    let join = |a: [[f32; 3]; 2], b: [[f32; 3]; 2]| {
        [[0, 1, 2].map(|i| a[0][i].min(b[0][i])), [0, 1, 2].map(|i| a[1][i].max(b[1][i]))]
    };
    finite.reduce(join).unwrap_or_default()
}

/// The middle of a box.
pub(super) fn middle([low, high]: [[f32; 3]; 2]) -> [f32; 3] {
    [0, 1, 2].map(|i| 0.5 * low[i] + 0.5 * high[i])
}

/// The largest side of a mesh's box, as placed; 1 where there is none.
pub(super) fn size(instances: &[Instance], boxes: &[[[f32; 3]; 2]]) -> f32 {
    let sides = instances.iter().filter_map(|instance| {
        let [low, high] = boxes.get(instance.mesh)?;
        let side = |axis: usize| {
            let column = instance.transform.columns[axis].iter().fold(0.0f32, |a, x| a.max(x.abs()));
            column * (high[axis] - low[axis])
        };
        Some(side(0).max(side(1)).max(side(2)))
    });
    let largest = sides.filter(|side| side.is_finite()).fold(0.0, f32::max);
    if largest > 0.0 {
        largest
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apply(transform: &Transform, p: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = transform.columns;
        [0, 1, 2].map(|i| x[i] * p[0] + y[i] * p[1] + z[i] * p[2] + transform.translation[i])
    }

    fn close(a: [f32; 3], b: [f32; 3]) -> bool {
        (0..3).all(|i| (a[i] - b[i]).abs() < 1e-5)
    }

    #[test]
    fn the_middle_stays_and_the_rest_turns_about_it() {
        let start = Transform { translation: [10.0, 0.0, 0.0], ..Transform::IDENTITY };
        let turned = Shift { rotate: [0.0, 90.0, 0.0], scale: 2.0, ..Shift::NONE }.of(&start, [1.0, 0.0, 0.0]);
        assert!(close(apply(&turned, [1.0, 0.0, 0.0]), [11.0, 0.0, 0.0]));
        // Counter-clockwise seen from above: +X goes to -Z.
        assert!(close(apply(&turned, [2.0, 0.0, 0.0]), [11.0, 0.0, -2.0]));
        let shifted = Shift { translate: [0.0, 3.0, 0.0], ..Shift::NONE }.of(&start, [1.0, 0.0, 0.0]);
        assert!(close(apply(&shifted, [0.0; 3]), [10.0, 3.0, 0.0]));
        assert_eq!(Shift::NONE.of(&start, [0.3; 3]), start);
    }

    #[test]
    fn turns_are_about_x_then_y_then_z() {
        let turned = Shift { rotate: [90.0, 90.0, 0.0], ..Shift::NONE }.of(&Transform::IDENTITY, [0.0; 3]);
        // y goes to z by the first, and z to x by the second.
        assert!(close(apply(&turned, [0.0, 1.0, 0.0]), [1.0, 0.0, 0.0]));
    }

    #[test]
    fn the_middle_of_nothing_is_the_origin() {
        assert_eq!(middle(bounds(&Mesh::default())), [0.0; 3]);
        let positions = vec![[0.0; 3], [f32::NAN; 3], [2.0, 4.0, -6.0]];
        assert_eq!(middle(bounds(&Mesh { positions, ..Mesh::default() })), [1.0, 2.0, -3.0]);
    }
}
