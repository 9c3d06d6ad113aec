//! The first pass: what faces refer to.

use std::path::Path;

use crate::load::colors::{decoded, ChannelRange};
use crate::load::precision::Rounding;
use crate::load::repair::unit_or_zero;
use crate::load::text::{parse_f64, Statement, Statements, Strays};
use crate::load::{LoadError, Sources};
use crate::memory::{Budget, Growth};

/// The points of a file, in its order, and the material libraries it names.
#[derive(Default)]
pub(super) struct Points {
    /// `v`: may be infinite or NaN.
    pub positions: Vec<[f32; 3]>,
    /// Linear colours of `positions` with alpha; empty where no vertex has one, white or left out at the end where only
    /// some have.
    pub colors: Vec<[f32; 4]>,
    /// `vt`, all finite.
    pub uvs: Vec<[f32; 2]>,
    /// `vn`: unit vectors, or zero for those without a direction.
    pub normals: Vec<[f32; 3]>,
    /// `mtllib`, with the line.
    pub libraries: Vec<(usize, String)>,
    odd_uvs: usize,
    odd_normals: usize,
    /// `v` with numbers that mean nothing.
    odd_counts: Strays,
    /// Colours with a channel that is cut off at 1.
    bright_colors: usize,
    rounding: Rounding,
}

/// Most bytes of a position, a colour, a texture coordinate or a normal.
const POINT_BYTES: usize = 16;

impl Points {
    /// All points of a file.
    pub fn read(path: &Path, bytes: &[u8], budget: &Budget) -> Result<Self, LoadError> {
        let (mut points, mut growth) = (Self::default(), Growth::new(budget));
        for statement in Statements::new(bytes) {
            growth.reach(points.count() + 1, POINT_BYTES).map_err(LoadError::memory(path, "its points"))?;
            match statement.keyword {
                b"v" => points.position(path, &statement)?,
                b"vt" => points.uv(path, &statement)?,
                b"vn" => points.normal(path, &statement)?,
                b"mtllib" => points.library(&statement),
                _ => {}
            }
        }
        points.finish_colors();
        Ok(points)
    }

    fn count(&self) -> usize {
        self.positions.len() + self.colors.len() + self.uvs.len() + self.normals.len()
    }

    /// Reports what was replaced.
    pub fn warn(&self, path: &Path, sources: &mut Sources) -> Result<(), LoadError> {
        self.rounding.tell(path, self.positions.iter().copied(), sources);
        let (is, are) = (
            "has more numbers than 'v x y z' has a meaning for; the first 3 count",
            "have more numbers than 'v x y z' has a meaning for; the first 3 count",
        );
        if let Some(message) = self.odd_counts.message(is, are) {
            sources.warn(path, Some(self.odd_counts.line), message)?;
        }
        if self.bright_colors > 0 {
            let message = format!("{} vertex colours are brighter than 1 and are cut off there", self.bright_colors);
            sources.warn(path, None, message)?;
        }
        if self.odd_uvs > 0 {
            let message = format!("{} 'vt' are not finite; 0 stands in for them", self.odd_uvs);
            sources.warn(path, None, message)?;
        }
        if self.odd_normals > 0 {
            let message = format!("{} 'vn' are not finite; flat normals stand in for them", self.odd_normals);
            sources.warn(path, None, message)?;
        }
        Ok(())
    }

    /// `v x y z [w]` or `v x y z r g b [a]`. The weight serves rational curves alone.
    fn position(&mut self, path: &Path, statement: &Statement) -> Result<(), LoadError> {
        const EXPECTED: &str = "'v x y z', then perhaps a weight, or 'r g b' and perhaps 'a'";
        let (numbers, count) = numbers::<7>(path, statement, EXPECTED)?;
        if count < 3 {
            return Err(wrong_count(path, statement, count, EXPECTED));
        }
        let [x, y, z, r, g, b, a] = numbers;
        match count {
            3 | 4 => {}
            6 => self.color([r, g, b, f64::NAN]),
            7 => self.color([r, g, b, a]),
            _ => self.odd_counts.count(statement),
        }
        self.positions.push([x, y, z].map(|x| self.rounding.round(x)));
        Ok(())
    }

