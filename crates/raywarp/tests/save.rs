//! Saving edited scenes: what is read back is what was edited, to the bit, and shows the same picture.

use std::path::{Path, PathBuf};

use crate::common::shipped;
use proptest::prelude::*;
use raywarp::accel::{AccelKind, Build, Quality};
use raywarp::device::{Device, DeviceChoice};
use raywarp::image::ToneMap;
use raywarp::render::{RenderOptions, Tracer};
use raywarp::scene::load::{self, LoadOptions, Loaded};
use raywarp::scene::save::{self, Original, SaveError};
use raywarp::scene::{
    AlphaMode, Background, Camera, Light, LightKind, Material, Projection, RenderDefaults, Scene, Transform,
};
use tempfile::TempDir;

/// Two placed triangles, a point and a spot light, and a camera whose angle is no round number of degrees.
const GLTF: &str = r#"{
  "asset": { "version": "2.0" },
  "extensionsUsed": ["KHR_lights_punctual"],
  "extensions": { "KHR_lights_punctual": { "lights": [
    { "type": "point", "intensity": 30 },
    { "type": "spot", "intensity": 50, "range": 9, "spot": { "innerConeAngle": 0.31, "outerConeAngle": 0.7 } } ] } },
  "buffers": [ { "byteLength": 36, "uri": "data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA" } ],
  "bufferViews": [ { "buffer": 0, "byteLength": 36 } ],
  "accessors": [ { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0] } ],
  "materials": [ { "name": "twin" }, { "name": "twin", "pbrMetallicRoughness": { "baseColorFactor": [1, 0.2, 0.1, 1] } } ],
  "meshes": [
    { "primitives": [ { "attributes": { "POSITION": 0 }, "material": 0 } ] },
    { "primitives": [ { "attributes": { "POSITION": 0 }, "material": 1 } ] } ],
  "cameras": [ { "type": "perspective", "perspective": { "yfov": 0.71234567, "znear": 0.1 } } ],
  "nodes": [
    { "name": "left", "mesh": 0, "translation": [-1.1, 0, 0], "rotation": [0, 0.38268343, 0, 0.92387953] },
    { "name": "same", "mesh": 1, "translation": [0.9, 0, 0] },
    { "name": "same", "mesh": 1, "translation": [0.4, 1, -1], "scale": [0.5, 0.5, 0.5] },
    { "extensions": { "KHR_lights_punctual": { "light": 0 } }, "translation": [0, 1, 3] },
    { "extensions": { "KHR_lights_punctual": { "light": 1 } }, "translation": [0, 0, 4] },
    { "camera": 0, "translation": [0.1, 0.2, 5] } ],
  "scenes": [ { "nodes": [0, 1, 2, 3, 4, 5] } ], "scene": 0
}"#;

const OBJ: &str = "mtllib m.mtl\no first\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n\
                   o second\nusemtl wood\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 4/1 5/1 6/1\n";
const MTL: &str = "newmtl red\nKd 1 0 0\nKs 0.5 0.5 0.5\nNs 10\nnewmtl wood\nKd 0.3 0.2 0.1\nmap_Kd checker.png\n\
                   norm checker.png\nd 0.5\n";

/// A folder with an OBJ, a glTF and a scene file on that one.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("m.obj", OBJ);
    write("m.mtl", MTL);
    write("lamps.gltf", GLTF);
    write(
        "on.toml",
        "version = 1\nbase = \"lamps.gltf\"\nambient = 0.1\nbackground = [0.25, 0.5, 0]\n\
         [render]\nsize = [40, 30]\nspp = 2\naccel = \"kd\"\n[[moves]]\ninstance = \"left\"\ntranslate = [0, 0, -1]\n",
    );
    std::fs::copy(shipped("glass/checker.png"), folder.path().join("checker.png")).unwrap();
    folder
}

