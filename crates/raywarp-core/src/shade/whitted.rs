//! The paper's shading: Phong's illumination and normals, shadows, and Whitted's mirrors and glass.
//!
//! Where the paper calls itself for each mirrored and refracted ray, [`trace`] keeps the branches in a small stack and
//! adds up the same contributions.

use super::optics::{fresnel, reflect, refract, schlick};
use crate::arch;
use crate::light::Illumination;
use crate::material::{flags, Material};
use crate::math::{clamp, mix, power, Vec3};
use crate::ray::{Hit, Ray};
use crate::stack::{Stack, Storage};
use crate::surface::{Scene, Surface};
use crate::texture::NO_TEXTURE;
use crate::traversal::{closest, occlusion, Counter, Occlusion, Space, Structure, START};

/// Most bounces that can be asked for.
pub const MAX_DEPTH: u32 = 16;

/// Rays that can wait. Mirrored and refracted rays alone need one more than [`MAX_DEPTH`]; a dozen layers of partly
/// covered mirrors of glass in front of each other may need more, and a branch beyond the last place is lost.
const BRANCHES: usize = 24;

/// Below this weight what lies behind layers of partial coverage is not followed: a quarter of an 8-bit step.
const FAINT: f32 = 1.0 / 1024.0;

/// What shading may do.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bounces after the camera ray, at most [`MAX_DEPTH`].
    pub depth: u32,
    /// 0: every light reaches everything.
    pub shadows: u32,
}

/// A ray yet to be followed.
#[derive(Clone, Copy)]
struct Branch {
    ray: Ray,
    /// What its radiance counts.
    weight: Vec3,
    /// Bounces so far in the low eight bits; above them the index of the material that the ray is inside of, plus one.
    state: u32,
}

/// Bits of the bounces in the state of a branch.
const DEPTH_BITS: u32 = 8;

impl Branch {
    #[inline(always)]
    fn depth(&self) -> u32 {
        self.state & ((1 << DEPTH_BITS) - 1)
    }

    /// One more than the index of the material that the ray is inside of; 0 for none that absorbs.
    #[inline(always)]
    fn medium(&self) -> u32 {
        self.state >> DEPTH_BITS
    }

    /// The state after another bounce, inside of some medium.
    #[inline(always)]
    fn next(&self, medium: u32) -> u32 {
        (self.depth() + 1) | medium << DEPTH_BITS
    }
}

/// One picture's worth of shading: where to trace, what is there, what is allowed.
struct Tracer<'a, S, C> {
    structure: &'a S,
    scene: &'a Scene,
    limits: &'a Limits,
    counter: &'a mut C,
}

/// Radiance along a camera ray, and whether it hit anything.
#[inline(always)]
pub fn trace<S: Structure, C: Counter>(
    structure: &S,
    scene: &Scene,
    limits: &Limits,
    ray: &Ray,
    counter: &mut C,
) -> (Vec3, bool) {
    let mut tracer = Tracer { structure, scene, limits, counter };
    let mut storage = Storage::new();
    let mut waiting = Stack::new(&mut storage);
    let mut branch = Branch { ray: *ray, weight: Vec3::ONE, state: 0 };
    tracer.counter.branch();
    let (mut radiance, mut previous, mut any) = (Vec3::ZERO, START, false);
    loop {
        let hit = closest(structure, &branch.ray, &previous, tracer.counter);
        if branch.medium() != 0 {
            // From the last surface on, behind which the ray goes straight on, or from its origin.
            let length = hit.t - arch::max(previous.t, 0.0);
            branch.weight = branch.weight * scene.material_of_medium(branch.medium()).transmittance(length);
        }
        if hit.is_miss() {
            radiance += branch.weight * scene.background.radiance(branch.ray.direction);
        } else {
            let material = scene.material::<S::Space>(&hit);
            let surface = scene.surface::<S::Space>(&branch.ray, &hit, material);
            // As `visible` asks; not by it, for then the surface would be found out twice.
            if surface.coverage <= 0.0 || (material.flags & flags::SINGLE_SIDED != 0 && !surface.outside) {
                previous = hit;
                continue;
            }
            any = true;
            let weight = branch.weight * surface.coverage;
            radiance += weight * tracer.local(&branch.ray, &hit, &surface, material);
            if branch.depth() < limits.depth {
                scatter::<S::Space>(scene, &branch, &hit, weight, &surface, material, &mut waiting);
            } else if !material.transmission.is_zero() {
                radiance += weight * material.transmission * scene.surroundings(branch.ray.direction);
            }
            // Go on straight behind a surface that covers only part.
            branch.weight = branch.weight * (1.0 - surface.coverage);
            previous = hit;
            if branch.weight.max_abs() > FAINT {
                continue;
            }
        }
        match waiting.pop() {
            Some(next) => (branch, previous) = (next, START),
            None => return (radiance, any),
        }
        tracer.counter.branch();
    }
}

