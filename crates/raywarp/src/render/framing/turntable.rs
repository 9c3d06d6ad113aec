//! Framing what turns: as much of the picture as it takes in any direction.

use glam::{DMat3, DVec3, Vec3};

use super::{Axes, Planes, Support};
use crate::scene::{Camera, Instance, Scene};

/// The cylinder that a scene sweeps as it turns about the upward axis through the middle of its box.
pub(super) struct Turntable {
    /// Right, up and front of the scene.
    basis: DMat3,
    centre: DVec3,
    radius: f64,
    /// Lowest and highest, along the axis.
    heights: [f64; 2],
}

impl Turntable {
    pub fn new(scene: &Scene, basis: DMat3) -> Self {
        let (right, up, front) = (basis.x_axis, basis.y_axis, basis.z_axis);
        let walls = Planes { sides: [right, -right, front, -front], forward: up, tangents: [0.0; 2] };
        let Support { sides: [right_most, left_most, front_most, back_most], depth: heights } = walls.of_scene(scene);
        if heights[0] > heights[1] {
            return Self { basis, centre: DVec3::ZERO, radius: 0.0, heights: [0.0; 2] };
        }
        let centre = right * (0.5 * (right_most - left_most)) + front * (0.5 * (front_most - back_most));
        let out = |point: DVec3| (point - centre).reject_from_normalized(up).length();
        let radius = scene.instances.iter().flat_map(|instance| corners(scene, instance)).map(out).fold(0.0, f64::max);
        Self { basis, centre, radius, heights }
    }

    /// Sees all of it. Its target is on the axis, where the camera may be turned about it.
    pub fn camera(&self, planes: &Planes, axes: &Axes, fov_y: f32) -> Camera {
        const POINTS: usize = 64;
        let rim = |i: usize| {
            let (sin, cos) = (std::f64::consts::TAU * (i / 2) as f64 / POINTS as f64).sin_cos();
            let around = self.basis.x_axis * cos + self.basis.z_axis * sin;
            self.centre + around * self.radius + self.basis.y_axis * self.heights[i % 2]
        };
        let points = (0..2 * POINTS).map(|i| planes.of_point(rim(i).as_vec3().to_array()));
        let camera = planes.camera(axes, &points.fold(Support::NONE, Support::join), fov_y);
        let (eye, axis) = (Vec3::from(camera.eye).as_dvec3(), self.basis.y_axis);
        let rise = axes.up.dot(axis);
        let height = match rise.abs() > 1e-3 {
            true => axes.up.dot(eye - self.centre) / rise,
            false => 0.5 * (self.heights[0] + self.heights[1]),
        };
        Camera { target: (self.centre + axis * height).as_vec3().to_array(), ..camera }
    }
}

/// The corners of an instance's triangles in the scene's space.
fn corners<'a>(scene: &'a Scene, instance: &'a Instance) -> impl Iterator<Item = DVec3> + 'a {
    let mesh = scene.meshes.get(instance.mesh);
    let linear = DMat3::from_cols_array_2d(&instance.transform.columns.map(|column| column.map(f64::from)));
    let shift = Vec3::from(instance.transform.translation).as_dvec3();
    let indices = mesh.into_iter().flat_map(|mesh| mesh.triangles.iter().flatten().map(move |&index| (mesh, index)));
    let points = indices.filter_map(|(mesh, index)| mesh.positions.get(index as usize));
    points.map(move |&point| linear * Vec3::from(point).as_dvec3() + shift).filter(|point| point.is_finite())
}

#[cfg(test)]
mod tests {
    use super::super::chosen_camera;
    use super::super::tests::{scene, silhouette};
    use super::*;
    use crate::scene::Viewpoint;

    #[test]
    fn what_turns_stays_in_the_picture() {
        let view = Viewpoint { turning: true, elevation: Some(30.0), ..Viewpoint::default() };
        let first = chosen_camera(&scene(), &view, 1.0).unwrap();
        let mut largest = 0.0f32;
        for degrees in 0..360 {
            let (turn, target) = (glam::Quat::from_rotation_y((degrees as f32).to_radians()), Vec3::from(first.target));
            let eye = (target + turn * (Vec3::from(first.eye) - target)).to_array();
            let [left, right, bottom, top] = silhouette(&scene(), &Camera { eye, ..first.clone() }, 1.0);
            let reach = [-left, right, -bottom, top].into_iter().fold(0.0, f32::max);
            assert!(reach < 0.801, "{degrees}: {left} {right} {bottom} {top}");
            largest = largest.max(reach);
        }
        assert!(largest > 0.7, "{largest}");
    }
}
