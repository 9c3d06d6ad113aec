//! Counts of nodes and triangles against a slow reference: recursive, one ray at a time, without any stack.

use raywarp::accel::bvh2::Bvh2;
use raywarp::accel::kdtree::KdTree;
use raywarp::accel::{Accel, AccelKind, Build, Quality};
use raywarp::query::{tests, RayKind, RaySource};
use raywarp::Ray;
use raywarp_core::ray::Hit;
use raywarp_core::traversal::binary::Boxes;
use raywarp_core::traversal::bvh2::{Full, ANY};
use raywarp_core::traversal::Tests;
use raywarp_core::triangle::{RayShear, Triangle};

/// A ray that looks for its closest hit.
struct Reference<'a> {
    ray: &'a Ray,
    shear: RayShear,
    best: Hit,
    counts: Tests,
}

impl<'a> Reference<'a> {
    fn new(ray: &'a Ray) -> Self {
        let best = Hit { t: ray.t_max, ..Hit::NONE };
        Self { ray, shear: RayShear::new(ray), best, counts: Tests::default() }
    }

    fn test(&mut self, triangle: &Triangle) {
        self.counts.triangles += 1;
        if let Some(hit) = triangle.intersect(&self.shear) {
            if hit.t >= self.ray.t_min && hit.precedes(&self.best) {
                self.best = hit;
            }
        }
    }

    /// Below a link of a hierarchy: the nearer child first; the other one whatever has been found meanwhile, as a stack
    /// that keeps no distances must.
    fn hierarchy(&mut self, tree: &Bvh2, boxes: &Full<ANY>, link: raywarp_core::traversal::bvh2::Child) {
        if link.is_leaf() {
            let (first, count) = (link.index() as usize, link.count() as usize);
            tree.triangles()[first..first + count].iter().for_each(|triangle| self.test(triangle));
            return;
        }
        self.counts.nodes += 1;
        let mut children = boxes.children(link.index(), self.ray.t_min, self.best.t);
        children.sort_by(|a, b| a.first.total_cmp(&b.first));
        for child in children.iter().filter(|child| child.first <= child.last) {
            self.hierarchy(tree, boxes, raywarp_core::traversal::bvh2::Child::of_bits(child.link));
        }
    }

    /// Below a node of a k-d tree, in whose cell the ray is from `first` to `last`.
    fn cells(&mut self, tree: &KdTree, index: u32, first: f32, last: f32) {
        self.counts.nodes += 1;
        let node = tree.nodes()[index as usize];
        if node.is_leaf() {
            let run = node.first() as usize..(node.first() + node.count()) as usize;
            tree.references()[run].iter().for_each(|&reference| self.test(&tree.triangles()[reference as usize]));
            return;
        }
        let (origin, slope) = (self.ray.origin[node.axis()], 1.0 / self.ray.direction[node.axis()]);
        let t = (node.plane() - origin) * slope;
        let (near, far) = match slope > 0.0 {
            true => (node.below(), node.below() + 1),
            false => (node.below() + 1, node.below()),
        };
        if earlier(t) > last {
            self.cells(tree, near, first, last);
        } else if later(t) < first {
            self.cells(tree, far, first, last);
        } else {
            self.cells(tree, near, first, last.min(later(t)));
            let begin = first.max(earlier(t));
            if begin <= later(self.best.t) {
                self.cells(tree, far, begin, last);
            }
        }
    }
}

/// Distances to planes are right to eight units in the last place.
fn earlier(t: f32) -> f32 {
    t.abs().mul_add(-8.0 / 16_777_216.0, t)
}

fn later(t: f32) -> f32 {
    t.abs().mul_add(8.0 / 16_777_216.0, t)
}

fn rays(triangles: &[Triangle]) -> Vec<Ray> {
    let scene = raywarp::scene::load::builtin().unwrap().scene;
    let source = RaySource::new(triangles, &scene.cameras[0], [48, 27]).unwrap();
    let mut rays = source.primary().rays;
    rays.extend(source.workload(RayKind::Random, &[], 1000).rays);
    rays
}

#[test]
fn hierarchies_are_counted_exactly() {
    let triangles = raywarp::query::opaque_triangles(&raywarp::scene::load::builtin().unwrap().scene).unwrap();
    let rays = rays(&triangles);
    for quality in Quality::ALL {
        let build = Build { kind: AccelKind::Bvh2, quality, cached: false };
        let accel = Accel::build(build, triangles.clone()).unwrap();
        let Accel::Bvh2(tree) = &accel else { panic!("a bvh2 was asked for") };
        // SAFETY: the tree outlives the view.
        let view = unsafe { tree.view().get() };
        for (ray, counted) in rays.iter().zip(tests(&accel, &rays, false, usize::MAX)) {
            let mut reference = Reference::new(ray);
            reference.hierarchy(tree, &Full::new(&view, ray), raywarp_core::traversal::bvh2::Child::node(0));
            assert_eq!([counted.nodes, counted.triangles], [reference.counts.nodes, reference.counts.triangles]);
        }
    }
}

#[test]
fn k_d_trees_are_counted_exactly() {
    let triangles = raywarp::query::opaque_triangles(&raywarp::scene::load::builtin().unwrap().scene).unwrap();
    let rays = rays(&triangles);
    let accel = Accel::build(AccelKind::Kd, triangles.clone()).unwrap();
    let Accel::Kd(tree) = &accel else { panic!("a k-d tree was asked for") };
    for (ray, counted) in rays.iter().zip(tests(&accel, &rays, false, usize::MAX)) {
        let mut reference = Reference::new(ray);
        if let Some((first, last)) = within(tree, ray) {
            reference.cells(tree, 0, first, last);
        }
        assert_eq!([counted.nodes, counted.triangles], [reference.counts.nodes, reference.counts.triangles]);
    }
}

/// The piece of a ray within the bounds of a tree.
fn within(tree: &KdTree, ray: &Ray) -> Option<(f32, f32)> {
    let [low, high] = tree.bounds();
    let (mut first, mut last) = (ray.t_min, ray.t_max);
    for axis in 0..3 {
        let inverse = 1.0 / ray.direction[axis];
        let (a, b) = ((low[axis] - ray.origin[axis]) * inverse, (high[axis] - ray.origin[axis]) * inverse);
        (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
    }
    (earlier(first) <= later(last)).then_some((earlier(first), later(last)))
}
