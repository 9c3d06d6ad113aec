//! Corners of faces: `v`, `v/vt`, `v//vn` and `v/vt/vn`, counted from 1 or backwards from the latest.

use std::path::Path;

use super::points::Points;
use crate::load::text::{parse_integer, Field, Statement};
use crate::load::LoadError;

/// Indices from 0 into the file's points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub position: u32,
    pub uv: Option<u32>,
    pub normal: Option<u32>,
}

/// What a corner names and the file lacks. Of a position that is an error; without the others there is still a surface.
#[derive(Clone, Copy, Default)]
pub(super) struct Lacking {
    pub uv: bool,
    pub normal: bool,
}

/// How many points of each kind stand before a face: negative indices count from there.
#[derive(Clone, Copy, Default)]
pub(super) struct Seen {
    pub positions: usize,
    pub uvs: usize,
    pub normals: usize,
}

/// What a corner needs to be understood.
pub(super) struct Context<'a> {
    pub path: &'a Path,
    pub points: &'a Points,
    pub seen: Seen,
}

impl Context<'_> {
    /// Reads one field of a face, and adds to what is lacking.
    #[inline]
    pub fn corner(&self, statement: &Statement, field: Field, lacking: &mut Lacking) -> Result<Corner, LoadError> {
        let mut parts = field.bytes.split(|&byte| byte == b'/');
        let [position, uv, normal] = [parts.next(), parts.next(), parts.next()].map(Option::unwrap_or_default);
        let indices = (|| {
            Some(Corner {
                position: index(position, self.points.positions.len(), self.seen.positions)?,
                uv: optional(uv, self.points.uvs.len(), self.seen.uvs, &mut lacking.uv)?,
                normal: optional(normal, self.points.normals.len(), self.seen.normals, &mut lacking.normal)?,
            })
        })();
        match indices {
            Some(corner) if parts.next().is_none() => Ok(corner),
            _ => Err(self.explain(statement, field)),
        }
    }

    /// Why a corner could not be read: the slow way, which only errors take.
    #[cold]
    fn explain(&self, statement: &Statement, field: Field) -> LoadError {
        let position = field.bytes.split(|&byte| byte == b'/').next().unwrap_or_default();
        let (total, seen) = (self.points.positions.len(), self.seen.positions);
        if let Some(number) = parse_integer(position).filter(|&number| resolve(number, total, seen).is_none()) {
            let read = format!("{} names vertex {number}", field.quoted());
            let expected = expected_range(total, seen);
            return statement.error(self.path, Some(field), read, &expected, "Check that the file is complete.");
        }
        let read = format!("{} is not a corner of a face", field.quoted());
        const HELP: &str = "Indices are whole numbers, from 1, or below 0 to count backwards.";
        statement.error(self.path, Some(field), read, "'v', 'v/vt', 'v//vn' or 'v/vt/vn'", HELP)
    }
}

fn expected_range(total: usize, seen: usize) -> String {
    match (total, seen) {
        (0, _) => "none, as the file has no 'v'".to_owned(),
        (_, 0) => format!("1 to {total}, as the file has {total} 'v', none of them before this line"),
        _ => format!("1 to {total} or -{seen} to -1, as the file has {total} 'v', {seen} before this line"),
    }
}

/// An index that may be left out, or name what is not there. `None` for what is no index.
#[inline]
fn optional(text: &[u8], total: usize, seen: usize, lacking: &mut bool) -> Option<Option<u32>> {
    if text.is_empty() {
        return Some(None);
    }
    let index = resolve(parse_integer(text)?, total, seen);
    *lacking |= index.is_none();
    Some(index)
}

#[inline]
fn index(text: &[u8], total: usize, seen: usize) -> Option<u32> {
    resolve(parse_integer(text)?, total, seen)
}

#[inline]
fn resolve(number: i64, total: usize, seen: usize) -> Option<u32> {
    let index = if number > 0 { number - 1 } else { i64::try_from(seen).ok()? + number };
    let in_range = number != 0 && index >= 0 && (index as u64) < total as u64;
    in_range.then(|| u32::try_from(index).ok()).flatten()
}
