//! Compressed geometry, decoded before anything reads it: views by meshopt, accessors of a primitive by Draco.
//!
//! Decoders are crates, in Rust without `unsafe` on these paths; what they may make of a file is in [`super::budget`]. A file
//! that makes one panic is refused as one that it cannot decode.

use std::collections::HashMap;
use std::panic::{catch_unwind, AssertUnwindSafe};

use ::gltf::json::accessor::ComponentType;
use ::gltf::json::Root;

use super::super::LoadError;
use super::budget::Budget;
use super::buffers::Buffers;
use super::origin::Origin;
use super::{draco, meshopt};

/// What was compressed, by index in the JSON.
#[derive(Default)]
pub(super) struct Decoded {
    pub views: HashMap<usize, Vec<u8>>,
    pub accessors: HashMap<usize, Attribute>,
}

/// The elements of an accessor, packed.
pub(super) struct Attribute {
    pub bytes: Vec<u8>,
    pub count: usize,
    pub lanes: usize,
    pub component: ComponentType,
}

/// Decodes all of a file.
pub(super) fn read(origin: Origin, root: &Root, buffers: &mut Buffers, budget: &mut Budget) -> Result<(), LoadError> {
    // Views first: Draco's streams are views too.
    buffers.decoded.views = meshopt::decode_views(origin, root, buffers, budget)?;
    buffers.decoded.accessors = draco::decode_primitives(origin, root, buffers, budget)?;
    Ok(())
}

/// What a decoder answers; a panic is the answer that there is none.
pub(super) fn fenced<T>(decode: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(decode)).unwrap_or_else(|_| Err("the decoder gave up on it".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_answer() {
        assert_eq!(fenced(|| Ok(7)), Ok(7));
        assert!(fenced::<()>(|| panic!("on purpose")).is_err());
    }
}
