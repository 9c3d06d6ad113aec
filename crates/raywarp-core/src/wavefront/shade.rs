//! The stage after hits: what each path meets, which light may reach it there, and where it goes on.

use super::add_light::Direct;
use super::{has_ended, Numbers, Path, ENDED};
use crate::arch;
use crate::bsdf::{flags, Bsdf, Frame as Axes, Inside, PointMaterial, Sample};
use crate::kernels::{Frame, Thread};
use crate::lights::{Incidence, World};
use crate::math::Vec3;
use crate::ray::{Hit, MeshHit, Ray};
use crate::sample::unit;
use crate::shade::optics::reflect;
use crate::surface::Surface;
use crate::traversal::MeshSpace;
use crate::view::{View, ViewMut};

/// Bounces after which paths that bring little are ended by chance.
const ROULETTE: u32 = 4;

/// Most that such a path goes on: every path ends.
const LONGEST: f32 = 0.95;

/// Takes each path one bounce further.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Shade {
    /// What is there.
    pub world: World,
    /// Which pixels, and which sample.
    pub frame: Frame,
    /// Bounces so far.
    pub depth: u32,
    /// Bounces after which paths end; light that is met then still counts.
    pub last: u32,
    /// 0: infinitely small lights reach everything.
    pub shadows: u32,
    /// How light is found: bits of [`strategy`].
    pub strategies: u32,
    /// Hits of the rays, one a slot.
    pub hits: View<MeshHit>,
    /// Their instances.
    pub instances: View<u32>,
    /// One a slot, read and written.
    pub rays: ViewMut<Ray>,
    /// One a slot, read and written.
    pub paths: ViewMut<Path>,
    /// One a slot, written: to a light.
    pub shadow_rays: ViewMut<Ray>,
    /// One a slot, written: what such a ray brings.
    pub direct: ViewMut<Direct>,
}

/// Ways to find light. All but infinitely small lights and what smooth surfaces show is found by both, each with its weight;
/// by one alone the mean is the same.
pub mod strategy {
    /// Looking for it.
    pub const LIGHTS: u32 = 1;
    /// Meeting it by chance.
    pub const CHANCE: u32 = 2;
    /// Both.
    pub const BOTH: u32 = LIGHTS | CHANCE;
}

/// Where a path goes on.
struct Step {
    ray: Ray,
    shadow_ray: Ray,
    direct: Vec3,
}

impl Step {
    /// Nowhere.
    const END: Self = Self { ray: ENDED, shadow_ray: ENDED, direct: Vec3::ZERO };
}

/// A surface that a path met, seen along its ray.
struct Vertex {
    surface: Surface,
    axes: Axes,
    bsdf: Bsdf,
    material: u32,
}

