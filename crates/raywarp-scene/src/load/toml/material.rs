//! Materials of a scene file.

use toml::Spanned;

use super::complaint::Complaint;
use super::file;
use super::{texture, Failure, Reader};
use crate::load::images::{self, Asker};
use crate::schema::Described;
use crate::{AlphaMode, Channel, Filter, Material, MetallicRoughness, NormalMap, Texture, Wrap};

impl Reader<'_> {
    /// A material of this file.
    pub(super) fn new_material(&mut self, entry: &Spanned<file::Material>, name: &str) -> Result<Material, Failure> {
        let mut material = Material { name: name.to_owned(), ..Material::default() };
        for parameter in Material::parameters() {
            if let Some(usual) = parameter.default() {
                parameter.set(&mut material, usual);
            }
        }
        let file::Material { given, others } = entry.get_ref();
        material.ambient = given.get("diffuse").unwrap_or(material.ambient);
        // Coverage below one mixes unless the file says otherwise.
        let mapped = others.opacity_map.as_ref().is_some_and(|map| map.get_ref().table().is_some());
        if mapped || given.get("opacity").is_some_and(|opacity: f32| opacity < 1.0) {
            material.alpha = AlphaMode::Blend;
        }
        self.set_material(entry, &mut material)?;
        Ok(material)
    }

    /// Gives a material what an entry says, and leaves the rest of it alone.
    pub(super) fn set_material(
        &mut self,
        entry: &Spanned<file::Material>,
        material: &mut Material,
    ) -> Result<(), Failure> {
        let at = entry.span().start;
        let file::Material { given, others } = entry.get_ref();
        given.apply(material);
        if given.get::<f32>("cutoff").is_some() && !matches!(material.alpha, AlphaMode::Mask(_)) {
            return Err(Complaint::new(at, "a cutoff without alpha = \"mask\"", "both or neither").into());
        }
        set(&mut material.diffuse_map, self.map(&others.diffuse_map, true)?);
        set(&mut material.specular_map, self.map(&others.specular_map, true)?);
        set(&mut material.emission_map, self.map(&others.emission_map, true)?);
        set(&mut material.opacity_map, self.opacity_map(others)?);
        set(&mut material.normal_map, self.normal_map(others, at)?);
        self.physical_maps(others, material)
    }

    /// Maps of numbers of the metallic-roughness model, which a material has from then on.
    fn physical_maps(&mut self, others: &file::MaterialKeys, material: &mut Material) -> Result<(), Failure> {
        let maps = [&others.metallic_map, &others.roughness_map, &others.transmission_map];
        let [metallic, roughness, transmission] = maps.map(|map| self.map(map, false));
        let (metallic, roughness, transmission) = (metallic?, roughness?, transmission?);
        if [metallic, roughness, transmission].iter().all(Option::is_none) {
            return Ok(());
        }
        let phong = MetallicRoughness::of_phong(material);
        let own = material.metallic_roughness.get_or_insert(phong);
        set(&mut own.metallic_map, metallic);
        set(&mut own.roughness_map, roughness);
        set(&mut own.transmission_map, transmission);
        Ok(())
    }

    /// What an entry says about a map: nothing, that there is none, or a texture.
    fn map(&mut self, entry: &MapEntry, srgb: bool) -> Result<Option<Option<Texture>>, Failure> {
        let Some(entry) = entry else { return Ok(None) };
        let Some(table) = entry.get_ref().table() else { return Ok(Some(None)) };
        if table.strength.is_some() {
            let expected = "strength on a normal_map or a height_map alone";
            return Err(Complaint::new(entry.span().start, "a strength", expected).into());
        }
        self.texture(table, entry.span().start, srgb).map(|texture| Some(Some(texture)))
    }

    fn opacity_map(&mut self, entry: &file::MaterialKeys) -> Result<Option<Option<Texture>>, Failure> {
        let map = self.map(&entry.opacity_map, false)?;
        let table = entry.opacity_map.as_ref().and_then(|map| map.get_ref().table());
        if table.is_some_and(|table| table.channel.is_some()) {
            return Ok(map);
        }
        Ok(map.map(|texture| texture.map(|texture| Texture { channel: Channel::Luminance, ..texture })))
    }

    /// The same of what bends the normal: the two kinds of maps are one thing of a material.
    fn normal_map(&mut self, entry: &file::MaterialKeys, at: usize) -> Result<Option<Option<NormalMap>>, Failure> {
        let given = |entry: &'_ MapEntry| entry.as_ref().is_some_and(|map| map.get_ref().table().is_some());
        match (given(&entry.normal_map), given(&entry.height_map)) {
            (true, true) => return Err(Complaint::new(at, "a normal_map and a height_map", "one of them").into()),
            (false, false) => return Ok((entry.normal_map.is_some() || entry.height_map.is_some()).then_some(None)),
            _ => {}
        }
        let normal = self.bump(&entry.normal_map)?.map(|(texture, scale)| NormalMap::Tangent { texture, scale });
        let height = self.bump(&entry.height_map)?.map(|(texture, scale)| NormalMap::Height { texture, scale });
        Ok(Some(normal.or(height)))
    }

    /// A texture that is not for colours, and its strength.
    fn bump(&mut self, entry: &MapEntry) -> Result<Option<(Texture, f32)>, Failure> {
        let Some((map, table)) = entry.as_ref().and_then(|map| Some((map, map.get_ref().table()?))) else {
            return Ok(None);
        };
        let texture = self.texture(table, map.span().start, false)?;
        Ok(Some((texture, table.strength.map_or(1.0, |number| number.0))))
    }

    fn texture(&mut self, table: &texture::TextureTable, at: usize, srgb: bool) -> Result<Texture, Failure> {
        let asker = Asker { path: self.path, line: Some(self.line(at)) };
        let path = self.folder.join(&table.file);
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

/// What a material says about a map.
type MapEntry = Option<Spanned<texture::Texture>>;

fn set<T>(value: &mut T, given: Option<T>) {
    if let Some(given) = given {
        *value = given;
    }
}

impl From<texture::Wrap> for Wrap {
    fn from(wrap: texture::Wrap) -> Self {
        match wrap {
            texture::Wrap::Repeat => Self::Repeat,
            texture::Wrap::Clamp => Self::Clamp,
            texture::Wrap::Mirror => Self::Mirror,
        }
    }
}

impl From<texture::Filtering> for Filter {
    fn from(filter: texture::Filtering) -> Self {
        match filter {
            texture::Filtering::Nearest => Self::Nearest,
            texture::Filtering::Bilinear => Self::Bilinear,
        }
    }
}

impl From<texture::Channel> for Channel {
    fn from(channel: texture::Channel) -> Self {
        match channel {
            texture::Channel::Rgb => Self::Rgb,
            texture::Channel::Red => Self::Red,
            texture::Channel::Green => Self::Green,
            texture::Channel::Blue => Self::Blue,
            texture::Channel::Alpha => Self::Alpha,
            texture::Channel::Luminance => Self::Luminance,
        }
    }
}
