//! Whole pictures: the same on every structure and device, whatever the cut into launches, and as they were.

use raywarp::accel::AccelKind;
use raywarp::device::Device;
use raywarp::image::png;
use raywarp::render::{RenderOptions, Rendering, Tracer};

use super::{device, kinds, reference, scene};

const SCENES: [&str; 3] = ["built-in", "cornell/cornell.toml", "glass/glass.toml"];

fn options() -> RenderOptions {
    RenderOptions { size: [160, 90], spp: 2, ..RenderOptions::default() }
}

fn render(path: &str, kind: AccelKind, device: &Device, options: &RenderOptions) -> Rendering {
    let tracer = Tracer::new(&scene(path), kind, device).unwrap();
    tracer.render(tracer.default_camera(), options, &mut |_| ()).unwrap()
}

fn differing(a: &[[f32; 4]], b: &[[f32; 4]]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a.map(f32::to_bits) != b.map(f32::to_bits)).count()
}

/// Every structure on the device under test against the hierarchy on the CPU, bit by bit.
#[test]
fn every_structure_gives_the_same_picture() {
    let size = if device().is_cuda() { [320, 180] } else { [64, 36] };
    let options = RenderOptions { size, spp: 1, ..options() };
    for path in SCENES {
        let expected = render(path, AccelKind::Bvh, &reference(), &options);
        assert_eq!(expected.non_finite, 0, "{path}");
        for kind in kinds() {
            let rendering = render(path, kind, &device(), &options);
            let differing = differing(&expected.picture.pixels, &rendering.picture.pixels);
            println!("{path}, {kind}: {differing} pixels differ");
            assert_eq!(differing, 0, "{path}, {kind}");
        }
    }
}

/// The same structure on both machines: every pixel and every count the same.
#[test]
fn two_machines_give_the_same_bits() {
    for path in SCENES {
        for kind in [AccelKind::Kd, AccelKind::Bvh] {
            let size = if device().is_cuda() { [640, 360] } else { [96, 54] };
            let counted = RenderOptions { count_tests: true, size, spp: 1, ..options() };
            let [a, b] = [reference(), device()].map(|device| render(path, kind, &device, &counted));
            assert_eq!(differing(&a.picture.pixels, &b.picture.pixels), 0, "{path}, {kind}");
            assert_eq!(a.tests, b.tests, "{path}, {kind}: tests of each pixel");
            let plain = render(path, kind, &device(), &RenderOptions { count_tests: false, ..counted });
            assert_eq!(differing(&a.picture.pixels, &plain.picture.pixels), 0, "{path}, {kind}: without counting");
        }
    }
}

#[test]
fn layers_are_the_same_on_both_machines() {
    for path in SCENES {
        let [a, b] = [reference(), device()].map(|device| {
            let tracer = Tracer::new(&scene(path), AccelKind::Bvh, &device).unwrap();
            tracer.layers(tracer.default_camera(), &options()).unwrap()
        });
        assert_eq!(a, b, "{path}");
        assert!(a.iter().any(|first_hit| first_hit.depth.is_finite()), "{path}");
    }
}

/// Many launches, each with some rows or some of the samples, against one launch for each strip of the picture.
#[test]
fn the_cut_into_launches_does_not_show() {
    let size = if device().is_cuda() { [2560, 1440] } else { [320, 180] };
    let options = RenderOptions { size, spp: 5, max_depth: 1, ..RenderOptions::default() };
    let whole = render("built-in", AccelKind::Bvh, &device(), &options);
    assert!(whole.launches > 1, "{} launches", whole.launches);
    let strip = |row: u32| RenderOptions { crop: Some([0, row, size[0], row + 36]), ..options };
    let strips = (0..size[1])
        .step_by(36)
        .flat_map(|row| render("built-in", AccelKind::Bvh, &device(), &strip(row)).picture.pixels);
    assert_eq!(differing(&whole.picture.pixels, &strips.collect::<Vec<_>>()), 0);
}

#[test]
fn a_crop_is_a_part_of_the_whole() {
    let whole = render("built-in", AccelKind::Bvh, &device(), &options());
    let crop = RenderOptions { crop: Some([31, 17, 98, 80]), ..options() };
    let part = render("built-in", AccelKind::Bvh, &device(), &crop).picture;
    assert_eq!((part.width, part.height), (67, 63));
    for (index, pixel) in part.pixels.iter().enumerate() {
        let (x, y) = (31 + index % 67, 17 + index / 67);
        assert_eq!(pixel, &whole.picture.pixels[y * 160 + x], "{x}, {y}");
    }
}

/// As 8-bit pictures against those committed: at most 2 steps off in any channel and 0.02 in the mean.
/// `RAYWARP_BLESS=1` writes them anew, to be looked at before they are committed.
#[test]
fn pictures_are_as_they_were() {
    for path in SCENES {
        let rendering = render(path, AccelKind::Bvh, &device(), &options());
        let picture = png::tone_map(&rendering.picture, &Default::default());
        let name = path.rsplit('/').next().unwrap().replace(".toml", "");
        let file = format!("{}/tests/conformance/golden/{name}.png", env!("CARGO_MANIFEST_DIR"));
        if std::env::var_os("RAYWARP_BLESS").is_some() {
            std::fs::write(&file, png::encode(&picture).unwrap()).unwrap();
            continue;
        }
        let golden = image::load_from_memory(golden(&name)).unwrap().to_rgb8();
        assert_eq!((golden.width(), golden.height()), (picture.width, picture.height), "{path}");
        let steps = golden.pixels().zip(&picture.pixels).flat_map(|(a, b)| (0..3).map(|i| a.0[i].abs_diff(b[i])));
        let (largest, sum) = steps.fold((0, 0), |(largest, sum), s| (s.max(largest), sum + s as usize));
        let mean = sum as f64 / (3 * picture.pixels.len()) as f64;
        assert!(largest <= 2 && mean <= 0.02, "{path}: {largest} steps off at most, {mean:.4} in the mean");
    }
}

/// Compiled in, for machines without the sources.
fn golden(name: &str) -> &'static [u8] {
    match name {
        "built-in" => include_bytes!("golden/built-in.png"),
        "cornell" => include_bytes!("golden/cornell.png"),
        "glass" => include_bytes!("golden/glass.png"),
        _ => panic!("no golden picture of {name}"),
    }
}
