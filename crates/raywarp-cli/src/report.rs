//! What a run did and what it cost, for people and for programs.

use std::fmt::Write;

use raywarp::accel::TreeStats;
use raywarp::device_scene::Report;
use raywarp::render::Rendering;
use raywarp::scene::Scene;
use serde::Serialize;

use crate::messages;
use crate::render::Taken;

/// Numbers of a run. All times are in seconds.
#[derive(Debug, Serialize)]
pub struct Statistics {
    /// Name of the device.
    pub device: String,
    /// `brute`, `kd` or `bvh`.
    pub accel: String,
    /// Columns and rows that were rendered.
    pub size: [u32; 2],
    /// Samples a pixel.
    pub spp: u32,
    /// Frames, where there are several pictures; the numbers are then sums over those that were rendered.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames: Option<FrameCounts>,
    /// Counts of the scene.
    pub scene: SceneCounts,
    /// Shape of the tree.
    pub tree: Tree,
    /// Bytes of the scene on the device.
    pub device_bytes: u64,
    /// Where the time went.
    pub seconds: Seconds,
    /// Kernels launched for the picture.
    pub launches: u32,
    /// Pixels that came out infinite or NaN; they are black in the picture.
    pub non_finite: u64,
    /// What was counted, in a second run without influence on the times.
    pub tests: Option<TestCounts>,
}

/// Frames of a run.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct FrameCounts {
    /// Frames that were rendered.
    pub rendered: u32,
    /// Frames that were there already.
    pub kept: u32,
    /// Frames among those rendered whose files were there, but of another scene or other options.
    pub renewed: u32,
}

/// What a scene has.
#[derive(Debug, Serialize)]
pub struct SceneCounts {
    /// Meshes.
    pub meshes: usize,
    /// Placed meshes.
    pub instances: usize,
    /// Triangles that are traced.
    pub triangles: u64,
    /// Triangles that were left out.
    pub dropped: u64,
    /// Vertices of the triangles that are traced.
    pub vertices: u64,
    /// Materials.
    pub materials: usize,
    /// Textures' pictures.
    pub images: usize,
    /// Lights.
    pub lights: usize,
    /// Cameras.
    pub cameras: usize,
    /// Lower and upper corner.
    pub bounds: [[f32; 3]; 2],
}

/// What a tree is like.
#[derive(Debug, Serialize)]
pub struct Tree {
    /// Inner nodes and leaves.
    pub nodes: u64,
    /// Leaves.
    pub leaves: u64,
    /// Triangles in leaves, repeated ones included.
    pub references: u64,
    /// Longest way from the root.
    pub depth: u64,
    /// Most triangles in a leaf.
    pub largest_leaf: u64,
    /// Expected cost of a ray by the surface area heuristic, in the units of `accel::TreeStats`.
    pub sah_cost: f64,
    /// Bytes.
    pub bytes: u64,
}

/// Where the time of a run went.
#[derive(Debug, Default, Serialize)]
pub struct Seconds {
    /// Reading files.
    pub load: f64,
    /// From meshes and instances to triangles.
    pub flatten: f64,
    /// Building the tree.
    pub build: f64,
    /// Copying to the device.
    pub upload: f64,
    /// Kernels of the picture, on the device.
    pub kernel: f64,
    /// The picture, with everything around the kernels.
    pub render: f64,
    /// Layers, encoding and writing.
    pub save: f64,
}

/// What rays cost.
#[derive(Debug, Serialize)]
pub struct TestCounts {
    /// Rays of all kinds.
    pub rays: u64,
    /// Millions of them a second of kernel time.
    pub mrays_per_second: f64,
    /// Nodes visited, per ray.
    pub nodes_per_ray: f64,
    /// Triangles tested, per ray.
    pub triangles_per_ray: f64,
    /// Nodes and triangles of the costliest pixel.
    pub most_of_a_pixel: u64,
}

impl SceneCounts {
    /// Counts of a scene as the tracer sees it.
    pub fn new(scene: &Scene, report: &Report) -> Self {
        Self {
            meshes: scene.meshes.len(),
            instances: scene.instances.len(),
            triangles: report.triangles as u64,
            dropped: crate::info::dropped(report),
            vertices: report.vertices as u64,
            materials: scene.materials.len(),
            images: scene.images.len(),
            lights: scene.lights.len(),
            cameras: scene.cameras.len(),
            bounds: report.bounds,
        }
    }
}

impl From<&TreeStats> for Tree {
    fn from(stats: &TreeStats) -> Self {
        Self {
            nodes: stats.nodes as u64,
            leaves: stats.leaves as u64,
            references: stats.references as u64,
            depth: stats.depth as u64,
            largest_leaf: stats.largest_leaf as u64,
            sah_cost: stats.sah_cost,
            bytes: stats.bytes as u64,
        }
    }
}

