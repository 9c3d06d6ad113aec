//! `raywarp info`.

use raywarp::accel::AccelKind;
use raywarp::device::{Device, DeviceChoice};
use raywarp::device_scene::{DeviceScene, Levels, Report};
use raywarp::scene::{Material, Scene};
use serde::Serialize;

use crate::failure::Result;
use crate::interrupt::Interrupt;
use crate::messages;
use crate::options::InfoOptions;
use crate::output::to_standard_output;
use crate::render::read;
use crate::report::{SceneCounts, Table, Tree};

/// Everything that is said about a scene.
#[derive(Debug, Serialize)]
struct Info {
    scene: SceneCounts,
    /// Names, in the order that `[[moves]]` counts in.
    instances: Vec<String>,
    materials: Vec<MaterialInfo>,
    images: Vec<ImageInfo>,
    cameras: Vec<String>,
    paths: Vec<String>,
    lights: Vec<String>,
    /// Defaults for rendering that the scene file gives, in words.
    render: String,
    /// Bytes of the scene as it was read.
    memory: u64,
    trees: Vec<TreeInfo>,
    warnings: Vec<String>,
    notes: Vec<String>,
}

#[derive(Debug, Serialize)]
struct MaterialInfo {
    name: String,
    diffuse: [f32; 3],
    specular: [f32; 3],
    shininess: f32,
    reflection: [f32; 3],
    transmission: [f32; 3],
    ior: f32,
    opacity: f32,
    maps: usize,
}

#[derive(Debug, Serialize)]
struct ImageInfo {
    name: String,
    size: [u32; 2],
}

#[derive(Debug, Serialize)]
struct TreeInfo {
    accel: String,
    build_seconds: f64,
    device_bytes: u64,
    #[serde(flatten)]
    tree: Tree,
}

/// Says what is in a scene.
pub fn run(options: &InfoOptions) -> Result<()> {
    let _ends = Interrupt::install();
    let loaded = read(options.scene.as_deref(), options.strict, &mut to_standard_output()?)?;
    let scene = &loaded.scene;
    let cpu = Device::open(DeviceChoice::Cpu)?;
    // Of instances there is one hierarchy whatever the structure of the meshes.
    let kinds: &[AccelKind] = match Levels::Auto.are_two(scene) {
        true => &[AccelKind::Bvh2],
        false => &[AccelKind::Brute, AccelKind::Kd, AccelKind::Bvh2],
    };
    let report = |&kind: &AccelKind| DeviceScene::new(scene, kind, &cpu).map(|ready| (kind, ready.report().clone()));
    let reports = kinds.iter().map(report).collect::<Result<Vec<_>, _>>()?;
    let bvh = &reports[reports.len() - 1].1;
    let info = Info {
        scene: SceneCounts::new(scene, bvh),
        instances: scene.instances.iter().map(|instance| instance.name.clone()).collect(),
        materials: scene.materials.iter().map(MaterialInfo::from).collect(),
        images: scene.images.iter().map(|i| ImageInfo { name: i.name.clone(), size: [i.width, i.height] }).collect(),
        cameras: scene.cameras.iter().map(|camera| camera.name.clone()).collect(),
        paths: scene.paths.iter().map(|path| path.name().to_owned()).collect(),
        lights: scene.lights.iter().map(|light| light.name.clone()).collect(),
        render: scene.render.to_string(),
        memory: memory(scene),
        trees: reports.iter().map(|(kind, report)| TreeInfo::new(*kind, report)).collect(),
        warnings: loaded.warnings.iter().map(ToString::to_string).collect(),
        notes: loaded.notes.iter().map(ToString::to_string).chain(bvh.notes.clone()).collect(),
    };
    messages::results(&info, options.json, || info.text())?;
    messages::warnings(&loaded.warnings);
    Ok(())
}

/// Triangles that the tracer left out.
pub fn dropped(report: &Report) -> u64 {
    (report.dropped.without_area + report.dropped.not_finite) as u64
}

/// Bytes of meshes and texels; the rest is small beside them.
fn memory(scene: &Scene) -> u64 {
    let meshes = scene.meshes.iter().map(|mesh| {
        12 * mesh.positions.len()
            + 12 * mesh.normals.len()
            + 8 * (mesh.uvs.len() + mesh.second_uvs.len())
            + 16 * (mesh.colors.len() + mesh.tangents.len())
            + 16 * mesh.triangles.len()
    });
    let images = scene.images.iter().map(|image| 4 * image.texels.len());
    meshes.chain(images).sum::<usize>() as u64
}

