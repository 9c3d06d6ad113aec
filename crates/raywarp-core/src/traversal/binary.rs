//! The way down a binary tree of boxes, whatever its nodes look like.

use core::mem::MaybeUninit;

use super::bvh2::{Child, MAX_DEPTH};
use super::{Counter, Visitor};
use crate::arch::{Links, Meeting};
use crate::ray::Ray;
use crate::triangle::{RayShear, Triangle};
use crate::view::View;

/// The nodes of a tree as one ray sees them.
pub trait Boxes {
    /// Where the ray is within the boxes of a node's two children, between `t_min` and `t_far`. Never less than it
    /// really is, however the distances round.
    fn children(&self, node: u32, t_min: f32, t_far: f32) -> [Meeting; 2];
}

/// What is added to a plane's distance: one sum for the planes where a box is entered, one for those where it is left.
#[derive(Clone, Copy)]
pub struct Slab {
    /// Rounded towards earlier.
    pub enter: f32,
    /// Rounded towards later.
    pub leave: f32,
}

/// Roundings of single precision that a box allows for, relative to the numbers that a distance is summed from: two
/// for the inverse and the sum, two for the origin's share, three by which a triangle's corners move when they are
/// sheared, five in the distance of a hit.
pub const SLACK: f32 = 16.0 / 16_777_216.0;

impl Slab {
    /// Of distances `plane + shift` where `plane` is at most `reach` from zero; conservative, after Ize 2013. Where that
    /// overflows the slab is no limit.
    #[inline(always)]
    pub fn new(shift: f32, reach: f32) -> Self {
        let slack = (shift.abs() + reach.abs()) * SLACK;
        let finite = slack < f32::INFINITY;
        Self {
            enter: if finite { shift - slack } else { f32::NEG_INFINITY },
            leave: if finite { shift + slack } else { f32::INFINITY },
        }
    }
}

/// From the distances of the planes. They are compared as integers, which takes three at a time on some machines: of
/// two negative ones that makes the first earlier and the last later, which is safe.
#[inline(always)]
pub fn meeting(enter: [f32; 3], leave: [f32; 3], t_min: f32, t_far: f32, link: u32) -> Meeting {
    let [ex, ey, ez] = enter;
    let [lx, ly, lz] = leave;
    let bits = |t: f32| t.to_bits() as i32;
    let first = bits(ex).max(bits(ey)).max(bits(ez)).max(bits(t_min));
    let last = bits(lx).min(bits(ly)).min(bits(lz)).min(bits(t_far));
    Meeting { first: f32::from_bits(first as u32), last: f32::from_bits(last as u32), link }
}

/// Links below this are nodes.
pub const LEAVES: u32 = 1 << 28;

/// Links of a way down: one is put aside at each of at most [`MAX_DEPTH`] nodes, `validate` sees to that.
pub type Aside<'a> = Links<'a, { MAX_DEPTH + 1 }>;

/// Where those lie.
pub type Storage = [MaybeUninit<u32>; MAX_DEPTH + 1];

/// From a node's children to the next link.
#[inline(always)]
pub fn step(links: &mut Aside, ordered: bool, a: Meeting, b: Meeting) -> u32 {
    // SAFETY: see `Aside`.
    unsafe {
        if ordered {
            links.descend(a, b)
        } else {
            links.descend_either(a, b)
        }
    }
}

/// From a leaf to the next link.
///
/// # Safety
/// The end was not reached before.
#[inline(always)]
pub unsafe fn step_back(links: &mut Aside, ordered: bool) -> u32 {
    // SAFETY: the caller's promise.
    unsafe {
        if ordered {
            links.pop()
        } else {
            links.pop_either()
        }
    }
}

/// Who looks at the triangles of leaves that lie in one array: a [`Visitor`], or one that keeps indices.
pub(super) trait LeafVisitor {
    /// As of a [`Visitor`].
    const ORDERED: bool;
    /// As of a [`Visitor`].
    const ENDS: bool;

    /// As [`Visitor::visit`], with the triangle's place in the array.
    fn visit_at(&mut self, index: u32, shear: &RayShear, triangle: &Triangle) -> f32;
}

impl<V: Visitor> LeafVisitor for V {
    const ORDERED: bool = V::ORDERED;
    const ENDS: bool = V::ENDS;

    #[inline(always)]
    fn visit_at(&mut self, _: u32, shear: &RayShear, triangle: &Triangle) -> f32 {
        self.visit(shear, triangle)
    }
}

/// Shows the visitor what lies in the boxes that the ray meets, in the order that it asks for.
#[inline(always)]
pub(super) fn walk<V: LeafVisitor>(
    boxes: &impl Boxes,
    triangles: View<Triangle>,
    ray: &Ray,
    counter: &mut impl Counter,
    visitor: &mut V,
) {
    let mut storage = [const { MaybeUninit::uninit() }; MAX_DEPTH + 1];
    let mut links = Links::new(&mut storage);
    let mut t_far = ray.t_max;
    let mut next = descend::<V>(boxes, 0, ray.t_min, t_far, &mut links, counter);
    if next == Aside::END {
        return;
    }
    // Not before: many rays meet no triangle's box.
    let shear = RayShear::new(ray);
    loop {
        counter.leaf();
        let leaf = Child::of_bits(next);
        let mut index = leaf.index();
        let end = index + leaf.count();
        loop {
            counter.triangle();
            t_far = visitor.visit_at(index, &shear, &triangles.load(index));
            if V::ENDS && t_far < ray.t_min {
                return;
            }
            index += 1;
            if index >= end {
                break;
            }
        }
        // SAFETY: `END` ends this loop.
        next = unsafe { step_back(&mut links, V::ORDERED) };
        next = descend::<V>(boxes, next, ray.t_min, t_far, &mut links, counter);
        if next == Aside::END {
            return;
        }
    }
}

/// From a link on to the first that is no node.
#[inline(always)]
fn descend<V: LeafVisitor>(
    boxes: &impl Boxes,
    mut next: u32,
    t_min: f32,
    t_far: f32,
    links: &mut Aside,
    counter: &mut impl Counter,
) -> u32 {
    while next < LEAVES {
        counter.node();
        let [a, b] = boxes.children(next, t_min, t_far);
        next = step(links, V::ORDERED, a, b);
    }
    next
}
