//! The first pass: what faces refer to.

use std::path::Path;

use crate::load::text::{parse_f32, Statement, Statements};
use crate::load::{LoadError, Sources};
use crate::srgb::srgb_to_linear;

/// The points of a file, in its order, and the material libraries it names.
#[derive(Default)]
pub(super) struct Points {
    /// `v`: may be infinite or NaN.
    pub positions: Vec<[f32; 3]>,
    /// Linear colours of `positions`; empty where no vertex has one, white or left out at the end where only some have.
    pub colors: Vec<[f32; 3]>,
    /// `vt`, all finite.
    pub uvs: Vec<[f32; 2]>,
    /// `vn`: unit vectors, or zero for those without a direction.
    pub normals: Vec<[f32; 3]>,
    /// `mtllib`, with the line.
    pub libraries: Vec<(usize, String)>,
    odd_uvs: usize,
    odd_normals: usize,
}

impl Points {
    /// All points of a file.
    pub fn read(path: &Path, bytes: &[u8]) -> Result<Self, LoadError> {
        let mut points = Self::default();
        for statement in Statements::new(bytes) {
            match statement.keyword {
                b"v" => points.position(path, &statement)?,
                b"vt" => points.uv(path, &statement)?,
                b"vn" => points.normal(path, &statement)?,
                b"mtllib" => points.library(&statement),
                _ => {}
            }
        }
        Ok(points)
    }

    /// Reports what was replaced.
    pub fn warn(&self, path: &Path, sources: &mut Sources) -> Result<(), LoadError> {
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

    /// `v x y z [w] [r g b]`. The weight serves rational curves alone.
    fn position(&mut self, path: &Path, statement: &Statement) -> Result<(), LoadError> {
        const EXPECTED: &str = "'v x y z', then perhaps a weight, then perhaps 'r g b'";
        let (numbers, count) = numbers::<7>(path, statement, EXPECTED)?;
        let color = match count {
            3 | 4 => None,
            6 => Some([numbers[3], numbers[4], numbers[5]]),
            7 => Some([numbers[4], numbers[5], numbers[6]]),
            _ => return Err(wrong_count(path, statement, count, EXPECTED)),
        };
        if let Some(color) = color {
            self.colors.resize(self.positions.len(), WHITE);
            self.colors.push(linear(color));
        }
        self.positions.push([numbers[0], numbers[1], numbers[2]]);
        Ok(())
    }

    /// `vt u [v] [w]`.
    fn uv(&mut self, path: &Path, statement: &Statement) -> Result<(), LoadError> {
        const EXPECTED: &str = "'vt u v'";
        let (numbers, count) = numbers::<2>(path, statement, EXPECTED)?;
        if count == 0 {
            return Err(wrong_count(path, statement, count, EXPECTED));
        }
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
        self.odd_normals += usize::from(!numbers.iter().all(|x| x.is_finite()));
        self.normals.push(unit(numbers));
        Ok(())
    }

    /// `mtllib a.mtl b.mtl`, and names with blanks: a name ends with `.mtl`, or else at a blank.
    fn library(&mut self, statement: &Statement) {
        let mut start = None;
        for field in statement.fields() {
            let from = *start.get_or_insert(field.offset);
            if field.bytes.to_ascii_lowercase().ends_with(b".mtl") {
                self.libraries.push((statement.line, statement.text_from(from, field.end())));
                start = None;
            }
        }
        let Some(from) = start else { return };
        let rest = statement.fields().skip_while(|field| field.offset < from);
        self.libraries.extend(rest.map(|field| (statement.line, statement.text_from(field.offset, field.end()))));
    }
}

const WHITE: [f32; 3] = [1.0; 3];

/// The first `N` numbers of a statement, 0 where there are fewer, and how many there are.
#[inline]
fn numbers<const N: usize>(path: &Path, statement: &Statement, expected: &str) -> Result<([f32; N], usize), LoadError> {
    let mut numbers = [0.0; N];
    let mut count = 0;
    for field in statement.fields() {
        let number = parse_f32(field.bytes).ok_or_else(|| {
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

/// A direction as a unit vector, zero for none.
fn unit(vector: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = vector.map(f64::from);
    let length = (x * x + y * y + z * z).sqrt();
    if length > 0.0 && length.is_finite() {
        [x, y, z].map(|x| (x / length) as f32)
    } else {
        [0.0; 3]
    }
}

/// Programs write vertex colours as they show them, in sRGB. A colour that is not finite is white.
fn linear(color: [f32; 3]) -> [f32; 3] {
    if !color.iter().all(|x| x.is_finite()) {
        return WHITE;
    }
    color.map(|x| srgb_to_linear(x.max(0.0)))
}
