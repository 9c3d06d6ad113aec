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
    /// Reads one field of a face.
    #[inline]
    pub fn corner(&self, statement: &Statement, field: Field) -> Result<Corner, LoadError> {
        let mut parts = field.bytes.split(|&byte| byte == b'/');
        let [position, uv, normal] = [parts.next(), parts.next(), parts.next()].map(Option::unwrap_or_default);
        let indices = (|| {
            Some(Corner {
                position: index(position, self.points.positions.len(), self.seen.positions)?,
                uv: optional(uv, self.points.uvs.len(), self.seen.uvs)?,
                normal: optional(normal, self.points.normals.len(), self.seen.normals)?,
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
        let parts: Vec<_> = field.bytes.split(|&byte| byte == b'/').collect();
        let kinds = [
            ("vertex", "v", self.points.positions.len(), self.seen.positions),
            ("texture coordinate", "vt", self.points.uvs.len(), self.seen.uvs),
            ("normal", "vn", self.points.normals.len(), self.seen.normals),
        ];
        for (position, (part, (kind, keyword, total, seen))) in parts.iter().zip(kinds).enumerate() {
            let may_be_empty = position > 0;
            let Some(number) = parse_integer(part) else {
                if part.is_empty() && may_be_empty {
                    continue;
                }
                break;
            };
            if resolve(number, total, seen).is_none() {
                let read = format!("{} names {kind} {number}", field.quoted());
                let expected = expected_range(keyword, total, seen);
                return statement.error(self.path, Some(field), read, &expected, "Check that the file is complete.");
            }
        }
        let read = format!("{} is not a corner of a face", field.quoted());
        const HELP: &str = "Indices are whole numbers, from 1, or below 0 to count backwards.";
        statement.error(self.path, Some(field), read, "'v', 'v/vt', 'v//vn' or 'v/vt/vn'", HELP)
    }
}

fn expected_range(keyword: &str, total: usize, seen: usize) -> String {
    match (total, seen) {
        (0, _) => format!("none, as the file has no '{keyword}'"),
        (_, 0) => format!("1 to {total}, as the file has {total} '{keyword}', none of them before this line"),
        _ => format!("1 to {total} or -{seen} to -1, as the file has {total} '{keyword}', {seen} before this line"),
    }
}

/// An index that may be left out.
#[inline]
fn optional(text: &[u8], total: usize, seen: usize) -> Option<Option<u32>> {
    if text.is_empty() {
        return Some(None);
    }
    index(text, total, seen).map(Some)
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
