//! From the number of a frame to its camera.

use raywarp::render::check_camera;
use raywarp::scene::{Camera, CameraPath, Viewpoint};

use super::orbit::{nearest_in_sight, Orbit};
use super::range::Range;
use crate::failure::{Context, Failure, Result};
use crate::render::Setup;

/// A camera in motion.
pub struct Flight {
    way: Way,
    /// All frames of the flight, of which a run may render a part.
    whole: Range,
}

enum Way {
    Orbit(Orbit, f64),
    Path(CameraPath, Viewpoint),
}

impl Flight {
    /// The flight that options ask for. `path` is the one that they name.
    pub fn new(setup: &Setup, path: Option<&CameraPath>, whole: Range) -> Self {
        let options = setup.options;
        let way = match path {
            Some(path) => Way::Path(path.clone(), options.camera.viewpoint()),
            None => Way::Orbit(orbit(setup), options.frames.orbit.unwrap_or_default()),
        };
        Self { way, whole }
    }

    /// The camera of a frame.
    pub fn camera(&self, frame: u32) -> Camera {
        match &self.way {
            Way::Orbit(orbit, degrees) => orbit.turned(degrees * self.share(frame, degrees % 360.0 == 0.0)),
            Way::Path(path, view) => view.adjust(path.at_share(self.share(frame, path.is_closed()))),
        }
    }

    /// Share of the way at a frame. One that comes back to its start is there in the frame after the last, so that the
    /// frames can be played in a loop; any other ends in the last frame.
    fn share(&self, frame: u32, comes_back: bool) -> f64 {
        let (done, last) = (frame - self.whole.first, self.whole.last - self.whole.first);
        let steps = f64::from(last) + if comes_back { 1.0 } else { 0.0 };
        if steps > 0.0 {
            f64::from(done) / steps
        } else {
            0.0
        }
    }

    /// Finds out whether every frame can be taken, before the first one is.
    ///
    /// # Errors
    /// For the first frame that cannot.
    pub fn check(&self, frames: Range) -> Result<()> {
        for frame in frames.frames() {
            check_camera(&self.camera(frame)).with_context(|| format!("frame {frame}"))?;
        }
        Ok(())
    }
}

/// The camera about its target, and about what its user calls up, else the scene's +Y.
fn orbit(setup: &Setup) -> Orbit {
    let options = setup.options;
    let camera = setup.camera.clone();
    let centre = match setup.has_target() {
        true => camera.target,
        // Any point of the line of sight gives the same first frame; this one keeps the scene in sight.
        false => nearest_in_sight(&camera, middle(setup.tracer.report().bounds)),
    };
    Orbit { centre, axis: options.camera.viewpoint().upward(), camera }
}

fn middle([low, high]: [[f32; 3]; 2]) -> [f32; 3] {
    [0, 1, 2].map(|axis| 0.5 * low[axis] + 0.5 * high[axis])
}

/// A path by its name, else by its number.
///
/// # Errors
/// Where there is none such, with the names of those that there are.
pub fn named<'a>(paths: &'a [CameraPath], wanted: &str) -> Result<&'a CameraPath> {
    let by_name = paths.iter().find(|path| path.name() == wanted);
    let by_index = || wanted.parse::<usize>().ok().and_then(|index| paths.get(index));
    by_name.or_else(by_index).ok_or_else(|| {
        let names: Vec<_> = paths.iter().enumerate().map(|(i, path)| format!("{i} '{}'", path.name())).collect();
        match paths {
            [] => Failure::new(format_args!(
                "there is no camera path '{wanted}': the scene has none; write [[paths]] into a scene file, or take \
                 --orbit"
            )),
            _ => Failure::new(format_args!("there is no camera path '{wanted}'; the scene has {}", names.join(", "))),
        }
    })
}
