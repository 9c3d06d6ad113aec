//! `raywarp-lab bench`: that of `raywarp`, over every structure.

use raywarp::accel::{AccelKind, Quality};
use raywarp::device::{Device, DeviceChoice};
use raywarp::device_scene::world_triangles;
use raywarp::render::Tracer;
use raywarp::scene::Scene;
use raywarp::{Ray, Triangle};
use raywarp_cli::bench::{self, BenchOptions, Built, Structures};
use raywarp_cli::failure::Result;
use raywarp_lab::structures::{Build, StructureKind, Tree};

/// Measures what the options ask for.
pub fn run(options: &BenchOptions) -> Result<()> {
    bench::run_with(options, &Every)
}

/// Every structure.
struct Every;

impl Structures for Every {
    fn open(&self, choice: DeviceChoice) -> Result<Device> {
        Ok(raywarp_lab::open(choice)?)
    }

    fn is_hierarchy(&self, name: &str) -> Result<bool> {
        Ok(name.parse::<StructureKind>()?.is_hierarchy())
    }

    fn build(&self, name: &str, quality: Quality, triangles: &[Triangle], device: &Device) -> Result<Built> {
        let tree = Tree::build(Build { kind: name.parse()?, quality }, triangles.to_vec())?;
        let (caster, stats) = (tree.caster(device)?, tree.stats());
        let triangle_bytes = size_of_val(&*tree.triangles());
        let tests = Box::new(move |rays: &[Ray], any_hit, most| tree.tests(rays, any_hit, most));
        Ok(Built { caster, stats, triangle_bytes, tests })
    }

    fn tracer(&self, name: &str, scene: &Scene, device: &Device) -> Result<Tracer> {
        let mut tracer = Tracer::new(scene, AccelKind::Bvh2, device)?;
        let triangles = world_triangles(scene, &scene.instances, &scene.materials)?;
        let build = Build::from(name.parse::<StructureKind>()?);
        tracer.scene_mut()?.replace(Tree::build(build, triangles)?.structure(build.quality, device)?);
        Ok(tracer)
    }
}