/// The scenes of the tests: the built-in one, those of the folder, and the shipped ones.
fn originals(folder: &Path) -> Vec<Option<PathBuf>> {
    let mut all = vec![None];
    all.extend(["m.obj", "lamps.gltf", "on.toml"].map(|name| Some(folder.join(name))));
    let names =
        ["built-in/paper.toml", "built-in/suzanne.ply", "cornell/cornell.toml", "glass/glass.toml", "glass/sphere.obj"];
    all.extend(names.map(|name| Some(shipped(name))));
    all
}

fn read(path: Option<&Path>) -> Loaded {
    match path {
        Some(path) => load::load(path, &LoadOptions { strict: true }).unwrap(),
        None => load::builtin().unwrap(),
    }
}

/// Every number that can be edited as text that tells different bits apart, signs of zeros included.
fn text(scene: &Scene) -> [String; 6] {
    [
        format!("{:?}", scene.instances),
        format!("{:?}", scene.materials),
        format!("{:?}", scene.lights),
        format!("{:?}", scene.cameras),
        format!("{:?}", (scene.background, scene.ambient)),
        format!("{:?}", scene.render),
    ]
}

/// The same scene, of which `now` is the outline, and `read` has the rest.
#[track_caller]
fn assert_same(saved: &Scene, now: &Scene, read: &Scene) {
    assert_eq!(saved.meshes.len(), read.meshes.len());
    for (saved, read) in saved.meshes.iter().zip(&read.meshes) {
        assert!(saved.positions == read.positions && saved.normals == read.normals && saved.uvs == read.uvs);
        assert!(saved.triangles == read.triangles && saved.materials == read.materials);
    }
    let texels = |scene: &Scene| scene.images.iter().map(|image| image.texels.clone()).collect::<Vec<_>>();
    assert!(texels(saved) == texels(read));
    for (saved, now) in text(saved).iter().zip(text(now)) {
        assert!(*saved == now, "{:.3000}\nis not\n{:.3000}", saved, now);
    }
}

/// Small and quick random numbers (Marsaglia's xorshift).
struct Dice(u64);

