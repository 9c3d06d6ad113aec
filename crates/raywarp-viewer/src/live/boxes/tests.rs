use proptest::prelude::*;
use raywarp::accel::TreeBox;
use raywarp::render;
use raywarp::scene::{Camera, Projection};

use super::eye::Eye;
use super::line::{Band, Line};
use super::{draw, lines};

const SIZE: [u32; 2] = [90, 60];

fn point() -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3(-3.0f32..3.0)
}

fn projection() -> impl Strategy<Value = Projection> {
    prop_oneof![
        (0.05f32..3.0).prop_map(|fov_y| Projection::Perspective { fov_y }),
        (0.1f32..20.0).prop_map(|height| Projection::Orthographic { height }),
    ]
}

fn camera() -> impl Strategy<Value = Camera> {
    (point(), point(), point(), projection())
        .prop_map(|(eye, target, up, projection)| Camera { name: String::new(), eye, target, up, projection })
        .prop_filter("one that sees something", |camera| {
            let apart: f32 = (0..3).map(|i| (camera.eye[i] - camera.target[i]).abs()).sum();
            apart > 0.1 && render::check_camera(camera).is_ok()
        })
}

fn one([a, b]: [[f32; 3]; 2]) -> TreeBox {
    let bounds = [[0, 1, 2].map(|i| a[i].min(b[i])), [0, 1, 2].map(|i| a[i].max(b[i]))];
    TreeBox { bounds, level: 0, is_leaf: true }
}

fn black(size: [u32; 2]) -> Vec<u8> {
    vec![0; 4 * size[0] as usize * size[1] as usize]
}

/// Where a camera shows a point, by the renderer's own rays: those at three corners span all others.
fn shown(camera: &Camera, point: [f64; 3]) -> Option<[f64; 2]> {
    let size = SIZE.map(|side| side as f32);
    let ray = |x, y| {
        let ray = render::ray(camera, SIZE, [x, y]).unwrap();
        [ray.origin, ray.direction].map(|v| glam::DVec3::from(v.to_array().map(f64::from)))
    };
    let [forward_from, forward] = ray(0.5 * size[0], 0.5 * size[1]);
    let sides = [ray(size[0], 0.5 * size[1]), ray(0.5 * size[0], size[1])];
    let away = glam::DVec3::from(point) - forward_from;
    let depth = away.dot(forward);
    let pixel = [0, 1].map(|axis| {
        let [from, direction] = sides[axis];
        // Half of the picture, at the depth of the point.
        let half = from - forward_from + direction * (depth / direction.dot(forward)) - forward * depth;
        f64::from(SIZE[axis]) * (0.5 + 0.5 * away.dot(half) / half.length_squared())
    });
    (depth > 1e-6).then_some(pixel)
}

