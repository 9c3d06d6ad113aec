//! Binary STL: a head of 80 bytes, the number of triangles, and 50 bytes for each.
//!
//! The last two of these were to be zero. Two programs put colours there, 5 bits a channel, taken as sRGB: VisCAM and
//! SolidView where bit 15 is set, red in the highest bits; Magics, which writes `COLOR=` and four bytes into the head for
//! all other facets, where it is not set, red in the lowest.

use std::path::Path;

use super::{Contents, Solid};
use crate::load::colors::decoded;
use crate::load::precision::Rounding;
use crate::load::{LoadError, Place};
use crate::memory::{Budget, Growth};

const HEAD: usize = 80;
/// Where the first triangle begins.
const BODY: usize = HEAD + 4;
const TRIANGLE: usize = 50;
/// Each triangle may have three vertices of its own, and they are counted by `u32`.
const MAX_TRIANGLES: u64 = u32::MAX as u64 / 3;

/// Whether the file is just as long as its number of triangles asks for.
pub(super) fn has_its_size(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|count| bytes.len() as u64 == size(count))
}

/// Reads the one solid.
pub(super) fn read(path: &Path, bytes: &[u8], budget: &Budget) -> Result<Contents, LoadError> {
    let Some(count) = count(bytes) else { return Err(no_stl(path, bytes.len())) };
    let available = bytes.len() as u64;
    if size(count) > available || u64::from(count) > MAX_TRIANGLES {
        return Err(too_many(path, count, available));
    }
    let triangles = || bytes[BODY..].chunks_exact(TRIANGLE).take(count as usize);
    let palette = Palette::of(&bytes[..HEAD], triangles().map(attribute));
    let (mut solid, mut growth) = (Solid::new(String::new()), Growth::new(budget));
    for triangle in triangles() {
        solid.add(corners(triangle), palette.color(attribute(triangle)));
        growth.reach(1, solid.bytes()).map_err(LoadError::memory(path, "its triangles"))?;
    }
    let mut warnings = Vec::new();
    let behind = available - size(count);
    if behind > 0 {
        warnings.push((None, format!("{behind} bytes behind the last triangle are skipped")));
    }
    let other = triangles().filter(|triangle| matches!(palette, Palette::None) && attribute(triangle) != 0).count();
    if other > 0 {
        warnings.push((None, format!("{other} triangles have attributes that are no colours; they are left out")));
    }
    Ok(Contents { solids: vec![solid], rounding: Rounding::default(), warnings })
}

/// The number of triangles that the file claims.
fn count(bytes: &[u8]) -> Option<u32> {
    bytes.get(HEAD..)?.first_chunk().map(|count| u32::from_le_bytes(*count))
}

/// Bytes of a file of so many triangles.
fn size(count: u32) -> u64 {
    BODY as u64 + TRIANGLE as u64 * u64::from(count)
}

/// The first vertex follows the normal, which is not needed.
fn corners(triangle: &[u8]) -> [[f32; 3]; 3] {
    let number = |at: usize| f32::from_le_bytes(std::array::from_fn(|byte| triangle[4 * at + byte]));
    [3, 6, 9].map(|first| [0, 1, 2].map(|axis| number(first + axis)))
}

fn attribute(triangle: &[u8]) -> u16 {
    u16::from_le_bytes([triangle[TRIANGLE - 2], triangle[TRIANGLE - 1]])
}

/// What attributes mean.
enum Palette {
    None,
    /// White where there is no colour.
    SolidView,
    /// The colour of facets without one of their own.
    Magics([f32; 4]),
}

impl Palette {
    fn of(head: &[u8], mut attributes: impl Iterator<Item = u16>) -> Self {
        const KEY: &[u8] = b"COLOR=";
        let key = head.windows(KEY.len()).position(|window| window == KEY);
        if let Some(rgba) = key.and_then(|key| head.get(key + KEY.len()..)?.first_chunk::<4>()) {
            let [r, g, b, a] = rgba.map(|byte| f32::from(byte) / 255.0);
            return Self::Magics([decoded(r), decoded(g), decoded(b), a]);
        }
        match attributes.any(|attribute| attribute & OWN != 0) {
            true => Self::SolidView,
            false => Self::None,
        }
    }

    fn color(&self, attribute: u16) -> Option<[f32; 4]> {
        let [low, middle, high] = [0, 5, 10].map(|shift| decoded(f32::from(attribute >> shift & 31) / 31.0));
        let is_set = attribute & OWN != 0;
        match *self {
            Self::None => None,
            Self::SolidView if is_set => Some([high, middle, low, 1.0]),
            Self::SolidView => Some([1.0; 4]),
            Self::Magics(color) if is_set => Some(color),
            Self::Magics(_) => Some([low, middle, high, 1.0]),
        }
    }
}

/// Set where SolidView gives a colour, and where Magics gives none.
const OWN: u16 = 1 << 15;

fn no_stl(path: &Path, length: usize) -> LoadError {
    LoadError::Syntax {
        path: path.to_owned(),
        place: Place::Byte(0),
        read: format!("the file has {length} bytes and does not begin with 'solid'"),
        expected: format!("text that does, or the {BODY} bytes that begin a binary STL file"),
        help: "Check that this is a whole STL file.".to_owned(),
    }
}

fn too_many(path: &Path, count: u32, available: u64) -> LoadError {
    LoadError::TooLarge {
        path: path.to_owned(),
        place: Place::Byte(HEAD as u64),
        what: format!(
            "{count} triangles are claimed, which take {} bytes, and the file has {available}; the limit is \
             {MAX_TRIANGLES} triangles",
            size(count)
        ),
        help: "The file is cut off or no STL file: write it again.".to_owned(),
    }
}
