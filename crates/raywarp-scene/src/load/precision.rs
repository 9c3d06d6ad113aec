//! What rounding to single precision takes from positions that a file gives in double.

use std::path::Path;

use super::Sources;
use crate::{Mesh, Scene};

/// Losses below this share of the geometry's extent need no word. Around the origin no rounding loses more than 2^-24 of
/// it: only what is more than sixty times as far from there as it is large can pass.
const WORTH_TELLING: f64 = 1.0 / (1 << 18) as f64;

/// The rounding of all positions of a file.
#[derive(Clone, Copy, Default)]
pub(super) struct Rounding {
    /// Largest error, in scene units.
    loss: f64,
}

impl Rounding {
    /// The nearest single-precision number.
    #[inline]
    pub fn round(&mut self, value: f64) -> f32 {
        let single = value as f32;
        let loss = (value - f64::from(single)).abs();
        if loss > self.loss && loss.is_finite() {
            self.loss = loss;
        }
        single
    }

    /// Notes the loss where it shows beside the extent of these positions, the file's own.
    pub fn tell(self, path: &Path, positions: impl Iterator<Item = [f32; 3]>, sources: &mut Sources) {
        self.tell_of("positions", path, positions, sources);
    }

    /// The same of the places of a scene's instances.
    pub fn tell_of_places(self, path: &Path, scene: &Scene, sources: &mut Sources) {
        if self.loss > 0.0 {
            self.tell_of("places of instances", path, placed_corners(scene), sources);
        }
    }

    fn tell_of(self, what: &str, path: &Path, positions: impl Iterator<Item = [f32; 3]>, sources: &mut Sources) {
        let (extent, distance) = extent_and_distance(positions);
        if self.loss > WORTH_TELLING * extent && extent > 0.0 {
            sources.inform(
                path,
                format!(
                    "{what} lose up to {:.2e} scene units in single precision: they are up to {distance:.3e} from the \
                     origin, on {extent:.3e} of extent",
                    self.loss
                ),
            );
        }
    }
}

/// The corners of the boxes of all meshes where they are placed.
fn placed_corners(scene: &Scene) -> impl Iterator<Item = [f32; 3]> + '_ {
    let boxes: Vec<_> = scene.meshes.iter().map(corners).collect();
    scene.instances.iter().flat_map(move |instance| {
        let corners = boxes.get(instance.mesh).copied().unwrap_or([[f32::NAN; 3]; 8]);
        corners.map(|corner| instance.transform.point(corner))
    })
}

/// Of the box of a mesh; not finite where there is none.
fn corners(mesh: &Mesh) -> [[f32; 3]; 8] {
    let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for position in &mesh.positions {
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(position[axis]);
            bounds[1][axis] = bounds[1][axis].max(position[axis]);
        }
    }
    std::array::from_fn(|corner| std::array::from_fn(|axis| bounds[(corner >> axis) & 1][axis]))
}

/// The longest side of the bounds, and the largest coordinate.
fn extent_and_distance(positions: impl Iterator<Item = [f32; 3]>) -> (f64, f64) {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for position in positions.filter(|position| position.iter().all(|x| x.is_finite())) {
        for (side, x) in bounds.iter_mut().zip(position.map(f64::from)) {
            *side = [side[0].min(x), side[1].max(x)];
        }
    }
    let extent = bounds.iter().map(|side| side[1] - side[0]).fold(0.0, f64::max);
    let distance = bounds.iter().flatten().filter(|x| x.is_finite()).fold(0.0, |far: f64, x| far.max(x.abs()));
    (extent, distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LoadOptions;

    fn notes(positions: &[[f64; 3]]) -> Vec<String> {
        let mut rounding = Rounding::default();
        let rounded: Vec<_> = positions.iter().map(|position| position.map(|x| rounding.round(x))).collect();
        let mut sources = Sources::new(&LoadOptions { strict: true });
        rounding.tell(Path::new("a"), rounded.into_iter(), &mut sources);
        sources.into_loaded(crate::Scene::default()).notes.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_is_far_away_for_its_size_loses_digits() {
        assert_eq!(
            notes(&[[4500000.123, 0.0, 0.0], [4500001.123, 0.0, 0.0], [4500000.123, 1.0, 0.0]]),
            ["a: positions lose up to 1.23e-1 scene units in single precision: they are up to 4.500e6 from the origin, on \
              1.000e0 of extent"]
        );
    }

    #[test]
    fn what_is_around_the_origin_or_fits_loses_nothing_worth_telling() {
        for fine in [
            &[[0.1, 0.2, 0.3], [1.0 / 3.0, 1e-9, 7.7]][..],
            &[[-4500000.123, 0.1, 0.0], [4500000.123, 0.1, 0.0]],
            &[[4500000.5, 0.0, 0.0], [4500001.0, 1.0, 0.0]],
            &[[2.5, 0.1, 0.3], [2.6, 0.2, 0.4]],
            &[[f64::NAN, 1e99, 0.1]],
            &[],
        ] {
            assert_eq!(notes(fine), [""; 0], "{fine:?}");
        }
    }
}
