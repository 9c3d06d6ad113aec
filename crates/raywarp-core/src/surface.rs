//! From a hit to the point on the surface and what it is made of.

use crate::arch;
use crate::background::Background;
use crate::light::Light;
use crate::material::{flags, Material};
use crate::math::{vec3, Vec3};
use crate::ray::{Hit, Ray, MISS};
use crate::texture::{mode, Textures, NO_TEXTURE};
use crate::traversal::Space;
use crate::view::View;

/// A triangle of the scene, as shading reads it.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Primitive {
    /// Indices into the vertex arrays.
    pub vertices: [u32; 3],
    /// Index into the materials.
    pub material: u32,
}

/// A mesh in a place, as shading reads it.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Mesh to world: each row is a row of the matrix, then the shift. Of no meaning [in world space](IN_WORLD).
    pub rows: [[f32; 4]; 3],
    /// Where the mesh's triangles begin among all primitives.
    pub first_primitive: u32,
    /// Material of all its triangles; [`MISS`] for their own.
    pub material: u32,
    /// Bits [`IN_WORLD`] and [`MIRRORED`].
    pub flags: u32,
    /// Makes 64 bytes.
    pub unused: u32,
}

impl Instance {
    /// Of vertices that are in world space already.
    pub const IN_PLACE: Self = Self {
        rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
        first_primitive: 0,
        material: MISS,
        flags: IN_WORLD,
        unused: 0,
    };
}

/// Bit of [`Instance::flags`]: its vertices are in world space already.
pub const IN_WORLD: u32 = 1;

/// Bit of [`Instance::flags`]: the transform turns left into right, so the vertices run clockwise where the outside is seen.
pub const MIRRORED: u32 = 2;

/// A scene, as shading reads it. Vertices are in world space or in that of their mesh, as their instance says.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// All placed meshes.
    pub instances: View<Instance>,
    /// All triangles, mesh by mesh.
    pub primitives: View<Primitive>,
    /// A position a vertex.
    pub positions: View<Vec3>,
    /// A shading normal a vertex; zero means flat.
    pub normals: View<Vec3>,
    /// Texture coordinates a vertex, or none at all; behind those of all vertices the second ones, where there are any.
    pub uvs: View<[f32; 2]>,
    /// Where the second ones begin; 0 where there are none.
    pub second_uvs: u32,
    /// Linear RGBA a vertex, or none at all.
    pub colors: View<[f32; 4]>,
    /// Tangent and handedness a vertex (zero: derived from the texture coordinates), or none at all.
    pub tangents: View<[f32; 4]>,
    /// Surfaces.
    pub materials: View<Material>,
    /// Images.
    pub textures: Textures,
    /// Light sources.
    pub lights: View<Light>,
    /// Beyond the scene.
    pub background: Background,
    /// Light that arrives everywhere.
    pub ambient: Vec3,
}

/// A point on a surface, seen from a side.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// World position.
    pub point: Vec3,
    /// Unit normal of the triangle, on the side that is seen.
    pub geometric: Vec3,
    /// Unit shading normal, on the same side.
    pub normal: Vec3,
    /// Whether the outside is seen, from which the vertices run counter-clockwise.
    pub outside: bool,
    /// How far a ray must start off the surface, along `geometric`, not to meet it by rounding.
    pub offset: f32,
    /// Texture coordinates of the first set.
    pub uv: [f32; 2],
    /// Colour that multiplies the diffuse reflectance.
    pub tint: Vec3,
    /// Coverage, from 0 to 1.
    pub coverage: f32,
}

impl Surface {
    /// Where a ray that leaves the surface starts: on the side that is seen for `side` = 1, on the other for -1.
    #[inline(always)]
    pub fn start(&self, side: f32) -> Vec3 {
        self.geometric.mul_add(side * self.offset, self.point)
    }
}

/// A point of a triangle, as a light.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// World position.
    pub point: Vec3,
    /// Unit normal on the side from which the vertices run counter-clockwise.
    pub outward: Vec3,
    /// Of the triangle.
    pub area: f32,
    /// As of [`Surface`].
    pub offset: f32,
}

/// Corners of a triangle and weights to mix them.
struct Corners {
    vertices: [u32; 3],
    weights: [f32; 3],
    /// -1 where the instance turns left into right, else 1.
    handedness: f32,
    /// Of an instance that is not in world space.
    transform: Option<Transform>,
}

impl Corners {
    #[inline(always)]
    fn mix([a, b, c]: [Vec3; 3], weights: [f32; 3]) -> Vec3 {
        a.mul_add(weights[0], b.mul_add(weights[1], c * weights[2]))
    }

