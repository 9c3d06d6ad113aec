//! Layers as pictures to look at.

use raywarp_core::display::byte;
use raywarp_core::false_color::{self as colors, is_miss, NOTHING};
pub use raywarp_core::false_color::{depth, HEAT};
use raywarp_core::kernels::FirstHit;
use raywarp_core::math::Vec3;

use super::{heatmap, ImageError, Layer, Layers, Rgb8};

/// A layer as a picture, and what its colours mean.
///
/// Normals and positions show x, y, z as red, green, blue; depth is white in front and dark grey at the far end;
/// texture coordinates show their fractional parts as red and green; an index has a colour of its own.
///
/// # Errors
/// [`ImageError::NoLayer`] for tests that were not counted.
pub fn draw(layers: &Layers, layer: Layer) -> Result<(Rgb8, String), ImageError> {
    let seen = || layers.first_hits.iter().filter(|first_hit| !is_miss(first_hit));
    Ok(match layer {
        Layer::Depth => {
            let range = Range::of(seen().map(|first_hit| first_hit.depth));
            let picture = draw_aov(layers, |s| colors::depth(range.share(s.depth)));
            (picture, format!("white is {}, dark grey {} scene units away", range.low, range.high))
        }
        Layer::Normal => {
            (draw_aov(layers, |s| colors::normal(s.normal)), "0.5 n + 0.5: grey is 0, full is +1".to_owned())
        }
        Layer::Albedo => (draw_aov(layers, |s| colors::albedo(s.albedo)), "diffuse colour, sRGB".to_owned()),
        Layer::Uv => {
            let channel = |x: f32| byte(x - x.floor());
            let picture = draw_aov(layers, |s| [channel(s.uv[0]), channel(s.uv[1]), 0]);
            (picture, "fractional part of u is red, of v is green".to_owned())
        }
        Layer::Position => position(layers),
        Layer::Primitive => {
            let triangle = |s: &FirstHit| colors::triangle(s.instance, s.primitive);
            (draw_aov(layers, triangle), "a colour for each triangle".to_owned())
        }
        Layer::Instance => (draw_aov(layers, |s| colors::index(s.instance)), "a colour for each instance".to_owned()),
        Layer::Material => (draw_aov(layers, |s| colors::index(s.material)), "a colour for each material".to_owned()),
        Layer::Tests => {
            let tests = layers.tests.as_deref().ok_or(ImageError::NoLayer(layer))?;
            let (picture, scale) = heatmap::draw(layers.width, layers.height, tests, None);
            (picture, scale.to_string())
        }
    })
}

fn draw_aov(layers: &Layers, color: impl Fn(&FirstHit) -> [u8; 3]) -> Rgb8 {
    let pixel = |first_hit: &FirstHit| if is_miss(first_hit) { NOTHING } else { color(first_hit) };
    let pixels = layers.first_hits.iter().map(pixel).collect();
    Rgb8 { width: layers.width, height: layers.height, pixels }
}

fn position(layers: &Layers) -> (Rgb8, String) {
    let seen = || layers.first_hits.iter().filter(|first_hit| !is_miss(first_hit));
    let axis = |pick: fn(Vec3) -> f32| Range::of(seen().map(|first_hit| pick(first_hit.position)));
    let [x, y, z] = [axis(|p| p.x), axis(|p| p.y), axis(|p| p.z)];
    let color = |s: &FirstHit| [x.share(s.position.x), y.share(s.position.y), z.share(s.position.z)].map(byte);
    let text = format!("from black to full: x {x} is red, y {y} is green, z {z} is blue");
    (draw_aov(layers, color), text)
}

/// The finite values of a layer from the smallest to the largest; from 0 to 0 where there are none.
struct Range {
    low: f32,
    high: f32,
}

impl Range {
    fn of(values: impl Iterator<Item = f32>) -> Self {
        let finite = values.filter(|value| value.is_finite());
        let (low, high) =
            finite.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if low <= high {
            Self { low, high }
        } else {
            Self { low: 0.0, high: 0.0 }
        }
    }

    fn share(&self, value: f32) -> f32 {
        colors::share(value, self.low, self.high)
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} to {}", self.low, self.high)
    }
}
