//! Cameras that frame a scene: the silhouette of its vertices fills the picture.
//!
//! Where a pinhole of a given direction must stand so that all points lie between two planes through it is a linear
//! condition on its place: of each plane only the point farthest out along its normal counts. So one pass over the
//! vertices finds the nearest place, exactly.

mod turntable;

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

use crate::scene::{radians, Camera, Instance, Mesh, Projection, Scene, UnknownCamera, Viewpoint};
use turntable::Turntable;

/// Name of the camera that frames a scene without one.
pub(super) const FRAMED: &str = "framed";

/// Vertical field of view of the camera that frames a scene, in radians.
const FOV: f32 = 0.7;

/// Share of a side of the picture that the silhouette takes.
const SHARE: f64 = 0.8;

/// From the front, right and above.
const USUAL_AWAY: DVec3 = DVec3::new(0.45, 0.35, 1.0);

/// The camera that a viewpoint asks for, for pictures of a width over height: one of the scene's by its name; else one
/// that frames the scene, where that is asked for or there is no camera; else the scene's first. Then with what is to be
/// different about it.
///
/// # Errors
/// [`UnknownCamera`] with the names of those that there are.
pub fn chosen_camera(scene: &Scene, viewpoint: &Viewpoint, aspect: f64) -> Result<Camera, UnknownCamera> {
    let camera = match (viewpoint.named(&scene.cameras)?, scene.cameras.first()) {
        (Some(named), _) => named.clone(),
        (None, Some(first)) if !viewpoint.frames() => first.clone(),
        (None, _) => framed(scene, viewpoint, aspect),
    };
    Ok(viewpoint.adjust(camera))
}

/// A view of all of a scene, for pictures of a width over height.
pub(super) fn framed(scene: &Scene, viewpoint: &Viewpoint, aspect: f64) -> Camera {
    let up = viewpoint.up.or(viewpoint.scene_up).or(scene.up).unwrap_or([0.0, 1.0, 0.0]);
    let fov_y = viewpoint.fov.map_or(FOV, radians);
    let axes = Axes::new(away(viewpoint), up);
    let planes = Planes::new(&axes, fov_y, aspect, SHARE * viewpoint.zoom.unwrap_or(1.0));
    if viewpoint.turning {
        return Turntable::new(scene, turn_to(up)).camera(&planes, &axes, fov_y);
    }
    planes.camera(&axes, &planes.of_scene(scene), fov_y)
}

/// A view of a box from the front, right and above, that fits a picture of any format not narrower than it is high.
pub fn framing([low, high]: [[f32; 3]; 2]) -> Camera {
    let axes = Axes::new(USUAL_AWAY, [0.0, 1.0, 0.0]);
    let planes = Planes::new(&axes, FOV, 1.0, SHARE);
    let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
    let support = (0..8).fold(Support::NONE, |support, i| support.join(planes.of_point(corner(i))));
    planes.camera(&axes, &support, FOV)
}

/// The turn that brings +Y to another upward direction and keeps +X where it can: with +Z up the front is at -Y, as
/// programs with +Z up have it.
pub(crate) fn turn_to(up: [f32; 3]) -> DMat3 {
    let up = Vec3::from(up).as_dvec3().normalize_or(DVec3::Y);
    let right = if up.x.abs() < 0.99 { DVec3::X } else { DVec3::Y };
    let right = (right - up * right.dot(up)).normalize();
    DMat3::from_cols(right, up, right.cross(up))
}

/// Direction from the scene to the eye, with +Y up.
fn away(viewpoint: &Viewpoint) -> DVec3 {
    let angles = [USUAL_AWAY.x.atan2(USUAL_AWAY.z), (USUAL_AWAY.y / USUAL_AWAY.length()).asin()].map(f64::to_degrees);
    let [azimuth, elevation] = viewpoint.side.map_or(angles, |side| side.angles());
    let azimuth = viewpoint.azimuth.unwrap_or(azimuth).to_radians();
    let elevation = viewpoint.elevation.unwrap_or(elevation).to_radians();
    DVec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos())
}

/// Right, up and forward of a camera, orthonormal, and its upward direction.
struct Axes {
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    upward: DVec3,
}

impl Axes {
    /// For a direction to the eye with +Y up, in a scene with another one.
    fn new(away: DVec3, up: [f32; 3]) -> Self {
        let turn = turn_to(up);
        let forward = -away.normalize();
        // Straight from above or below, what is behind the scene is up in the picture, or down.
        let upright = if forward.cross(DVec3::Y).length() > 1e-6 { DVec3::Y } else { DVec3::Z * forward.y.signum() };
        let right = forward.cross(upright).normalize();
        let upward = turn * upright;
        Self { right: turn * right, up: turn * right.cross(forward), forward: turn * forward, upward }
    }
}

