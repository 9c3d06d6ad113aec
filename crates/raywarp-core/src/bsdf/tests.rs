//! Every lobe against what it says of itself: densities, chi-square tests, reciprocity, and the energy that it gives back.

use std::f64::consts::{PI, TAU};

use super::*;
use crate::math::{sin_cos_of_turns, vec3};
use crate::sample::{combine, unit};

/// Columns and rows of the bins over the sphere.
const BINS: [usize; 2] = [16, 24];

fn opaque(metallic: f32, roughness: f32) -> PointMaterial {
    PointMaterial {
        base_color: vec3(0.8, 0.4, 0.2),
        metallic,
        reflectance: Vec3::splat(0.04),
        roughness,
        grazing: 1.0,
        transmission: 0.0,
    }
}

/// Materials whose lobes have a density: matt and metal at some roughnesses, thin walls, and glass from both sides.
fn materials() -> Vec<(&'static str, PointMaterial, Option<Inside>)> {
    let mut all = Vec::new();
    for roughness in [0.3, 0.5, 1.0] {
        for metallic in [0.0, 0.5, 1.0] {
            all.push(("opaque", opaque(metallic, roughness), None));
        }
        let clear = |metallic, transmission| PointMaterial { transmission, ..opaque(metallic, roughness) };
        all.push(("thin wall", clear(0.0, 1.0), None));
        all.push(("thin wall, part", clear(0.25, 0.5), None));
        for eta in [1.0 / 1.5, 1.5, 1.0] {
            all.push(("glass", clear(0.0, 1.0), Some(Inside { eta })));
            all.push(("glass, part", clear(0.25, 0.5), Some(Inside { eta })));
        }
    }
    all
}

fn view(degrees: f32) -> Vec3 {
    let (sine, cosine) = sin_cos_of_turns(degrees / 360.0);
    vec3(0.6 * sine, 0.8 * sine, cosine)
}

/// By shares of the longitude and of the angle from the pole.
fn direction(column: f64, row: f64) -> Vec3 {
    let ((sine, cosine), angle) = ((row * PI).sin_cos(), column * TAU);
    vec3((sine * angle.cos()) as f32, (sine * angle.sin()) as f32, cosine as f32)
}

/// The integral of a function over each bin of the sphere, by the midpoint rule.
fn over_bins(fine: usize, mut f: impl FnMut(Vec3) -> f64) -> Vec<f64> {
    let [columns, rows] = BINS;
    let mut bins = vec![0.0; columns * rows];
    let (all_columns, all_rows) = (columns * fine, rows * fine);
    for row in 0..all_rows {
        let area = PI * TAU / (all_columns * all_rows) as f64 * ((row as f64 + 0.5) / all_rows as f64 * PI).sin();
        for column in 0..all_columns {
            let at = direction((column as f64 + 0.5) / all_columns as f64, (row as f64 + 0.5) / all_rows as f64);
            bins[row / fine * columns + column / fine] += area * f(at);
        }
    }
    bins
}

fn bin(direction: Vec3) -> usize {
    let [columns, rows] = BINS;
    let angle = f64::from(direction.y).atan2(f64::from(direction.x)).rem_euclid(TAU) / TAU;
    let row = f64::from(direction.z).clamp(-1.0, 1.0).acos() / PI * rows as f64;
    (row as usize).min(rows - 1) * columns + ((angle * columns as f64) as usize).min(columns - 1)
}

fn numbers(index: u32) -> ([f32; 2], f32) {
    let number = |dimension| unit(combine(combine(7, index), dimension));
    ([number(0), number(1)], number(2))
}

