//! Where a camera shows points and straight edges, in pixels.

use raywarp::render;
use raywarp::scene::{Camera, Projection};

/// Pixels beyond the picture to which edges are kept, for the width of their lines.
const MARGIN: f64 = 8.0;

/// Least depth that is shown, in units of the deeper end of an edge.
const NEAR: f64 = 1e-9;

/// A camera before a picture.
pub(super) struct Eye {
    at: [f64; 3],
    /// Right, up and forward.
    axes: [[f64; 3]; 3],
    /// Columns and rows.
    size: [f64; 2],
    /// Pixels a scene unit, at depth 1 of a pinhole.
    pixels: f64,
    is_parallel: bool,
}

/// A point before an eye: a pixel is `x / w`, `y / w`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    x: f64,
    y: f64,
    w: f64,
    depth: f64,
}

impl Eye {
    /// None for a camera that cannot be rendered from.
    pub fn new(camera: &Camera, size: [u32; 2]) -> Option<Self> {
        render::check_camera(camera).ok()?;
        let axes = render::axes(camera).ok()?.map(|axis| axis.to_array().map(f64::from));
        let size = size.map(f64::from);
        let (height, is_parallel) = match camera.projection {
            Projection::Perspective { fov_y } => (2.0 * f64::from((0.5 * fov_y).tan()), false),
            Projection::Orthographic { height } => (f64::from(height), true),
        };
        Some(Self { at: camera.eye.map(f64::from), axes, size, pixels: size[1] / height, is_parallel })
    }

    fn see(&self, point: [f64; 3]) -> Seen {
        let away = [0, 1, 2].map(|i| point[i] - self.at[i]);
        let [right, up, depth] = self.axes.map(|axis| (0..3).map(|i| axis[i] * away[i]).sum::<f64>());
        let w = if self.is_parallel { 1.0 } else { depth };
        let middle = self.size.map(|side| 0.5 * side * w);
        Seen { x: self.pixels * right + middle[0], y: middle[1] - self.pixels * up, w, depth }
    }

    /// Bit `i` of an index says which of both bounds the corner has on axis `i`.
    pub fn corners(&self, bounds: &[[f32; 3]; 2]) -> [Seen; 8] {
        std::array::from_fn(|corner| self.see([0, 1, 2].map(|i| f64::from(bounds[corner >> i & 1][i]))))
    }

    /// Which faces of a box look at the eye: on each axis, the low one and the high one.
    pub fn faces(&self, [low, high]: &[[f32; 3]; 2]) -> [[bool; 2]; 3] {
        [0, 1, 2].map(|i| {
            let (at, along) = (self.at[i], self.axes[2][i]);
            match self.is_parallel {
                true => [along > 0.0, along < 0.0],
                false => [at < f64::from(low[i]), at > f64::from(high[i])],
            }
        })
    }

    /// The part of a straight edge that is in front of the eye and within the picture or a little beside it, in pixels
    /// from the upper left corner; none where nothing of it is, or where a number is not finite.
    pub fn project(&self, [from, to]: [Seen; 2]) -> Option<[[f32; 2]; 2]> {
        let near = if self.is_parallel { 0.0 } else { NEAR * from.depth.max(to.depth) };
        let [right, below] = self.size.map(|side| side + MARGIN);
        // Each is negative outside of one side of what is seen, and changes evenly along the edge.
        let inside =
            |p: &Seen| [p.depth - near, p.x + MARGIN * p.w, right * p.w - p.x, p.y + MARGIN * p.w, below * p.w - p.y];
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for (a, b) in inside(&from).into_iter().zip(inside(&to)) {
            if !(a.is_finite() && b.is_finite()) || (a < 0.0 && b < 0.0) {
                return None;
            }
            let crossing = a / (a - b);
            match (a < 0.0, b < 0.0) {
                (true, _) => first = first.max(crossing),
                (_, true) => last = last.min(crossing),
                _ => {}
            }
        }
        let at = |t: f64| {
            let [x, y, w] = [(from.x, to.x), (from.y, to.y), (from.w, to.w)].map(|(a, b)| a + t * (b - a));
            let pixel = [(x / w).clamp(-MARGIN, right), (y / w).clamp(-MARGIN, below)];
            pixel.iter().all(|x| x.is_finite()).then_some(pixel.map(|x| x as f32))
        };
        (first <= last).then_some([at(first)?, at(last)?])
    }
}
