//! What lights a scene, for path tracing: which source to look at, where on it, and how probable that was.

mod environment;
mod triangles;

pub use environment::Environment;
pub use triangles::{EmissiveTriangles, EmitterPowers};

use crate::bsdf::MetallicRoughness;
use crate::math::Vec3;
use crate::sampling::{AliasTable, Pair};
use crate::surface::{Scene, Surface};
use crate::view::View;

/// A scene with what path tracing needs beside it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct World {
    /// What is there. Its background and its ambient light are not looked at.
    pub scene: Scene,
    /// One a material of the scene.
    pub materials: View<MetallicRoughness>,
    /// Whatever sends out light, in this order: the lights of the scene, the environment, the triangles.
    pub choice: AliasTable,
    /// Beyond the scene.
    pub environment: Environment,
    /// Triangles that glow.
    pub triangles: EmissiveTriangles,
}

/// A direction in which light may arrive at a point.
#[derive(Clone, Copy, Debug)]
pub struct Incidence {
    /// Unit vector to the light.
    pub towards: Vec3,
    /// Where a ray that looks for obstacles ends.
    pub t_max: f32,
    /// Radiance; of an infinitely small light, what the scattering function times the cosine is multiplied by.
    pub radiance: Vec3,
    /// Probability per solid angle, the choice of the light included; of an infinitely small light that of the choice.
    pub density: f32,
    /// Whether the light is infinitely small, so that no ray meets it by chance.
    pub delta: bool,
}

impl World {
    /// Light from one of all sources, by chance; none where it is on the other side of itself. `start` is where the ray will
    /// start off the surface.
    #[inline(always)]
    pub fn sample_light(&self, surface: &Surface, start: Vec3, which: Pair, place: Pair) -> Option<Incidence> {
        let (index, _) = self.choice.sample(which);
        let probability = self.choice.density(index);
        let lights = self.scene.lights.len();
        let incidence = if index < lights {
            self.delta_light(index, surface, start)
        } else if index == lights {
            self.environment.sample(place)
        } else {
            self.sample_triangle(index - lights - 1, surface, start, place.point())?
        };
        Some(Incidence { density: incidence.density * probability, ..incidence })
    }

    /// An infinitely small light. Its colour is the radiance that a white, matt surface sends back: `1 / pi` of what arrives.
    #[inline(always)]
    fn delta_light(&self, index: u32, surface: &Surface, start: Vec3) -> Incidence {
        let light = self.scene.lights.at(index).at(start);
        Incidence {
            towards: light.towards,
            t_max: light.distance - surface.offset,
            radiance: light.color * core::f32::consts::PI,
            density: 1.0,
            delta: true,
        }
    }

    /// Probability per solid angle with which [`sample_light`](Self::sample_light) looks towards the environment in a
    /// direction.
    #[inline(always)]
    pub fn density_of_environment(&self, direction: Vec3) -> f32 {
        self.choice.density(self.scene.lights.len()) * self.environment.density(direction)
    }
}
