//! Options of the camera.

use clap::Args;
use raywarp::scene::Viewpoint;

use crate::values;

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
    /// What is up in the picture: a vector or an axis, such as +Z
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = values::direction)]
    #[arg(help_heading = "Camera")]
    pub up: Option<[f32; 3]>,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::field_of_view, help_heading = "Camera")]
    pub fov: Option<f64>,
    /// Parallel rays, for a picture of this height in scene units
    #[arg(long, value_name = "HEIGHT", value_parser = values::height, conflicts_with = "fov", help_heading = "Camera")]
    pub ortho: Option<f32>,
}

impl CameraOptions {
    /// The same in the library's words.
    pub fn viewpoint(&self) -> Viewpoint {
        let (eye, target, up, fov) = (self.eye, self.target, self.up, self.fov);
        Viewpoint { camera: self.camera.clone(), eye, target, up, fov, height: self.ortho }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use raywarp::scene::{degrees, Camera, Projection};

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
}