    #[inline(always)]
    fn mix_array<const N: usize>(&self, array: &View<[f32; N]>, first: u32) -> [f32; N] {
        let [a, b, c] = self.vertices.map(|vertex| array.at(first + vertex));
        core::array::from_fn(|i| {
            arch::fma(a[i], self.weights[0], arch::fma(b[i], self.weights[1], c[i] * self.weights[2]))
        })
    }
}

/// The way from a mesh to the world.
#[derive(Clone, Copy)]
struct Transform {
    rows: [Vec3; 3],
    shift: Vec3,
}

impl Transform {
    #[inline(always)]
    fn of(instance: &Instance) -> Self {
        let [x, y, z] = instance.rows;
        let row = |[a, b, c, _]: [f32; 4]| vec3(a, b, c);
        Self { rows: [row(x), row(y), row(z)], shift: vec3(x[3], y[3], z[3]) }
    }

    #[inline(always)]
    fn point(&self, p: Vec3) -> Vec3 {
        self.vector(p) + self.shift
    }

    #[inline(always)]
    fn vector(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.rows;
        vec3(x.dot(v), y.dot(v), z.dot(v))
    }

    /// By the cofactors: the inverse transpose up to a factor, which is negative where this turns left into right.
    #[inline(always)]
    fn normal(&self, n: Vec3) -> Vec3 {
        let [x, y, z] = self.rows;
        vec3(y.cross(z).dot(n), z.cross(x).dot(n), x.cross(y).dot(n)).normalize()
    }
}

/// The rounding error of an interpolated point is a few units of 2^-24 of the largest coordinate of the triangle; this
/// many keep a ray that leaves the point off the triangle.
const OFFSET: f32 = 32.0 / 16_777_216.0;

/// A normal of a triangle of any length, on the side that is outside: from there the vertices of its mesh run counter-clockwise.
#[inline(always)]
fn outward([p0, p1, p2]: [Vec3; 3], corners: &Corners) -> Vec3 {
    (p1 - p0).cross(p2 - p0) * corners.handedness
}

/// What keeps a ray off a triangle.
#[inline(always)]
fn offset(positions: &[Vec3; 3]) -> f32 {
    let [p0, p1, p2] = positions.map(Vec3::max_abs);
    OFFSET * arch::max(p0, arch::max(p1, p2))
}

/// Whether a ray meets the side that a normal is on.
#[inline(always)]
fn faces(normal: Vec3, ray: &Ray) -> bool {
    normal.dot(ray.direction) <= 0.0
}

impl Scene {
    /// The material of what was hit.
    #[inline(always)]
    pub fn material<S: Space>(&self, hit: &Hit) -> &Material {
        self.materials.item(self.material_index::<S>(hit))
    }

    /// Its index.
    #[inline(always)]
    pub fn material_index<S: Space>(&self, hit: &Hit) -> u32 {
        let instance = self.instances.item(hit.instance);
        if S::OF_MESH && instance.material != MISS {
            return instance.material;
        }
        self.primitives.load(instance.first_primitive + hit.primitive).material
    }

    /// What light that is not followed any further is taken for: the ambient light, or the background where that is
    /// brighter. Black would show as speckles in glass.
    #[inline(always)]
    pub fn surroundings(&self, direction: Vec3) -> Vec3 {
        self.ambient.max(self.background.radiance(direction))
    }

    /// What a ray that enters a triangle's surface is inside of: one more than the index of its material. Materials beyond
    /// the first 2^24 do not absorb.
    #[inline(always)]
    pub fn medium<S: Space>(&self, hit: &Hit) -> u32 {
        let medium = self.material_index::<S>(hit) + 1;
        if medium < 1 << 24 {
            medium
        } else {
            0
        }
    }

    /// The material of a medium, which is not 0.
    #[inline(always)]
    pub fn material_of_medium(&self, medium: u32) -> &Material {
        self.materials.item(medium - 1)
    }

    #[inline(always)]
    fn corners<S: Space>(&self, hit: &Hit) -> Corners {
        let instance = self.instances.item(hit.instance);
        let placed = S::OF_MESH && instance.flags & IN_WORLD == 0;
        Corners {
            vertices: self.primitives.load(instance.first_primitive + hit.primitive).vertices,
            weights: [1.0 - hit.u - hit.v, hit.u, hit.v],
            handedness: if instance.flags & MIRRORED != 0 { -1.0 } else { 1.0 },
            transform: if placed { Some(Transform::of(instance)) } else { None },
        }
    }

