//! What a study found: everything that the report shows, and what its JSON holds.

use raywarp::accel::TreeStats;
use serde::Serialize;

use raywarp_cli::bench::Spread;

/// A whole run.
#[derive(Debug, Serialize)]
pub struct Study {
    /// What it ran on, and with what.
    pub about: About,
    /// One a scene, in the order of the command line.
    pub scenes: Vec<SceneStudy>,
    /// How the time to build a tree grows with the number of triangles.
    pub growth: Vec<Growth>,
    /// Sentences about what was left out, and why.
    pub notes: Vec<String>,
}

/// The machine, the program and the way it was called.
#[derive(Debug, Serialize)]
pub struct About {
    /// The device's name, for people.
    pub device: String,
    /// CUDA version of the driver, and its own; none on the CPU.
    pub driver: Option<String>,
    /// Highest clock of the device.
    pub clock_mhz: Option<u32>,
    /// Of the device.
    pub multiprocessors: Option<u32>,
    /// Most single-precision operations a second at that clock, a fused multiply-add counted as two; none on the CPU.
    pub peak_flops: Option<f64>,
    /// Threads of the CPU that builds trees, and traces where there is no GPU.
    pub cpu_threads: usize,
    /// Of the program.
    pub version: &'static str,
    /// Of its sources, where the build said.
    pub commit: Option<&'static str>,
    /// What was typed.
    pub command: String,
    /// Whether this is the short run.
    pub quick: bool,
}

/// One scene.
#[derive(Debug, Serialize)]
pub struct SceneStudy {
    /// The file's name, or that of the built-in scene.
    pub name: String,
    /// Triangles that can be hit.
    pub triangles: usize,
    /// Size of the pictures, in pixels.
    pub picture: [u32; 2],
    /// Every structure.
    pub structures: Vec<Structure>,
    /// What rays cost in them.
    pub tests: Vec<TestCost>,
    /// Where the time of a frame goes.
    pub shares: Vec<StageShares>,
    /// How long the threads of a frame take.
    pub loads: Vec<Load>,
    /// How the lanes of a warp are used.
    pub lanes: Vec<LaneUse>,
    /// Frames by blocks of several shapes.
    pub shapes: Vec<BlockShape>,
    /// Ways to share out the work, over batches of rays.
    pub sharing: Vec<Sharing>,
    /// Paths of several bounces in one kernel, and bounce by bounce.
    pub paths: Vec<PathWay>,
}

/// A structure over a scene: how large, how good, how long to build, how fast.
#[derive(Debug, Serialize)]
pub struct Structure {
    /// For people: "k-d tree of the paper".
    pub name: String,
    /// As `--accel` takes it, and `--tree` where it has several qualities.
    pub accel: String,
    pub tree: Option<String>,
    /// Size, quality and time to build.
    #[serde(flatten)]
    pub stats: TreeStats,
    /// By kind of rays. What brute force could only do with too few rays to fill a GPU is missing.
    pub rates: Vec<Rate>,
    /// Whole frames, likewise.
    pub frames: Vec<FrameTime>,
    /// Share of the device's peak arithmetic that its triangle tests reach; brute force on a GPU only.
    pub share_of_peak: Option<f64>,
}

/// Rays a second.
#[derive(Debug, Serialize)]
pub struct Rate {
    /// "primary", "shadow", "reflected", "diffuse".
    pub rays: String,
    pub count: usize,
    pub mrays_per_s: Spread,
}

/// Time of a frame's kernels.
#[derive(Clone, Debug, Serialize)]
pub struct FrameTime {
    /// "primary": no shadows, no bounces; "all": shadows and five bounces.
    pub rays: String,
    pub ms: Spread,
    /// Rays of all kinds that the frame traces.
    pub traced: u64,
}

/// What rays of a kind cost in a structure, exactly counted.
#[derive(Debug, Serialize)]
pub struct TestCost {
    /// As in [`Structure::name`].
    pub structure: String,
    /// As in [`Rate::rays`].
    pub rays: String,
    /// How many rays were counted.
    pub counted: usize,
    /// Nodes visited by a ray.
    pub nodes: Distribution,
    /// Triangles tested by a ray, repeated ones included.
    pub triangles: Distribution,
    /// Mean of the triangles tested over all references, and over all triangles.
    pub share_of_references: f64,
    pub share_of_triangles: f64,
}