/// The planes that bound what is to be seen, and the direction of view.
struct Planes {
    /// Normals outwards: right, left, top, bottom.
    sides: [DVec3; 4],
    forward: DVec3,
    /// Tangents of half the angles between left and right, top and bottom.
    tangents: [f64; 2],
}

/// How far points reach along the normals of the planes, and along the view.
#[derive(Clone, Copy)]
struct Support {
    sides: [f64; 4],
    depth: [f64; 2],
}

impl Support {
    const NONE: Self = Self { sides: [f64::NEG_INFINITY; 4], depth: [f64::INFINITY, f64::NEG_INFINITY] };

    fn join(self, other: Self) -> Self {
        let sides = [0, 1, 2, 3].map(|i| self.sides[i].max(other.sides[i]));
        Self { sides, depth: [self.depth[0].min(other.depth[0]), self.depth[1].max(other.depth[1])] }
    }
}

impl Planes {
    fn new(axes: &Axes, fov_y: f32, aspect: f64, share: f64) -> Self {
        let half = share * (0.5 * f64::from(fov_y)).tan();
        let tangents = [half * aspect, half];
        let out = |axis: DVec3, tangent: f64| axis - axes.forward * tangent;
        let [across, along] = tangents;
        let sides = [out(axes.right, across), out(-axes.right, across), out(axes.up, along), out(-axes.up, along)];
        Self { sides, forward: axes.forward, tangents }
    }

    fn of_scene(&self, scene: &Scene) -> Support {
        let supports: Vec<Support> =
            scene.instances.par_iter().map(|instance| self.of_instance(scene, instance)).collect();
        supports.into_iter().fold(Support::NONE, Support::join)
    }

    fn of_point(&self, point: [f32; 3]) -> Support {
        let point = Vec3::from(point).as_dvec3();
        match point.is_finite() {
            true => Support { sides: self.sides.map(|side| side.dot(point)), depth: [self.forward.dot(point); 2] },
            false => Support::NONE,
        }
    }

    /// Of all corners of triangles. The planes go to the mesh's space instead of its vertices to the scene's.
    fn of_instance(&self, scene: &Scene, instance: &Instance) -> Support {
        let Some(mesh) = scene.meshes.get(instance.mesh) else { return Support::NONE };
        let back =
            DMat3::from_cols_array_2d(&instance.transform.columns.map(|column| column.map(f64::from))).transpose();
        let local = Self { sides: self.sides.map(|side| back * side), forward: back * self.forward, ..*self };
        let shift = self.of_point(instance.transform.translation);
        let support = local.of_mesh(mesh);
        let sides = [0, 1, 2, 3].map(|i| support.sides[i] + shift.sides[i]);
        let [near, far] = support.depth;
        match near <= far && shift.depth[0].is_finite() {
            true => Support { sides, depth: [near + shift.depth[0], far + shift.depth[0]] },
            false => Support::NONE,
        }
    }

    fn of_mesh(&self, mesh: &Mesh) -> Support {
        let corner =
            |&index: &u32| mesh.positions.get(index as usize).map_or(Support::NONE, |&point| self.of_point(point));
        let triangle = |triangle: &[u32; 3]| triangle.iter().map(corner).fold(Support::NONE, Support::join);
        mesh.triangles.par_iter().with_min_len(1 << 14).map(triangle).reduce(|| Support::NONE, Support::join)
    }

