//! Two levels find what brute force finds: bit for bit along the rays that the instances see, and but for the rounding of
//! a transform along those of the world.

use crate::common::{ray, scene, Numbers, AIMS, FAMILIES};
use proptest::prelude::*;
use raywarp::accel::two_level::{build, Placement, TwoLevel};
use raywarp::accel::{Accel, AccelKind, BuildError, Quality};
use raywarp::scene::Transform;
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::ray::{Hit, Ray};
use raywarp_core::traversal::bvh2::Child;
use raywarp_core::traversal::two_level::{Instance, BAKED};
use raywarp_core::traversal::{
    closest, occlusion, Counter, MeshSpace, NullStatistics, Occlusion, Structure, Visitor, START,
};
use raywarp_core::triangle::{flags, Triangle};

// Transforms.

type Columns = [[f32; 3]; 3];

fn turn(n: &mut Numbers) -> Columns {
    let x = n.point().normalize();
    let y = x.cross(n.point()).normalize();
    [x, y, x.cross(y)].map(Vec3::to_array)
}

fn times(a: Columns, b: Columns) -> Columns {
    b.map(|column| [0, 1, 2].map(|i| (0..3).map(|k| a[k][i] * column[k]).sum()))
}

fn scales(s: [f32; 3]) -> Columns {
    [[s[0], 0.0, 0.0], [0.0, s[1], 0.0], [0.0, 0.0, s[2]]]
}

/// Kinds of [`transform`].
const TRANSFORMS: usize = 11;

/// Nothing, a shift, a turn, a mirror, unequal scales, a shear, tiny, huge, a mixture, flat, or nearly flat.
fn transform(kind: usize, n: &mut Numbers) -> Transform {
    let mut unequal = || [0; 3].map(|_| n.pick(&[0.01, 0.3, 1.0, -2.0, 7.0]));
    let stretched = scales(unequal());
    let columns = match kind {
        0 | 1 => scales([1.0; 3]),
        2 => turn(n),
        3 => times(turn(n), scales([1.0, 1.0, -1.0])),
        4 => times(turn(n), stretched),
        5 => [[1.0, 0.0, 0.0], [n.signed() * 3.0, 1.0, 0.0], [n.signed(), n.signed() * 5.0, 1.0]],
        6 => times(turn(n), scales([1e-6; 3])),
        7 => times(turn(n), scales([1e6; 3])),
        8 => times(times(turn(n), stretched), turn(n)),
        9 => times(turn(n), scales([1.0, n.pick(&[0.0, 1e-30]), 1.0])),
        _ => times(turn(n), scales([1.0, 1e-9, 1.0])),
    };
    let far = n.pick(&[0.0, 1.0, 100.0, 1e5]);
    let translation = if kind == 0 { [0.0; 3] } else { (n.point() * far).to_array() };
    Transform { columns, translation }
}

fn put(transform: &Transform, p: Vec3) -> Vec3 {
    let [x, y, z] = transform.columns.map(Vec3::from);
    x * p.x + y * p.y + z * p.z + transform.translation.into()
}

/// The scene without instances.
fn flattened(meshes: &[Vec<Triangle>], placements: &[Placement]) -> Vec<Triangle> {
    let place = |p: &Placement| {
        let p = *p;
        meshes[p.mesh].iter().map(move |t| {
            let [a, b, c] = [t.v0, t.v1, t.v2].map(|v| put(&p.transform, v));
            let flags = p.flags.unwrap_or(t.flags);
            Triangle { instance: p.instance, ..Triangle::new(a, b, c, t.primitive, flags) }
        })
    };
    raywarp::accel::drop_degenerate(placements.iter().flat_map(place).collect()).0
}

/// One instance after the other.
fn place(list: &[(usize, Transform)]) -> Vec<Placement> {
    let place = |(&(mesh, transform), instance)| Placement { mesh, transform, instance, flags: None };
    list.iter().zip(0..).map(place).collect()
}

// The oracle: every triangle of every instance, along the ray that the instance sees.

struct Seen {
    instance: Instance,
    triangles: Vec<Triangle>,
}

#[derive(Clone, Copy)]
struct Everything<'a>(&'a [Seen]);