impl Dice {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.bits() >> 33) % count.max(1) as u64) as usize
    }

    fn coin(&mut self) -> bool {
        self.below(2) == 0
    }

    fn share(&mut self) -> f32 {
        match self.below(6) {
            0 => 0.0,
            1 => 1.0,
            _ => (self.bits() >> 40) as f32 / (1u64 << 24) as f32,
        }
    }

    /// Any number that a scene file may hold, of all magnitudes.
    fn any(&mut self) -> f32 {
        loop {
            let value = match self.below(4) {
                0 => f32::from_bits(self.bits() as u32),
                1 => -0.0,
                _ => 20.0 * (self.share() - 0.5),
            };
            if value.abs() <= 1e11 {
                return value;
            }
        }
    }

    fn positive(&mut self) -> f32 {
        self.any().abs().max(1e-20)
    }

    fn color(&mut self) -> [f32; 3] {
        if self.coin() {
            return [self.share(); 3];
        }
        [self.any().abs(), self.share(), self.any().abs()]
    }

    fn shares(&mut self) -> [f32; 3] {
        [self.share(), self.share(), self.share()]
    }

    fn vector(&mut self) -> [f32; 3] {
        [self.any(), self.any(), 1.0 + self.share()]
    }

    fn name(&mut self) -> String {
        ["", "a \"quoted\" name", "lamp", "grün\n\\"][self.below(4)].to_owned()
    }

    fn light(&mut self) -> Light {
        let (position, direction) = (self.vector(), self.vector());
        let outer = 0.01 + 1.5 * self.share();
        let kind = match self.below(3) {
            0 => LightKind::Point { position },
            1 => LightKind::Directional { direction },
            _ => LightKind::Spot { position, direction, inner: outer * 0.99 * self.share(), outer },
        };
        let mut light = Light { name: self.name(), kind, color: self.color(), ..Light::default() };
        if !matches!(kind, LightKind::Directional { .. }) {
            light.attenuation = [self.positive(), self.positive(), self.share()];
            light.range = if self.coin() { f32::INFINITY } else { self.positive() };
        }
        light
    }

    fn camera(&mut self) -> Camera {
        let projection = match self.below(3) {
            0 => Projection::Orthographic { height: self.positive() },
            _ => Projection::Perspective { fov_y: 2e-5 + 3.1 * self.share() },
        };
        let eye = self.vector();
        let up = if self.coin() { [0.0, 1.0, 0.0] } else { self.vector() };
        Camera { name: self.name(), eye, target: [eye[0], eye[1], 3.0 + self.share()], up, projection }
    }

    fn edit_material(&mut self, material: &mut Material) {
        for _ in 0..3 {
            match self.below(14) {
                0 => material.name = self.name(),
                1 => material.diffuse = self.color(),
                2 => material.ambient = self.color(),
                3 => material.specular = self.color(),
                4 => material.shininess = self.positive(),
                5 => material.emission = self.color(),
                6 => material.reflection = self.shares(),
                7 => material.transmission = self.shares(),
                8 => material.ior = 0.5 + self.share(),
                9 => material.fresnel ^= true,
                10 => material.opacity = self.share(),
                11 => {
                    material.alpha = [AlphaMode::Opaque, AlphaMode::Blend, AlphaMode::Mask(self.share())][self.below(3)]
                }
                12 => material.unlit ^= true,
                _ => (material.diffuse_map, material.normal_map) = (None, None),
            }
        }
    }

    fn edit_render(&mut self, render: &mut RenderDefaults) {
        match self.below(10) {
            0 => render.size = Some([1 + self.below(9000) as u32, 1 + self.below(9000) as u32]),
            1 => render.spp = Some(1 + self.below(100) as u32),
            2 => render.max_depth = Some(self.below(17) as u32),
            3 => render.shadows = Some(self.coin()),
            4 => render.seed = Some(self.bits() as u32),
            5 => render.exposure = Some(30.0 * (self.share() - 0.5)),
            6 => render.tone_map = Some(ToneMap::Filmic),
            7 => render.accel = Some(AccelKind::ALL[self.below(AccelKind::ALL.len())]),
            8 => render.tree = Some(Quality::High),
            _ => *render = RenderDefaults::default(),
        }
    }

    fn edit_list<T>(&mut self, list: &mut Vec<T>, new: impl Fn(&mut Self) -> T) {
        let entry = new(self);
        let index = self.below(list.len());
        match self.below(5) {
            0 => list.clear(),
            1 => list.push(entry),
            2 => list.insert(0, entry),
            3 if !list.is_empty() => list[index] = entry,
            _ if !list.is_empty() => drop(list.remove(index)),
            _ => {}
        }
    }

    fn edit(&mut self, scene: &mut Scene) {
        match self.below(8) {
            0 => self.edit_list(&mut scene.lights, Self::light),
            1 => self.edit_list(&mut scene.cameras, Self::camera),
            2 => {
                let sky = Background { zenith: self.color(), horizon: self.color(), ground: self.color() };
                scene.background = [None, Some(sky), Some(Background::constant(self.color()))][self.below(3)];
            }
            3 => scene.ambient = [None, Some(self.color())][self.below(2)],
            4 => self.edit_render(&mut scene.render),
            5 => {
                let index = self.below(scene.materials.len());
                self.edit_material(&mut scene.materials[index]);
            }
            _ => {
                let index = self.below(scene.instances.len());
                let mut transform = Transform { translation: self.vector(), ..Transform::IDENTITY };
                if self.coin() {
                    let diagonal = |dice: &mut Self| 0.5 + dice.share();
                    let [a, b, c] = [diagonal(self), diagonal(self), diagonal(self)];
                    transform.columns = [[a, 0.1, -0.0], [0.2 * self.share(), b, 0.0], [0.0, -0.1, c]];
                }
                scene.instances[index].transform = transform;
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_edit_comes_back_to_the_bit(seed in 1u64..) {
        let folder = folder();
        let mut dice = Dice(seed);
        for path in originals(folder.path()) {
            let loaded = read(path.as_deref());
            let original = Original::of(path.as_deref(), &loaded);
            for edits in 0..6 {
                let mut now = loaded.scene.outline();
                (0..edits).for_each(|_| dice.edit(&mut now));
                let target = folder.path().join("saved.toml");
                save::to_file(&original, &loaded.scene.outline(), &now, &target).unwrap();
                let saved = read(Some(&target));
                assert_same(&saved.scene, &now, &loaded.scene);

                // Saved again, on the saved one and from another folder.
                let below = folder.path().join("below");
                std::fs::create_dir_all(&below).unwrap();
                let next = below.join("again.TOML");
                let before = now.clone();
                dice.edit(&mut now);
                save::to_file(&Original::of(Some(&target), &saved), &before, &now, &next).unwrap();
                assert_same(&read(Some(&next)).scene, &now, &loaded.scene);
            }
        }
    }
}

#[test]
fn an_unchanged_scene_is_its_base_and_nothing_else() {
    let folder = folder();
    let loaded = read(None);
    let target = folder.path().join("a.toml");
    let text = save::to_toml(&Original::BuiltIn, &loaded.scene, &loaded.scene, &target).unwrap();
    assert_eq!(text.lines().skip(1).collect::<Vec<_>>(), ["version = 1", "base = \"built-in\""]);
    let path = folder.path().join("lamps.gltf");
    let loaded = read(Some(&path));
    let text = save::to_toml(&Original::of(Some(&path), &loaded), &loaded.scene, &loaded.scene, &target).unwrap();
    assert!(text.ends_with("base = \"lamps.gltf\"\n"), "{text}");
}

/// As the viewer would: another surface, a lamp turned, an instance moved, a view, and options.
fn edited(scene: &Scene) -> Scene {
    let mut now = scene.outline();
    if let Some(material) = now.materials.last_mut() {
        (material.diffuse, material.specular, material.shininess) = ([0.1, 0.7, 0.3], [0.4; 3], 60.5);
    }
    if let Some(light) = now.lights.first_mut() {
        light.color = [0.9, 0.5, 0.1];
    }
    if let Some(instance) = now.instances.first_mut() {
        let columns = &mut instance.transform.columns;
        *columns = columns.map(|column| column.map(|x| x * 0.9));
        instance.transform.translation[1] += 0.1;
    }
    let [eye, target] = [[0.31, 1.2, 4.7], [0.0, 0.6, -0.2]];
    let projection = Projection::Perspective { fov_y: 0.777_777_7 };
    now.cameras.insert(0, Camera { name: "view".to_owned(), eye, target, up: [0.0, 1.0, 0.0], projection });
    now.ambient = Some([0.2, 0.21, 0.22]);
    now.render = RenderDefaults { size: Some([64, 40]), spp: Some(2), exposure: Some(0.25), ..now.render };
    now
}

#[test]
fn a_saved_scene_shows_the_same_picture() {
    let folder = folder();
    let device = Device::open(DeviceChoice::Cpu).unwrap();
    for path in originals(folder.path()) {
        let loaded = read(path.as_deref());
        let mut now = edited(&loaded.scene);
        let target = folder.path().join("saved.toml");
        save::to_file(&Original::of(path.as_deref(), &loaded), &loaded.scene, &now, &target).unwrap();
        (now.meshes, now.images) = (loaded.scene.meshes, loaded.scene.images);
        let picture = |scene: &Scene| {
            let tracer = Tracer::new(scene, Build::wished(&scene.render, &device, false), &device).unwrap();
            let options = RenderOptions { seed: 7, ..RenderOptions::from(&scene.render) };
            tracer.render(tracer.default_camera(), &options, &mut |_| ()).unwrap().picture
        };
        assert_eq!(picture(&read(Some(&target)).scene), picture(&now), "{path:?}");
    }
}

#[test]
fn a_saved_file_reads_well() {
    let folder = folder();
    let loaded = read(None);
    let mut now = edited(&loaded.scene);
    now.lights.truncate(1);
    let text = save::to_toml(&Original::BuiltIn, &loaded.scene, &now, &folder.path().join("a.toml")).unwrap();
    for part in
        ["\n[base]\nfile = \"built-in\"\nlights = false\n", "ambient = [0.2, 0.21, 0.22]", "diffuse = [0.1, 0.7, 0.3]"]
    {
        assert!(text.contains(part), "{text}");
    }
    assert!(text.lines().all(|line| line.len() < 160), "{text}");
}

#[test]
fn what_cannot_be_saved_is_an_error_with_a_reason() {
    let folder = folder();
    let path = folder.path().join("on.toml");
    let loaded = read(Some(&path));
    let target = folder.path().join("a.toml");
    let save = |target: &Path, edit: &dyn Fn(&mut Scene)| {
        let mut now = loaded.scene.outline();
        edit(&mut now);
        save::to_toml(&Original::of(Some(&path), &loaded), &loaded.scene, &now, target)
    };
    let says = |result: Result<String, SaveError>, part: &str| {
        let error = result.unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    };
    save(&target, &|_| ()).unwrap();
    says(save(&folder.path().join("a.obj"), &|_| ()), "ends in .toml");
    says(save(&path, &|_| ()), "made of it");
    std::fs::copy(folder.path().join("lamps.gltf"), folder.path().join("b.toml")).unwrap();
    save(&folder.path().join("b.toml"), &|_| ()).unwrap();
    says(save(&folder.path().join("none/a.toml"), &|_| ()), "cannot find the folder");
    says(save(&target, &|scene| drop(scene.materials.pop())), "number of materials");
    says(save(&target, &|scene| drop(scene.instances.pop())), "other instances");
    says(save(&target, &|scene| scene.materials[0].diffuse[1] = f32::NAN), "expected a number from 0 to 1e12");
    says(save(&target, &|scene| scene.materials[0].reflection[1] = 1.5), "expected a number from 0 to 1");
    says(save(&target, &|scene| scene.instances[0].transform.columns = [[0.0; 3]; 3]), "flattens space");
    says(save(&target, &|scene| scene.lights[0].kind = LightKind::Directional { direction: [0.0; 3] }), "zero");
    says(
        save(&target, &|scene| scene.cameras[0].projection = Projection::Perspective { fov_y: 3.13 }),
        "to 179 degrees",
    );
    says(save(&target, &|scene| scene.render.spp = Some(0)), "a whole number from 1 to");
}

#[test]
fn a_file_that_the_scene_is_made_of_is_never_overwritten() {
    let folder = folder();
    let (first, second) = (folder.path().join("on.toml"), folder.path().join("second.toml"));
    let loaded = read(Some(&first));
    save::to_file(&Original::of(Some(&first), &loaded), &loaded.scene, &loaded.scene, &second).unwrap();
    let loaded = read(Some(&second));
    let error = save::to_file(&Original::of(Some(&second), &loaded), &loaded.scene, &loaded.scene, &first).unwrap_err();
    assert!(matches!(error, SaveError::Original(_)), "{error}");
}

#[test]
fn all_files_of_a_scene_are_told_once() {
    let folder = folder();
    let names = |path: &str| -> Vec<String> {
        let files = read(Some(&folder.path().join(path))).files;
        files.iter().map(|file| file.file_name().unwrap().to_string_lossy().into_owned()).collect()
    };
    assert_eq!(names("on.toml"), ["on.toml", "lamps.gltf"]);
    assert_eq!(names("m.obj"), ["m.obj", "m.mtl", "checker.png"]);
    assert!(load::builtin().unwrap().files.is_empty());
}