    /// In world space.
    #[inline(always)]
    fn positions(&self, corners: &Corners) -> [Vec3; 3] {
        let positions = corners.vertices.map(|vertex| self.positions.at(vertex));
        match &corners.transform {
            Some(transform) => positions.map(|p| transform.point(p)),
            None => positions,
        }
    }

    /// In world space, of a corner; zero where it has none.
    #[inline(always)]
    fn normal(&self, corners: &Corners, corner: usize) -> Vec3 {
        let normal = self.normals.at(corners.vertices[corner]);
        match &corners.transform {
            Some(transform) if !normal.is_zero() => transform.normal(normal) * corners.handedness,
            _ => normal,
        }
    }

    /// The point that a ray hit.
    #[inline(always)]
    pub fn surface<S: Space>(&self, ray: &Ray, hit: &Hit, material: &Material) -> Surface {
        let corners = self.corners::<S>(hit);
        let positions = self.positions(&corners);
        let outward = outward(positions, &corners).normalize();
        let outside = faces(outward, ray);
        let side = if outside { 1.0 } else { -1.0 };
        let (uv, tint, coverage) = self.attributes(&corners, material);
        let mut normal = self.shading_normal(&corners, outward);
        if material.normal_map != NO_TEXTURE {
            normal = self.perturb_normal(&corners, normal, material);
        }
        let offset = offset(&positions);
        Surface {
            point: Corners::mix(positions, corners.weights),
            geometric: outward * side,
            normal: normal * side,
            outside,
            offset,
            uv,
            tint,
            coverage,
        }
    }

    /// The point of a hit, as that of a light.
    #[inline(always)]
    pub fn spot<S: Space>(&self, hit: &Hit) -> Spot {
        let corners = self.corners::<S>(hit);
        let positions = self.positions(&corners);
        let outward = outward(positions, &corners);
        Spot {
            point: Corners::mix(positions, corners.weights),
            outward: outward.normalize(),
            area: 0.5 * outward.length(),
            offset: offset(&positions),
        }
    }

    /// What a texture says at a hit; white without one.
    #[inline(always)]
    pub fn map<S: Space>(&self, hit: &Hit, texture: u32) -> Vec3 {
        if texture == NO_TEXTURE {
            return Vec3::ONE;
        }
        let [u, v] = self.coordinates::<S>(hit, texture);
        self.textures.sample(texture, u, v).color
    }

    /// Texture coordinates, colour and coverage at a hit.
    #[inline(always)]
    fn attributes(&self, corners: &Corners, material: &Material) -> ([f32; 2], Vec3, f32) {
        let uv = self.mixed_uv(corners, 0);
        let (mut tint, mut coverage) = (Vec3::ONE, material.opacity);
        if !self.colors.is_empty() {
            let [r, g, b, a] = corners.mix_array(&self.colors, 0);
            (tint, coverage) = (vec3(r, g, b), coverage * a);
        }
        if material.diffuse_map != NO_TEXTURE {
            let [u, v] = self.laid_out(corners, material.diffuse_map);
            let texel = self.textures.sample(material.diffuse_map, u, v);
            (tint, coverage) = (tint * texel.color, coverage * texel.alpha);
        }
        if material.opacity_map != NO_TEXTURE {
            let [u, v] = self.laid_out(corners, material.opacity_map);
            coverage *= self.textures.sample(material.opacity_map, u, v).color.x;
        }
        let coverage = if material.flags & flags::MASK != 0 {
            if coverage >= material.cutoff {
                1.0
            } else {
                0.0
            }
        } else if material.flags & flags::BLEND != 0 {
            crate::math::clamp(coverage, 0.0, 1.0)
        } else {
            1.0
        };
        (uv, tint, coverage)
    }

    /// Texture coordinates, of vertices from a place on.
    #[inline(always)]
    fn mixed_uv(&self, corners: &Corners, first: u32) -> [f32; 2] {
        match self.uvs.is_empty() {
            true => [0.0; 2],
            false => corners.mix_array(&self.uvs, first),
        }
    }

    /// Where the texture coordinates begin by which a texture is laid out.
    #[inline(always)]
    fn uv_set(&self, map: u32) -> u32 {
        match self.textures.list.item(map).mode & mode::SECOND_UVS != 0 {
            true => self.second_uvs,
            false => 0,
        }
    }

    /// Texture coordinates by which a texture is laid out.
    #[inline(always)]
    fn laid_out(&self, corners: &Corners, map: u32) -> [f32; 2] {
        self.mixed_uv(corners, self.uv_set(map))
    }

