//! Any bytes as a material library, with a picture that it may name.
#![no_main]

const OBJ: &[u8] = b"mtllib fuzz.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
/// A Targa picture of two texels.
const PICTURE: &[u8] = b"\0\0\x02\0\0\0\0\0\0\0\0\0\x02\0\x01\0\x20\x08\0\0\0\0\xff\xff\xff\xff";

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    raywarp_fuzz::load_files(&[("fuzz.obj", OBJ), ("fuzz.mtl", bytes), ("a.tga", PICTURE)]);
});
