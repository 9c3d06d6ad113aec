//! Every triangle, for every ray: the paper's first version, and the oracle of all others.

use super::{Counter, MeshStructure, Structure, Visitor, WorldSpace};
use crate::ray::Ray;
use crate::triangle::{RayShear, Triangle};
use crate::view::View;

/// All triangles in a row.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Brute {
    /// In the order of the scene.
    pub triangles: View<Triangle>,
}

impl Structure for Brute {
    const NAME: &'static str = "brute";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        let shear = RayShear::new(ray);
        for index in 0..self.triangles.len() {
            counter.triangle();
            if visitor.visit(&shear, &self.triangles.load(index)) < ray.t_min {
                return;
            }
        }
    }
}

impl MeshStructure for Brute {
    /// First triangle, and how many.
    type Part = [u32; 2];

    #[inline(always)]
    fn part(&self, &[first, len]: &[u32; 2]) -> Self {
        Self { triangles: self.triangles.part(first, len) }
    }
}
