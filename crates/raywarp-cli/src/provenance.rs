//! What a picture was made of: the scene's files, the options and the camera, as words and as a fingerprint.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use raywarp::image::{Development, Layer, Provenance};
use raywarp::render::RenderOptions;
use raywarp::scene::{degrees, Camera, Projection};
use xxhash_rust::xxh3::{xxh3_128, Xxh3};

/// The program, as its files name it.
const SOFTWARE: &str = concat!("raywarp ", env!("CARGO_PKG_VERSION"));

/// Everything that a picture's values depend on. Devices, structures and threads are not among it.
pub struct Origin<'a> {
    /// The file of the scene; none: the built-in scene.
    pub scene: Option<&'a Path>,
    /// See [`digest`].
    pub digest: u128,
    /// Size, samples and so on.
    pub options: RenderOptions,
    /// How PNG shows radiance.
    pub development: Development,
    /// From where.
    pub camera: &'a Camera,
    /// Beside the picture.
    pub layers: &'a [Layer],
    /// Top of the scale of a heat map.
    pub heatmap_max: Option<u64>,
}

impl Origin<'_> {
    /// For the files of the picture.
    pub fn provenance(&self) -> Provenance {
        let options = self.flags();
        let layers: Vec<_> = self.layers.iter().map(|layer| layer.name()).collect();
        let all = format!("{SOFTWARE}\n{:032x}\n{options}\n{layers:?}\n{:?}", self.digest, self.heatmap_max);
        let name = self.scene.and_then(Path::file_name).map(|name| format!("{} ", name.to_string_lossy()));
        Provenance {
            software: SOFTWARE.to_owned(),
            comment: format!("raywarp render {}{options}", name.unwrap_or_default()),
            fingerprint: format!("{:032x}", xxh3_128(all.as_bytes())),
        }
    }

    /// Options that give the picture again, to the bit.
    fn flags(&self) -> String {
        let RenderOptions { size: [width, height], spp, max_depth, shadows, seed, crop, .. } = self.options;
        let Development { exposure, tone_map } = self.development;
        let crop = crop.map(|[x0, y0, x1, y1]| format!(" --crop {x0},{y0},{x1},{y1}")).unwrap_or_default();
        let shadows = if shadows { "--shadows" } else { "--no-shadows" };
        format!(
            "--size {width}x{height}{crop} --samples {spp} --max-depth {max_depth} {shadows} --seed {seed} \
             --exposure={exposure} --tone-map {tone_map} {}",
            camera_flags(self.camera)
        )
    }
}

/// Each number is read back to the same bits.
fn camera_flags(camera: &Camera) -> String {
    let vector = |[x, y, z]: [f32; 3]| format!("{x:?},{y:?},{z:?}");
    let [eye, target, up] = [camera.eye, camera.target, camera.up].map(vector);
    let lens = match camera.projection {
        Projection::Perspective { fov_y } => format!("--fov {}", degrees(fov_y)),
        Projection::Orthographic { height } => format!("--ortho {height:?}"),
    };
    format!("--eye={eye} --target={target} --up={up} {lens}")
}

/// A number of the contents of all files of a scene, wherever they lie. One that is missing counts as that.
pub fn digest(files: &[PathBuf]) -> u128 {
    let mut hash = Xxh3::new();
    for file in files {
        // Contents end where their length says.
        match add(&mut hash, file) {
            Ok(bytes) => hash.update(&bytes.to_le_bytes()),
            Err(_) => hash.update(b"missing"),
        }
    }
    hash.digest128()
}

fn add(hash: &mut Xxh3, file: &Path) -> std::io::Result<u64> {
    // A pipe or a device might never end; none of them is part of a scene.
    if !std::fs::metadata(file)?.is_file() {
        return Err(std::io::ErrorKind::InvalidInput.into());
    }
    let file = File::open(file)?;
    // One that grows ends where it ended when it was opened.
    let length = file.metadata()?.len();
    let (mut file, mut total, mut buffer) = (file.take(length), 0, vec![0; 1 << 20]);
    loop {
        let read = file.read(&mut buffer)?;
        if read == 0 {
            return Ok(total);
        }
        hash.update(&buffer[..read]);
        total += read as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fingerprint(change: impl Fn(&mut Origin)) -> String {
        let camera = Camera {
            name: String::new(),
            eye: [0.1, -2.0, 3e9],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            projection: Projection::Orthographic { height: 2.5 },
        };
        let mut origin = Origin {
            scene: None,
            digest: 1,
            options: RenderOptions::default(),
            development: Development::default(),
            camera: &camera,
            layers: &[],
            heatmap_max: None,
        };
        change(&mut origin);
        origin.provenance().fingerprint
    }

    #[test]
    fn whatever_changes_the_picture_changes_the_fingerprint_and_nothing_else_does() {
        let usual = fingerprint(|_| ());
        assert_eq!(usual, fingerprint(|origin| origin.options.count_tests = true));
        assert_eq!(usual, fingerprint(|origin| origin.scene = Some(Path::new("elsewhere/a.obj"))));
        let changes: [&dyn Fn(&mut Origin); 7] = [
            &|origin| origin.digest = 2,
            &|origin| origin.options.spp = 2,
            &|origin| origin.options.crop = Some([0, 0, 9, 9]),
            &|origin| origin.options.shadows = false,
            &|origin| origin.development.exposure = -0.5,
            &|origin| origin.layers = &[Layer::Depth],
            &|origin| origin.heatmap_max = Some(9),
        ];
        for (index, change) in changes.into_iter().enumerate() {
            assert_ne!(usual, fingerprint(change), "{index}");
        }
    }

    #[test]
    fn contents_count_and_not_places() {
        let (one, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let write = |folder: &tempfile::TempDir, name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let first = digest(&[write(&one, "a", "x"), write(&one, "b", "yz")]);
        assert_eq!(first, digest(&[write(&other, "c", "x"), write(&other, "d", "yz")]));
        assert_ne!(first, digest(&[write(&other, "c", "xy"), write(&other, "d", "z")]));
        assert_ne!(first, digest(&[write(&other, "c", "x"), other.path().join("none")]));
    }
}