impl<S: Structure, C: Counter> Tracer<'_, S, C> {
    /// What the surface itself sends towards the viewer: Phong's sum over the lights, and its own light.
    #[inline(always)]
    fn local(&mut self, ray: &Ray, hit: &Hit, surface: &Surface, material: &Material) -> Vec3 {
        let diffuse = material.diffuse * surface.tint;
        if material.flags & flags::UNLIT != 0 {
            return diffuse;
        }
        let map = |index: u32| {
            if index == NO_TEXTURE {
                return Vec3::ONE;
            }
            let [u, v] = self.scene.coordinates::<S::Space>(hit, index);
            self.scene.textures.sample(index, u, v).color
        };
        let mut specular = material.specular * map(material.specular_map);
        if material.flags & flags::METALLIC != 0 {
            specular = specular * surface.tint;
        }
        let mut sum = material.emission * map(material.emission_map);
        sum += material.ambient * surface.tint * self.scene.ambient;
        for index in 0..self.scene.lights.len() {
            let light = self.scene.lights.at(index).at(surface.point);
            let cosine = light.towards.dot(surface.normal);
            if light.color.is_zero() || cosine <= 0.0 || light.towards.dot(surface.geometric) <= 0.0 {
                continue;
            }
            let mirrored = reflect(ray.direction, surface.normal);
            let highlight = power(clamp(mirrored.dot(light.towards), 0.0, 1.0), material.shininess);
            let answer = diffuse.mul_add(cosine, specular * highlight);
            if !answer.is_zero() {
                self.counter.light(index);
                sum += answer * light.color * self.transmittance(surface, &light);
            }
        }
        sum
    }

    /// The share of a light that reaches the surface: all, none, or what surfaces in between let through.
    #[inline(always)]
    fn transmittance(&mut self, surface: &Surface, light: &Illumination) -> Vec3 {
        if self.limits.shadows == 0 {
            return Vec3::ONE;
        }
        // The start is off the surface by `offset`: twice that before the light, a lamp in a ceiling is not behind it.
        let t_max = light.distance - 2.0 * surface.offset;
        let ray = Ray { origin: surface.start(1.0), t_min: 0.0, direction: light.towards, t_max };
        match occlusion(self.structure, &ray, self.counter) {
            Occlusion::Clear => Vec3::ONE,
            Occlusion::Blocked => Vec3::ZERO,
            Occlusion::Filtered => self.filter(&ray),
        }
    }

    /// What a shadow ray that meets nothing opaque brings through, surface by surface.
    #[cold]
    #[cfg_attr(target_arch = "nvptx64", inline(never))]
    #[cfg_attr(not(target_arch = "nvptx64"), inline(always))]
    fn filter(&mut self, ray: &Ray) -> Vec3 {
        let (mut share, mut previous, mut entered) = (Vec3::ONE, START, 0.0);
        while share.max_abs() > FAINT {
            previous = closest(self.structure, ray, &previous, self.counter);
            if previous.is_miss() {
                return share;
            }
            let material = self.scene.material::<S::Space>(&previous);
            let coverage = self.scene.coverage::<S::Space>(&previous, material);
            share = share * mix(Vec3::ONE, material.transmission, coverage);
            if material.flags & flags::VOLUME != 0 {
                if self.scene.is_inside::<S::Space>(ray, &previous) {
                    share = share * material.transmittance(previous.t - entered);
                } else {
                    entered = previous.t;
                }
            }
        }
        Vec3::ZERO
    }
}

