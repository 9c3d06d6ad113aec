//! What the paper reports, for comparison: Agarwal and Malhotra, *Real-Time Ray Tracing using CUDA*.

/// How it is named.
pub const CITATION: &str = "Agarwal and Malhotra, Real-Time Ray Tracing using CUDA";

/// Triangles of its scene, and those of all leaves of its k-d tree.
pub const TRIANGLES: u32 = 17_000;
/// See [`TRIANGLES`].
pub const REFERENCES: u32 = 53_000;

/// How many times as fast as brute force its tree is, without secondary rays.
pub const SPEED_UP: f64 = 3.0;
/// What its figure of the mirrored box took, on a GPU that it does not name, and the size of that.
pub const FIGURE_SECONDS: f64 = 165.0;
/// See [`FIGURE_SECONDS`].
pub const FIGURE_SIZE: [u32; 2] = [1920, 1080];

/// Share of the time that goes into intersection, at least.
pub const INTERSECTION: f64 = 0.9;

/// Triangles tested by a ray on average, about, and what shares of references and triangles that is.
pub const TESTS_PER_RAY: u32 = 2_000;
/// See [`TESTS_PER_RAY`].
pub const SHARE_OF_REFERENCES: f64 = 0.037;
/// See [`TESTS_PER_RAY`].
pub const SHARE_OF_TRIANGLES: f64 = 0.115;
/// Triangles tested by one ray at most.
pub const MOST_TESTS: u32 = 8_926;

/// How many times as fast it expects frames to be with work that is shared out as threads fall idle.
pub const EXPECTED_GAIN: [f64; 2] = [2.0, 3.0];
