//! A study that nobody made, for tests: every number is invented.

use raywarp::accel::TreeStats;
use raywarp::image::{png, Rgb8};

use crate::study::findings::{
    About, Bin, BlockShape, Distribution, FrameTime, Growth, LaneUse, Load, PathWay, Rate, SceneStudy, Sharing,
    StageShares, Structure, Study, TestCost,
};
use raywarp_cli::bench::Spread;

const RAYS: [&str; 4] = ["primary", "shadow", "reflected", "diffuse"];
const FRAMES: [&str; 2] = ["primary", "all"];

/// Every field is filled.
pub fn study(scenes: &[&str]) -> Study {
    let growth = |(builder, factor): (&str, f64)| {
        let builder = builder.to_owned();
        move |&triangles: &usize| {
            let n = triangles as f64;
            Growth { builder: builder.clone(), triangles, seconds: factor * 1e-8 * n * n.ln() }
        }
    };
    let builders = [("test k-d tree", 9.0), ("test bvh2, fast", 0.7), ("test bvh2, high", 31.0)];
    let sizes = [1000, 8000, 64_000, 512_000, 4_000_000];
    Study {
        about: about(),
        scenes: scenes.iter().map(|name| scene(name)).collect(),
        growth: builders
            .into_iter()
            .flat_map(|builder| sizes.iter().map(growth(builder)).collect::<Vec<_>>())
            .collect(),
        notes: vec!["Everything here is invented: it is data of a test.".to_owned()],
    }
}

/// Nothing is filled.
pub fn empty() -> Study {
    Study { about: about(), scenes: Vec::new(), growth: Vec::new(), notes: Vec::new() }
}

/// A scene of which nothing was found.
pub fn empty_scene(name: &str) -> SceneStudy {
    SceneStudy {
        name: name.to_owned(),
        triangles: 0,
        picture: [0, 0],
        structures: Vec::new(),
        tests: Vec::new(),
        shares: Vec::new(),
        loads: Vec::new(),
        lanes: Vec::new(),
        shapes: Vec::new(),
        sharing: Vec::new(),
        paths: Vec::new(),
    }
}

fn about() -> About {
    About {
        device: "a device of a test".to_owned(),
        driver: Some("CUDA 0.0, driver 0.0".to_owned()),
        clock_mhz: Some(1000),
        multiprocessors: Some(100),
        peak_flops: Some(12.3e12),
        cpu_threads: 7,
        version: "0.0.0",
        commit: Some("0000000"),
        command: "raywarp-lab study test.obj --quick".to_owned(),
        quick: true,
    }
}

fn scene(name: &str) -> SceneStudy {
    SceneStudy {
        name: name.to_owned(),
        triangles: 10_000,
        picture: [640, 360],
        structures: STRUCTURES.iter().enumerate().map(|(index, of)| structure(index as f64, of)).collect(),
        tests: STRUCTURES[1..].iter().flat_map(|of| RAYS.map(|rays| tests(of.0, rays))).collect(),
        shares: STRUCTURES.iter().flat_map(|of| FRAMES.map(|rays| shares(of.0, rays))).collect(),
        loads: STRUCTURES[1..4].iter().flat_map(|of| FRAMES.map(|rays| load(of.0, rays))).collect(),
        lanes: lanes(),
        shapes: [[8, 8], [16, 16], [32, 4]].iter().flat_map(|&shape| FRAMES.map(|rays| block(shape, rays))).collect(),
        sharing: sharing(),
        paths: paths(),
    }
}

const STRUCTURES: [(&str, &str, Option<&str>); 10] = [
    ("test brute force", "brute", None),
    ("test k-d tree", "kd", None),
    ("test bvh2, fast", "bvh2", Some("fast")),
    ("test bvh2, medium", "bvh2", Some("medium")),
    ("test bvh2, high", "bvh2", Some("high")),
    ("test bvh", "bvh", Some("medium")),
    ("test bvh4", "bvh4", Some("medium")),
    ("test bvh8", "bvh8", Some("medium")),
    ("test bvh8w", "bvh8w", Some("medium")),
    ("test bvh8f", "bvh8f", Some("medium")),
];

fn structure(index: f64, &(name, accel, tree): &(&str, &str, Option<&str>)) -> Structure {
    let rate = |rays: &str, factor: f64| {
        let mrays_per_s = around(0.7 * 5f64.powf(index.min(4.0)) * factor + index);
        Rate { rays: rays.to_owned(), count: 2_000_000, mrays_per_s }
    };
    let frame = |rays: &str, traced: u64| {
        let ms = around(traced as f64 * 1e-3 / 5f64.powf(index.min(4.0)));
        FrameTime { rays: rays.to_owned(), ms, traced }
    };
    Structure {
        name: name.to_owned(),
        accel: accel.to_owned(),
        tree: tree.map(str::to_owned),
        stats: TreeStats {
            nodes: 5000 * index as usize + 1,
            leaves: 3000 * index as usize + 1,
            references: if accel == "kd" { 31_000 } else { 10_000 + 300 * index as usize },
            duplicates: if accel == "kd" { 21_000 } else { 300 * index as usize },
            depth: 17,
            largest_leaf: 12,
            sah_cost: 123.4 / (index + 1.0),
            bytes: 123_456 * (index as usize + 1),
            build_seconds: 0.0031 * (index * index + 0.01),
        },
        rates: RAYS.iter().zip([1.0, 1.7, 0.6, 0.2]).map(|(rays, factor)| rate(rays, factor)).collect(),
        frames: vec![frame("primary", 230_400), frame("all", 1_234_567)],
        share_of_peak: (accel == "brute").then_some(0.543),
    }
}