impl Shade {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let slot = thread.x;
        // SAFETY: one thread a slot.
        let (Some(ray), Some(mut path)) = (unsafe { (self.rays.get(slot), self.paths.get(slot)) }) else { return };
        let step = if has_ended(&ray) {
            Step::END
        } else {
            let hit = self.hits.load(slot).of_instance(self.instances.at(slot));
            let step = self.step(slot, &ray, &hit, &mut path);
            // SAFETY: one thread a slot.
            unsafe {
                self.paths.set(slot, path);
                self.rays.set(slot, step.ray);
            }
            step
        };
        // SAFETY: one thread a slot.
        unsafe {
            self.shadow_rays.set(slot, step.shadow_ray);
            self.direct.set(slot, Direct { radiance: step.direct, unused: 0 });
        }
    }

    #[inline(always)]
    fn step(&self, slot: u32, ray: &Ray, hit: &Hit, path: &mut Path) -> Step {
        let world = &self.world;
        if path.medium() != 0 {
            let inside = world.scene.material_of_medium(path.medium());
            path.throughput = path.throughput * inside.transmittance(hit.t);
        }
        if hit.is_miss() {
            let radiance = world.environment.radiance(ray.direction);
            let share = self.share_of_chance(path.density, || world.density_of_environment(ray.direction));
            path.radiance += path.throughput * radiance * share;
            return Step::END;
        }
        if self.depth == 0 {
            path.state |= Path::MET;
        }
        let index = world.scene.material_index::<MeshSpace>(hit);
        let (material, point) = (world.scene.materials.item(index), world.materials.item(index));
        if point.flags & flags::EMISSIVE != 0 {
            let outside = !world.scene.is_inside::<MeshSpace>(ray, hit);
            let share = self.share_of_chance(path.density, || world.density_of_triangle(hit, ray.direction));
            path.radiance += path.throughput * world.emission(hit, outside) * share;
        }
        if self.depth >= self.last && point.flags & flags::UNLIT == 0 {
            return Step::END;
        }
        let surface = world.scene.surface::<MeshSpace>(ray, hit, material);
        if point.flags & flags::UNLIT != 0 {
            path.radiance += path.throughput * material.diffuse * surface.tint;
            return Step::END;
        }
        let Some(pixel) = self.frame.pixel_of_slot(slot) else { return Step::END };
        let numbers = Numbers::at(&self.frame.sampler(pixel), self.depth);
        let vertex = self.vertex(ray, hit, surface, index);
        let (shadow_ray, direct) = self.look_for_light(&vertex, path, &numbers).unwrap_or((ENDED, Vec3::ZERO));
        let ray = self.go_on(&vertex, path, &numbers).unwrap_or(ENDED);
        Step { ray, shadow_ray, direct }
    }

    #[inline(always)]
    fn vertex(&self, ray: &Ray, hit: &Hit, surface: Surface, index: u32) -> Vertex {
        let view = -ray.direction;
        let axes = Axes::about(seen_normal(surface.normal, surface.geometric, view));
        let local = axes.to_local(view);
        // Rounding alone brings it below the surface.
        let local = Vec3 { z: arch::max(local.z, 1e-4), ..local };
        let record = self.world.materials.item(index);
        let encloses = record.flags & flags::VOLUME != 0;
        let eta = if surface.outside { 1.0 / record.ior } else { record.ior };
        let inside = if encloses { Some(Inside { eta }) } else { None };
        let bsdf = Bsdf::new(local, self.point_material(hit, index, surface.tint), inside);
        Vertex { surface, axes, bsdf, material: index }
    }

    /// A material with its textures at a hit.
    #[inline(always)]
    fn point_material(&self, hit: &Hit, index: u32, tint: Vec3) -> PointMaterial {
        let material = self.world.materials.item(index);
        let map = |texture: u32| self.world.scene.map::<MeshSpace>(hit, texture).x;
        PointMaterial {
            base_color: material.base_color * tint,
            metallic: material.metallic * map(material.metallic_map),
            reflectance: material.reflectance,
            roughness: material.roughness * map(material.roughness_map),
            grazing: material.grazing,
            transmission: material.transmission * map(material.transmission_map),
        }
    }

    /// The ray to a light, and what it brings; weighed against meeting that light by chance.
    #[inline(always)]
    fn look_for_light(&self, vertex: &Vertex, path: &Path, numbers: &Numbers) -> Option<(Ray, Vec3)> {
        let Vertex { surface, axes, bsdf, .. } = vertex;
        if !bsdf.has_density() || self.strategies & strategy::LIGHTS == 0 {
            return None;
        }
        let start = surface.start(1.0);
        let incidence = self.world.sample_light(surface, start, numbers.light, numbers.place)?;
        let light = axes.to_local(incidence.towards);
        let side = surface.geometric.dot(incidence.towards);
        if incidence.radiance.is_zero() || incidence.density <= 0.0 || !same_side(side, light.z) {
            return None;
        }
        let scattered = bsdf.eval(light);
        let share = self.share_of_looking(&incidence, scattered.density);
        let weight = scattered.value * (share / incidence.density);
        let direct = path.throughput * weight * incidence.radiance;
        if direct.is_zero() {
            return None;
        }
        if incidence.delta && self.shadows == 0 {
            return Some((ENDED, direct));
        }
        // Behind the surface the ray starts there; the difference to the direction is that of rounding.
        let origin = if side < 0.0 { surface.start(-1.0) } else { start };
        Some((Ray { origin, t_min: 0.0, direction: incidence.towards, t_max: incidence.t_max }, direct))
    }

    /// The share of what was met by chance with one density, where looking for it may have another. What cannot be looked for
    /// counts in full.
    #[inline(always)]
    fn share_of_chance(&self, density: f32, looked_for: impl FnOnce() -> f32) -> f32 {
        match self.strategies {
            _ if density == f32::INFINITY => 1.0,
            strategy::LIGHTS => (looked_for() == 0.0) as u32 as f32,
            strategy::CHANCE => 1.0,
            _ => power(density, looked_for()),
        }
    }

    #[inline(always)]
    fn share_of_looking(&self, incidence: &Incidence, by_chance: f32) -> f32 {
        if incidence.delta || self.strategies == strategy::LIGHTS {
            1.0
        } else {
            power(incidence.density, by_chance)
        }
    }

    /// The ray on which the path goes on.
    #[inline(always)]
    fn go_on(&self, vertex: &Vertex, path: &mut Path, numbers: &Numbers) -> Option<Ray> {
        let Vertex { surface, axes, bsdf, material } = vertex;
        let Sample { light, weight, density } = bsdf.sample(numbers.direction.point(), unit(numbers.lobe.x))?;
        let direction = axes.to_world(light).normalize();
        let side = surface.geometric.dot(direction);
        if !same_side(side, light.z) {
            return None;
        }
        path.throughput = path.throughput * weight;
        path.density = density;
        let largest = path.throughput.max_abs();
        if self.depth >= ROULETTE {
            let survives = arch::min(largest, LONGEST);
            if unit(numbers.lobe.y) >= survives {
                return None;
            }
            path.throughput = path.throughput / survives;
        }
        let usable = largest > 0.0 && largest < f32::INFINITY;
        if light.z < 0.0 && self.world.materials.item(*material).flags & flags::VOLUME != 0 {
            path.enter(if surface.outside { *material + 1 } else { 0 });
        }
        usable.then(|| Ray::new(surface.start(if side < 0.0 { -1.0 } else { 1.0 }), direction))
    }
}

/// Whether a direction is on the same side of the triangle and of the shading normal: else light would leak.
#[inline(always)]
fn same_side(geometric: f32, shading: f32) -> bool {
    geometric * shading > 0.0
}

/// The power heuristic (Veach 1997): the share of what was found with one density, where the other way has another.
#[inline(always)]
fn power(own: f32, other: f32) -> f32 {
    let ratio = other / own;
    1.0 / arch::fma(ratio, ratio, 1.0)
}

/// The shading normal, bent so that the mirrored view stays above the triangle (Keller et al. 2017, "The Iray light
/// transport simulation and rendering system", appendix A.3): else a normal map would show black.
#[inline(always)]
fn seen_normal(normal: Vec3, geometric: Vec3, view: Vec3) -> Vec3 {
    let mirrored = reflect(-view, normal);
    let (height, least) = (mirrored.dot(geometric), arch::min(0.5 * view.dot(geometric), 0.01));
    if height >= least {
        return normal;
    }
    let lifted = geometric.mul_add(least - height, mirrored).normalize();
    let bent = (view + lifted).normalize();
    if bent.dot(geometric) > 0.0 {
        bent
    } else {
        geometric
    }
}
