//! Meshes in many places: two levels on the device against the CPU, and against the same scene in world space.

use std::sync::Arc;

use raywarp::accel::two_level::TwoLevel;
use raywarp::accel::{AccelKind, Quality};
use raywarp::device::Device;
use raywarp::device_scene::{two_level, Levels, SceneError, Structure};
use raywarp::query::RayCaster;
use raywarp::render::{framing, RenderOptions, Tracer};
use raywarp::scene::{Instance, Scene, Transform};
use raywarp::{DeviceScene, Hit, Ray, Triangle, Vec3};

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
    let triangles = |(instance, index): (&Instance, u32)| {
        let (mesh, transform) = (&scene.meshes[instance.mesh], instance.transform);
        mesh.triangles.iter().zip(0..).map(move |(corners, primitive)| {
            let [a, b, c] = corners.map(|vertex| put(&transform, mesh.positions[vertex as usize]));
            Triangle { instance: index, ..Triangle::new(a, b, c, primitive, 0) }
        })
    };
    scene.instances.iter().zip(0..).flat_map(triangles).collect()
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

fn caster_of(tree: &TwoLevel, device: &Device) -> RayCaster {
    RayCaster::of_structure(Structure::of_instances(tree, device).unwrap(), device)
}

fn tracer_of(scene: &Scene, levels: Levels, kind: AccelKind, device: &Device) -> Result<Tracer, SceneError> {
    let scene = DeviceScene::with_levels(scene, levels, kind, device)?;
    Ok(Tracer::of_scene(Arc::new(scene)).unwrap())
}

fn bits(hit: &Hit) -> [u32; 5] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive, hit.instance]
}

