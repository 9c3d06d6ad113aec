//! A material as its statements stand.

use std::path::Path;

use super::map::Map;
use crate::load::text::{parse_f32, parse_integer, Field, Statement};
use crate::load::{LoadError, Sources};

/// `newmtl` and what follows it; of two of a kind the last holds.
#[derive(Default)]
pub(super) struct Definition {
    pub name: String,
    pub line: usize,
    /// Ka.
    pub ambient: Option<[f32; 3]>,
    /// Kd.
    pub diffuse: Option<[f32; 3]>,
    /// Ks.
    pub specular: Option<[f32; 3]>,
    /// Ke.
    pub emission: Option<[f32; 3]>,
    /// Tf.
    pub filter: Option<[f32; 3]>,
    /// Ns.
    pub shininess: Option<f32>,
    /// Ni.
    pub ior: Option<f32>,
    /// d.
    pub dissolve: Option<f32>,
    /// Tr; `d` holds where both stand, as programs disagree on what this one means.
    pub transparency: Option<f32>,
    pub illum: Option<i64>,
    /// Pm.
    pub metallic: Option<f32>,
    /// Pr.
    pub roughness: Option<f32>,
    pub ambient_map: Option<Map>,
    pub diffuse_map: Option<Map>,
    pub specular_map: Option<Map>,
    pub emission_map: Option<Map>,
    pub opacity_map: Option<Map>,
    pub bump_map: Option<Map>,
    pub normal_map: Option<Map>,
    pub metallic_map: Option<Map>,
    pub roughness_map: Option<Map>,
}

impl Definition {
    pub fn new(name: String, line: usize) -> Self {
        Self { name, line, ..Self::default() }
    }

    /// Whether it says anything of metal or roughness.
    pub fn is_physical(&self) -> bool {
        let maps = self.metallic_map.is_some() || self.roughness_map.is_some();
        maps || self.metallic.is_some() || self.roughness.is_some()
    }

    /// Whether `Tr` alone says that there is nothing to see: written by programs that mean the opposite by it.
    pub fn is_hidden_by_tr(&self) -> bool {
        self.dissolve.is_none() && self.transparency.is_some_and(|transparency| transparency >= 1.0)
    }

    /// Takes in a statement, by its keyword in lower case. False where that is none of MTL's.
    pub fn statement(
        &mut self,
        path: &Path,
        keyword: &[u8],
        statement: &Statement,
        sources: &mut Sources,
    ) -> Result<bool, LoadError> {
        let mut reader = Reader { path, statement, sources };
        match keyword {
            b"ka" => self.ambient = reader.color()?,
            b"kd" => self.diffuse = reader.color()?,
            b"ks" => self.specular = reader.color()?,
            b"ke" => self.emission = reader.color()?,
            b"tf" => self.filter = reader.color()?,
            b"ns" => self.shininess = reader.scalar()?,
            b"ni" => self.ior = reader.scalar()?,
            b"d" => self.dissolve = reader.dissolve()?,
            b"tr" => self.transparency = reader.scalar()?,
            b"pm" => self.metallic = reader.scalar()?,
            b"pr" => self.roughness = reader.scalar()?,
            b"illum" => self.illum = Some(reader.illum()?),
            b"map_ka" => self.ambient_map = reader.map()?,
            b"map_kd" => self.diffuse_map = reader.map()?,
            b"map_ks" => self.specular_map = reader.map()?,
            b"map_ke" => self.emission_map = reader.map()?,
            b"map_d" => self.opacity_map = reader.map()?,
            b"bump" | b"map_bump" => self.bump_map = reader.map()?,
            b"map_pm" => self.metallic_map = reader.map()?,
            b"map_pr" => self.roughness_map = reader.map()?,
            b"norm" | b"map_norm" => self.normal_map = reader.map()?,
            _ => return Ok(false),
        }
        Ok(true)
    }
}

struct Reader<'a, 'b> {
    path: &'a Path,
    statement: &'a Statement<'b>,
    sources: &'a mut Sources,
}

