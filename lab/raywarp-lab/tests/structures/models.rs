//! The study's models against slow references: counts must be those of the traversal that renders.

use raywarp::accel::bvh2::Bvh2;
use raywarp::accel::{Accel, AccelKind, Quality};
use raywarp::device::{Device, DeviceChoice};
use raywarp::device_scene::Structure;
use raywarp::query::{opaque_triangles, RayCaster, RayKind, RaySource};
use raywarp::render::{RenderOptions, Tracer};
use raywarp::scene::Scene;
use raywarp::{Ray, Triangle};
use raywarp_core::traversal::{Tests, START};
use raywarp_lab::clocks::{follow, stage_times};
use raywarp_lab::lanes::{batch, frame, LaneSteps, Log, LoopForm, WARP};

const SIZE: [u32; 2] = [64, 32];

struct Subject {
    scene: Scene,
    triangles: Vec<Triangle>,
    tree: Accel,
}

impl Subject {
    fn new() -> Self {
        let scene = raywarp::scene::load::builtin().unwrap().scene;
        let triangles = opaque_triangles(&scene).unwrap();
        let tree = Accel::build(AccelKind::Bvh2, triangles.clone()).unwrap();
        Self { scene, triangles, tree }
    }

    fn bvh2(&self) -> &Bvh2 {
        let Accel::Bvh2(tree) = &self.tree else { panic!("a bvh2 was asked for") };
        tree
    }

    fn rays(&self, kind: RayKind) -> Vec<Ray> {
        let source = RaySource::new(&self.triangles, &self.scene.cameras[0], SIZE).unwrap();
        let primary = source.primary();
        let device = Device::open(DeviceChoice::Cpu).unwrap();
        let caster = RayCaster::of_structure(Structure::of(&self.tree, Quality::High, &device).unwrap(), &device);
        let spots = source.spots(&primary.rays, &caster.hits(&primary.rays).unwrap());
        source.workload(kind, &spots, 2048).rays
    }

    /// Nodes and triangles of all rays, by the traversal that renders.
    fn tests(&self, rays: &[Ray], any_hit: bool) -> u64 {
        let mut tests = Tests::default();
        for ray in rays {
            match any_hit {
                true => drop(self.tree.occlusion(ray, &mut tests)),
                false => drop(self.tree.closest(ray, &START, &mut tests)),
            }
        }
        u64::from(tests.nodes) + u64::from(tests.triangles)
    }
}

fn adds_up(sum: &LaneSteps) {
    assert_eq!(sum.useful + sum.boxes + sum.leaves + sum.finished + sum.shading, sum.steps * WARP as u64, "{sum:?}");
}

/// The forms that put nothing off do what the renderer does, and no lane works more than it.
#[test]
fn useful_steps_are_those_of_the_renderer() {
    let subject = Subject::new();
    for kind in [RayKind::Primary, RayKind::Shadow, RayKind::Diffuse] {
        let rays = subject.rays(kind);
        let tests = subject.tests(&rays, kind.any_hit());
        for form in LoopForm::ALL {
            let sum = batch(subject.bvh2(), &rays, kind.any_hit(), form, usize::MAX);
            adds_up(&sum);
            match form {
                LoopForm::IfIf | LoopForm::WhileWhile => assert_eq!(sum.useful, tests, "{kind}, {form:?}"),
                // A leaf that is put off shortens the ray later.
                LoopForm::Speculative | LoopForm::Postponed => assert!(sum.useful >= tests, "{kind}, {form:?}"),
            }
        }
    }
}

/// Warps of one lane wait for nobody.
#[test]
fn a_lane_alone_only_waits_for_missing_ones() {
    let subject = Subject::new();
    for ray in subject.rays(RayKind::Primary).iter().step_by(97) {
        let sum = batch(subject.bvh2(), std::slice::from_ref(ray), false, LoopForm::WhileWhile, usize::MAX);
        assert_eq!((sum.boxes, sum.leaves, sum.shading), (0, 0, 0));
        assert_eq!((sum.useful, sum.finished), (sum.steps, 31 * sum.steps));
    }
}

/// Two models of one thing: frames without bounces and shadows are batches of primary rays.
#[test]
fn a_frame_of_camera_rays_is_a_batch() {
    let subject = Subject::new();
    let tracer = Tracer::new(&subject.scene, AccelKind::Bvh2, &Device::open(DeviceChoice::Cpu).unwrap()).unwrap();
    let options = RenderOptions { size: SIZE, spp: 1, max_depth: 0, shadows: false, ..RenderOptions::default() };
    let rays = subject.rays(RayKind::Primary);
    let mut expected = LaneSteps::default();
    let mut modelled = LaneSteps::default();
    // Rays of a batch come in tiles of 8 x 4 pixels.
    for (warp, rays) in rays.chunks(WARP).enumerate() {
        let (x0, y0) = (warp as u32 % (SIZE[0] / 8) * 8, warp as u32 / (SIZE[0] / 8) * 4);
        let pixels: Vec<[u32; 2]> = (0..32).map(|i| [x0 + i % 8, y0 + i / 8]).collect();
        let logs: Vec<Log> = follow(&tracer, &subject.scene.cameras[0], &options, &pixels).unwrap().unwrap();
        modelled = modelled.plus(frame(&logs));
        expected = expected.plus(batch(subject.bvh2(), rays, false, LoopForm::WhileWhile, usize::MAX));
    }
    adds_up(&modelled);
    assert_eq!(modelled, expected);
}

/// What a frame's lanes do is what its counting kernel counts.
#[test]
fn a_frame_with_all_rays_is_followed_whole() {
    let subject = Subject::new();
    let tracer = Tracer::new(&subject.scene, AccelKind::Bvh2, &Device::open(DeviceChoice::Cpu).unwrap()).unwrap();
    let camera = &subject.scene.cameras[0];
    let options = RenderOptions { size: SIZE, spp: 1, ..RenderOptions::default() };
    let pixels: Vec<[u32; 2]> = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y])).collect();
    let logs: Vec<Log> = follow(&tracer, camera, &options, &pixels).unwrap().unwrap();
    let sum = logs.chunks(WARP).map(frame).fold(LaneSteps::default(), LaneSteps::plus);
    adds_up(&sum);
    let costs = tracer.costs(camera, &options).unwrap();
    assert_eq!(sum.useful, costs.tests.iter().map(|t| u64::from(t.nodes) + u64::from(t.triangles)).sum::<u64>());
    assert!(sum.shading > 0 && costs.ticks.iter().all(|&ticks| ticks > 0));
}

/// Stages fill a thread's time: what is missing is what reading the clock takes.
#[test]
fn stages_add_up_to_a_frame() {
    let subject = Subject::new();
    let device = Device::open(DeviceChoice::Cpu).unwrap();
    let options = RenderOptions { size: SIZE, spp: 1, ..RenderOptions::default() };
    for kind in [AccelKind::Brute, AccelKind::Kd, AccelKind::Bvh2] {
        let tracer = Tracer::new(&subject.scene, kind, &device).unwrap();
        let stages = stage_times(&tracer, &subject.scene.cameras[0], &options).unwrap().unwrap();
        assert!(stages.iter().all(|&time| time > 0), "{kind}: {stages:?}");
    }
    let tracer = Tracer::new(&subject.scene, AccelKind::Bvh8f, &device).unwrap();
    assert_eq!(stage_times(&tracer, &subject.scene.cameras[0], &options).unwrap(), None);
}