impl Everything<'_> {
    fn of(tree: &TwoLevel) -> Vec<Seen> {
        let seen = |&instance: &Instance| {
            let mut triangles = Vec::new();
            below(tree, instance.root, &mut triangles);
            Seen { instance, triangles }
        };
        tree.instances().iter().map(seen).collect()
    }
}

fn below(tree: &TwoLevel, child: Child, found: &mut Vec<Triangle>) {
    if child.is_leaf() {
        let first = child.index() as usize;
        return found.extend(&tree.triangles()[first..first + child.count() as usize]);
    }
    tree.nodes()[child.index() as usize].children.iter().for_each(|&child| below(tree, child, found));
}

impl Structure for Everything<'_> {
    const NAME: &'static str = "everything";
    type Space = MeshSpace;

    fn traverse(&self, ray: &Ray, _: &mut impl Counter, visitor: &mut impl Visitor) {
        for Seen { instance, triangles } in self.0 {
            let within = instance.bring(ray);
            for t in triangles {
                let flags = (t.flags & instance.keep) | (instance.flags & !BAKED);
                let own = if instance.flags & BAKED != 0 { t.instance } else { instance.index };
                let shear = raywarp_core::triangle::RayShear::new(&within);
                if visitor.visit(&shear, &Triangle { flags, instance: own, ..*t }) < ray.t_min {
                    return;
                }
            }
        }
    }
}

fn bits(hit: Hit) -> [u32; 5] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive, hit.instance]
}

fn agree(tree: &TwoLevel, everything: &[Seen], ray: &Ray) -> Result<(), String> {
    let everything = Everything(everything);
    let mut previous = START;
    for _ in 0..4 {
        let truth = closest(&everything, ray, &previous, &mut NullStatistics);
        let found = tree.closest(ray, &previous, &mut NullStatistics);
        if bits(found) != bits(truth) {
            return Err(format!("{found:?}, not {truth:?}, along {ray:?}"));
        }
        previous = truth;
        if truth.is_miss() {
            break;
        }
    }
    let truth = occlusion(&everything, ray, &mut NullStatistics);
    match tree.occlusion(ray, &mut NullStatistics) {
        found if found != truth => Err(format!("{found:?}, not {truth:?}, along {ray:?}")),
        _ => Ok(()),
    }
}

/// Whether too little is left of a direction in some instance: see the module on traversal.
fn underflows(everything: &[Seen], ray: &Ray) -> bool {
    let small = |direction: Vec3| direction.max_abs() < 1e-30 && !direction.is_zero();
    everything.iter().any(|seen| small(seen.instance.bring(ray).direction))
}

/// A few meshes in many places.
fn check(family: usize, kinds: &[usize], count: usize, rays: usize, seed: u64) -> Result<(), String> {
    let mut n = Numbers(seed);
    let meshes: Vec<_> = (0..3).map(|i| scene((family + i) % FAMILIES, count >> i, &mut n)).collect();
    let list: Vec<_> = kinds.iter().map(|&kind| (n.below(3), transform(kind, &mut n))).collect();
    let mut placements = place(&list);
    for placement in &mut placements {
        placement.flags = n.pick(&[None, None, Some(0), Some(flags::TRANSPARENT)]);
    }
    let world = flattened(&meshes, &placements);
    let tree = build(meshes, &placements, Quality::default()).map_err(|e| e.to_string())?;
    tree.validate().map_err(|flaw| flaw.to_string())?;
    if world.is_empty() {
        return Ok(());
    }
    let everything = Everything::of(&tree);
    let rays = (0..AIMS * rays).map(|i| ray(i % AIMS, &world, &mut n));
    rays.filter(|ray| !underflows(&everything, ray)).try_for_each(|ray| agree(&tree, &everything, &ray))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn two_levels_find_what_everything_finds(
        family in 0..FAMILIES,
        kinds in prop::collection::vec(0..TRANSFORMS, 0..12),
        count in 1usize..120,
        seed: u64,
    ) {
        check(family, &kinds, count, 6, seed).map_err(TestCaseError::fail)?;
    }
}