proptest! {
    #[test]
    fn a_point_of_a_ray_is_shown_where_the_ray_goes_through(
        camera in camera(),
        x in 0.0f32..90.0,
        y in 0.0f32..60.0,
        t in 0.01f32..100.0,
    ) {
        let ray = render::ray(&camera, SIZE, [x, y]).unwrap();
        let at = [0, 1, 2].map(|i| ray.origin.to_array()[i] + t * ray.direction.to_array()[i]);
        let eye = Eye::new(&camera, SIZE).unwrap();
        let corner = eye.corners(&[at, at])[0];
        let [from, to] = eye.project([corner, corner]).expect("what a ray meets is seen");
        prop_assert_eq!(from, to);
        // A point at distance t is rounded by about 1e-6 of the coordinates.
        let size_of_pixel = match camera.projection {
            Projection::Perspective { fov_y } => 2.0 * (0.5 * fov_y).tan() * (0.5 * fov_y).cos() * t / 60.0,
            Projection::Orthographic { height } => height / 60.0,
        };
        let slack = 0.02 + 4e-6 * (10.0 + t) / size_of_pixel;
        prop_assert!((from[0] - x).abs() < slack && (from[1] - y).abs() < slack, "{from:?}, not {x}, {y}");
    }

    #[test]
    fn edges_are_drawn_where_they_are_shown_and_nowhere_else(camera in camera(), corners in [point(), point()]) {
        let item = one(corners);
        let mut picture = black(SIZE);
        draw(&mut picture, SIZE, &camera, &[item], 0);
        let lit = |x: i64, y: i64| {
            let inside = (0..90).contains(&x) && (0..60).contains(&y);
            inside && picture[4 * (y as usize * 90 + x as usize)..][..3] != [0; 3]
        };
        let mut expected = vec![false; 90 * 60];
        let [low, high] = item.bounds.map(|corner| corner.map(f64::from));
        for edge in 0..12 {
            let (axis, others) = (edge / 4, [(edge / 4 + 1) % 3, (edge / 4 + 2) % 3]);
            let at = |t: f64| {
                let mut at = low;
                at[axis] += t * (high[axis] - low[axis]);
                for (k, other) in others.into_iter().enumerate() {
                    at[other] = if edge >> k & 1 == 1 { high[other] } else { low[other] };
                }
                shown(&camera, at)
            };
            // Whoever ends within the middle of a pixel may be left out, so short edges may be invisible.
            let long = matches!([at(0.0), at(1.0)], [Some(a), Some(b)] if (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) > 2.0);
            for i in 0..=2_000 {
                let Some([x, y]) = at(f64::from(i) / 2_000.0) else { continue };
                if !(-2.0..92.0).contains(&x) || !(-2.0..62.0).contains(&y) {
                    continue;
                }
                let (column, row) = (x.floor() as i64, y.floor() as i64);
                let around = || (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (column + dx, row + dy)));
                if long && (2.0..88.0).contains(&x) && (2.0..58.0).contains(&y) {
                    prop_assert!(around().any(|(x, y)| lit(x, y)), "nothing at {x}, {y}");
                }
                for (x, y) in around().filter(|(x, y)| (0..90).contains(x) && (0..60).contains(y)) {
                    expected[(y * 90 + x) as usize] = true;
                }
            }
        }
        // Next to the eye 2000 samples an edge are not enough.
        let is_far = |corner: usize| {
            let p: [f64; 3] = std::array::from_fn(|i| if corner >> i & 1 == 1 { high[i] } else { low[i] });
            shown(&camera, p).is_some_and(|[x, y]| x.abs().max(y.abs()) < 500.0)
        };
        if (0..8).all(is_far) {
            let wrong = (0..90 * 60).find(|&at| lit(at as i64 % 90, at as i64 / 90) && !expected[at]);
            prop_assert!(wrong.is_none(), "lit without an edge: {wrong:?}");
        }
    }

    #[test]
    fn nothing_is_too_odd_to_draw(
        numbers in prop::array::uniform16(number()),
        level in 0u32..100,
        parallel: bool,
        size in [1u32..70, 1u32..70],
    ) {
        let [ex, ey, ez, tx, ty, tz, ux, uy, uz, lens, rest @ ..] = numbers;
        let projection = match parallel {
            true => Projection::Orthographic { height: lens },
            false => Projection::Perspective { fov_y: if lens.abs() > 4.0 { 1.0 } else { lens } },
        };
        let (eye, target, up) = ([ex, ey, ez], [tx, ty, tz], [ux, uy, uz]);
        let camera = Camera { name: String::new(), eye, target, up, projection };
        let [a, b, c, d, e, f] = rest;
        let odd = TreeBox { bounds: [[a, b, c], [d, e, f]], level, is_leaf: false };
        let mut picture = black(size);
        draw(&mut picture, size, &camera, &[odd, one(odd.bounds)], level);
        prop_assert!(picture.chunks_exact(4).all(|pixel| pixel[3] == 0));
        if let Some(eye) = Eye::new(&camera, size) {
            for line in lines(&eye, size, &[odd, one(odd.bounds)], u32::MAX) {
                let close = |end: [f32; 2]| (0..2).all(|i| end[i] >= -8.0 && end[i] <= size[i] as f32 + 8.0);
                prop_assert!(line.ends.into_iter().all(close), "{line:?}");
            }
        }
    }

    #[test]
    fn bands_of_any_height_make_one_picture(
        ends in [[-8.0f32..78.0, -8.0f32..58.0], [-8.0f32..78.0, -8.0f32..58.0]],
        width in 0.5f32..6.0,
        rows in 1usize..50,
    ) {
        let line = Line { ends, color: [255, 9, 90], width, strength: 0.7 };
        let drawn = |rows: usize| {
            let mut picture = black([70, 50]);
            for (band, pixels) in picture.chunks_mut(4 * 70 * rows).enumerate() {
                line.draw(&mut Band { pixels, columns: 70, first: band * rows });
            }
            picture
        };
        prop_assert!(drawn(rows) == drawn(50));
    }
}

