//! Indices of lists, strips and fans to triangles.

use ::gltf::json::mesh::Mode;

/// Vertex triples, all turned the way of the first. Corners left over at the end make no triangle. `None` for points
/// and lines.
pub(super) fn triangles(mode: Mode, indices: &[u32]) -> Option<Vec<[u32; 3]>> {
    Some(match mode {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return None,
        Mode::Triangles => indices.chunks_exact(3).map(|corner| [corner[0], corner[1], corner[2]]).collect(),
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(place, corner)| match place % 2 {
                0 => [corner[0], corner[1], corner[2]],
                _ => [corner[0], corner[2], corner[1]],
            })
            .collect(),
        Mode::TriangleFan => match indices.split_first() {
            Some((&hub, rim)) => rim.windows(2).map(|edge| [edge[0], edge[1], hub]).collect(),
            None => Vec::new(),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mode_follows_the_specification() {
        let indices = [0, 1, 2, 3, 4];
        assert_eq!(triangles(Mode::Triangles, &indices), Some(vec![[0, 1, 2]]));
        assert_eq!(triangles(Mode::TriangleStrip, &indices), Some(vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]]));
        assert_eq!(triangles(Mode::TriangleFan, &indices), Some(vec![[1, 2, 0], [2, 3, 0], [3, 4, 0]]));
        assert_eq!(triangles(Mode::LineStrip, &indices), None);
        for mode in [Mode::Triangles, Mode::TriangleStrip, Mode::TriangleFan] {
            assert_eq!(triangles(mode, &[]), Some(vec![]));
            assert_eq!(triangles(mode, &[7, 8]), Some(vec![]));
        }
    }
}