#[test]
fn small_scenes_agree() {
    for kind in 0..TRANSFORMS {
        for family in 0..FAMILIES {
            for seed in 0..6 {
                check(family, &[kind; 3], 10 + seed as usize, 4, seed << 16 | (kind * FAMILIES + family) as u64)
                    .unwrap();
            }
        }
    }
}

/// From there a ray of the world and the one that an instance sees are apart by more than the mesh is large.
#[test]
fn rays_from_afar_are_not_lost() {
    let (mut hits, mesh) = (0, sphere(6));
    for seed in 0..200 {
        let mut n = Numbers(seed);
        let list: Vec<_> = (0..5).map(|i| (0, transform([2, 4, 5, 8][i % 4], &mut n))).collect();
        let placements = place(&list);
        let world = flattened(std::slice::from_ref(&mesh), &placements);
        let tree = build(vec![mesh.clone()], &placements, Quality::default()).unwrap();
        let everything = Everything::of(&tree);
        for _ in 0..200 {
            let target = n.pick(&world).v0;
            let origin = target + n.point() * n.pick(&[1e4, 1e5, 1e6, 1e7]);
            let ray = Ray::new(origin, target - origin);
            agree(&tree, &everything, &ray).unwrap();
            hits += !tree.closest(&ray, &START, &mut NullStatistics).is_miss() as u32;
        }
    }
    assert!(hits > 10_000, "{hits}");
}

// Closed meshes.

/// A sphere of rings, dented, whose seams share exact corners.
fn sphere(rings: u32) -> Vec<Triangle> {
    let columns = 2 * rings;
    let corner = |row: u32, column: u32| {
        let column = if row == 0 || row == rings { 0 } else { column % columns };
        let theta = std::f32::consts::PI * row as f32 / rings as f32;
        let phi = std::f32::consts::TAU * column as f32 / columns as f32;
        let dent = 1.0 + 0.05 * Numbers(u64::from(row * columns + column)).signed();
        vec3(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()) * dent
    };
    let mut triangles = Vec::new();
    for (row, column) in (0..rings).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let [a, b] = [corner(row, column), corner(row, column + 1)];
        let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
        for [p, q, r] in [[a, b, c], [b, d, c]] {
            if p != q && q != r && r != p {
                triangles.push(Triangle::new(p, q, r, triangles.len() as u32, 0));
            }
        }
    }
    triangles
}

#[test]
fn no_ray_escapes_from_a_placed_mesh() {
    let mesh = sphere(24);
    for kind in 1..9 {
        for seed in 0..4 {
            let mut n = Numbers(seed << 8 | kind as u64);
            let mut here = transform(kind, &mut n);
            if kind == 6 {
                // Nearer than where a step of the coordinates is larger than the mesh.
                here.translation = here.translation.map(|x| x * 1e-7);
            }
            let there = Transform { translation: [3e7, 0.0, 0.0], ..here };
            let meshes = vec![mesh.clone()];
            let placements = place(&[(0, here), (0, there)]);
            let tree = build(meshes, &placements, Quality::default()).unwrap();
            for i in 0..5000 {
                let t = n.pick(&mesh);
                let (a, b) = (t.v0, [t.v1, t.v2][i % 2]);
                let share = if i % 3 == 0 { 0.0 } else { n.unit() };
                let origin = put(&here, n.point() * 0.3);
                let ray = Ray::new(origin, put(&here, a + (b - a) * share) - origin);
                let hit = tree.closest(&ray, &START, &mut NullStatistics);
                assert!(!hit.is_miss(), "{here:?}: {ray:?}");
                assert_eq!(tree.occlusion(&ray, &mut NullStatistics), Occlusion::Blocked);
            }
        }
    }
}

// Against the scene in world space.