    /// The nearest camera that has all points between the planes, in the middle between those that do not touch.
    fn camera(&self, axes: &Axes, support: &Support, fov_y: f32) -> Camera {
        let support = if support.depth[0] <= support.depth[1] { *support } else { self.of_point([0.0; 3]) };
        let [right, left, top, bottom] = support.sides;
        let [near, far] = support.depth;
        let (across, along) = (0.5 * (right - left), 0.5 * (top - bottom));
        let fit = |out: f64, other: f64, tangent: f64| -(out + other) / (2.0 * tangent);
        let back = fit(right, left, self.tangents[0]).min(fit(top, bottom, self.tangents[1]));
        let middle = 0.5 * (near + far);
        // A point alone fills nothing: then it is seen from a distance that single precision can tell from none.
        let size = [across, along, middle].into_iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        let least = if size > 0.0 { 1e-4 * size } else { 1.0 };
        let place = |depth: f64| axes.right * across + axes.up * along + axes.forward * depth;
        Camera {
            name: FRAMED.to_owned(),
            eye: place(back.min(middle - least)).as_vec3().to_array(),
            target: place(middle).as_vec3().to_array(),
            up: axes.upward.as_vec3().to_array(),
            projection: Projection::Perspective { fov_y },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::camera::axes;
    use crate::scene::{Side, Transform};

    /// Some crooked triangles, placed twice.
    pub(super) fn scene() -> Scene {
        let mesh = Mesh {
            positions: vec![[0.0; 3], [3.0, 0.5, 0.25], [0.5, 0.25, 1.0], [1.0, 4.0, -0.5], [99.0; 3]],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            materials: vec![0; 2],
            ..Mesh::default()
        };
        let turned =
            Transform { columns: [[0.0, 0.0, 2.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.5]], translation: [5.0, -7.0, 1.0] };
        let instance = |transform| Instance { name: String::new(), mesh: 0, transform, material: None };
        Scene { meshes: vec![mesh], instances: [Transform::IDENTITY, turned].map(instance).into(), ..Scene::default() }
    }

    /// Left, right, bottom and top of the silhouette, -1 and 1 being the sides of the picture.
    pub(super) fn silhouette(scene: &Scene, camera: &Camera, aspect: f32) -> [f32; 4] {
        let [right, up, forward] = axes(camera).unwrap();
        let Projection::Perspective { fov_y } = camera.projection else { unreachable!() };
        let half = (0.5 * fov_y).tan();
        let mut bounds = [f32::INFINITY, f32::NEG_INFINITY, f32::INFINITY, f32::NEG_INFINITY];
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh];
            for &vertex in mesh.triangles.iter().flatten() {
                let point = glam::Mat3::from_cols_array_2d(&instance.transform.columns)
                    * Vec3::from(mesh.positions[vertex as usize]);
                let ray =
                    (point + Vec3::from(instance.transform.translation) - Vec3::from(camera.eye)).to_array().into();
                let depth = forward.dot(ray);
                assert!(depth > 0.0);
                let (x, y) = (right.dot(ray) / depth / half / aspect, up.dot(ray) / depth / half);
                bounds = [bounds[0].min(x), bounds[1].max(x), bounds[2].min(y), bounds[3].max(y)];
            }
        }
        bounds
    }

    #[test]
    fn the_silhouette_takes_four_fifths_of_one_side_and_no_more_of_the_other() {
        let mut views = vec![Viewpoint::default(), Viewpoint { fov: Some(90.0), ..Viewpoint::default() }];
        views.extend(Side::ALL.map(|side| Viewpoint { side: Some(side), ..Viewpoint::default() }));
        views.push(Viewpoint {
            azimuth: Some(200.0),
            elevation: Some(-35.0),
            scene_up: Some([0.0, 0.0, 1.0]),
            ..Viewpoint::default()
        });
        for view in views {
            for aspect in [16.0 / 9.0, 1.0, 0.25] {
                let camera = chosen_camera(&scene(), &view, aspect).unwrap();
                let [left, right, bottom, top] = silhouette(&scene(), &camera, aspect as f32);
                let largest = (0.5 * (right - left)).max(0.5 * (top - bottom));
                assert!((largest - 0.8).abs() < 1e-4, "{view:?} {aspect}: {left} {right} {bottom} {top}");
                assert!(left >= -0.8001 && right <= 0.8001 && bottom >= -0.8001 && top <= 0.8001);
            }
        }
        let zoomed = Viewpoint { zoom: Some(0.5), ..Viewpoint::default() };
        let [left, right, bottom, top] = silhouette(&scene(), &chosen_camera(&scene(), &zoomed, 1.0).unwrap(), 1.0);
        assert!(((right - left).max(top - bottom) - 0.8).abs() < 1e-4);
    }

    #[test]
    fn sides_and_upward_axes_are_where_people_look_for_them() {
        let forward = |side, up| {
            let view = Viewpoint { side: Some(side), scene_up: Some(up), ..Viewpoint::default() };
            let [right, up, forward] = axes(&chosen_camera(&scene(), &view, 1.0).unwrap()).unwrap();
            [forward, right, up].map(|axis| axis.to_array().map(|x| x.round() + 0.0))
        };
        let (y, z) = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        assert_eq!(forward(Side::Front, y), [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], y]);
        assert_eq!(forward(Side::Right, y), [[-1.0, 0.0, 0.0], [0.0, 0.0, -1.0], y]);
        assert_eq!(forward(Side::Top, y), [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]);
        assert_eq!(forward(Side::Bottom, y), [y, [1.0, 0.0, 0.0], z]);
        assert_eq!(forward(Side::Front, z), [y, [1.0, 0.0, 0.0], z]);
        assert_eq!(forward(Side::Right, z), [[-1.0, 0.0, 0.0], y, z]);
        assert_eq!(forward(Side::Front, [0.0, -1.0, 0.0])[2], [0.0, -1.0, 0.0]);
    }

    #[test]
    fn what_has_no_size_is_seen_too() {
        let mut point = scene();
        point.meshes[0].positions = vec![[1e6, 3.0, 2.0]; 5];
        for scene in [&point, &Scene::default()] {
            let camera = chosen_camera(scene, &Viewpoint::default(), 1.5).unwrap();
            assert!(axes(&camera).is_ok(), "{camera:?}");
        }
    }
}
