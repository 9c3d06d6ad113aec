//! Scenes, rays and answers in files that NumPy reads: bare little-endian numbers of 32 bits.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use raywarp::{Ray, Triangle, Vec3};

/// Writes `vertices` and `triangles`: three coordinates a vertex, three indices a triangle. A vertex that triangles
/// share is there once, as it would be in a model.
pub fn write_scene(folder: &Path, triangles: &[Triangle]) -> io::Result<()> {
    let mut places: HashMap<[u32; 3], u32> = HashMap::with_capacity(triangles.len());
    let mut vertices = Vec::with_capacity(triangles.len());
    let mut place = |vertex: Vec3| {
        let bits = vertex.to_array().map(f32::to_bits);
        *places.entry(bits).or_insert_with(|| {
            vertices.push(bits);
            (vertices.len() - 1) as u32
        })
    };
    let indices: Vec<_> = triangles.iter().map(|t| [place(t.v0), place(t.v1), place(t.v2)]).collect();
    write(&folder.join("vertices"), vertices.into_iter().flatten())?;
    write(&folder.join("triangles"), indices.into_iter().flatten())
}

/// Writes `origins`, `directions` and `limits`. The rays start at 0.
pub fn write_rays(folder: &Path, rays: &[Ray]) -> io::Result<()> {
    let bits = |vector: Vec3| vector.to_array().map(f32::to_bits);
    write(&folder.join("origins"), rays.iter().flat_map(|ray| bits(ray.origin)))?;
    write(&folder.join("directions"), rays.iter().flat_map(|ray| bits(ray.direction)))?;
    write(&folder.join("limits"), rays.iter().map(|ray| ray.t_max.to_bits()))
}

/// Reads distances.
pub fn read_distances(file: &Path) -> io::Result<Vec<f32>> {
    let bytes = std::fs::read(file)?;
    Ok(bytes.chunks_exact(4).map(|chunk| f32::from_le_bytes(chunk.try_into().unwrap_or_default())).collect())
}

fn write(file: &Path, numbers: impl Iterator<Item = u32>) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(file)?);
    for number in numbers {
        file.write_all(&number.to_le_bytes())?;
    }
    file.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shared_vertices_are_written_once() {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let [a, b, c, d] = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        let folder = tempfile::tempdir().unwrap();
        write_scene(folder.path(), &[Triangle::new(a, b, c, 0, 0), Triangle::new(a, c, d, 1, 0)]).unwrap();
        assert_eq!(read_distances(&folder.path().join("vertices")).unwrap().len(), 4 * 3);
        let indices = read_distances(&folder.path().join("triangles")).unwrap();
        assert_eq!(indices.iter().map(|index| index.to_bits()).collect::<Vec<_>>(), [0, 1, 2, 0, 2, 3]);
    }

    #[test]
    fn rays_are_what_they_were() {
        let folder = tempfile::tempdir().unwrap();
        let ray = Ray { t_max: f32::INFINITY, ..Ray::new(Vec3::new(1.0, -2.5, 3.0), Vec3::new(0.0, 1.0, 0.0)) };
        write_rays(folder.path(), &[ray, Ray { t_max: 0.5, ..ray }]).unwrap();
        assert_eq!(read_distances(&folder.path().join("limits")).unwrap(), [f32::INFINITY, 0.5]);
        assert_eq!(read_distances(&folder.path().join("origins")).unwrap()[..3], [1.0, -2.5, 3.0]);
    }
}
