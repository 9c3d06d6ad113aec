//! Maps: a picture's file name between options.

use std::path::Path;

use super::beside;
use crate::load::images::{self, Asker};
use crate::load::text::{parse_f32, Field, Statement};
use crate::load::{LoadError, Sources};
use crate::{Channel, Scene, Texture, Wrap};

/// A `map_` statement as it stands.
pub(super) struct Map {
    pub line: usize,
    /// Relative to the library.
    pub name: String,
    /// `-s`, along u and v.
    pub scale: [f32; 2],
    /// `-o`, along u and v.
    pub offset: [f32; 2],
    /// `-mm`.
    pub base: f32,
    /// `-mm`.
    pub gain: f32,
    /// `-clamp on`.
    pub clamp: bool,
    /// `-imfchan`.
    pub channel: Option<Channel>,
    /// `-bm`.
    pub bump: f32,
}

impl Map {
    /// Options may stand before and behind the name, which may hold blanks. `None` with a warning without a name.
    pub fn read(path: &Path, statement: &Statement, sources: &mut Sources) -> Result<Option<Self>, LoadError> {
        let fields: Vec<_> = statement.fields().collect();
        let mut parser = Parser { path, statement, fields: &fields, at: 0, name: None, map: Self::new(statement.line) };
        while let Some(&field) = fields.get(parser.at) {
            parser.at += 1;
            parser.take(field, sources)?;
        }
        let Some((start, end)) = parser.name else {
            sources.warn(
                path,
                Some(statement.line),
                format!("{} names no image; it is skipped", statement.quoted()),
            )?;
            return Ok(None);
        };
        let name = statement.text_from(start, end);
        Ok(Some(Self { name: name.trim_matches('"').to_owned(), ..parser.map }))
    }

    fn new(line: usize) -> Self {
        Self {
            line,
            name: String::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
            base: 0.0,
            gain: 1.0,
            clamp: false,
            channel: None,
            bump: 1.0,
        }
    }

    /// The map with its picture in the scene.
    pub fn texture(
        &self,
        path: &Path,
        srgb: bool,
        scene: &mut Scene,
        sources: &mut Sources,
    ) -> Result<Texture, LoadError> {
        let asker = Asker { path, line: Some(self.line) };
        let image = images::from_file(&beside(path, &self.name), asker, scene, sources)?;
        let wrap = if self.clamp { Wrap::Clamp } else { Wrap::Repeat };
        Ok(Texture {
            wrap: [wrap; 2],
            channel: self.channel.unwrap_or_default(),
            transform: [[self.scale[0], 0.0, self.offset[0]], [0.0, self.scale[1], self.offset[1]]],
            base: self.base,
            gain: self.gain,
            ..Texture::new(image, srgb)
        })
    }
}

struct Parser<'a, 'b> {
    path: &'a Path,
    statement: &'a Statement<'b>,
    fields: &'a [Field<'b>],
    /// The field that comes next.
    at: usize,
    /// Where the name starts and ends.
    name: Option<(usize, usize)>,
    map: Map,
}

impl<'b> Parser<'_, 'b> {
    /// An option with its values, or a part of the name.
    fn take(&mut self, field: Field<'b>, sources: &mut Sources) -> Result<(), LoadError> {
        match field.bytes {
            b"-s" => self.map.scale = self.up_to_three([1.0; 2])?,
            b"-o" => self.map.offset = self.up_to_three([0.0; 2])?,
            b"-t" => {
                self.up_to_three([0.0; 2])?;
                let message = "'-t' (turbulence) is not supported; the texture is not disturbed";
                sources.warn(self.path, Some(self.statement.line), message)?;
            }
            b"-mm" => {
                self.map.base = self.number()?;
                self.map.gain = self.number()?;
            }
            b"-bm" => self.map.bump = self.number()?,
            b"-clamp" => self.map.clamp = self.value()?.bytes == b"on",
            b"-imfchan" => self.map.channel = self.channel(sources)?,
            b"-blendu" | b"-blendv" | b"-cc" | b"-boost" | b"-texres" | b"-type" | b"-colorspace" => {
                self.value()?;
            }
            _ => {
                let start = self.name.map_or(field.offset, |(start, _)| start);
                self.name = Some((start, field.end()));
            }
        }
        Ok(())
    }

    fn value(&mut self) -> Result<Field<'b>, LoadError> {
        let field = self.fields.get(self.at).copied();
        self.at += 1;
        field.ok_or_else(|| {
            let read = format!("{} ends in an option", self.statement.quoted());
            self.statement.error(self.path, None, read, "its value", "Complete or remove the option.")
        })
    }

    fn number(&mut self) -> Result<f32, LoadError> {
        let field = self.value()?;
        parse_f32(field.bytes).filter(|number| number.is_finite()).ok_or_else(|| self.no_number(field))
    }

    /// `u [v [w]]`: the first two, as far as they are given. A number that ends the line is the name of the image, if
    /// there is no other.
    fn up_to_three(&mut self, mut values: [f32; 2]) -> Result<[f32; 2], LoadError> {
        values[0] = self.number()?;
        for index in 1..3 {
            let may_be_name = self.name.is_none() && self.at + 1 >= self.fields.len();
            let number = self.fields.get(self.at).and_then(|field| parse_f32(field.bytes));
            let Some(number) = number.filter(|number| number.is_finite() && !may_be_name) else { break };
            if let Some(value) = values.get_mut(index) {
                *value = number;
            }
            self.at += 1;
        }
        Ok(values)
    }

    fn channel(&mut self, sources: &mut Sources) -> Result<Option<Channel>, LoadError> {
        let field = self.value()?;
        Ok(Some(match field.bytes {
            b"r" => Channel::Red,
            b"g" => Channel::Green,
            b"b" => Channel::Blue,
            b"m" => Channel::Alpha,
            b"l" => Channel::Luminance,
            _ => {
                let message = format!("'-imfchan' {} is not supported; the default channel is used", field.quoted());
                sources.warn(self.path, Some(self.statement.line), message)?;
                return Ok(None);
            }
        }))
    }

    fn no_number(&self, field: Field) -> LoadError {
        let read = format!("{} is not a finite number", field.quoted());
        self.statement.error(self.path, Some(field), read, "the option's number", "Correct or remove the option.")
    }
}