/// Rays at the middles of triangles: what both see of them differs by rounding alone.
fn against_flattened(list: &[(usize, Transform)], rays: usize, seed: u64) {
    let meshes = vec![sphere(12), sphere(9)];
    let placements = place(list);
    let world = flattened(&meshes, &placements);
    let flat = Accel::build(AccelKind::Bvh, world.clone()).unwrap();
    let tree = build(meshes, &placements, Quality::default()).unwrap();
    tree.validate().unwrap();
    let (mut n, mut others) = (Numbers(seed), 0);
    for _ in 0..rays {
        let t = n.pick(&world);
        let middle = (t.v0 + t.v1 + t.v2) * (1.0 / 3.0);
        let origin = middle + n.point() * (t.extent() * n.pick(&[2.0, 5.0, 50.0]));
        let ray = Ray::new(origin, middle - origin);
        let [a, b] = [flat.closest(&ray, &START, &mut NullStatistics), tree.closest(&ray, &START, &mut NullStatistics)];
        // A rounding of what the coordinates are, some thirty times, over the slope at which a triangle is met.
        let size = origin.max_abs().max(middle.max_abs()).max(t.extent());
        let bound = |hit: &Hit| {
            let id = (hit.instance, hit.primitive);
            let t = world.iter().find(|t| (t.instance, t.primitive) == id).unwrap();
            let slope = (t.v1 - t.v0).cross(t.v2 - t.v0).normalize().dot(ray.direction).abs();
            32.0 / 16_777_216.0 * 8.0 * size / slope
        };
        assert!(!a.is_miss() && !b.is_miss(), "{a:?} {b:?} {ray:?}");
        if (a.instance, a.primitive) == (b.instance, b.primitive) {
            assert!((a.t - b.t).abs() <= bound(&a), "{a:?} {b:?} {ray:?} {}", bound(&a));
        } else {
            // Through an edge between the two, or past an edge of what is in front.
            others += 1;
        }
    }
    assert!(others * 200 <= rays, "{others} of {rays}");
}

#[test]
fn numbers_and_distances_are_those_of_the_flattened_scene() {
    for kind in [0, 1, 2, 3, 4, 5, 8, 9] {
        for seed in 0..4 {
            let mut n = Numbers(seed << 8 | kind as u64);
            let list: Vec<_> = (0..6)
                .map(|i| {
                    let place = transform(kind, &mut n);
                    // Side by side, near enough to the origin that rounding says nothing about what is hit.
                    (i % 2, Transform { translation: [8.0 * i as f32, 0.0, 0.0], ..place })
                })
                .collect();
            against_flattened(&list, 500, seed);
        }
    }
}

#[test]
fn a_thousand_instances() {
    let mut n = Numbers(5);
    let list: Vec<_> = (0..1000)
        .map(|i| {
            let at = [i % 10, i / 10 % 10, i / 100].map(|k| k as f32 * 3.0);
            (i % 2, Transform { columns: turn(&mut n), translation: at })
        })
        .collect();
    against_flattened(&list, 2000, 1);
    let meshes = vec![sphere(12), sphere(9)];
    let tree = build(meshes.clone(), &place(&list), Quality::default()).unwrap();
    let stats = tree.stats();
    assert_eq!((stats.instances, stats.meshes, stats.baked), (1000, 2, 0));
    assert_eq!(stats.triangles, meshes[0].len() + meshes[1].len());
    assert_eq!(stats.seen, 500 * stats.triangles as u64);
    assert!(stats.upper_depth <= 20, "{stats:?}");
}

/// Each shows the same triangles to a ray: the first of the scene is the one that counts.
#[test]
fn of_instances_in_the_same_place_the_first_is_hit() {
    let meshes = vec![sphere(8)];
    let place_it = transform(4, &mut Numbers(3));
    let placements = place(&[(0, place_it); 100]);
    let world = flattened(&meshes, &placements[..1]);
    let tree = build(meshes, &placements, Quality::default()).unwrap();
    let mut n = Numbers(1);
    for i in 0..2000 {
        let ray = ray(i % 8, &world, &mut n);
        let hit = tree.closest(&ray, &START, &mut NullStatistics);
        assert!(
            hit.is_miss() || world.iter().any(|t| (t.instance, t.primitive) == (hit.instance, hit.primitive)),
            "{hit:?}"
        );
        // The same hit of every other instance comes after it.
        assert!(hit.is_miss() || tree.closest(&ray, &hit, &mut NullStatistics).t == hit.t, "{hit:?}");
    }
}

