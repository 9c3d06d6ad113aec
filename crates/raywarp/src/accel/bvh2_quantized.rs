//! The 32-byte nodes of a binary hierarchy, made from its 64-byte nodes.

use raywarp_core::build::quantize::{plane, quantize, MOST};
use raywarp_core::math::Vec3;
use raywarp_core::traversal;
use raywarp_core::traversal::bvh2::Node as Full;
use raywarp_core::traversal::bvh2_quantized::{position, Grid, Node};
use raywarp_core::triangle::Triangle;

use super::bounds::Bounds;
use super::bvh2::Bvh2;
use super::view::{lend, Borrowed};
use super::{Invalid, TreeStats};

/// A binary hierarchy in 32-byte nodes.
#[derive(Clone, Debug)]
pub struct QuantizedBvh2 {
    pub(crate) nodes: Vec<Node>,
    pub(crate) grid: Grid,
    pub(crate) triangles: Vec<Triangle>,
    build_seconds: f64,
}

impl QuantizedBvh2 {
    /// The same tree with smaller nodes: each box contains the one that it was.
    pub fn new(tree: Bvh2) -> Self {
        let start = std::time::Instant::now();
        let grid = grid(&tree.bounds());
        let nodes = compress(tree.nodes(), &grid);
        let build_seconds = tree.build_seconds + start.elapsed().as_secs_f64();
        Self { nodes, grid, triangles: tree.triangles, build_seconds }
    }

    /// Inner nodes; 0 is the root.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// What their planes are counted in.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// In the order of the leaves.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// For tracing on this machine.
    pub fn view(&self) -> Borrowed<'_, traversal::QuantizedBvh2> {
        Borrowed::new(traversal::QuantizedBvh2 {
            nodes: lend(&self.nodes),
            triangles: lend(&self.triangles),
            grid: self.grid,
        })
    }

    /// Size and quality.
    pub fn stats(&self) -> TreeStats {
        let bytes = size_of_val(&self.nodes[..]) + size_of_val(&self.triangles[..]);
        TreeStats { bytes, build_seconds: self.build_seconds, ..self.expanded().stats() }
    }

    /// See [`Accel::validate`](super::Accel::validate).
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.expanded().validate()
    }

    fn expanded(&self) -> Bvh2 {
        let nodes = self.nodes.iter().map(|node| expand(node, &self.grid)).collect();
        Bvh2 { nodes, triangles: self.triangles.clone(), build_seconds: self.build_seconds }
    }
}

/// With the boxes as numbers, none larger than it is on the grid.
pub(super) fn expand(node: &Node, grid: &Grid) -> Full {
    let [low, high] = [(0, 0u32), (16, 1)].map(|(shift, up)| {
        node.children.map(|child| {
            let [x, y, z] = [0, 1, 2].map(|i: u32| {
                if grid.scale[i] == f32::INFINITY {
                    return if up == 0 { -f32::MAX } else { f32::MAX };
                }
                let exact = plane(child.planes[i as usize] >> shift & MOST, grid, i);
                let near = exact as f32;
                match up {
                    0 if f64::from(near) < exact => near.next_up(),
                    1 if f64::from(near) > exact => near.next_down(),
                    _ => near,
                }
            });
            Vec3::new(x, y, z)
        })
    });
    Full { low, high, children: node.children.map(|child| child.link), unused: [0; 2] }
}

/// Positions between which the planes of a tree are put: a little within the first and the last.
const FIRST: f64 = 2.001;
const LAST: f64 = 7.99;

/// The grid over `bounds`.
pub(crate) fn grid(bounds: &Bounds) -> Grid {
    let axis = |i: usize| {
        let (low, high) = (f64::from(bounds.low[i]), f64::from(bounds.high[i]));
        if low <= high {
            axis(low, high)
        } else {
            axis(0.0, 0.0)
        }
    };
    let [x, y, z] = [0, 1, 2].map(axis);
    Grid { base: Vec3::new(x.0, y.0, z.0), scale: Vec3::new(x.1, y.1, z.1) }
}

