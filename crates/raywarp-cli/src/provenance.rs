//! What a picture was made of: the scene's files, the options and the camera, as words and as a fingerprint.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use raywarp::image::{Layer, Provenance};
use raywarp::scene::{axis_name, degrees, Camera, Projection, RenderDefaults};
use xxhash_rust::xxh3::{xxh3_128, Xxh3};

use crate::options::{self, EnvironmentOptions};
use crate::values::Backdrop;

/// The program, as its files name it.
const SOFTWARE: &str = concat!("raywarp ", env!("CARGO_PKG_VERSION"));

/// Everything that a picture's values depend on. Devices, structures and threads are not among it.
pub struct Origin<'a> {
    /// The file of the scene; none: the built-in scene.
    pub scene: Option<&'a Path>,
    /// See [`digest`].
    pub digest: u128,
    /// Size, samples and so on: all that a picture depends on, none left out.
    pub settings: RenderDefaults,
    /// The part of the picture.
    pub crop: Option<[u32; 4]>,
    /// Instead of the scene's own.
    pub background: Option<Backdrop>,
    /// Instead of the scene's own.
    pub environment: &'a EnvironmentOptions,
    /// Which way is up in the scene, if that is not +Y.
    pub scene_up: Option<[f32; 3]>,
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
        let crop = self.crop.map(|[x0, y0, x1, y1]| format!(" --crop {x0},{y0},{x1},{y1}")).unwrap_or_default();
        let background = self.background.map(|color| format!(" --background={color}")).unwrap_or_default();
        let (settings, camera) = (options::flags(&self.settings), camera_flags(self.camera, self.scene_up));
        let environment = self.environment.flags();
        format!("{settings}{crop}{background}{environment} {camera}")
    }
}

/// Each number is read back to the same bits. An axis by its name turns the scene's sky too.
fn camera_flags(camera: &Camera, scene_up: Option<[f32; 3]>) -> String {
    let vector = |[x, y, z]: [f32; 3]| format!("{x:?},{y:?},{z:?}");
    let [eye, target, up] = [camera.eye, camera.target, camera.up].map(vector);
    let lens = match camera.projection {
        Projection::Perspective { fov_y } => format!("--fov {}", degrees(fov_y)),
        Projection::Orthographic { height } => format!("--ortho {height:?}"),
    };
    let up = scene_up.and_then(axis_name).map_or(up, str::to_owned);
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
            settings: RenderDefaults::usual(),
            crop: None,
            background: None,
            environment: &EnvironmentOptions::default(),
            scene_up: None,
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
        assert_eq!(usual, fingerprint(|origin| origin.scene = Some(Path::new("elsewhere/a.obj"))));
        let changes: [&dyn Fn(&mut Origin); 9] = [
            &|origin| origin.digest = 2,
            &|origin| origin.settings.spp = Some(2),
            &|origin| origin.crop = Some([0, 0, 9, 9]),
            &|origin| origin.settings.shadows = Some(false),
            &|origin| origin.settings.exposure = Some(-0.5),
            &|origin| origin.background = Some(Backdrop::None),
            &|origin| origin.scene_up = Some([0.0, 0.0, 1.0]),
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
