use super::{LoadError, Sources};
use crate::scene::Scene;
use std::path::Path;
pub(super) fn read(path: &Path, _sources: &mut Sources) -> Result<Scene, LoadError> {
    Err(LoadError::unknown_format(path))
}
