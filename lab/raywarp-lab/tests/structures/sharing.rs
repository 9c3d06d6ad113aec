//! Every way to share out rays gives the answers of brute force, to the bit, and leaves its queues as they were.

use raywarp::accel::bvh2::Bvh2;
use raywarp::accel::{Accel, AccelKind};
use raywarp::device::Device;
use raywarp::query::{opaque_triangles, Answers, RayCaster, RayKind, RaySource};
use raywarp::scene::Camera;
use raywarp::Triangle;
use raywarp_lab::lanes::LoopForm;
use raywarp_lab::paths::{PathBatch, Scheme, Surfaces};
use raywarp_lab::{Batch, Queues, Way};

const WAYS: [Way; 9] = [
    Way::Direct(LoopForm::IfIf),
    Way::Direct(LoopForm::WhileWhile),
    Way::Direct(LoopForm::Speculative),
    Way::Direct(LoopForm::Postponed),
    Way::Queued(Queues::Global),
    Way::Queued(Queues::Block),
    Way::Queued(Queues::Warp),
    Way::Refill,
    Way::RefillSpeculative,
];

fn subject() -> (Vec<Triangle>, Camera) {
    let scene = raywarp::scene::load::builtin().unwrap().scene;
    (opaque_triangles(&scene).unwrap(), scene.cameras[0].clone())
}

fn tree(triangles: &[Triangle]) -> Bvh2 {
    match Accel::build(AccelKind::Bvh2, triangles.to_vec()).unwrap() {
        Accel::Bvh2(tree) => tree,
        _ => panic!("a bvh2 was asked for"),
    }
}

#[test]
fn every_way_gives_every_ray_the_same_answer() {
    crate::devices().iter().for_each(answers_are_those_of_brute_force);
}

fn answers_are_those_of_brute_force(device: &Device) {
    let (triangles, camera) = subject();
    let tree = tree(&triangles);
    let source = RaySource::new(&triangles, &camera, [61, 37]).unwrap();
    let mut rays = source.primary().rays;
    rays.extend(source.workload(RayKind::Random, &[], 3000).rays);
    let caster = RayCaster::new(triangles, AccelKind::Brute, device).unwrap();
    for count in [0, 1, 31, rays.len()] {
        let rays = &rays[..count];
        for any_hit in [false, true] {
            let expected = match any_hit {
                true => Answers::Occluded(caster.any(rays).unwrap()),
                false => Answers::Closest(caster.hits(rays).unwrap()),
            };
            for way in WAYS {
                let mut batch = Batch::new(device, &tree, rays, any_hit).unwrap();
                for threads in [64, 32, 128, 256] {
                    batch.set_block(threads).unwrap();
                    batch.clear().unwrap();
                    assert_eq!(batch.time(way, [1, 2]).unwrap().len(), 2);
                    assert!(batch.is_reset().unwrap(), "{way:?}, {count} rays, {threads} threads");
                    assert!(batch.answers().unwrap() == expected, "{way:?}, {count} rays, any hit: {any_hit}");
                }
            }
        }
    }
}

#[test]
fn all_schemes_follow_the_same_paths() {
    crate::devices().iter().for_each(paths_end_at_the_same_places);
}

fn paths_end_at_the_same_places(device: &Device) {
    let (triangles, camera) = subject();
    let tree = tree(&triangles);
    let source = RaySource::new(&triangles, &camera, [53, 31]).unwrap();
    let rays = source.primary().rays;
    for surfaces in [Surfaces::Mirrors, Surfaces::Diffuse] {
        let mut batch = PathBatch::new(device, &tree, &triangles, &rays, surfaces, 5, source.offset()).unwrap();
        batch.follow(Scheme::OneKernel).unwrap();
        let expected = batch.trails().unwrap();
        assert!(expected.iter().all(|trail| (1..=6).contains(&trail.rays)));
        assert!(expected.iter().any(|trail| trail.rays > 2));
        for scheme in [Scheme::Wavefront, Scheme::SortedWavefront, Scheme::Wavefront] {
            batch.follow(scheme).unwrap();
            assert!(batch.trails().unwrap() == expected, "{scheme:?}, {surfaces:?}");
        }
    }
}
