//! Boxes on a grid of 16 bits an axis, each around the one that it was.

use crate::traversal::bvh2::Node as Full;
use crate::traversal::bvh2_quantized::{position, Corner, Grid, Node};

/// Largest code of a plane.
pub const MOST: u32 = 0xffff;

/// The node on a grid that holds its boxes.
#[inline(always)]
pub fn quantize(node: &Full, grid: &Grid) -> Node {
    Node { children: [corner(node, 0, grid), corner(node, 1, grid)] }
}

#[inline(always)]
fn corner(node: &Full, side: usize, grid: &Grid) -> Corner {
    let (low, high) = (node.low[side], node.high[side]);
    let mut planes = [MOST; 3];
    if node.has_child(side) {
        for axis in 0..3 {
            planes[axis as usize] = below(low[axis], grid, axis) | above(high[axis], grid, axis) << 16;
        }
    }
    Corner { planes, link: node.children[side] }
}

/// Where the plane of a code lies.
#[inline(always)]
pub fn plane(code: u32, grid: &Grid, axis: u32) -> f64 {
    grid.base[axis] as f64 + grid.scale[axis] as f64 * position(code) as f64
}

/// The code next to a plane; the two beside it hold it between them.
#[inline(always)]
fn close(x: f32, grid: &Grid, axis: u32) -> u32 {
    let place = (x as f64 - grid.base[axis] as f64) / grid.scale[axis] as f64;
    // The codes are the middle bits of the numbers from 2 to 8.
    (place.clamp(2.0, 7.999) as f32).to_bits() >> 8 & MOST
}

/// The last code that is not above `x`.
#[inline(always)]
pub fn below(x: f32, grid: &Grid, axis: u32) -> u32 {
    let mut code = (close(x, grid, axis) + 1).min(MOST);
    while code > 0 && plane(code, grid, axis) > x as f64 {
        code -= 1;
    }
    code
}

/// The first code that is not below `x`.
#[inline(always)]
pub fn above(x: f32, grid: &Grid, axis: u32) -> u32 {
    let mut code = close(x, grid, axis).saturating_sub(1);
    while code < MOST && plane(code, grid, axis) < x as f64 {
        code += 1;
    }
    code
}