    /// The same at a hit.
    #[inline(always)]
    pub fn coordinates<S: Space>(&self, hit: &Hit, map: u32) -> [f32; 2] {
        self.laid_out(&self.corners::<S>(hit), map)
    }

    /// Whether a ray meets a triangle from inside.
    #[inline(always)]
    pub fn is_inside<S: Space>(&self, ray: &Ray, hit: &Hit) -> bool {
        let corners = self.corners::<S>(hit);
        !faces(outward(self.positions(&corners), &corners), ray)
    }

    /// What tints the diffuse reflectance at a hit.
    #[inline(always)]
    pub fn tint<S: Space>(&self, hit: &Hit, material: &Material) -> Vec3 {
        self.attributes(&self.corners::<S>(hit), material).1
    }

    /// Coverage at a hit: 0 for a hole.
    #[inline]
    pub fn coverage<S: Space>(&self, hit: &Hit, material: &Material) -> f32 {
        if material.flags & (flags::MASK | flags::BLEND) == 0 {
            return 1.0;
        }
        self.attributes(&self.corners::<S>(hit), material).2
    }

    #[inline(always)]
    fn shading_normal(&self, corners: &Corners, outward: Vec3) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for corner in 0..3 {
            let normal = self.normal(corners, corner);
            let normal = if normal.is_zero() { outward } else { normal };
            sum = normal.mul_add(corners.weights[corner], sum);
        }
        let normal = sum.normalize();
        // A file may hold normals that point inwards: the winding decides which side is out.
        if normal.is_zero() {
            outward
        } else if normal.dot(outward) < 0.0 {
            -normal
        } else {
            normal
        }
    }

    /// The shading normal after the normal map.
    #[inline(always)]
    fn perturb_normal(&self, corners: &Corners, normal: Vec3, material: &Material) -> Vec3 {
        let set = self.uv_set(material.normal_map);
        let [u, v] = self.mixed_uv(corners, set);
        let Some((tangent, bitangent)) = self.frame(corners, normal, set) else { return normal };
        let (x, y, z) = if material.flags & flags::HEIGHT != 0 {
            let (right, up) = self.textures.slope(material.normal_map, u, v);
            (-right, -up, 1.0)
        } else {
            let painted = self.textures.sample(material.normal_map, u, v).color.mul_add(2.0, Vec3::splat(-1.0));
            (painted.x, painted.y, painted.z)
        };
        let (x, y) = self.textures.list.item(material.normal_map).to_mesh(x, y);
        let (x, y) = (x * material.bump, y * material.bump);
        let bent = tangent.mul_add(x, bitangent.mul_add(y, normal * z)).normalize();
        if bent.is_zero() {
            normal
        } else {
            bent
        }
    }

    /// Unit vectors along which u and v grow, at right angles to the normal; none where the mesh does not say.
    #[inline(always)]
    fn frame(&self, corners: &Corners, normal: Vec3, set: u32) -> Option<(Vec3, Vec3)> {
        let (mut tangent, mut handedness) = (Vec3::ZERO, 1.0);
        if !self.tangents.is_empty() {
            let [x, y, z, w] = corners.mix_array(&self.tangents, 0);
            (tangent, handedness) = (vec3(x, y, z), w);
            if let Some(transform) = &corners.transform {
                (tangent, handedness) = (transform.vector(tangent), w * corners.handedness);
            }
        }
        if tangent.is_zero() {
            (tangent, handedness) = self.derived_tangent(corners, set)?;
        }
        let tangent = normal.mul_add(-normal.dot(tangent), tangent).normalize();
        let sign = if handedness < 0.0 { -1.0 } else { 1.0 };
        (!tangent.is_zero()).then(|| (tangent, normal.cross(tangent) * sign))
    }

    /// The direction in which u grows over the triangle, and whether (u, v) is mirrored on it.
    #[inline(always)]
    fn derived_tangent(&self, corners: &Corners, set: u32) -> Option<(Vec3, f32)> {
        if self.uvs.is_empty() {
            return None;
        }
        let [p0, p1, p2] = self.positions(corners);
        let [t0, t1, t2] = corners.vertices.map(|vertex| self.uvs.at(set + vertex));
        let (du1, dv1, du2, dv2) = (t1[0] - t0[0], t1[1] - t0[1], t2[0] - t0[0], t2[1] - t0[1]);
        let area = arch::fma(du1, dv2, -(du2 * dv1));
        let tangent = ((p1 - p0) * dv2 - (p2 - p0) * dv1) * if area < 0.0 { -1.0 } else { 1.0 };
        (area != 0.0).then_some((tangent, area * corners.handedness))
    }
}