impl Reader<'_, '_> {
    /// `r [g b]`, `xyz x [y z]` or `spectral file`. `None` with a warning for what cannot be used.
    fn color(&mut self) -> Result<Option<[f32; 3]>, LoadError> {
        let fields: Vec<_> = self.statement.fields().take(4).collect();
        match fields.first().map(|field| field.bytes) {
            Some(b"spectral") => self.warn("spectral curves are not supported; the default colour is used"),
            Some(b"xyz") => Ok(self.numbers(&fields[1..])?.map(linear_from_xyz)),
            _ => self.numbers(&fields[..fields.len().min(3)]),
        }
    }

    /// One number for all channels, or three.
    fn numbers(&mut self, fields: &[Field]) -> Result<Option<[f32; 3]>, LoadError> {
        let numbers = fields.iter().map(|field| self.number(*field)).collect::<Result<Vec<_>, _>>()?;
        match numbers[..] {
            [grey] => self.finite([grey; 3]),
            [r, g, b] => self.finite([r, g, b]),
            _ => Err(self.missing("1 or 3 numbers")),
        }
    }

    fn scalar(&mut self) -> Result<Option<f32>, LoadError> {
        let field = self.statement.fields().next().ok_or_else(|| self.missing("a number"))?;
        let number = self.number(field)?;
        Ok(self.finite([number])?.map(|[number]| number))
    }

    /// `d` or `d -halo`, the latter as the former.
    fn dissolve(&mut self) -> Result<Option<f32>, LoadError> {
        let mut fields = self.statement.fields();
        if fields.next().is_none_or(|field| field.bytes != b"-halo") {
            return self.scalar();
        }
        let field = fields.next().ok_or_else(|| self.missing("a number"))?;
        let number = self.number(field)?;
        self.warn::<()>("'-halo' is not supported; the surface is as transparent from all sides")?;
        Ok(self.finite([number])?.map(|[number]| number))
    }

    fn illum(&mut self) -> Result<i64, LoadError> {
        let field = self.statement.fields().next().ok_or_else(|| self.missing("a number from 0 to 10"))?;
        let number = parse_integer(field.bytes).ok_or_else(|| self.no_number(field))?;
        if (0..=10).contains(&number) {
            return Ok(number);
        }
        self.warn::<()>(&format!("the illumination model {number} is not one of 0 to 10; 2 is used"))?;
        Ok(2)
    }

    fn map(&mut self) -> Result<Option<Map>, LoadError> {
        Map::read(self.path, self.statement, self.sources)
    }

    fn number(&self, field: Field) -> Result<f32, LoadError> {
        parse_f32(field.bytes).ok_or_else(|| self.no_number(field))
    }

    /// Values below 0 are 0; infinity and NaN are as if not written.
    fn finite<const N: usize>(&mut self, numbers: [f32; N]) -> Result<Option<[f32; N]>, LoadError> {
        if numbers.iter().all(|number| number.is_finite()) {
            return Ok(Some(numbers.map(|number| number.max(0.0))));
        }
        self.warn(&format!("{} is not finite; the default is used", self.statement.quoted()))
    }

    fn warn<T>(&mut self, message: &str) -> Result<Option<T>, LoadError> {
        self.sources.warn(self.path, Some(self.statement.line), message)?;
        Ok(None)
    }

    fn no_number(&self, field: Field) -> LoadError {
        let read = format!("{} is not a number", field.quoted());
        self.statement.error(self.path, Some(field), read, "a number", "Write numbers as 1.5 or -2e-3.")
    }

    fn missing(&self, expected: &str) -> LoadError {
        let read = format!("{} has too few numbers", self.statement.quoted());
        self.statement.error(self.path, None, read, expected, "Complete or remove the line.")
    }
}

/// CIE XYZ to linear sRGB (IEC 61966-2-1); what lies outside of the gamut is cut off.
fn linear_from_xyz([x, y, z]: [f32; 3]) -> [f32; 3] {
    [
        3.240_97 * x - 1.537_383 * y - 0.498_611 * z,
        -0.969_244 * x + 1.875_968 * y + 0.041_555 * z,
        0.055_63 * x - 0.203_977 * y + 1.056_972 * z,
    ]
    .map(|channel| channel.max(0.0))
}
