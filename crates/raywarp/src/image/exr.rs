//! Pictures and layers as OpenEXR: linear, 32 bits a channel, neither exposed nor tone-mapped.
//!
//! One part with the channels `R`, `G`, `B`, `A` and, for each layer, the names that tev and Mitsuba 3 group by:
//! `depth.Z`, `normal.X`, `albedo.R`, `uv.U`, `position.X`, `primitive.ID`, `material.ID`, `tests.nodes`.

use std::io::Cursor;

use ::exr::meta::attribute::{AttributeValue, Text};
use ::exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, Layer as Part, LayerAttributes, SmallVec,
    WritableImage,
};
use raywarp_core::kernels::FirstHit;
use raywarp_core::math::Vec3;
use raywarp_core::traversal::Tests;

use super::provenance::EXR_FINGERPRINT;
use super::{Format, ImageError, Layer, Layers, Picture, Provenance};

type Channel = AnyChannel<FlatSamples>;

/// The bytes of an EXR file with the picture and the asked layers. Of an index that is not there, all bits are set.
///
/// # Errors
/// [`ImageError::NoLayer`] for a layer that `layers` lacks, [`ImageError::Encode`] for a picture without pixels.
pub fn encode(picture: &Picture, layers: Option<&Layers>, asked: &[Layer]) -> Result<Vec<u8>, ImageError> {
    encode_described(picture, layers, asked, None)
}

/// As [`encode`], for a file that says how it was made.
///
/// # Errors
/// As for [`encode`].
pub fn encode_described(
    picture: &Picture,
    layers: Option<&Layers>,
    asked: &[Layer],
    provenance: Option<&Provenance>,
) -> Result<Vec<u8>, ImageError> {
    let (width, height) = (picture.width, picture.height);
    let failed = |reason: String| ImageError::Encode { format: Format::Exr, width, height, reason };
    let count = width as usize * height as usize;
    if count == 0 || picture.pixels.len() != count {
        return Err(failed(format!("it holds {} pixels", picture.pixels.len())));
    }
    let mut channels = picture_channels(picture);
    for &layer in asked {
        let layers = layers.filter(|layers| layers.first_hits.len() == count).ok_or(ImageError::NoLayer(layer))?;
        channels.extend(layer_channels(layers, layer)?);
    }
    let size = (width as usize, height as usize);
    // A crop keeps its place within the whole, so that parts can be put together again.
    let layer_position = ::exr::math::Vec2(picture.origin[0] as i32, picture.origin[1] as i32);
    let attributes = LayerAttributes { layer_position, ..attributes(provenance) };
    let part = Part::new(size, attributes, Encoding::SMALL_FAST_LOSSLESS, AnyChannels::sort(channels));
    let whole = (picture.whole[0] as usize, picture.whole[1] as usize);
    let image = Image::empty(ImageAttributes::with_size(whole)).with_layer(part);
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_unbuffered(&mut bytes).map_err(|error| failed(error.to_string()))?;
    Ok(bytes.into_inner())
}

fn attributes(provenance: Option<&Provenance>) -> LayerAttributes {
    let Some(Provenance { software, comment, fingerprint }) = provenance else { return LayerAttributes::default() };
    // Attributes hold no more than Latin-1.
    let text = |text: &str| Text::new_or_none(text.replace(|c: char| !c.is_ascii(), "?"));
    let mut attributes =
        LayerAttributes { software_name: text(software), comments: text(comment), ..LayerAttributes::default() };
    if let (Some(name), Some(value)) = (text(EXR_FINGERPRINT), text(fingerprint)) {
        attributes.other.insert(name, AttributeValue::Text(value));
    }
    attributes
}

fn picture_channels(picture: &Picture) -> SmallVec<[Channel; 4]> {
    let names = ["R", "G", "B", "A"];
    let channel = |(index, name)| {
        let samples = picture.pixels.iter().map(|pixel| pixel[index]).collect();
        AnyChannel::new(name, FlatSamples::F32(samples))
    };
    names.into_iter().enumerate().map(channel).collect()
}

fn layer_channels(layers: &Layers, layer: Layer) -> Result<Vec<Channel>, ImageError> {
    let first_hits = FirstHits(&layers.first_hits, layer);
    Ok(match layer {
        Layer::Depth => vec![first_hits.float("Z", |s| s.depth)],
        Layer::Normal => first_hits.vector(["X", "Y", "Z"], |s| s.normal),
        Layer::Albedo => first_hits.vector(["R", "G", "B"], |s| s.albedo),
        Layer::Uv => vec![first_hits.float("U", |s| s.uv[0]), first_hits.float("V", |s| s.uv[1])],
        Layer::Position => first_hits.vector(["X", "Y", "Z"], |s| s.position),
        Layer::Primitive => vec![first_hits.index("ID", |s| s.primitive)],
        Layer::Instance => vec![first_hits.index("ID", |s| s.instance)],
        Layer::Material => vec![first_hits.index("ID", |s| s.material)],
        Layer::Tests => test_channels(layers.tests.as_deref().ok_or(ImageError::NoLayer(layer))?),
    })
}