/// What boxes on the grid can enclose.
pub(super) fn covered(grid: &Grid) -> Bounds {
    let end = |axis: u32, code, beyond: f32| {
        let is_endless = grid.scale[axis] == f32::INFINITY;
        let end = plane(code, grid, axis) as f32;
        if is_endless || end.is_infinite() {
            return beyond;
        }
        // Rounded inwards.
        if beyond < 0.0 {
            end.next_up()
        } else {
            end.next_down()
        }
    };
    Bounds { low: [0, 1, 2].map(|axis| end(axis, 0, -f32::MAX)), high: [0, 1, 2].map(|axis| end(axis, MOST, f32::MAX)) }
}

/// Base and scale of an axis, such that its first and last plane enclose what there is. Where that is narrow beside its
/// distance from zero, single precision cannot say so: the grid is then as wide as it must be. Near the end of single
/// precision there is none: an infinite scale makes every box endless on that axis.
fn axis(low: f64, high: f64) -> (f32, f32) {
    let mut scale = ((high - low) / (LAST - FIRST)) as f32 * (1.0 + f32::EPSILON) + f32::MIN_POSITIVE;
    loop {
        let base = (low - FIRST * f64::from(scale)).max(f64::from(-f32::MAX)) as f32;
        let at = |code| f64::from(base) + f64::from(scale) * f64::from(position(code));
        if at(0) <= low && at(MOST) >= high {
            return (base, scale);
        }
        if scale > f32::MAX / 16.0 {
            return (0.0, f32::INFINITY);
        }
        scale *= 1.25;
    }
}

/// The same tree on a grid: boxes contain those of `nodes`.
pub(crate) fn compress(nodes: &[Full], grid: &Grid) -> Vec<Node> {
    use rayon::prelude::*;
    nodes.par_iter().map(|node| quantize(node, grid)).collect()
}

/// Whether `small` is what [`compress`] makes of `nodes`.
///
/// # Errors
/// The first node that is not.
pub(crate) fn same(nodes: &[Full], small: &[Node], grid: &Grid) -> Result<(), Invalid> {
    let made = compress(nodes, grid);
    match (0..made.len().max(small.len())).find(|&i| made.get(i) != small.get(i)) {
        Some(node) => Err(Invalid::Outside { node: node as u32 }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywarp_core::build::quantize::{above, below};

    proptest! {
        #[test]
        fn a_box_on_the_grid_contains_the_box(
            corners in prop::array::uniform6(-1.0f32..1.0),
            size in prop::sample::select(vec![1e-30f32, 1e-6, 1.0, 1e6, 1e30, 3e38]),
            around in prop::array::uniform3(0.0f32..1.0),
        ) {
            let order = |a: f32, b: f32| (a.min(b) * size, a.max(b) * size);
            let sides = [0, 1, 2].map(|i| order(corners[i], corners[i + 3]));
            let bounds = Bounds {
                low: [0, 1, 2].map(|i| sides[i].0 - around[i] * (size * 0.01)),
                high: [0, 1, 2].map(|i| sides[i].1 + around[i] * (size * 0.01)),
            };
            prop_assume!(bounds.low.iter().chain(&bounds.high).all(|x| x.is_finite()));
            let grid = grid(&bounds);
            for (axis, (low, high)) in sides.into_iter().enumerate() {
                let axis = axis as u32;
                if grid.scale[axis] == f32::INFINITY {
                    prop_assert!(size > 1e37);
                    continue;
                }
                let (below, above) = (below(low, &grid, axis), above(high, &grid, axis));
                prop_assert!(plane(below, &grid, axis) <= f64::from(low));
                prop_assert!(plane(above, &grid, axis) >= f64::from(high));
                // Not more than a step of the coarser half around it.
                let step = f64::from(grid.scale[axis]) / 8192.0 * 1.001;
                prop_assert!(plane(below, &grid, axis) >= f64::from(low) - step, "{low} {}", plane(below, &grid, axis));
                prop_assert!(plane(above, &grid, axis) <= f64::from(high) + step);
            }
        }
    }
}
