//! Materials of a scene file.

use toml::Spanned;

use super::complaint::Complaint;
use super::file::{self, Alpha};
use super::{Failure, Reader};
use crate::scene::load::images::{self, Asker};
use crate::scene::{AlphaMode, Channel, Filter, Material, NormalMap, Texture, Wrap};

impl Reader<'_> {
    /// Reads a material into the scene.
    pub(super) fn material(&mut self, entry: &Spanned<file::Material>) -> Result<(), Failure> {
        let at = entry.span().start;
        let entry = entry.get_ref();
        let usual = Material::default();
        let diffuse = entry.diffuse.map_or(usual.diffuse, |color| color.0);
        let specular = entry.specular.map_or(usual.specular, |color| color.0);
        let material = Material {
            name: entry.name.get_ref().clone(),
            ambient: entry.ambient.map_or(diffuse, |color| color.0),
            diffuse,
            specular,
            shininess: entry.shininess.map_or(USUAL_SHININESS, |number| number.0),
            emission: entry.emission.map_or(usual.emission, |color| color.0),
            reflection: entry.reflection.map_or(usual.reflection, |color| color.0),
            transmission: entry.transmission.map_or(usual.transmission, |color| color.0),
            ior: entry.ior.map_or(usual.ior, |number| number.0),
            fresnel: entry.fresnel,
            opacity: entry.opacity.map_or(usual.opacity, |number| number.0),
            alpha: alpha(entry, at)?,
            unlit: entry.unlit,
            diffuse_map: self.optional(&entry.diffuse_map, true)?,
            specular_map: self.optional(&entry.specular_map, true)?,
            emission_map: self.optional(&entry.emission_map, true)?,
            opacity_map: self.opacity_map(entry)?,
            normal_map: self.normal_map(entry, at)?,
        };
        self.scene.materials.push(material);
        Ok(())
    }

    fn optional(&mut self, entry: &Option<Spanned<file::Texture>>, srgb: bool) -> Result<Option<Texture>, Failure> {
        let Some(entry) = entry else { return Ok(None) };
        if entry.get_ref().0.strength.is_some() {
            let expected = "strength on a normal_map or a height_map alone";
            return Err(Complaint::new(entry.span().start, "a strength", expected).into());
        }
        self.texture(entry, srgb).map(Some)
    }

    fn opacity_map(&mut self, entry: &file::Material) -> Result<Option<Texture>, Failure> {
        let texture = self.optional(&entry.opacity_map, false)?;
        let chosen = entry.opacity_map.as_ref().is_some_and(|map| map.get_ref().0.channel.is_some());
        Ok(texture.map(|texture| if chosen { texture } else { Texture { channel: Channel::Luminance, ..texture } }))
    }

    fn normal_map(&mut self, entry: &file::Material, at: usize) -> Result<Option<NormalMap>, Failure> {
        let strength = |map: &Spanned<file::Texture>| map.get_ref().0.strength.map_or(1.0, |number| number.0);
        Ok(match (&entry.normal_map, &entry.height_map) {
            (None, None) => None,
            (Some(map), None) => Some(NormalMap::Tangent { texture: self.texture(map, false)?, scale: strength(map) }),
            (None, Some(map)) => Some(NormalMap::Height { texture: self.texture(map, false)?, scale: strength(map) }),
            (Some(_), Some(_)) => {
                return Err(Complaint::new(at, "a normal_map and a height_map", "one of them").into());
            }
        })
    }

    fn texture(&mut self, entry: &Spanned<file::Texture>, srgb: bool) -> Result<Texture, Failure> {
        let table = &entry.get_ref().0;
        let asker = Asker { path: self.path, line: Some(self.line(entry.span().start)) };
        let path = self.base.join(&table.file);
        let image = images::from_file(&path, asker, &mut self.scene, self.sources)?;
        let usual = Texture::new(image, table.srgb.unwrap_or(srgb));
        let [u, v] = table.scale.map_or([1.0; 2], |scale| scale.0);
        let [du, dv] = table.offset.map_or([0.0; 2], |offset| offset.map(|number| number.0));
        Ok(Texture {
            wrap: table.wrap.as_ref().map_or(usual.wrap, |wraps| wraps.0.map(Wrap::from)),
            filter: table.filter.map_or(usual.filter, Filter::from),
            channel: table.channel.map_or(usual.channel, Channel::from),
            transform: [[u, 0.0, du], [0.0, v, dv]],
            base: table.base.map_or(usual.base, |number| number.0),
            gain: table.gain.map_or(usual.gain, |number| number.0),
            ..usual
        })
    }
}

/// Of a highlight without a given exponent; it shows only where `specular` is given.
const USUAL_SHININESS: f32 = 32.0;

/// Coverage below one mixes unless the file says otherwise.
fn alpha(entry: &file::Material, at: usize) -> Result<AlphaMode, Complaint> {
    let partial = entry.opacity.is_some_and(|opacity| opacity.0 < 1.0) || entry.opacity_map.is_some();
    let usual = if partial { Alpha::Blend } else { Alpha::Opaque };
    let alpha = entry.alpha.unwrap_or(usual);
    if entry.cutoff.is_some() && alpha != Alpha::Mask {
        return Err(Complaint::new(at, "a cutoff without alpha = \"mask\"", "both or neither"));
    }
    Ok(match alpha {
        Alpha::Opaque => AlphaMode::Opaque,
        Alpha::Mask => AlphaMode::Mask(entry.cutoff.map_or(0.5, |number| number.0)),
        Alpha::Blend => AlphaMode::Blend,
    })
}

impl From<file::Wrap> for Wrap {
    fn from(wrap: file::Wrap) -> Self {
        match wrap {
            file::Wrap::Repeat => Self::Repeat,
            file::Wrap::Clamp => Self::Clamp,
            file::Wrap::Mirror => Self::Mirror,
        }
    }
}

impl From<file::Filtering> for Filter {
    fn from(filter: file::Filtering) -> Self {
        match filter {
            file::Filtering::Nearest => Self::Nearest,
            file::Filtering::Bilinear => Self::Bilinear,
        }
    }
}

impl From<file::Channel> for Channel {
    fn from(channel: file::Channel) -> Self {
        match channel {
            file::Channel::Rgb => Self::Rgb,
            file::Channel::Red => Self::Red,
            file::Channel::Green => Self::Green,
            file::Channel::Blue => Self::Blue,
            file::Channel::Alpha => Self::Alpha,
            file::Channel::Luminance => Self::Luminance,
        }
    }
}
