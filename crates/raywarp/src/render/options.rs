//! What a picture may be asked to be.

use raywarp_scene::settings::RenderDefaults;
pub use raywarp_scene::settings::{Integrator, MAX_DEPTH, MAX_SIDE, MAX_SPP};

use super::RenderError;

const _: () = assert!(MAX_DEPTH == raywarp_core::shade::whitted::MAX_DEPTH);

/// The options of a picture, with their defaults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderOptions {
    /// Width and height of the whole picture, in pixels.
    pub size: [u32; 2],
    /// Samples a pixel, at least 1.
    pub spp: u32,
    /// How light is followed.
    pub integrator: Integrator,
    /// Bounces after the camera ray, at most [`MAX_DEPTH`]. Light is looked for at the last one too, so paths of light are
    /// scattered once more often.
    pub max_depth: u32,
    /// Whether lights cast shadows.
    pub shadows: bool,
    /// Changes the random numbers.
    pub seed: u32,
    /// Left, top, right and bottom of the part to render, in pixels, the last two exclusive; `None` for all.
    pub crop: Option<[u32; 4]>,
    /// Whether to count the tests of each pixel.
    pub count_tests: bool,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self::from(&RenderDefaults::default())
    }
}

impl From<&RenderDefaults> for RenderOptions {
    /// A whole picture as the scene or the command line asks for, and else as usual.
    fn from(wanted: &RenderDefaults) -> Self {
        Self {
            size: wanted.size(),
            spp: wanted.spp(),
            integrator: wanted.integrator(),
            max_depth: wanted.max_depth(),
            shadows: wanted.shadows(),
            seed: wanted.seed(),
            crop: None,
            count_tests: false,
        }
    }
}

/// The part of the picture to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub origin: [u32; 2],
    pub extent: [u32; 2],
}

impl Window {
    pub fn pixels(&self) -> usize {
        self.extent[0] as usize * self.extent[1] as usize
    }
}

impl RenderOptions {
    /// The window, once every option is in its range.
    pub(super) fn check(&self) -> Result<Window, RenderError> {
        let refuse = |sentence: String| Err(RenderError::Option(sentence));
        let [width, height] = self.size;
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return refuse(format!("a picture of {width}x{height} pixels is not possible: a side has 1 to {MAX_SIDE}"));
        }
        if !(1..=MAX_SPP).contains(&self.spp) {
            return refuse(format!("{} samples a pixel are not possible: there are 1 to {MAX_SPP}", self.spp));
        }
        if self.max_depth > MAX_DEPTH {
            return refuse(format!("a depth of {} is not possible: it is 0 to {MAX_DEPTH}", self.max_depth));
        }
        if self.count_tests && self.integrator == Integrator::Path {
            return refuse("tests are counted with the integrator whitted alone".to_owned());
        }
        let [left, top, right, bottom] = self.crop.unwrap_or([0, 0, width, height]);
        if left >= right || top >= bottom || right > width || bottom > height {
            return refuse(format!(
                "the crop {left},{top},{right},{bottom} holds no pixel of the {width}x{height} picture: of \
                 left,top,right,bottom, left < right <= {width} and top < bottom <= {height}"
            ));
        }
        Ok(Window { origin: [left, top], extent: [right - left, bottom - top] })
    }
}