/// How a number is spread over rays or threads.
#[derive(Debug, Default, Serialize)]
pub struct Distribution {
    pub mean: f64,
    pub median: f64,
    /// What 95 of 100 do not exceed.
    pub p95: f64,
    pub most: f64,
    /// From the least to the most, without gaps.
    pub histogram: Vec<Bin>,
}

/// A column of a histogram.
#[derive(Debug, Serialize)]
pub struct Bin {
    /// The first number that falls into it, and the first that does not.
    pub from: f64,
    pub to: f64,
    /// Share of all, 0 to 1.
    pub share: f64,
}

/// Where the time of a frame goes, by clocks within the kernel: shares of the three add to 1.
#[derive(Debug, Serialize)]
pub struct StageShares {
    /// As in [`Structure::name`].
    pub structure: String,
    /// As in [`FrameTime::rays`].
    pub rays: String,
    pub generation: f64,
    pub intersection: f64,
    pub shading: f64,
}

/// How long the threads of a frame take: the paper's figure 2.
#[derive(Debug, Serialize)]
pub struct Load {
    /// As in [`Structure::name`].
    pub structure: String,
    /// As in [`FrameTime::rays`].
    pub rays: String,
    /// "cycles" on a GPU, "ns" on a CPU.
    pub unit: &'static str,
    /// Over the threads, one a pixel.
    pub time: Distribution,
    /// Mean over warps of the mean work of their pixels over the most, work being nodes and triangles; blocks likewise.
    pub warp_balance: f64,
    pub block_balance: f64,
    /// The heat map, as PNG, with the time that its brightest colour stands for.
    #[serde(skip)]
    pub picture: Vec<u8>,
    pub brightest: f64,
}

/// What the 32 lanes of a warp do while it traces, step by step, all in step: shares of lane-steps, which add to 1.
#[derive(Debug, Serialize)]
pub struct LaneUse {
    /// The loop: "while-while", "if-if", "speculative", "postponed".
    pub form: String,
    /// As in [`Rate::rays`], or "frame, primary" and "frame, all": whole frames of the paper's shading.
    pub rays: String,
    /// Steps of the warps that were followed, each a node or a triangle.
    pub steps: u64,
    /// Lanes that visit a node or test a triangle of their own: the SIMD efficiency.
    pub useful: f64,
    /// Lanes that have triangles to test while others visit nodes.
    pub boxes: f64,
    /// Lanes that have nodes to visit while others test triangles.
    pub leaves: f64,
    /// Lanes whose ray is done while others of the warp are not.
    pub finished: f64,
    /// Lanes that have no ray of the kind that the others trace: theirs missed, or needs no shadow. Frames only.
    pub shading: f64,
}

/// A frame with blocks of some shape.
#[derive(Debug, Serialize)]
pub struct BlockShape {
    /// Columns and rows.
    pub shape: [u32; 2],
    /// As in [`FrameTime::rays`].
    pub rays: String,
    pub ms: Spread,
}

/// One way to share out the work.
#[derive(Debug, Serialize)]
pub struct Sharing {
    /// What is varied: "order of the rays", "threads a block", "loop", "queue".
    pub group: String,
    /// "one thread a ray", "if-if", "persistent, global queue", ...
    pub way: String,
    /// As in [`Rate::rays`].
    pub rays: String,
    pub mrays_per_s: Spread,
    /// Rate over that of the group's plain way, which every group has.
    pub gain: f64,
}

/// Paths of several bounces.
#[derive(Debug, Serialize)]
pub struct PathWay {
    /// "one kernel", "wavefront", "wavefront, sorted".
    pub way: String,
    /// "reflected": every surface is a mirror; "diffuse": every bounce is random.
    pub rays: String,
    pub bounces: u32,
    /// Rays of all bounces together.
    pub traced: u64,
    pub ms: Spread,
    pub mrays_per_s: f64,
    /// Mean time of the sorting, part of the above.
    pub sorting_ms: f64,
    /// Rate over that of one kernel.
    pub gain: f64,
}

/// Time to build a tree over so many triangles.
#[derive(Debug, Serialize)]
pub struct Growth {
    /// As in [`Structure::name`].
    pub builder: String,
    pub triangles: usize,
    pub seconds: f64,
}
