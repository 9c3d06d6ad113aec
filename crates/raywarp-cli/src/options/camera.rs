//! Options of the camera.

use clap::Args;
use raywarp::scene::{Side, Viewpoint};

use crate::values::{self, Upward};

/// From where to look: options of every command that makes pictures.
#[derive(Debug, Args)]
pub struct CameraOptions {
    /// A camera of the scene, by its name or its number from 0; none: the first, or one that frames everything
    #[arg(long, value_name = "NAME|INDEX", help_heading = "Camera")]
    pub camera: Option<String>,
    /// Put the camera there
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = values::vector)]
    #[arg(help_heading = "Camera")]
    pub eye: Option<[f32; 3]>,
    /// Look at this point
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = values::vector)]
    #[arg(help_heading = "Camera")]
    pub target: Option<[f32; 3]>,
    /// What is up in the picture: a vector, or an axis such as +Z, which turns the built-in sun and sky as well
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = values::upward)]
    #[arg(help_heading = "Camera")]
    pub up: Option<Upward>,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::field_of_view, help_heading = "Camera")]
    pub fov: Option<f64>,
    /// Parallel rays, for a picture of this height in scene units
    #[arg(long, value_name = "HEIGHT", value_parser = values::height, conflicts_with = "fov", help_heading = "Camera")]
    pub ortho: Option<f32>,
    /// Frame the scene from this side: front, back, left, right, top, bottom
    #[arg(long, value_name = "SIDE", conflicts_with_all = ["camera", "eye", "target"], help_heading = "Camera")]
    #[arg(value_parser = values::words::<Side>(Side::ALL.map(Side::name)), hide_possible_values = true)]
    pub view: Option<Side>,
    /// Frame it from so many degrees about its upward axis, from the front to the right
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true, value_parser = values::azimuth)]
    #[arg(conflicts_with_all = ["camera", "eye", "target"], help_heading = "Camera")]
    pub azimuth: Option<f64>,
    /// Frame it from so many degrees above its horizon
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true, value_parser = values::elevation)]
    #[arg(conflicts_with_all = ["camera", "eye", "target"], help_heading = "Camera")]
    pub elevation: Option<f64>,
    /// Frame it so many times as large as all of it would be
    #[arg(long, value_name = "FACTOR", value_parser = values::zoom)]
    #[arg(conflicts_with_all = ["camera", "eye", "target"], help_heading = "Camera")]
    pub zoom: Option<f64>,
}

impl CameraOptions {
    /// The same in the library's words.
    pub fn viewpoint(&self) -> Viewpoint {
        Viewpoint {
            camera: self.camera.clone(),
            eye: self.eye,
            target: self.target,
            up: self.up.map(|up| up.direction),
            fov: self.fov,
            height: self.ortho,
            side: self.view,
            azimuth: self.azimuth,
            elevation: self.elevation,
            zoom: self.zoom,
            turning: false,
            scene_up: self.up.filter(|up| up.is_axis).map(|up| up.direction),
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use raywarp::scene::{degrees, Camera, Projection, Side};

    use crate::options::RenderOptions;

    fn asked(words: &[&str]) -> Result<Camera, clap::Error> {
        let options = RenderOptions::try_parse_from([&["render"], words].concat())?;
        let projection = Projection::Perspective { fov_y: 0.5 };
        let camera = Camera { name: String::new(), eye: [0.0; 3], target: [0.0; 3], up: [0.0; 3], projection };
        Ok(options.camera.viewpoint().adjust(camera))
    }

    #[test]
    fn every_angle_can_be_asked_for() {
        for i in 1..2000 {
            let fov_y = 0.0015 * i as f32;
            let camera = asked(&["--fov", &degrees(fov_y).to_string()]).unwrap();
            assert_eq!(camera.projection, Projection::Perspective { fov_y });
        }
    }

    #[test]
    fn parallel_rays_have_a_height_and_no_angle() {
        let camera = asked(&["--eye", "-1e-9,2,3.5e20", "--ortho", "2.5"]).unwrap();
        assert_eq!((camera.eye, camera.projection), ([-1e-9, 2.0, 3.5e20], Projection::Orthographic { height: 2.5 }));
        assert!(asked(&["--ortho", "2.5", "--fov", "40"]).is_err());
        assert!(asked(&["--ortho", "0"]).is_err());
    }

    #[test]
    fn an_axis_by_its_name_turns_the_scene_and_a_vector_the_picture() {
        let view = |up: &str| RenderOptions::parse_from(["render", "--up", up]).camera.viewpoint();
        let z = Some([0.0, 0.0, 1.0]);
        assert_eq!((view("+Z").up, view("+Z").scene_up), (z, z));
        assert_eq!((view("0,0,1").up, view("0,0,1").scene_up), (z, None));
    }

    #[test]
    fn a_framed_scene_has_a_side_or_angles_and_no_other_camera() {
        let view = RenderOptions::parse_from(["render", "--view", "left", "--elevation", "-20", "--zoom", "2"])
            .camera
            .viewpoint();
        assert_eq!(
            (view.side, view.azimuth, view.elevation, view.zoom),
            (Some(Side::Left), None, Some(-20.0), Some(2.0))
        );
        for words in [["--view", "inside"], ["--zoom", "0"], ["--elevation", "91"], ["--azimuth", "nan"]] {
            assert!(asked(&words).is_err(), "{words:?}");
        }
        assert!(asked(&["--view", "top", "--eye", "1,2,3"]).is_err());
    }
}