/// Of every size, and what is none.
fn number() -> impl Strategy<Value = f32> {
    let odd =
        [0.0, -0.0, 1.0, -1.0, f32::MAX, -f32::MAX, f32::MIN_POSITIVE, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    prop_oneof![4 => -3.0f32..3.0, 1 => any::<f32>(), 1 => prop::sample::select(odd.to_vec())]
}

fn from(eye: [f32; 3], target: [f32; 3]) -> Camera {
    let projection = Projection::Perspective { fov_y: 1.0 };
    Camera { name: String::new(), eye, target, up: [0.0, 1.0, 0.0], projection }
}

fn lit(camera: &Camera, boxes: &[TreeBox]) -> usize {
    let mut picture = black(SIZE);
    draw(&mut picture, SIZE, camera, boxes, 9);
    picture.chunks_exact(4).filter(|pixel| pixel[..3] != [0; 3]).count()
}

#[test]
fn a_box_behind_the_eye_or_at_no_place_is_not_drawn() {
    let whole = one([[-1.0; 3], [1.0; 3]]);
    assert!(lit(&from([0.0, 0.0, 5.0], [0.0; 3]), &[whole]) > 100);
    assert_eq!(lit(&from([0.0, 0.0, 5.0], [0.0, 0.0, 9.0]), &[whole]), 0);
    let parallel = Camera { projection: Projection::Orthographic { height: 4.0 }, ..from([0.0, 0.0, 5.0], [0.0; 3]) };
    assert!(lit(&parallel, &[whole]) > 100);
    assert_eq!(lit(&Camera { target: [0.0, 0.0, 9.0], ..parallel }, &[whole]), 0);
    let nowhere = TreeBox { bounds: [[f32::NAN; 3], [1.0; 3]], ..whole };
    assert_eq!(lit(&from([0.0, 0.0, 5.0], [0.0; 3]), &[nowhere]), 0);
    assert_eq!(lit(&from([0.0, 0.0, 5.0], [0.0, 0.0, 5.0]), &[whole]), 0);
}

#[test]
fn from_inside_a_box_its_edges_are_seen() {
    assert!(lit(&from([0.0, 0.0, 0.9], [0.0; 3]), &[one([[-1.0; 3], [1.0; 3]])]) > 50);
}

#[test]
fn a_picture_of_another_size_stays_as_it_is() {
    let whole = one([[-1.0; 3], [1.0; 3]]);
    for (bytes, size) in [(0, [0, 0]), (0, [7, 0]), (7, SIZE), (4 * 90 * 60 - 4, SIZE), (16, [u32::MAX, u32::MAX])] {
        let mut picture = vec![0; bytes];
        draw(&mut picture, size, &from([0.0, 0.0, 5.0], [0.0; 3]), &[whole], 0);
        assert!(picture.iter().all(|&byte| byte == 0));
    }
}

#[test]
fn deeper_boxes_than_the_level_are_not_drawn() {
    let camera = from([0.0, 0.0, 5.0], [0.0; 3]);
    let root = TreeBox { is_leaf: false, ..one([[-1.0; 3], [1.0; 3]]) };
    let deep = TreeBox { level: 10, ..one([[-0.2; 3], [0.2; 3]]) };
    assert_eq!(lit(&camera, &[deep]), 0);
    assert_eq!(lit(&camera, &[root, deep]), lit(&camera, &[root]));
    // What is above the level is fainter.
    let mut pictures = [black(SIZE), black(SIZE)];
    draw(&mut pictures[0], SIZE, &camera, &[root, deep], 0);
    draw(&mut pictures[1], SIZE, &camera, &[root, deep], 10);
    let brightest = |picture: &[u8]| picture.chunks_exact(4).map(|pixel| pixel[0]).max();
    assert!(brightest(&pictures[1]) < brightest(&pictures[0]) || pictures[0] == pictures[1]);
}