impl TreeInfo {
    fn new(accel: AccelKind, report: &Report) -> Self {
        Self {
            accel: accel.to_string(),
            build_seconds: report.build_seconds,
            device_bytes: report.device_bytes,
            tree: (&report.tree).into(),
        }
    }
}

impl From<&Material> for MaterialInfo {
    fn from(material: &Material) -> Self {
        let maps = [material.diffuse_map, material.specular_map, material.emission_map, material.opacity_map];
        Self {
            name: material.name.clone(),
            diffuse: material.diffuse,
            specular: material.specular,
            shininess: material.shininess,
            reflection: material.reflection,
            transmission: material.transmission,
            ior: material.ior,
            opacity: material.opacity,
            maps: maps.iter().flatten().count() + usize::from(material.normal_map.is_some()),
        }
    }
}

impl Info {
    fn text(&self) -> String {
        let mut table = Table::default();
        let scene = &self.scene;
        table.row("triangles", format!("{} ({} dropped)", scene.triangles, scene.dropped));
        table.row("vertices", scene.vertices);
        table.row("meshes", format!("{}, placed {} times", scene.meshes, scene.instances));
        table.row("instances", numbered(&self.instances));
        let [low, high] = scene.bounds.map(|[x, y, z]| format!("{x} {y} {z}"));
        table.row("bounds", format!("{low}  to  {high}"));
        table.row("lights", named(&self.lights));
        table.row("cameras", named(&self.cameras));
        if !self.paths.is_empty() {
            table.row("camera paths", named(&self.paths));
        }
        if !self.render.is_empty() {
            table.row("render", &self.render);
        }
        table.row("memory", format!("{} as read", messages::bytes(self.memory)));
        self.material_rows(&mut table);
        for image in &self.images {
            table.row("image", format!("{} ({}x{})", image.name, image.size[0], image.size[1]));
        }
        for tree in &self.trees {
            let time = messages::seconds(tree.build_seconds);
            table.row(&format!("tree {}", tree.accel), format!("{}, built in {time}", tree.tree.sentence()));
        }
        for note in &self.notes {
            table.row("note", note);
        }
        table.0
    }

    fn material_rows(&self, table: &mut Table) {
        table.row("materials", self.materials.len());
        for (index, material) in self.materials.iter().enumerate() {
            table.row("", format!("{index:>3} {}", material.sentence()));
        }
    }
}

impl MaterialInfo {
    /// The name and what sets the material apart.
    fn sentence(&self) -> String {
        let color = |c: [f32; 3]| format!("{:.2} {:.2} {:.2}", c[0], c[1], c[2]);
        let mut text = format!("{:<20} diffuse {}", self.name, color(self.diffuse));
        let mut add = |part: String| {
            text.push_str(", ");
            text.push_str(&part);
        };
        if self.specular != [0.0; 3] {
            add(format!("specular {} ^ {}", color(self.specular), self.shininess));
        }
        if self.reflection != [0.0; 3] {
            add(format!("reflection {}", color(self.reflection)));
        }
        if self.transmission != [0.0; 3] {
            add(format!("transmission {}, ior {}", color(self.transmission), self.ior));
        }
        if self.opacity < 1.0 {
            add(format!("opacity {}", self.opacity));
        }
        if self.maps > 0 {
            add(format!("{} maps", self.maps));
        }
        text
    }
}

/// Names that are shown of a list.
const SHOWN: usize = 12;

/// How many, with numbers from 0 and names.
fn numbered(names: &[String]) -> String {
    let pairs: Vec<_> = names.iter().take(SHOWN).enumerate().map(|(i, name)| format!("{i} '{name}'")).collect();
    match names.len() {
        0 => "none".to_owned(),
        count if count > SHOWN => format!("{count}: {}, ...", pairs.join(", ")),
        count => format!("{count}: {}", pairs.join(", ")),
    }
}

/// How many, and their names.
fn named(names: &[String]) -> String {
    let shown: Vec<_> = names.iter().take(SHOWN).map(|name| format!("'{name}'")).collect();
    match names.len() {
        0 => "none".to_owned(),
        count if count > SHOWN => format!("{count}: {}, ...", shown.join(", ")),
        count => format!("{count}: {}", shown.join(", ")),
    }
}
