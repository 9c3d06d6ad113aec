//! Places of nodes as the file writes them: the `gltf` crate reads them in single precision.

use serde::Deserialize;

use crate::load::precision::Rounding;

#[derive(Deserialize)]
struct File {
    #[serde(default)]
    nodes: Vec<Node>,
}

#[derive(Deserialize)]
struct Node {
    translation: Option<[f64; 3]>,
    matrix: Option<[f64; 16]>,
}

/// What the translations of all nodes lose. Nothing is known of a file that the crate reads only once it is mended.
pub(super) fn rounding(json: &[u8]) -> Rounding {
    let mut rounding = Rounding::default();
    let file = ::gltf::json::deserialize::from_slice::<File>(json);
    for node in file.into_iter().flat_map(|file| file.nodes) {
        let moved = node.matrix.map(|matrix| [matrix[12], matrix[13], matrix[14]]);
        for x in node.translation.into_iter().chain(moved).flatten() {
            rounding.round(x);
        }
    }
    rounding
}