fn test_channels(tests: &[Tests]) -> Vec<Channel> {
    let channel = |name: &str, pick: fn(&Tests) -> u32| {
        let name = format!("{}.{name}", Layer::Tests);
        AnyChannel::new(name.as_str(), FlatSamples::U32(tests.iter().map(pick).collect()))
    };
    vec![channel("nodes", |t| t.nodes), channel("triangles", |t| t.triangles), channel("rays", |t| t.rays)]
}

/// First hits, and the layer that names the channels made of them.
struct FirstHits<'a>(&'a [FirstHit], Layer);

impl FirstHits<'_> {
    fn channel(&self, name: &str, samples: FlatSamples) -> Channel {
        AnyChannel::new(format!("{}.{name}", self.1).as_str(), samples)
    }

    fn float(&self, name: &str, pick: fn(&FirstHit) -> f32) -> Channel {
        self.channel(name, FlatSamples::F32(self.0.iter().map(pick).collect()))
    }

    fn index(&self, name: &str, pick: fn(&FirstHit) -> u32) -> Channel {
        self.channel(name, FlatSamples::U32(self.0.iter().map(pick).collect()))
    }

    fn vector(&self, names: [&str; 3], pick: fn(&FirstHit) -> Vec3) -> Vec<Channel> {
        let channel = |(index, name)| {
            let samples = self.0.iter().map(|first_hit| pick(first_hit).to_array()[index]).collect();
            self.channel(name, FlatSamples::F32(samples))
        };
        names.into_iter().enumerate().map(channel).collect()
    }
}

#[cfg(test)]
mod tests {
    use ::exr::prelude::{ReadChannels, ReadLayers};

    use super::*;

    #[test]
    fn channels_are_named_by_layer_and_hold_what_was_given() {
        let picture = Picture {
            width: 2,
            height: 1,
            origin: [3, 4],
            whole: [16, 9],
            pixels: vec![[0.5, 1.0, 4.0, 1.0], [0.0; 4]],
        };
        let seen = FirstHit { depth: 2.5, primitive: 7, ..FirstHit::NONE };
        let tests = Some(vec![Tests { nodes: 3, triangles: 5, rays: 1 }, Tests::default()]);
        let layers = Layers { width: 2, height: 1, first_hits: vec![seen, FirstHit::NONE], tests };
        let bytes = encode(&picture, Some(&layers), &Layer::ALL).unwrap();

        let image = ::exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
        let image = image.first_valid_layer().all_attributes().from_buffered(Cursor::new(bytes)).unwrap();
        assert_eq!(image.layer_data.attributes.layer_position, ::exr::math::Vec2(3, 4));
        assert_eq!(image.attributes.display_window.size, ::exr::math::Vec2(16, 9));
        let channels = &image.layer_data.channel_data.list;
        let names: Vec<_> = channels.iter().map(|channel| channel.name.to_string()).collect();
        let expected =
            "A B G R albedo.B albedo.G albedo.R depth.Z instance.ID material.ID normal.X normal.Y normal.Z position.X \
                        position.Y position.Z primitive.ID tests.nodes tests.rays tests.triangles uv.U uv.V";
        assert_eq!(names.join(" "), expected);
        let of = |name: &str| &channels.iter().find(|channel| channel.name.eq(name)).unwrap().sample_data;
        assert_eq!(of("B"), &FlatSamples::F32(vec![4.0, 0.0]));
        assert_eq!(of("depth.Z"), &FlatSamples::F32(vec![2.5, f32::INFINITY]));
        assert_eq!(of("primitive.ID"), &FlatSamples::U32(vec![7, u32::MAX]));
        assert_eq!(of("tests.triangles"), &FlatSamples::U32(vec![5, 0]));
    }

    #[test]
    fn a_layer_that_was_not_rendered_is_an_error() {
        let picture = Picture { width: 1, height: 1, whole: [1, 1], pixels: vec![[0.0; 4]], ..Picture::default() };
        assert!(matches!(encode(&picture, None, &[Layer::Depth]), Err(ImageError::NoLayer(Layer::Depth))));
    }
}