/// The first hit after `previous` that covers anything and shows the side that it is met from.
///
/// Shadow rays do not ask for the side: what is culled still casts its shadow, as it does where glTF is drawn with shadow
/// maps and in Blender after an import; leaves of a single side would else lose theirs half of the time.
#[inline(always)]
pub fn visible<S: Structure>(
    structure: &S,
    scene: &Scene,
    ray: &Ray,
    previous: &Hit,
    counter: &mut impl Counter,
) -> Hit {
    let mut hit = *previous;
    loop {
        hit = closest(structure, ray, &hit, counter);
        if hit.is_miss() {
            return hit;
        }
        let material = scene.material::<S::Space>(&hit);
        if material.flags & flags::SINGLE_SIDED != 0 && scene.is_inside::<S::Space>(ray, &hit) {
            continue;
        }
        if material.flags & (flags::MASK | flags::BLEND) == 0 || scene.coverage::<S::Space>(&hit, material) > 0.0 {
            return hit;
        }
    }
}

/// Puts the mirrored and the refracted ray aside, each with its share of `weight`.
#[inline(always)]
fn scatter<S: Space>(
    scene: &Scene,
    branch: &Branch,
    hit: &Hit,
    weight: Vec3,
    surface: &Surface,
    material: &Material,
    waiting: &mut Stack<'_, Branch, BRANCHES>,
) {
    let transparent = !material.transmission.is_zero();
    if material.reflection.is_zero() && !transparent {
        return;
    }
    // Made again where it counts: nothing is kept alive while lights are asked for.
    let tint = if material.flags & flags::METALLIC != 0 { scene.tint::<S>(hit, material) } else { Vec3::ONE };
    let reflection = material.reflection * tint;
    let direction = branch.ray.direction;
    let eta = if surface.outside { 1.0 / material.ior } else { material.ior };
    let (normal, refracted) = if transparent { refraction(direction, surface, eta) } else { (surface.normal, None) };
    let cosine = -direction.dot(normal);
    let share = if transparent && refracted.is_none() {
        1.0
    } else if material.flags & flags::FRESNEL == 0 {
        0.0
    } else if transparent && material.ior != 1.0 {
        fresnel(cosine, eta)
    } else {
        schlick(cosine)
    };
    let mut wait = |direction: Vec3, side: f32, weight: Vec3, medium: u32| {
        if !weight.is_zero() {
            let ray = Ray::new(surface.start(side), direction.normalize());
            waiting.push(Branch { ray, weight, state: branch.next(medium) });
        }
    };
    if let Some(refracted) = refracted {
        let medium = match (material.flags & flags::VOLUME != 0, surface.outside) {
            (true, true) => scene.medium::<S>(hit),
            (true, false) => 0,
            (false, _) => branch.medium(),
        };
        wait(refracted, -1.0, weight * material.transmission * (1.0 - share), medium);
    }
    let mirrored = if transparent && material.flags & flags::FRESNEL != 0 && material.ior != 1.0 {
        // Glass: what Fresnel's equations do not let through, tinted by `reflection` if that has a colour.
        let tint = if material.reflection.is_zero() { Vec3::ONE } else { reflection };
        tint * share
    } else {
        mix(reflection, Vec3::ONE, share)
    };
    wait(mirror(direction, surface), 1.0, weight * mirrored, branch.medium());
}

/// The refracted direction and the normal that bends it: the shading normal, or the flat one where the shading normal
/// would send the ray to the wrong side of the triangle or reflect it totally, although the triangle itself would not.
#[inline(always)]
fn refraction(direction: Vec3, surface: &Surface, eta: f32) -> (Vec3, Option<Vec3>) {
    match refract(direction, surface.normal, eta) {
        Some(bent) if bent.dot(surface.geometric) < 0.0 => (surface.normal, Some(bent)),
        _ => (surface.geometric, refract(direction, surface.geometric, eta)),
    }
}

/// The mirror direction; about the flat normal where the shading normal would send it into the surface.
#[inline(always)]
fn mirror(direction: Vec3, surface: &Surface) -> Vec3 {
    let mirrored = reflect(direction, surface.normal);
    if mirrored.dot(surface.geometric) > 0.0 {
        mirrored
    } else {
        reflect(direction, surface.geometric)
    }
}
