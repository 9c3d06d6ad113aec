//! Stanford PLY: ascii and binary of both byte orders.
//!
//! One mesh, one instance, one grey material. What is read:
//! - `vertex`: `x y z`; `nx ny nz`; `red green blue [alpha]` (also with `diffuse_` in front); `s t`, `u v` or
//!   `texture_u texture_v`, v up. Every numeric type will do. Integer colours are sRGB, as scanners and editors write
//!   them, and become linear; floating point colours are taken as linear. Alpha is linear always.
//! - `face` with a list `vertex_indices` or `vertex_index`; polygons are cut into triangles. As MeshLab writes them: a
//!   list `texcoord` with u and v of each corner, `texnumber`, and the colour of a face, as for vertices.
//! - `tristrips`, strips that -1 separates, every second triangle turned round.
//!
//! - `comment TextureFile NAME`, a picture for the first set of texture coordinates that there is, of corners or of
//!   vertices; of several, `texnumber` says which.
//!
//! Other elements and properties are passed over. Floating point colours that count to 255 are sRGB too. Vertices without normals get smooth ones
//! ([`smooth`](crate::normals::smooth)). The material's diffuse reflectance is 0.8, so that vertex colours,
//! which multiply it, stay near what they are and white does not reflect all light.
//!
//! The header is read by `ply-rs-bw`; the body is not. That crate reads no `nan` or `inf` in ascii, cannot say at
//! which byte a binary file went wrong, and counts elements without properties one by one, 4,000,000,000 if the header
//! says so.

mod color;
mod elements;
mod faces;
mod header;
mod split;
mod surface;
mod values;
mod vertices;

use std::path::Path;

use self::elements::Reader;
use self::header::Header;
use super::{LoadError, Sources};
use crate::Scene;

/// Reads the one mesh of a PLY file.
///
/// # Errors
/// [`LoadError::Io`] for an unreadable file, [`LoadError::TooLarge`] for a header that claims more than the file
/// holds, [`LoadError::Syntax`] for everything else.
pub(super) fn read(path: &Path, sources: &mut Sources) -> Result<Scene, LoadError> {
    let bytes = sources.bytes(path)?;
    let header = Header::parse(path, &bytes)?;
    header.check_against_size(path, bytes.len())?;
    let body = Reader { path, header: &header, bytes: &bytes, budget: sources.budget() }.read()?;
    surface::assemble(path, &header, body, sources)
}

#[cfg(test)]
mod tests;
