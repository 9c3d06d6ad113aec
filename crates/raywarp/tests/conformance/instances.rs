//! Meshes in many places: two levels on the device against the CPU, and against the same scene in world space.

use raywarp::accel::{AccelKind, Quality};
use raywarp::device::Device;
use raywarp::query::{two_level, RayCaster};
use raywarp::scene::{Instance, Scene, Transform};
use raywarp::{Hit, Ray, Triangle, Vec3};

use super::{device, reference, scaled, scene, Random};

/// The built-in mesh `count` times: turned, sheared, mirrored, of many sizes, some of them in the same place.
fn copies(count: usize) -> Scene {
    let mut scene = scene("built-in");
    let mut random = Random(17);
    let place = |i: usize| {
        let size = [0.2, 0.5, 1.0, 4.0][i % 4];
        let columns = [(); 3].map(|()| (random.vector() * size).to_array());
        let translation = if i % 10 == 9 { [0.0; 3] } else { (random.vector() * 20.0).to_array() };
        Instance { name: format!("copy {i}"), mesh: 0, transform: Transform { columns, translation }, material: None }
    };
    scene.instances = (0..count).map(place).collect();
    scene
}

fn put(transform: &Transform, p: [f32; 3]) -> Vec3 {
    let [x, y, z] = transform.columns.map(Vec3::from);
    x * p[0] + y * p[1] + z * p[2] + transform.translation.into()
}

/// In world space.
fn flattened(scene: &Scene) -> Vec<Triangle> {
    let corners = |instance: &Instance| {
        let (mesh, transform) = (&scene.meshes[instance.mesh], instance.transform);
        mesh.triangles.iter().map(move |t| t.map(|vertex| put(&transform, mesh.positions[vertex as usize])))
    };
    let all = scene.instances.iter().flat_map(corners).zip(0..);
    all.map(|([a, b, c], primitive)| Triangle::new(a, b, c, primitive, 0)).collect()
}

/// At triangles from afar; if `odd`, also from surfaces, where rounding decides, and such as mean nothing.
fn rays(triangles: &[Triangle], count: usize, odd: bool) -> Vec<Ray> {
    let mut random = Random(23);
    let ray = |i: usize| {
        let t = triangles[random.bits() as usize % triangles.len()];
        let middle = (t.v0 + t.v1 + t.v2) * (1.0 / 3.0);
        if odd && i.is_multiple_of(4) {
            return Ray::new(t.v0, random.vector());
        }
        let origin = middle + random.vector() * 30.0;
        let mut ray = Ray::new(origin, middle - origin);
        match i % 32 {
            1 => ray.direction = Vec3::new(0.0, -1.0, 0.0),
            2 => ray.t_max = 0.9,
            3 => ray.t_min = 1.1,
            _ if !odd => {}
            5 => ray.origin.y = f32::NAN,
            6 => ray.direction = Vec3::ZERO,
            7 => ray.direction.x = f32::INFINITY,
            _ => {}
        }
        ray
    };
    (0..count).map(ray).collect()
}

fn bits(hit: &Hit) -> [u32; 4] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive]
}

#[test]
fn two_machines_give_the_same_bits() {
    let scene = copies(500);
    let rays = rays(&flattened(&scene), scaled(1_000_000), true);
    let tree = two_level(&scene, Quality::default()).unwrap();
    assert_eq!(tree.validate(), Ok(()));
    assert!(tree.stats().instances > 490, "{:?}", tree.stats());
    let answers = |device: &Device| {
        let caster = RayCaster::from_instanced(&tree, device).unwrap();
        (caster.hits(&rays).unwrap(), caster.any(&rays).unwrap())
    };
    let [(a, shadows), (b, others)] = [answers(&reference()), answers(&device())];
    assert!(a.iter().filter(|hit| !hit.is_miss()).count() * 2 > rays.len());
    let differing = a.iter().zip(&b).filter(|(a, b)| bits(a) != bits(b)).count();
    println!("{} rays: {differing} hits differ", rays.len());
    assert_eq!(differing, 0, "of {} hits", rays.len());
    assert_eq!(shadows, others);
    // A shadow is where there is a hit.
    assert!(a.iter().zip(&shadows).all(|(hit, &shadow)| shadow != hit.is_miss()));
}

/// Where the two find different triangles, rounding decides: they are as good as equally far, or one was only grazed.
#[test]
fn world_space_gives_the_same_numbers() {
    let scene = copies(100);
    let triangles = flattened(&scene);
    let rays = rays(&triangles, scaled(400_000), false);
    let flat = RayCaster::new(triangles, AccelKind::Bvh, &device()).unwrap().hits(&rays).unwrap();
    let tree = two_level(&scene, Quality::default()).unwrap();
    let two = RayCaster::from_instanced(&tree, &device()).unwrap().hits(&rays).unwrap();
    let same = flat.iter().zip(&two).filter(|(a, b)| a.primitive == b.primitive);
    let (count, worst) = same.fold((0, 0.0f32), |(count, worst), (a, b)| {
        (count + 1, if a.is_miss() { worst } else { worst.max((a.t - b.t).abs() / a.t.max(1.0)) })
    });
    println!("{count} of {} rays find the same triangle, t differs by {worst:e} at most", rays.len());
    assert!(count * 1000 >= rays.len() * 995, "{count} of {}", rays.len());
}