fn around(median: f64) -> Spread {
    Spread { median, least: 0.97 * median, most: 1.02 * median }
}

/// Falling columns, as wide as each other.
fn distribution(scale: f64) -> Distribution {
    let bin = |index: i32| {
        let share = 0.21 * 0.8f64.powi(index) + 0.001 * f64::from(index % 3);
        Bin { from: scale * f64::from(index), to: scale * f64::from(index + 1), share }
    };
    let histogram = (0..40).map(bin).collect();
    Distribution { mean: 4.4 * scale, median: 3.1 * scale, p95: 14.2 * scale, most: 39.0 * scale, histogram }
}

/// Columns that widen.
fn wide_distribution(scale: f64) -> Distribution {
    let bin = |index: i32| {
        let from = scale * 1.3f64.powi(index);
        Bin { from, to: 1.3 * from, share: 0.0024 * f64::from(index * (29 - index)) / 9.5 }
    };
    let histogram = (0..30).map(bin).collect();
    Distribution { mean: 88.0 * scale, median: 44.0 * scale, p95: 700.0 * scale, most: 2600.0 * scale, histogram }
}

fn tests(structure: &str, rays: &str) -> TestCost {
    TestCost {
        structure: structure.to_owned(),
        rays: rays.to_owned(),
        counted: 100_000,
        nodes: distribution(3.0),
        triangles: distribution(structure.len() as f64 - 8.0),
        share_of_references: 0.0123,
        share_of_triangles: 0.0456,
    }
}

fn shares(structure: &str, rays: &str) -> StageShares {
    let [structure, rays] = [structure, rays].map(str::to_owned);
    StageShares { structure, rays, generation: 0.02, intersection: 0.91, shading: 0.07 }
}

fn load(structure: &str, rays: &str) -> Load {
    let shade = |pixel: u32| ((pixel % 64) * (pixel / 64) % 256) as u8;
    let picture = Rgb8 { width: 64, height: 36, pixels: (0..64 * 36).map(|pixel| [shade(pixel), 90, 40]).collect() };
    Load {
        structure: structure.to_owned(),
        rays: rays.to_owned(),
        unit: "cycles",
        time: wide_distribution(345.6),
        warp_balance: 0.61,
        block_balance: 0.43,
        picture: png::encode(&picture).unwrap(),
        brightest: 654_321.0,
    }
}

fn lanes() -> Vec<LaneUse> {
    let forms = ["while-while", "if-if", "speculative", "postponed"];
    let kinds = ["primary", "diffuse", "frame, primary", "frame, all"];
    let lane = |form: &str, rays: &str, useful: f64| LaneUse {
        form: form.to_owned(),
        rays: rays.to_owned(),
        steps: 1_234_567,
        useful,
        boxes: 0.1,
        leaves: 0.08,
        finished: 0.7 - useful,
        shading: 0.12,
    };
    let row =
        |form: &'static str| kinds.iter().zip([0.6, 0.3, 0.5, 0.2]).map(move |(rays, useful)| lane(form, rays, useful));
    forms.into_iter().flat_map(row).collect()
}

fn block(shape: [u32; 2], rays: &str) -> BlockShape {
    BlockShape { shape, rays: rays.to_owned(), ms: around(f64::from(shape[0]) / 3.0) }
}

fn sharing() -> Vec<Sharing> {
    let groups: [(&str, &[&str]); 3] = [
        ("order of the rays", &["as made", "shuffled", "sorted by origin", "sorted by origin and direction"]),
        ("loop", &["while-while", "if-if", "speculative", "postponed"]),
        (
            "queue",
            &["one thread a ray", "persistent, global queue", "persistent, queue a block", "persistent, stealing"],
        ),
    ];
    let one = |group: &str, way: &str, rays: &str, gain: f64| Sharing {
        group: group.to_owned(),
        way: way.to_owned(),
        rays: rays.to_owned(),
        mrays_per_s: around(321.0 * gain),
        gain,
    };
    let mut all = Vec::new();
    for (group, ways) in groups {
        for (index, way) in ways.iter().enumerate() {
            all.extend(
                RAYS.iter()
                    .map(|rays| one(group, way, rays, 1.0 + 0.07 * (index * rays.len()) as f64 - 0.2 * index as f64)),
            );
        }
    }
    all
}

fn paths() -> Vec<PathWay> {
    let ways = [("one kernel", 1.0), ("wavefront", 0.8), ("wavefront, sorted", 1.3)];
    let one = |rays: &str, way: &str, gain: f64| PathWay {
        way: way.to_owned(),
        rays: rays.to_owned(),
        bounces: 5,
        traced: 7_654_321,
        ms: around(12.3 / gain),
        mrays_per_s: 622.0 * gain,
        sorting_ms: if way.ends_with("sorted") { 1.5 } else { 0.0 },
        gain,
    };
    ["reflected", "diffuse"].into_iter().flat_map(|rays| ways.map(|(way, gain)| one(rays, way, gain))).collect()
}
