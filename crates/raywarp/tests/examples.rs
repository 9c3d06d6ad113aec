//! The examples do what they say.

#[allow(dead_code)]
#[path = "../examples/device_rays.rs"]
mod device_rays;
#[allow(dead_code)]
#[path = "../examples/mesh.rs"]
mod mesh;
#[allow(dead_code)]
#[path = "../examples/million_rays.rs"]
mod million_rays;
#[allow(dead_code)]
#[path = "../examples/moving_instances.rs"]
mod moving_instances;
#[allow(dead_code)]
#[path = "../examples/two_cameras.rs"]
mod two_cameras;

use raywarp::image::png;

#[test]
fn a_mesh_from_arrays_becomes_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mesh.png");
    mesh::render(&mesh::pyramid(), [32, 24], &file).unwrap();
    let picture = png::read(&file).unwrap();
    let [red, _, blue] = picture.pixels[12 * 32 + 16];
    assert!(red > blue, "the pyramid is orange, and in the middle");
    let [red, _, blue] = picture.pixels[0];
    assert!(blue >= red, "the sky is not");
}

#[test]
fn rays_find_the_box_below_them() {
    // The box covers three quarters of the square that rays come from.
    assert_eq!(million_rays::hits(100).unwrap(), 7500);
}

#[test]
fn batches_on_streams_are_answered_each_for_itself() {
    let blocked = device_rays::blocked([0.0, 5.0, 0.5], 64).unwrap();
    let shares: Vec<f64> = blocked.iter().map(|&(_, share)| share).collect();
    assert!(shares[0] > 0.25 && shares[0] < 0.5 && shares[2] > 0.25, "{shares:?}");
    assert_eq!(shares[1], 0.0, "nothing is as high as that");
}

#[test]
fn two_eyes_see_two_pictures() {
    let folder = tempfile::tempdir().unwrap();
    two_cameras::render([32, 18], folder.path()).unwrap();
    let read = |name| png::read(&folder.path().join(name)).unwrap();
    let (left, right) = (read("left.png"), read("right.png"));
    assert_eq!([left.width, left.height], [right.width, right.height]);
    assert_ne!(left.pixels, right.pixels);
}

#[test]
fn instances_move_from_frame_to_frame() {
    let folder = tempfile::tempdir().unwrap();
    let after = |frames: u32| {
        let file = folder.path().join(format!("{frames}.png"));
        moving_instances::animate(100, frames, [64, 36], &file).unwrap();
        png::read(&file).unwrap().pixels
    };
    assert!(after(1) == after(1) && after(1) != after(2));
}