#[test]
fn two_machines_give_the_same_bits() {
    let scene = copies(500);
    let rays = rays(&flattened(&scene), scaled(1_000_000), true);
    let tree = two_level(&scene, Quality::default()).unwrap();
    assert_eq!(tree.validate(), Ok(()));
    assert!(tree.stats().instances > 490, "{:?}", tree.stats());
    let answers = |device: &Device| {
        let caster = caster_of(&tree, device);
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
    let two = caster_of(&tree, &device()).hits(&rays).unwrap();
    let same = flat.iter().zip(&two).filter(|(a, b)| (a.instance, a.primitive) == (b.instance, b.primitive));
    let (count, worst) = same.fold((0, 0.0f32), |(count, worst), (a, b)| {
        (count + 1, if a.is_miss() { worst } else { worst.max((a.t - b.t).abs() / a.t.max(1.0)) })
    });
    println!("{count} of {} rays find the same triangle, t differs by {worst:e} at most", rays.len());
    assert!(count * 1000 >= rays.len() * 995, "{count} of {}", rays.len());
}

fn picture(scene: &Scene, levels: Levels, kind: AccelKind, device: &Device) -> Vec<[f32; 4]> {
    let tracer = tracer_of(scene, levels, kind, device).unwrap();
    let options = RenderOptions { size: [160, 120], spp: 2, ..RenderOptions::default() };
    let camera = framing(tracer.report().bounds);
    let rendering = tracer.render(&camera, &options, &mut |_| ()).unwrap();
    let first_hits = tracer.layers(&camera, &options).unwrap();
    assert!(first_hits.iter().any(|hit| hit.instance > 5 && hit.instance < scene.instances.len() as u32));
    rendering.picture.pixels
}

/// Mirrors, glass and shadows of turned, sheared and mirrored copies, some of a material of their own.
#[test]
fn pictures_know_instances() {
    let mut scene = copies(60);
    let materials = scene.materials.len() as u32;
    scene.instances.iter_mut().step_by(7).zip(0..).for_each(|(copy, i)| copy.material = Some(i % materials));
    let on_cpu = picture(&scene, Levels::Two, AccelKind::Bvh, &reference());
    assert!(picture(&scene, Levels::Two, AccelKind::Bvh, &device()) == on_cpu);
    // Every structure, brute force too, brings a ray to an instance by the same rounding.
    for kind in [AccelKind::Brute, AccelKind::Kd] {
        assert!(picture(&scene, Levels::Two, kind, &reference()) == on_cpu, "{kind}");
    }
    let in_world = picture(&scene, Levels::One, AccelKind::Bvh, &reference());
    let differs = |(a, b): &(&[f32; 4], &[f32; 4])| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > 0.02);
    let differing = on_cpu.iter().zip(&in_world).filter(differs).count();
    // Mirrors and glass spread what rounding decides; the light as a whole is the same.
    let light = |pixels: &[[f32; 4]]| pixels.iter().flat_map(|p| &p[..3]).map(|&x| f64::from(x)).sum::<f64>();
    let ratio = light(&on_cpu) / light(&in_world);
    println!("{differing} of {} pixels differ where rounding decides, the light by {ratio}", in_world.len());
    assert!(differing * 20 < in_world.len(), "{differing} pixels");
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

#[test]
fn queries_find_the_same_in_every_structure_of_instances() {
    let scene = copies(200);
    let rays = rays(&flattened(&scene), scaled(40_000), true);
    let with = |kind, device: &Device| {
        let caster = RayCaster::of_scene(Arc::new(DeviceScene::geometry(&scene, Levels::Two, kind, device).unwrap()));
        (caster.hits(&rays).unwrap(), caster.count(&rays).unwrap())
    };
    let (hits, counts) = with(AccelKind::Bvh, &reference());
    for (kind, device) in [(AccelKind::Bvh, device()), (AccelKind::Brute, reference()), (AccelKind::Kd, reference())] {
        let (found, counted) = with(kind, &device);
        let differing = hits.iter().zip(&found).filter(|(a, b)| bits(a) != bits(b)).count();
        assert_eq!(differing, 0, "{kind}");
        assert!(counted == counts, "{kind}");
    }
}

#[test]
fn an_instance_that_moves_looks_as_if_it_had_been_there() {
    let original = copies(40);
    let mut moved = original.clone();
    for (i, copy) in moved.instances.iter_mut().enumerate().skip(1).step_by(3) {
        copy.transform.translation[i % 3] += 4.0;
        copy.transform.columns[i % 3] = copy.transform.columns[i % 3].map(|x| -1.5 * x);
    }
    for (kind, device) in [(AccelKind::Bvh, device()), (AccelKind::Brute, reference()), (AccelKind::Kd, reference())] {
        let mut tracer = tracer_of(&original, Levels::Two, kind, &device).unwrap();
        assert!(tracer.scene().structure().has_instances());
        let indices: Vec<usize> = (1..40).step_by(3).collect();
        assert!(tracer.scene_mut().unwrap().move_instances(&original, &moved.instances, &indices).unwrap());
        let fresh = tracer_of(&moved, Levels::Two, kind, &device).unwrap();
        let options = RenderOptions { size: [96, 64], ..RenderOptions::default() };
        let camera = framing(fresh.report().bounds);
        let [a, b] = [&tracer, &fresh].map(|t| t.render(&camera, &options, &mut |_| ()).unwrap().picture);
        assert!(a == b, "{kind}");
        // Rays find it there too, by the same structure.
        let caster = RayCaster::of_scene(Arc::clone(tracer.scene()));
        assert!(matches!(tracer.scene_mut(), Err(SceneError::Shared { holders: 2 })));
        let rays = rays(&flattened(&moved), 2000, false);
        assert_eq!(caster.hits(&rays).unwrap(), RayCaster::of_scene(Arc::clone(fresh.scene())).hits(&rays).unwrap());
        drop(caster);
        // What is flat cannot be undone: it has to be brought to world space.
        moved.instances[1].transform.columns[0] = [0.0; 3];
        assert!(!tracer.scene_mut().unwrap().move_instances(&original, &moved.instances, &[1]).unwrap());
        moved.instances[1].transform.columns[0] = original.instances[1].transform.columns[0].map(|x| -1.5 * x);
    }
}

#[test]
fn structures_without_kernels_for_instances_are_refused_on_a_gpu() {
    let refused = |kind| tracer_of(&copies(20), Levels::Two, kind, &device()).err();
    for kind in [AccelKind::Brute, AccelKind::Kd] {
        match refused(kind) {
            Some(error) => assert!(error.to_string().contains("placed by instances"), "{error}"),
            None => assert!(!device().is_cuda(), "{kind}"),
        }
    }
}