/// How unlikely counts are, in standard deviations (Wilson and Hilferty's approximation to chi-square).
fn deviation(expected: &[f64], found: &[u32]) -> f64 {
    // Bins of which little is expected count as one.
    let (mut square, mut degrees, mut rare) = (0.0, -1.0, (0.0, 0.0));
    let mut add = |expected: f64, found: f64| {
        square += (found - expected).powi(2) / expected;
        degrees += 1.0;
    };
    for (&expected, &found) in expected.iter().zip(found) {
        if expected >= 8.0 {
            add(expected, f64::from(found));
        } else {
            rare = (rare.0 + expected, rare.1 + f64::from(found));
        }
    }
    if rare.0 >= 8.0 {
        add(rare.0, rare.1);
    } else {
        assert!(rare.1 < 40.0, "{} samples where {} are expected", rare.1, rare.0);
    }
    let spread = 2.0 / (9.0 * f64::max(degrees, 1.0));
    ((square / f64::max(degrees, 1.0)).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[test]
fn directions_are_found_with_the_density_that_is_told() {
    const SAMPLES: u32 = 100_000;
    for (name, material, inside) in materials() {
        for degrees in [5.0, 45.0, 80.0] {
            // There the density ends abruptly within a bin, where the midpoint rule does not see it.
            if degrees > 45.0 && inside.is_some_and(|inside| inside.eta > 1.0) {
                continue;
            }
            let bsdf = Bsdf::new(view(degrees), material, inside);
            let density = over_bins(24, |light| f64::from(bsdf.eval(light).density));
            let mut found = vec![0; density.len()];
            let mut lost = 0;
            for index in 0..SAMPLES {
                let (at, lobe) = numbers(index);
                match bsdf.sample(at, lobe) {
                    Some(sample) if sample.density < f32::INFINITY => found[bin(sample.light)] += 1,
                    _ => lost += 1,
                }
            }
            let what = format!("{name} {material:?} {inside:?} from {degrees} degrees");
            let total: f64 = density.iter().sum::<f64>() + f64::from(lost) / f64::from(SAMPLES);
            assert!((total - 1.0).abs() < 0.01, "{what}: the density integrates to {total}");
            let expected: Vec<f64> = density.iter().map(|density| density * f64::from(SAMPLES)).collect();
            // Of a hundred such tests one in a thousand runs exceeds this.
            let deviation = deviation(&expected, &found);
            assert!(deviation < 4.3, "{what}: {deviation:.1} standard deviations");
        }
    }
}

#[test]
fn light_goes_the_same_way_back() {
    for (name, material, inside) in materials().into_iter().filter(|(_, _, inside)| inside.is_none()) {
        for (a, b) in [(view(10.0), view(70.0)), (view(30.0), vec3(-0.7, 0.1, 0.5).normalize())] {
            let of = |view: Vec3, light: Vec3| Bsdf::new(view, material, inside).eval(light).value / light.z;
            let (there, back) = (of(a, b), of(b, a));
            assert!((there - back).max_abs() <= 1e-4 * there.max_abs(), "{name} {material:?}: {there:?} {back:?}");
        }
    }
}

/// Directional albedo of GGX's lobe with a reflectance of 1, in double precision and by the formulas of Heitz 2014.
fn albedo_of_metal(cosine: f64, alpha: f64) -> f64 {
    let (steps, view) = (400, [(1.0 - cosine * cosine).sqrt(), 0.0, cosine]);
    let square = alpha * alpha;
    let lambda = |z: f64| 0.5 * ((1.0 + square * (1.0 / (z * z) - 1.0)).sqrt() - 1.0);
    let mut sum = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            // Even over the projected hemisphere.
            let (radius, angle) = (((i as f64 + 0.5) / steps as f64).sqrt(), (j as f64 + 0.5) / steps as f64 * TAU);
            let light = [radius * angle.cos(), radius * angle.sin(), (1.0 - radius * radius).sqrt()];
            let half: Vec<f64> = view.iter().zip(light).map(|(a, b)| a + b).collect();
            let length = half.iter().map(|x| x * x).sum::<f64>().sqrt();
            let z = half[2] / length;
            let facets = square / (PI * (z * z * (square - 1.0) + 1.0).powi(2));
            sum += PI * facets / ((1.0 + lambda(cosine) + lambda(light[2])) * 4.0 * cosine * light[2]);
        }
    }
    sum / (steps * steps) as f64
}

/// Mean of the weights: what comes back of light that is the same from all sides.
fn albedo(bsdf: &Bsdf) -> f64 {
    const SAMPLES: u32 = 40_000;
    let weight = |index| {
        let (at, lobe) = numbers(index);
        bsdf.sample(at, lobe).map_or(0.0, |sample| f64::from(sample.weight.y))
    };
    (0..SAMPLES).map(weight).sum::<f64>() / f64::from(SAMPLES)
}

