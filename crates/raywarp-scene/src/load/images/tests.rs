use super::*;
use crate::LoadOptions;

const ASKER: &str = "a.mtl";

fn asker() -> Asker<'static> {
    Asker { path: Path::new(ASKER), line: Some(7) }
}

fn png(width: u32, height: u32, texel: [u8; 4]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let picture = image::RgbaImage::from_pixel(width, height, image::Rgba(texel));
    picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The picture's index and the warnings after asking twice for it.
fn ask_twice(path: &Path) -> (Scene, Vec<String>) {
    let (mut scene, mut sources) = (Scene::default(), Sources::new(&LoadOptions::default()));
    for _ in 0..2 {
        assert_eq!(from_file(path, asker(), &mut scene, &mut sources).unwrap(), 0);
    }
    assert_eq!(scene.images.len(), 1);
    (scene, sources.into_warnings().iter().map(ToString::to_string).collect())
}

#[test]
fn a_picture_is_decoded_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    std::fs::write(&path, png(3, 2, [1, 2, 3, 4])).unwrap();
    let (mut scene, mut sources) = (Scene::default(), Sources::new(&LoadOptions::default()));
    let crooked = folder.path().join("./").join(".//a.png");
    assert_eq!(from_file(&path, asker(), &mut scene, &mut sources).unwrap(), 0);
    assert_eq!(from_file(&crooked, asker(), &mut scene, &mut sources).unwrap(), 0);
    assert_eq!((scene.images[0].width, scene.images[0].height), (3, 2));
    assert_eq!(scene.images[0].texels, vec![[1, 2, 3, 4]; 6]);
    assert!(sources.into_warnings().is_empty());
}

#[test]
fn each_scene_has_its_own_indices() {
    let mut sources = Sources::new(&LoadOptions::default());
    let mut scenes = [Scene::default(), Scene::default()];
    let bytes = png(1, 1, [9; 4]);
    for (name, scene, index) in [("x", 0, 0), ("y", 0, 1), ("y", 1, 0), ("y", 0, 1), ("y", 1, 0)] {
        assert_eq!(from_bytes(name, &bytes, asker(), &mut scenes[scene], &mut sources).unwrap(), index);
    }
}

#[test]
fn a_missing_picture_is_one_warning_and_a_checker() {
    let (scene, warnings) = ask_twice(Path::new("/nowhere/b.png"));
    assert_eq!(
        warnings,
        ["a.mtl:7: the image /nowhere/b.png cannot be used: No such file or directory (os error 2); a magenta checker \
          stands in for its colours"]
    );
    let image = &scene.images[0];
    assert!(is_fallback(image));
    assert_eq!((image.width, image.height, image.texels.len()), (8, 8, 64));
    assert_eq!(image.texels[..2], [[255, 0, 255, 255], [0, 0, 0, 255]]);
    assert_eq!(image.texels[8], [0, 0, 0, 255]);
}

#[test]
fn a_directory_is_no_picture() {
    let folder = tempfile::tempdir().unwrap();
    let (_, warnings) = ask_twice(folder.path());
    assert!(warnings[0].contains("it is a directory"), "{warnings:?}");
}

#[test]
fn broken_pictures_are_one_warning_each() {
    let folder = tempfile::tempdir().unwrap();
    let whole = png(64, 64, [5; 4]);
    let truncated = &whole[..whole.len() / 2];
    for (name, bytes) in [("empty.png", &b""[..]), ("text.jpg", b"not a picture"), ("cut.png", truncated)] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let (_, warnings) = ask_twice(&path);
        assert_eq!(warnings.len(), 1, "{name}");
        assert!(warnings[0].contains(name) && !warnings[0].contains('\n'), "{warnings:?}");
    }
}

#[test]
fn with_strict_a_missing_picture_is_an_error() {
    let mut sources = Sources::new(&LoadOptions { strict: true });
    let error = from_file(Path::new("b.png"), asker(), &mut Scene::default(), &mut sources).unwrap_err();
    assert!(matches!(error, LoadError::Strict(_)), "{error}");
}

/// A header that promises 30000x30000 texels in a file of a hundred bytes.
#[test]
fn a_bomb_is_refused_by_its_header() {
    let mut bytes = png(1, 1, [0; 4]);
    bytes[16..24].copy_from_slice(&[0, 0, 0x75, 0x30, 0, 0, 0x75, 0x30]);
    let crc = bytes[12..29].iter().fold(!0_u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
    });
    bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
    let reason = decode("bomb.png", &bytes, &Budget::of(u64::MAX)).unwrap_err();
    let Unusable::Reason(reason) = reason else { panic!("{reason:?}") };
    assert!(reason.contains("30000x30000 texels would take 3600000000 bytes"), "{reason}");
}

#[test]
fn sizes_have_limits() {
    assert!(check_size(0, 4, 100).is_err());
    assert!(check_size(32_769, 1, 100).is_err());
    assert!(check_size(4096, 4096, 1).is_ok());
    assert!(check_size(4097, 4096, 1).is_err());
    assert!(check_size(8192, 8192, 1_000_000).is_ok());
    assert!(check_size(32_768, 32_768, u64::MAX).is_err());
}

/// Targa has no signature: only the name tells.
#[test]
fn targa_goes_by_its_name() {
    let mut bytes = Cursor::new(Vec::new());
    image::RgbImage::from_pixel(2, 2, image::Rgb([1, 2, 3])).write_to(&mut bytes, ImageFormat::Tga).unwrap();
    assert_eq!(decode("a.TGA", bytes.get_ref(), &Budget::of(1000)).unwrap().texels, vec![[1, 2, 3, 255]; 4]);
    assert!(decode("a", bytes.get_ref(), &Budget::of(1000)).is_err());
}