    /// The colour of the position that comes next, as it is written.
    fn color(&mut self, color: [f64; 4]) {
        self.colors.resize(self.positions.len(), NO_COLOR);
        self.colors.push(color.map(|channel| channel as f32));
    }

    /// Programs write vertex colours as they show them, in sRGB. A colour that is not finite is white, and no alpha is 1.
    fn finish_colors(&mut self) {
        let channels = |colors: &[[f32; 4]]| ChannelRange::of(colors.iter().flat_map(|&[r, g, b, _]| [r, g, b]));
        let range = channels(&self.colors);
        let alphas = ChannelRange::of(self.colors.iter().map(|color| color[3]));
        for color in &mut self.colors {
            let [r, g, b, a] = *color;
            let finite = [r, g, b].iter().all(|channel| channel.is_finite());
            self.bright_colors += usize::from(finite && [r, g, b].iter().any(|&channel| range.cuts(channel)));
            let [r, g, b] = if finite { [r, g, b].map(|channel| decoded(range.unit(channel))) } else { [1.0; 3] };
            *color = [r, g, b, if a.is_finite() { alphas.unit(a) } else { 1.0 }];
        }
    }

    /// `vt u [v] [w]`.
    fn uv(&mut self, path: &Path, statement: &Statement) -> Result<(), LoadError> {
        const EXPECTED: &str = "'vt u v'";
        let (numbers, count) = numbers::<2>(path, statement, EXPECTED)?;
        if count == 0 {
            return Err(wrong_count(path, statement, count, EXPECTED));
        }
        let numbers = numbers.map(|x| x as f32);
        let finite = numbers.iter().all(|x| x.is_finite());
        self.odd_uvs += usize::from(!finite);
        self.uvs.push(if finite { numbers } else { [0.0; 2] });
        Ok(())
    }

    /// `vn x y z`, of any length.
    fn normal(&mut self, path: &Path, statement: &Statement) -> Result<(), LoadError> {
        const EXPECTED: &str = "'vn x y z'";
        let (numbers, count) = numbers::<3>(path, statement, EXPECTED)?;
        if count < 3 {
            return Err(wrong_count(path, statement, count, EXPECTED));
        }
        let normal = numbers.map(|x| x as f32);
        self.odd_normals += usize::from(!normal.iter().all(|x| x.is_finite()));
        self.normals.push(unit_or_zero(normal));
        Ok(())
    }

    /// `mtllib a.mtl b.mtl`, and names with blanks: a name ends with `.mtl`, or else at a blank. Quotes stay, as they may
    /// be part of a name.
    fn library(&mut self, statement: &Statement) {
        let mut start = None;
        for field in statement.fields() {
            let from = *start.get_or_insert(field.offset);
            let name = statement.text_from(from, field.end());
            let is_quoted = name.len() > 1 && name.starts_with('"') && name.ends_with('"');
            if is_quoted || field.bytes.to_ascii_lowercase().ends_with(b".mtl") {
                self.libraries.push((statement.line, name));
                start = None;
            }
        }
        let Some(from) = start else { return };
        let rest = statement.fields().skip_while(|field| field.offset < from);
        self.libraries.extend(rest.map(|field| (statement.line, statement.text_from(field.offset, field.end()))));
    }
}

/// Stands for the colours of vertices that have none.
const NO_COLOR: [f32; 4] = [f32::NAN; 4];

/// The first `N` numbers of a statement, 0 where there are fewer, and how many there are.
#[inline]
fn numbers<const N: usize>(path: &Path, statement: &Statement, expected: &str) -> Result<([f64; N], usize), LoadError> {
    let mut numbers = [0.0; N];
    let mut count = 0;
    for field in statement.fields() {
        let number = parse_f64(field.bytes).ok_or_else(|| {
            let read = format!("{} is not a number", field.quoted());
            statement.error(path, Some(field), read, expected, "Write numbers as 1.5 or -2e-3.")
        })?;
        if let Some(slot) = numbers.get_mut(count) {
            *slot = number;
        }
        count += 1;
    }
    Ok((numbers, count))
}

fn wrong_count(path: &Path, statement: &Statement, count: usize, expected: &str) -> LoadError {
    let read = format!("{} has {count} {}", statement.quoted(), if count == 1 { "number" } else { "numbers" });
    statement.error(path, None, read, expected, "Complete the line, or export the file again.")
}