/// Baked, all of it: then there is no difference at all.
#[test]
fn flat_and_single_placements_are_those_of_the_flattened_scene_to_the_bit() {
    for seed in 0..20 {
        let mut n = Numbers(seed);
        let meshes = vec![sphere(8), sphere(5), sphere(3)];
        let flat = [(); 4].map(|()| (0, transform(9, &mut n)));
        let list = [&flat[..], &[(1, transform(4, &mut n)), (2, transform(3, &mut n))]].concat();
        let placements = place(&list);
        let world = flattened(&meshes, &placements);
        let accel = Accel::build(AccelKind::Bvh, world.clone()).unwrap();
        let tree = build(meshes, &placements, Quality::default()).unwrap();
        tree.validate().unwrap();
        assert_eq!((tree.stats().baked, tree.stats().instances), (6, 1));
        assert_eq!(tree.stats().seen, world.len() as u64);
        for i in 0..2000 {
            let ray = ray(i % AIMS, &world, &mut n);
            let [a, b] =
                [accel.closest(&ray, &START, &mut NullStatistics), tree.closest(&ray, &START, &mut NullStatistics)];
            assert_eq!(bits(a), bits(b), "{ray:?}");
        }
    }
}

#[test]
fn empty_meshes_are_left_out() {
    let nowhere = [Vec::new(), vec![Triangle::new(Vec3::ZERO, Vec3::ZERO, Vec3::ONE, 0, 0); 10]];
    let meshes = vec![nowhere[0].clone(), sphere(4), nowhere[1].clone()];
    let at = |x| Transform { translation: [x, 0.0, 0.0], ..Transform::IDENTITY };
    let list = [(0, at(0.0)), (1, at(0.0)), (0, at(5.0)), (2, at(1.0)), (2, at(2.0)), (1, at(10.0))];
    let placements = place(&list);
    let tree = build(meshes.clone(), &placements, Quality::default()).unwrap();
    assert_eq!(tree.validate(), Ok(()));
    assert_eq!((tree.stats().instances, tree.stats().meshes, tree.stats().dropped.without_area), (2, 1, 20));
    let down = Ray::new(vec3(10.1, 5.0, 0.1), vec3(0.0, -1.0, 0.0));
    let hit = tree.closest(&down, &START, &mut NullStatistics);
    assert_eq!(hit.instance, 5, "{hit:?}");

    for placements in [&[][..], &placements[..1], &placements[3..5]] {
        let tree = build(meshes.clone(), placements, Quality::default()).unwrap();
        assert_eq!(tree.validate(), Ok(()));
        assert_eq!(tree.stats().seen, 0);
        for direction in [Vec3::ONE, Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY)] {
            let ray = Ray::new(Vec3::splat(1e30), direction);
            assert!(tree.closest(&ray, &START, &mut NullStatistics).is_miss());
            assert_eq!(tree.occlusion(&ray, &mut NullStatistics), Occlusion::Clear);
        }
    }
}

#[test]
fn flags_of_a_placement_come_before_those_of_the_mesh() {
    let veil = sphere(4).into_iter().map(|t| Triangle { flags: flags::TRANSPARENT, ..t }).collect::<Vec<_>>();
    let meshes = vec![veil, sphere(4)];
    let at = |x| Transform { translation: [x, 0.0, 0.0], ..Transform::IDENTITY };
    let list = [0.0, 10.0, 20.0, 30.0].map(|x| ((x >= 20.0) as usize, at(x)));
    let mut placements = place(&list);
    placements[1].flags = Some(0);
    placements[3].flags = Some(flags::CUTOUT);
    let tree = build(meshes, &placements, Quality::default()).unwrap();
    let expected = [Occlusion::Filtered, Occlusion::Blocked, Occlusion::Blocked, Occlusion::Filtered];
    for (i, expected) in expected.into_iter().enumerate() {
        let ray = Ray::new(vec3(10.0 * i as f32 + 0.1, 5.0, 0.1), vec3(0.0, -1.0, 0.0));
        assert_eq!(tree.occlusion(&ray, &mut NullStatistics), expected, "{i}");
    }
}

#[test]
fn a_mesh_that_is_not_there_is_an_error() {
    let placement = Placement { mesh: 1, transform: Transform::IDENTITY, instance: 0, flags: None };
    let error = build(vec![sphere(4)], &[placement], Quality::default()).unwrap_err();
    assert_eq!(error, BuildError::NoSuchMesh { placement: 0, mesh: 1, count: 1 });
}
