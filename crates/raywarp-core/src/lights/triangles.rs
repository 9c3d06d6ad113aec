//! Triangles that glow, as lights: chosen by their power, and by chance evenly over their area.

use super::{Incidence, World};
use crate::kernels::Thread;
use crate::material::flags;
use crate::math::Vec3;
use crate::ray::{Hit, MISS};
use crate::sampling::warp;
use crate::surface::{Scene, Surface};
use crate::traversal::MeshSpace;
use crate::view::{View, ViewMut};

/// Which triangles glow.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EmissiveTriangles {
    /// Instance and primitive of each, all primitives of an instance in a row.
    pub triangles: View<[u32; 2]>,
    /// Of each instance, where its primitives begin in that list; [`MISS`] where none of them glows.
    pub first: View<u32>,
}

impl World {
    /// A point of a triangle as it is seen from a surface; none where it shows its dark side.
    #[inline(always)]
    pub(super) fn sample_triangle(
        &self,
        index: u32,
        surface: &Surface,
        start: Vec3,
        at: [f32; 2],
    ) -> Option<Incidence> {
        let [instance, primitive] = self.triangles.triangles.at(index);
        let [u, v] = warp::triangle(at);
        let hit = Hit { t: 0.0, u, v, primitive, instance };
        let spot = self.scene.spot::<MeshSpace>(&hit);
        let offset = spot.point - start;
        let (distance, towards) = (offset.length(), offset.normalize());
        let cosine = towards.dot(spot.outward);
        let radiance = self.emission(&hit, cosine < 0.0);
        let density = distance * distance / (spot.area * cosine.abs());
        let reaches = density > 0.0 && density < f32::INFINITY;
        // Short of the triangle by the rounding of both ends.
        let t_max = distance - 2.0 * (surface.offset + spot.offset);
        reaches.then_some(Incidence { towards, t_max, radiance, density, delta: false })
    }

    /// Probability per solid angle with which [`sample_light`](Self::sample_light) finds a hit of a ray of unit direction.
    #[inline(always)]
    pub fn density_of_triangle(&self, hit: &Hit, direction: Vec3) -> f32 {
        let first = self.triangles.first.at(hit.instance);
        if first == MISS {
            return 0.0;
        }
        let spot = self.scene.spot::<MeshSpace>(hit);
        let cosine = direction.dot(spot.outward).abs();
        let index = self.scene.lights.len() + 1 + first + hit.primitive;
        let density = self.choice.density(index) * hit.t * hit.t / (spot.area * cosine);
        if density < f32::INFINITY {
            density
        } else {
            0.0
        }
    }

    /// Radiance of the surface's own at a hit, on the side that is outside or on the other.
    #[inline(always)]
    pub fn emission(&self, hit: &Hit, outside: bool) -> Vec3 {
        let index = self.scene.material_index::<MeshSpace>(hit);
        let material = self.scene.materials.item(index);
        if material.emission.is_zero() || (material.flags & flags::SINGLE_SIDED != 0 && !outside) {
            return Vec3::ZERO;
        }
        material.emission * self.scene.map::<MeshSpace>(hit, material.emission_map)
    }
}

/// Finds the power of each triangle that may glow, for the table by which they are chosen.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EmitterPowers {
    /// What is there.
    pub scene: Scene,
    /// The triangles.
    pub triangles: View<[u32; 2]>,
    /// Of each material, what a unit of its area counts.
    pub weights: View<f32>,
    /// One a triangle, written.
    pub powers: ViewMut<f32>,
}

impl EmitterPowers {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.triangles.len() {
            return;
        }
        let [instance, primitive] = self.triangles.at(thread.x);
        let hit = Hit { t: 0.0, u: 0.0, v: 0.0, primitive, instance };
        let weight = self.weights.at(self.scene.material_index::<MeshSpace>(&hit));
        let area = self.scene.spot::<MeshSpace>(&hit).area;
        let power = weight * area;
        let usable = power > 0.0 && power < f32::INFINITY;
        // SAFETY: one thread a triangle.
        unsafe { self.powers.set(thread.x, if usable { power } else { 0.0 }) };
    }
}