#[test]
fn white_metal_gives_back_what_the_lobe_does_not_lose() {
    for roughness in [0.3f32, 0.6, 1.0] {
        for degrees in [10.0, 60.0] {
            let metal = PointMaterial { base_color: Vec3::ONE, ..opaque(1.0, roughness) };
            let found = albedo(&Bsdf::new(view(degrees), metal, None));
            let expected = albedo_of_metal(f64::from(view(degrees).z), f64::from(roughness * roughness));
            assert!((found - expected).abs() < 0.005, "{roughness} {degrees}: {found} {expected}");
        }
    }
}

/// But at grazing angles the specification's mix of a matt base and a layer does, whose shares are those of different half
/// vectors.
#[test]
fn nothing_gives_back_more_than_it_gets() {
    for roughness in [0.0, 0.01, 0.2, 0.5, 1.0] {
        for (metallic, transmission, steepest) in
            [(0.0, 0.0, 50.0), (1.0, 0.0, 88.0), (0.5, 0.5, 50.0), (0.0, 1.0, 88.0)]
        {
            for degrees in [0.0, 50.0, steepest] {
                let white = PointMaterial { base_color: Vec3::ONE, transmission, ..opaque(metallic, roughness) };
                let found = albedo(&Bsdf::new(view(degrees), white, None));
                assert!(found < 1.005, "{white:?} from {degrees} degrees: {found}");
                let smooth = roughness < 0.03 && transmission + metallic >= 1.0;
                assert!(!smooth || found > 0.995, "{white:?} from {degrees} degrees: {found}");
            }
        }
    }
}

/// Radiance is denser in glass by the square of the index of refraction; without that factor nothing is lost.
#[test]
fn smooth_glass_loses_nothing() {
    for eta in [1.0 / 1.5, 1.5, 1.0, 2.4] {
        for degrees in [0.0, 30.0, 45.0, 85.0] {
            let clear = PointMaterial { base_color: Vec3::ONE, transmission: 1.0, ..opaque(0.0, 0.0) };
            let bsdf = Bsdf::new(view(degrees), clear, Some(Inside { eta }));
            for index in 0..1000 {
                let (at, lobe) = numbers(index);
                let sample = bsdf.sample(at, lobe).unwrap();
                let scale = if sample.light.z < 0.0 { eta * eta } else { 1.0 };
                assert!((sample.weight.y / scale - 1.0).abs() < 1e-5 && sample.density == f32::INFINITY);
                if eta == 1.0 {
                    assert!((sample.light + view(degrees)).max_abs() < 1e-6);
                }
            }
        }
    }
}

#[test]
fn black_and_extreme_surfaces_are_legal() {
    for base_color in [Vec3::ZERO, Vec3::ONE] {
        for roughness in [0.0, 1e-3, 1.0] {
            for (metallic, transmission) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                for inside in [None, Some(Inside { eta: 1.0 }), Some(Inside { eta: 0.01 }), Some(Inside { eta: 100.0 })]
                {
                    let material = PointMaterial { base_color, transmission, ..opaque(metallic, roughness) };
                    let bsdf = Bsdf::new(view(89.9), material, inside);
                    for index in 0..200 {
                        let (at, lobe) = numbers(index);
                        if let Some(sample) = bsdf.sample(at, lobe) {
                            assert!(sample.weight.max_abs().is_finite() && !sample.density.is_nan(), "{material:?}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn frames_are_orthonormal_about_every_direction() {
    for z in [vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, -1.0), vec3(0.6, 0.0, -0.8), vec3(0.36, 0.48, 0.8)] {
        let frame = Frame::about(z);
        for (v, w) in [(frame.x, frame.y), (frame.y, frame.z), (frame.z, frame.x)] {
            assert!(v.dot(w).abs() < 1e-6 && (v.length() - 1.0).abs() < 1e-6);
        }
        let there = vec3(0.1, -0.7, 0.2);
        assert!((frame.to_world(frame.to_local(there)) - there).max_abs() < 1e-6);
    }
}