impl TestCounts {
    /// Counts of a run that counted; the kernel time is that of a run that did not.
    pub fn new(counted: &Rendering, kernel_seconds: f64) -> Option<Self> {
        let tests = counted.tests.as_ref()?;
        let (mut nodes, mut triangles, mut rays, mut most) = (0u64, 0u64, 0u64, 0u64);
        for pixel in tests {
            nodes += u64::from(pixel.nodes);
            triangles += u64::from(pixel.triangles);
            rays += u64::from(pixel.rays);
            most = most.max(u64::from(pixel.nodes) + u64::from(pixel.triangles));
        }
        let per_ray = |count: u64| count as f64 / rays.max(1) as f64;
        Some(Self {
            rays,
            mrays_per_second: if kernel_seconds > 0.0 { 1e-6 * rays as f64 / kernel_seconds } else { 0.0 },
            nodes_per_ray: per_ray(nodes),
            triangles_per_ray: per_ray(triangles),
            most_of_a_pixel: most,
        })
    }

    /// Counts of two pictures whose kernels took so long together.
    fn and(&self, other: &Self, kernel_seconds: f64) -> Self {
        let rays = self.rays + other.rays;
        let per_ray = |a: f64, b: f64| (a * self.rays as f64 + b * other.rays as f64) / rays.max(1) as f64;
        Self {
            rays,
            mrays_per_second: if kernel_seconds > 0.0 { 1e-6 * rays as f64 / kernel_seconds } else { 0.0 },
            nodes_per_ray: per_ray(self.nodes_per_ray, other.nodes_per_ray),
            triangles_per_ray: per_ray(self.triangles_per_ray, other.triangles_per_ray),
            most_of_a_pixel: self.most_of_a_pixel.max(other.most_of_a_pixel),
        }
    }
}

impl Statistics {
    /// Adds what a picture cost.
    pub fn add(&mut self, taken: &Taken) {
        let rendering = &taken.rendering;
        self.launches += rendering.launches;
        self.non_finite += rendering.non_finite;
        self.seconds.kernel += rendering.kernel_seconds;
        self.seconds.render += taken.seconds;
        let tests = TestCounts::new(taken.counted(), rendering.kernel_seconds);
        self.tests = match (self.tests.take(), tests) {
            (Some(sum), Some(tests)) => Some(sum.and(&tests, self.seconds.kernel)),
            (sum, tests) => sum.or(tests),
        };
    }

    /// Lines for people.
    pub fn table(&self) -> String {
        let mut table = Table::default();
        table.row("device", &self.device);
        table.row("picture", format!("{}x{}, {} samples a pixel", self.size[0], self.size[1], self.spp));
        if let Some(FrameCounts { rendered, kept, .. }) = self.frames {
            table.row("frames", format!("{rendered} rendered, {kept} kept"));
        }
        self.scene_rows(&mut table);
        table.row("tree", format!("{}: {}", self.accel, self.tree.sentence()));
        table.row("on the device", messages::bytes(self.device_bytes));
        self.time_rows(&mut table);
        if let Some(tests) = &self.tests {
            table.row("rays", format!("{}, {:.1} million a second", tests.rays, tests.mrays_per_second));
            let (nodes, triangles) = (tests.nodes_per_ray, tests.triangles_per_ray);
            table.row("tests a ray", format!("{nodes:.1} nodes, {triangles:.1} triangles"));
            table.row("costliest pixel", format!("{} tests", tests.most_of_a_pixel));
        }
        if self.non_finite > 0 {
            table.row("not finite", format!("{} pixels, black in the picture", self.non_finite));
        }
        table.0
    }

    fn scene_rows(&self, table: &mut Table) {
        let scene = &self.scene;
        table.row("triangles", format!("{} ({} dropped)", scene.triangles, scene.dropped));
        let (meshes, instances) = (scene.meshes, scene.instances);
        let (materials, lights) = (scene.materials, scene.lights);
        table.row("scene", format!("{meshes} meshes, {instances} instances, {materials} materials, {lights} lights"));
    }

    fn time_rows(&self, table: &mut Table) {
        let seconds = &self.seconds;
        let stages = [
            ("load", seconds.load),
            ("flatten", seconds.flatten),
            ("build", seconds.build),
            ("upload", seconds.upload),
            ("render", seconds.render),
            ("save", seconds.save),
        ];
        for (name, time) in stages {
            table.row(name, messages::seconds(time));
        }
        table.row("kernels", format!("{} in {} launches", messages::seconds(seconds.kernel), self.launches));
    }
}

impl Tree {
    /// Its numbers in a line.
    pub fn sentence(&self) -> String {
        format!(
            "{} nodes, {} leaves, {} references, depth {}, largest leaf {}, SAH cost {:.1}, {}",
            self.nodes,
            self.leaves,
            self.references,
            self.depth,
            self.largest_leaf,
            self.sah_cost,
            messages::bytes(self.bytes)
        )
    }
}

/// Lines of a name and a value.
#[derive(Default)]
pub struct Table(pub String);

impl Table {
    /// Adds a line.
    pub fn row(&mut self, name: &str, value: impl std::fmt::Display) {
        // A name within may hold line breaks. Writing to a string cannot fail.
        let _ = writeln!(self.0, "{name:<16}{}", messages::text(&value.to_string()));
    }
}
