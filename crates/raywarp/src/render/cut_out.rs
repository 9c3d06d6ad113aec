//! Pictures without what lies behind the scene.

use rayon::prelude::*;

use super::{camera, RenderError, Tracer};
use crate::image::Picture;
use crate::scene::Camera;

impl Tracer {
    /// Takes the background away from a picture that this camera took: what remains of each pixel is the radiance of what
    /// its rays hit, times the share of them that did, which stands beside it (premultiplied alpha). Mirrors keep what they
    /// see. At an edge the background is taken as it is in the middle of the pixel.
    ///
    /// # Errors
    /// [`RenderError::Camera`] for a camera that cannot have taken it.
    pub fn cut_out(&self, picture: &mut Picture, camera: &Camera) -> Result<(), RenderError> {
        let camera = camera::kernel_camera(camera, picture.whole)?;
        let (background, [left, top]) = (self.scene.appearance()?.lighting.background, picture.origin);
        let width = picture.width.max(1) as usize;
        picture.pixels.par_chunks_mut(width).enumerate().for_each(|(row, pixels)| {
            for (column, [r, g, b, share]) in pixels.iter_mut().enumerate() {
                let (x, y) = (left as f32 + column as f32 + 0.5, top as f32 + row as f32 + 0.5);
                let behind = background.radiance(camera.ray(x, y).direction).to_array();
                for (channel, behind) in [r, g, b].into_iter().zip(behind) {
                    let own = (*channel - (1.0 - *share) * behind).max(0.0);
                    *channel = if *share > 0.0 { own } else { 0.0 };
                }
            }
        });
        Ok(())
    }
}
