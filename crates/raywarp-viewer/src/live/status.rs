//! What a viewer tells beside the picture.

use serde::Serialize;

/// The state of a viewer, for the lines over the picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Status {
    /// What runs beside: "reading model.glb", "building a better tree"; nothing if all is done.
    pub busy: Option<String>,
    /// What happened last, until the next thing happens or a few seconds have passed.
    pub notice: Option<Notice>,
    /// The scene's name.
    pub scene: String,
    /// Device that traces.
    pub device: String,
    /// Structure that is traced, such as "bvh2, fast".
    pub accel: String,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Pixels of the picture as it is shown.
    pub size: [u32; 2],
    /// Pixels that were traced for it: fewer while the camera moves.
    pub traced: [u32; 2],
    /// Time of one frame, from one to the next while the camera moves, in milliseconds.
    pub frame_ms: f64,
    /// Time of the kernels that trace within it.
    pub kernel_ms: f64,
    /// Time within it from the samples to pixels in the host's memory: developing and copying.
    pub fetch_ms: f64,
    /// Million rays of all kinds a second of kernel time, from a count of a part of the picture; nothing if not known.
    pub mrays_per_s: Option<f64>,
    /// Samples a pixel so far.
    pub samples: u32,
    /// Samples a pixel when it is done.
    pub spp: u32,
    /// Whether there is nothing left to refine.
    pub settled: bool,
    /// What is shown: "picture", "normals" and so on.
    pub view: String,
    /// What the colours of a debug view mean.
    pub legend: Option<Legend>,
    /// Lines about the picked point: what, and its value.
    pub pick: Vec<(String, String)>,
    /// Whether the numbers are to be shown.
    pub statistics: bool,
    /// Whether the help is to be shown.
    pub help: bool,
    /// Whether the panel is to be shown.
    pub panel: bool,
    /// Whether the picture is held at full size and all samples while the camera moves.
    pub reference: bool,
}

/// A message for people.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Notice {
    /// A sentence.
    pub text: String,
    /// Whether something failed.
    pub error: bool,
}

/// The scale of a debug view.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Legend {
    /// What is shown, with its unit.
    pub title: String,
    /// What the first colour stands for.
    pub low: String,
    /// What the last colour stands for.
    pub high: String,
    /// From low to high, sRGB; empty where the title says it all.
    pub colors: Vec<[u8; 3]>,
}
